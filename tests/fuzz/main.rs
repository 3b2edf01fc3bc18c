//! Hostile input, at random: every parser with texts that are nearly right, scenes that nobody would write
//! with every stepper, method and remedy, and whole command lines. Nothing may panic, hang or pass in
//! silence.
//!
//! Each target runs for a moment in the ordinary suite, for as long as `SLUMP_FUZZ_SECS` says otherwise:
//! `SLUMP_FUZZ_SECS=1030 cargo test --release --test fuzz` takes an hour on two cores. What fails stays in
//! a file that the failure names. It goes to the target's folder in `corpus/`, whose files are tried first,
//! and stays there.

mod books;
mod command_lines;
mod parsers;
mod run;
mod scenes;
mod texts;
mod trial;

use std::path::{Path, PathBuf};
use std::time::Duration;

use arbitrary::Unstructured;

use trial::Trial;

/// Time that a target gets where nothing else is said, s.
const MOMENT_SECS: f64 = 1.0;

/// What takes longer is not tried with changes: too few other inputs would be.
const QUICK: Duration = Duration::from_millis(50);

/// A kind of input.
#[derive(Clone, Copy)]
struct Target {
    /// Its folder in the corpus.
    name: &'static str,
    /// How the names of its files end.
    ending: &'static str,
}

impl Target {
    /// Tries what is in `kept`, then what `draw` makes of random bytes for as long as asked for, and says
    /// how many inputs there were. `draw` gets those of `kept` that are quick. `check` gets each as a text
    /// and as a file; whether it was taken.
    fn fuzz(
        self,
        kept: &[String],
        mut draw: impl FnMut(&mut Unstructured<'_>, &[String]) -> arbitrary::Result<String>,
        mut check: impl FnMut(&str, &Path) -> bool,
    ) {
        let mut trial = Trial::start(self);
        let mut quick = kept.to_vec();
        quick.retain(|text| trial.of(text, &mut check) < QUICK);
        let secs = std::env::var("SLUMP_FUZZ_SECS").ok().and_then(|secs| secs.parse().ok());
        let millis = 1e3 * secs.unwrap_or(MOMENT_SECS);
        arbtest::arbtest(|u| {
            trial.of(&draw(u, &quick)?, &mut check);
            Ok(())
        })
        .budget_ms(millis as u64)
        .run();
        let Trial { inputs, taken, .. } = trial;
        println!("{}: {inputs} inputs, {} of them kept, {taken} taken", self.name, kept.len());
    }

    /// Everything that ever failed, and what is known to be hostile.
    fn corpus(self) -> Vec<String> {
        let ours = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fuzz/corpus");
        let entries = std::fs::read_dir(ours.join(self.name)).expect("a folder of the corpus");
        let mut paths: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
        paths.sort();
        paths.iter().map(|path| std::fs::read_to_string(path).expect("a text")).collect()
    }
}
