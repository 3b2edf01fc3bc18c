//! Checks the lists of steppers and settings: if the lists say that a stepper uses a setting, the setting must change
//! its steps.

use std::path::Path;

use crate::common::*;
use crate::program::*;
use slump::config::read_scene;
use slump::setting::{About, Kind, Value};

/// Number of compared steps: enough for grains to collide, and for later steps to start from the impulses of earlier
/// steps.
const STEPS: usize = 6;

/// Returns four piles whose grains collide and bounce: with cohesion, without cohesion, with too few sweeps to solve a
/// step, and with bounded friction.
fn piles() -> [Scene; 4] {
    let pile = |bond| pressed_pile(12, 0.5, 7, parameters(bond, 1e-3, 0.3, 0.5));
    let mut unsolved = pile(0.0);
    unsolved.solver.max_sweeps = 3;
    let mut bounded = pile(0.0);
    bounded.solver = SolverSettings::BOUNDED;
    [pile(20.0), pile(0.0), unsolved, bounded]
}

/// Returns values to try for a setting. A stepper may refuse some of these values.
fn values(about: &About) -> Vec<Value> {
    match about.kind {
        Kind::Number => [1e-4, 1e-3, 0.01, 0.1, 0.9, 2.0, 50.0].map(Value::Number).to_vec(),
        Kind::Count => [1, 2, 7].map(Value::Count).to_vec(),
        Kind::Switch => [true, false].map(Value::Switch).to_vec(),
        Kind::Word(words) => words.iter().map(|word| Value::Word(word.name)).collect(),
    }
}

/// Returns as text the positions, velocities and measured quantities after [`STEPS`] steps, or `None` if the settings
/// are invalid or a step fails.
fn course(pile: &Scene, settings: Settings) -> Option<String> {
    let mut scene = pile.clone();
    scene.set_settings(settings);
    let mut run = scene.simulation().ok()?;
    for _ in 0..STEPS {
        run.step().ok()?;
    }
    let grains = run.grains();
    Some(format!("{:?}{:?}{:?}", grains.positions, grains.velocities, run.observables()))
}

/// Returns true if at least one of the tried values of a setting gives another run than the value of the scene, or if
/// Slump refuses all tried values.
fn matters(about: &About, stepper: Stepper) -> bool {
    let mut taken = 0;
    for pile in piles() {
        let settings = Settings { stepper, ..pile.settings() };
        let before = course(&pile, settings).expect("sound settings");
        for value in values(about) {
            let mut changed = settings;
            assert!(changed.set(about.name, value), "{} as {value:?}", about.name);
            if changed == settings {
                continue;
            }
            let Some(after) = course(&pile, changed) else { continue };
            taken += 1;
            if after != before {
                return true;
            }
        }
    }
    taken == 0
}

#[test]
fn a_setting_that_a_stepper_reads_and_a_remedy_that_it_takes_change_its_steps() {
    for &stepper in Stepper::ALL {
        let takes =
            |name| REMEDIES.iter().any(|row| row.name == name && row.taken_by.contains(&stepper));
        for about in
            Settings::about().filter(|about| stepper.reads(about.name) || takes(about.name))
        {
            assert!(matters(about, stepper), "{stepper}: {} changes nothing", about.name);
        }
    }
}

#[test]
fn scene_files_that_do_not_know_the_newest_settings_are_read() {
    let hourglass = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/scenes/hourglass.toml");
    let text = read(&hourglass);
    assert!(!text.contains("substeps") && !text.contains("remedies"), "it is older than they are");
    read_scene(&hourglass).expect("a sound scene");
}

#[test]
fn a_stepper_has_the_observables_that_it_says() {
    for &stepper in Stepper::ALL {
        let [mut pile, ..] = piles();
        pile.stepper = stepper;
        let mut run = start(&pile);
        run.step().expect("a finite state");
        let columns = |row: &Observables| match serde_json::to_value(row) {
            Ok(serde_json::Value::Object(columns)) => columns,
            other => panic!("{other:?}"),
        };
        let of_all = columns(&Observables::default());
        let mut more = columns(run.observables());
        more.retain(|column, _| !of_all.contains_key(column));
        let said = stepper.info().observables;
        let has_all = said.iter().all(|column| more.contains_key(*column));
        assert!(has_all && said.len() == more.len(), "{stepper}: {more:?}");
    }
}
