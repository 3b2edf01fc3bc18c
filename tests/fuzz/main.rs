//! Fuzzing with random hostile input: nearly correct texts for every parser, absurd scenes with every stepper, solver
//! method and remedy (an optional correction of a stepper), and whole command lines. Nothing may panic, hang or fail
//! silently.
//!
//! Each run of these tests tries the same inputs. A target is one kind of input, and it defines the number of its
//! inputs. `SLUMP_FUZZ_TIMES` multiplies this number; `SLUMP_FUZZ_SECS` sets instead for how many seconds each target
//! tries inputs. Another `SLUMP_FUZZ_SEED` gives other inputs. `ARBTEST_SEED` gives only the input with the seed that a
//! failure message names. A failing input stays in a file that the failure message names. Move this file to the folder
//! of its target in `corpus/` and keep it there: these files are tried first.

#[path = "../common/columnar.rs"]
mod columnar;
#[path = "../common/program.rs"]
mod program;

mod command_lines;
mod files;
mod parsers;
mod scenes;
mod trial;

use arbitrary::Unstructured;

use program::*;
use trial::Trial;

/// Number of random bytes from which an input is made. No kind of input needs more.
const DRAWN_FROM: u64 = 1 << 16;

#[derive(Clone, Copy)]
struct Target {
    name: &'static str,
    ending: &'static str,
    /// Number of random inputs in an ordinary run of the tests, which takes about a second per target (kind of input).
    inputs: u64,
}

impl Target {
    /// Tries the inputs in `kept` and then random inputs, which `draw` makes from random bytes, and prints the number
    /// of inputs. `check` gets each input as a text and as the path of a file with this text, and returns true if the
    /// program accepted the input.
    fn fuzz(
        self,
        kept: &[String],
        mut draw: impl FnMut(&mut Unstructured<'_>) -> arbitrary::Result<String>,
        mut check: impl FnMut(&str, &Path) -> bool,
    ) {
        let mut trial = Trial::start(self);
        for text in kept {
            trial.of(text, &mut check);
        }
        let mut property = |u: &mut Unstructured<'_>| {
            if let Ok(text) = draw(u) {
                trial.of(&text, &mut check);
            }
            Ok(())
        };
        if std::env::var_os("ARBTEST_SEED").is_some() {
            return arbtest::arbtest(property).run();
        }
        let (run, begun) = (asked_for("SLUMP_FUZZ_SEED").unwrap_or(1), Instant::now());
        let secs = asked_for("SLUMP_FUZZ_SECS").map(Duration::from_secs);
        let inputs = self.inputs * asked_for("SLUMP_FUZZ_TIMES").unwrap_or(1);
        let mut number = 0;
        while secs.map_or(number < inputs, |secs| begun.elapsed() < secs) {
            arbtest::arbtest(&mut property).seed(seed(run, number)).run();
            number += 1;
        }
        let Trial { inputs, taken, .. } = trial;
        println!("{}: {inputs} inputs, {} of them kept, {taken} taken", self.name, kept.len());
    }

    /// Returns all stored inputs of this target: inputs that have failed in the past, and known hostile inputs.
    fn corpus(self) -> Vec<String> {
        let ours = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fuzz/corpus");
        let folder = ours.join(self.name);
        names_in(&folder).iter().map(|name| read(folder.join(name))).collect()
    }
}

fn asked_for(variable: &str) -> Option<u64> {
    let number = |text: String| text.parse().unwrap_or_else(|_| panic!("{variable} is {text}"));
    std::env::var(variable).ok().map(number)
}

/// Returns the seed from which input number `number` is made. `run` is the value of `SLUMP_FUZZ_SEED` for this run of
/// the tests. The seed has random bits in the upper half, and the number of random bytes in the lower half.
fn seed(run: u64, number: u64) -> u64 {
    let hash = blake3::hash(&[run.to_le_bytes(), number.to_le_bytes()].concat());
    let random = hash.as_bytes().iter().take(4).fold(0, |seed, &byte| seed << 8 | u64::from(byte));
    random << u32::BITS | DRAWN_FROM
}
