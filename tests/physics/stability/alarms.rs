//! What a run says when it goes wrong.

use crate::common::*;
use slump::scene::stability::{cantilever, column, heap, mass_ratio, overlapped};

/// The kinds of alarms of a run, and what they say.
fn alarms(scene: &Scene, steps: u32) -> Vec<(AlarmKind, String)> {
    let mut run = start(scene);
    for _ in 0..steps {
        if run.step().is_err() {
            break;
        }
    }
    let said = run.alarms().iter();
    said.map(|alarm| (alarm.kind, alarm.message(&scene.settings()))).collect()
}

#[test]
fn a_run_that_is_well_says_nothing() {
    assert_eq!(alarms(&heap(5), 300), []);
    assert_eq!(alarms(&cantilever(4), 300), []);
}

#[test]
fn an_overlap_of_more_than_a_twentieth_is_told_of_at_once() {
    let said = alarms(&overlapped(0.06), 1);
    assert_eq!(said[0].0, AlarmKind::Overlap);
    assert!(said[0].1.contains("step 1,") && said[0].1.contains("time step below 0.001 s"));
    assert_eq!(alarms(&overlapped(0.04), 50), []);
}

#[test]
fn a_hundred_steps_at_the_sweep_limit_are_told_of_and_ninety_nine_are_not() {
    let mut scene = mass_ratio(1e3);
    scene.solver.max_sweeps = 2;
    scene.solver.tolerance = 1e-15;
    let limit = |steps| {
        let said = alarms(&scene, steps).into_iter();
        said.filter(|(kind, _)| *kind == AlarmKind::SweepLimit).collect::<Vec<_>>()
    };
    assert_eq!(limit(99), []);
    let said = limit(100);
    assert!(said[0].1.contains("step 100,") && said[0].1.contains("method newton"), "{said:?}");
}

#[test]
fn a_state_that_is_not_finite_is_told_of_with_what_helps() {
    let mut scene = column(20);
    scene.stepper = Stepper::Dem;
    scene.parameters.substeps = 1;
    scene.parameters.time_step_secs = 1.0;
    scene.gravity = Gravity::Uniform { acceleration: DVec2::new(0.0, -1e150) };
    let said = alarms(&scene, 1000);
    let (_, words) =
        said.iter().find(|(kind, _)| *kind == AlarmKind::NotFinite).expect("it blows up");
    assert!(words.contains("more than 1 substeps"), "{words}");
}

/// A scene whose bonds break fast, by the law `range`.
fn brittle(mut scene: Scene, bond: f64, time_step_secs: f64) -> Scene {
    scene.stepper = Stepper::Range;
    scene.solver.method = Method::Newton;
    scene.solver.stop = StopTest::Residual;
    scene.solver.tolerance = 1e-6;
    scene.parameters.restitution_threshold = 2.0;
    scene.parameters.bond = bond;
    scene.parameters.debonding_distance = 1e-4;
    scene.parameters.time_step_secs = time_step_secs;
    scene
}

#[test]
fn a_break_that_a_step_is_too_long_to_see_is_told_of_with_the_step_that_is_not() {
    // Runs until bonds have broken, or for 0.1 s: what it says of breaks, and whether there were any.
    let run = |scene: &Scene| {
        let mut simulation = start(scene);
        let mut broken = 0.0;
        while simulation.time_secs() < 0.1 && broken == 0.0 {
            let step = simulation.step().expect("finite");
            broken = step.broken_bond_energy.unwrap_or_default();
        }
        let alarms = simulation.alarms().iter();
        let unseen = alarms.filter(|alarm| alarm.kind == AlarmKind::BreakUnseen).copied();
        (unseen.collect::<Vec<_>>(), broken > 0.0)
    };
    let pile = paper_pile().expect("the shipped state");
    let long = brittle(pile.clone(), 20.0, 5e-3);
    let (said, broke) = run(&long);
    assert!(broke && said.len() == 1, "{said:?}");
    // Sixteen substeps of 0.4 √(2 δc d / (Bond g)), 7.14e-5 s, are 4.57e-4 s.
    let bond_time = (2.0 * 1e-4 * pile.mean_diameter / (20.0 * 9.8f64)).sqrt();
    let longest = said[0].longest_time_step_secs.expect("the step that can");
    assert!((longest - 6.4 * bond_time).abs() < 1e-12, "{longest}");
    let words = said[0].message(&long.settings());
    assert!(words.contains("time step of at most 4.5e-4 s"), "{words}");
    // At that step breaks are seen; without bonds, and where none is about to break, there is nothing to see.
    assert_eq!(run(&brittle(pile.clone(), 20.0, 4.5e-4)), (Vec::new(), true));
    assert_eq!(run(&brittle(pile, 0.0, 5e-3)), (Vec::new(), false));
    assert_eq!(run(&brittle(heap(5), 20.0, 5e-3)), (Vec::new(), false));
}

#[test]
fn a_grain_that_falls_out_of_the_world_is_told_of() {
    // Off the end of a base that is finite.
    let mut scene = heap(3);
    scene.grains[0].position.x += 100.0 * scene.mean_diameter;
    scene.fixed_discs.truncate(3);
    let side = 100.0 * scene.mean_diameter;
    let secs = (2.0 * 5.0 * side / scene.gravity.magnitude()).sqrt();
    let steps = (secs / scene.parameters.time_step_secs) as u32;
    let said = alarms(&scene, steps);
    assert!(said.iter().any(|(kind, _)| *kind == AlarmKind::GrainLost), "{said:?}");
    // Through the ground: too deep for any contact to bring it back.
    let mut scene = column(1);
    scene.grains[0].position.y = -1.5 * scene.mean_diameter;
    let said = alarms(&scene, 1);
    assert!(said.iter().any(|(kind, _)| *kind == AlarmKind::GrainLost), "{said:?}");
}
