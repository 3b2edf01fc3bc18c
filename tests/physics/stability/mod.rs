//! Where methods fail, guarded: the verdicts of a quick pass are those of the committed table, and
//! what theory says of the borders is what is measured.
//!
//! After a change that makes a verdict better, or worse for a good reason, renew the table:
//! `cargo run --release -- stability --quick --table tests/physics/stability/table.csv`.

mod alarms;
mod friction;
mod remedies;
mod size;
mod theory;

use std::sync::OnceLock;

use slump::study::stability::{CHALLENGES, StabilityTable, StabilityVerdict};

const RENEW: &str =
    "cargo run --release -- stability --quick --table tests/physics/stability/table.csv";

/// Challenges that no contender fails: what was feared of them does not happen here.
const UNBROKEN: [&str; 1] = ["rest"];

fn quick() -> &'static StabilityTable {
    static TABLE: OnceLock<StabilityTable> = OnceLock::new();
    TABLE.get_or_init(|| {
        let all: Vec<_> = CHALLENGES.iter().collect();
        StabilityTable::run(&all, true, || ()).expect("sound scenes")
    })
}

#[test]
fn every_verdict_is_that_of_the_table() {
    let committed = StabilityTable::from_csv(include_str!("table.csv")).expect("a proper table");
    let mut changes = Vec::new();
    for (now, then) in quick().cells.iter().zip(&committed.cells) {
        let same = (&now.scene, &now.method) == (&then.scene, &then.method);
        assert!(same && now.level == then.level, "the table has other rows; renew it: {RENEW}");
        if now.verdict != then.verdict {
            let change = if now.verdict > then.verdict { "WORSE" } else { "better" };
            changes.push(format!(
                "{change}: {} at {} {}, {} (was {}, {})",
                now.method,
                now.scene,
                now.level,
                now.error,
                then.verdict.name(),
                then.error
            ));
        }
    }
    let (now, then) = (quick().cells.len(), committed.cells.len());
    assert_eq!(now, then, "the table has other rows; renew it: {RENEW}");
    assert!(changes.is_empty(), "{}\nIf that is right: {RENEW}", changes.join("\n"));
}

#[test]
fn every_scene_breaks_a_method_at_its_last_level_and_none_at_its_first() {
    for challenge in &CHALLENGES {
        let hardest = challenge.quick[challenge.quick.len() - 1];
        let of = |level: f64| {
            let here = quick().cells.iter();
            here.filter(move |cell| cell.scene == challenge.name && cell.level == level)
        };
        let broken = of(hardest).any(|cell| cell.verdict != StabilityVerdict::Holds);
        assert_eq!(broken, !UNBROKEN.contains(&challenge.name), "{}", challenge.name);
        let held = of(challenge.quick[0]).any(|cell| cell.verdict == StabilityVerdict::Holds);
        let recovers = challenge.name == "overlap";
        assert!(held || recovers, "{}: nobody holds at the first level", challenge.name);
    }
}
