//! Hostile input, at random: every parser with texts that are nearly right, scenes that nobody would write
//! with every stepper, method and remedy, and whole command lines. Nothing may panic, hang or pass in
//! silence.
//!
//! Each target runs for a moment in the ordinary suite, for as long as `SLUMP_FUZZ_SECS` says otherwise:
//! `SLUMP_FUZZ_SECS=1030 cargo test --release --test fuzz` takes an hour on two cores. What fails stays in
//! a file that the failure names. It goes to the target's folder in `corpus/`, whose files are tried first,
//! and stays there.

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

/// Time that a target gets where nothing else is said, s.
const MOMENT_SECS: f64 = 1.0;

/// What takes longer is not tried with changes: too few other inputs would be.
const QUICK: Duration = Duration::from_millis(50);

#[derive(Clone, Copy)]
struct Target {
    name: &'static str,
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
        let folder = ours.join(self.name);
        names_in(&folder).iter().map(|name| read(folder.join(name))).collect()
    }
}
