//! Hostile input, at random: every parser with texts that are nearly right, and scenes that nobody would
//! write with every stepper, method and remedy. Nothing may panic, hang or pass in silence.
//!
//! Each target runs for a moment in the ordinary suite, for as long as `SLUMP_FUZZ_SECS` says otherwise:
//! `SLUMP_FUZZ_SECS=600 cargo test --release --test fuzz` takes an hour on two cores. A failure prints a seed;
//! its input goes to `corpus/`, whose files are tried first, and stays there.

mod parsers;
mod scenes;
mod texts;

use std::time::{Duration, Instant};

use arbitrary::Unstructured;

/// Time that a target gets where nothing else is said, s.
const MOMENT_SECS: f64 = 1.0;
/// More than an input may take: it would be a hang to whoever waits for it.
const PATIENCE: Duration = Duration::from_secs(20);

/// Tries inputs made of random bytes for as long as asked for, and says how many there were.
fn fuzz(name: &str, mut one: impl FnMut(&mut Unstructured<'_>) -> arbitrary::Result<()>) {
    let secs = std::env::var("SLUMP_FUZZ_SECS").ok().and_then(|secs| secs.parse().ok());
    let millis = 1e3 * secs.unwrap_or(MOMENT_SECS);
    let mut inputs = 0u64;
    arbtest::arbtest(|u| {
        inputs += 1;
        let begun = Instant::now();
        let outcome = one(u);
        assert!(begun.elapsed() < PATIENCE, "{name}: an input took {:?}", begun.elapsed());
        outcome
    })
    .budget_ms(millis as u64)
    .run();
    println!("{name}: {inputs} inputs");
}
