//! What a run says when it goes wrong.

use glam::DVec2;
use slump::scene::Scene;
use slump::scene::stability::{cantilever, column, heap, mass_ratio, overlapped};
use slump::sim::{AlarmKind, Stepper};

/// The kinds of alarms of a run, and what they say.
fn alarms(scene: &Scene, steps: u32) -> Vec<(AlarmKind, String)> {
    let mut simulation = scene.simulation().expect("a sound scene");
    for _ in 0..steps {
        if simulation.step().is_err() {
            break;
        }
    }
    let said = simulation.alarms().iter();
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
    scene.gravity = slump::world::Gravity::Uniform { acceleration: DVec2::new(0.0, -1e150) };
    let said = alarms(&scene, 1000);
    let (_, words) =
        said.iter().find(|(kind, _)| *kind == AlarmKind::NotFinite).expect("it blows up");
    assert!(words.contains("more than 1 substeps"), "{words}");
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
