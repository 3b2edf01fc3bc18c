//! Walls that a force drives, among springs.

use super::driven::{carried, drive, pressed};
use crate::common::*;

/// The same under springs, with the weight of a grain as the force of a contact, and ten thousand times its stiffness.
fn on_springs(mass: f64) -> Scene {
    let mut scene = pressed(mass);
    scene.stepper = Stepper::Dem;
    (scene.parameters.stiffness, scene.parameters.damping_ratio) = (2e4, 0.3);
    scene
}

#[test]
fn a_piston_on_springs_carries_its_pressure_and_its_energy_balances() {
    let scene = on_springs(0.01);
    let mut run = start(&scene);
    let substep = scene.parameters.time_step_secs / f64::from(run.substeps());
    let height = |run: &Simulation| match run.world().boundaries[1] {
        Boundary::HalfSpace { point, .. } => point.y,
        _ => panic!("it stays one"),
    };
    for step in 0..1500 {
        let (before, from) = (drive(&run).clone(), height(&run));
        take_steps(&mut run, 1);
        let now = drive(&run);
        // Substeps go on with the speed of their end, and their work is that of the mean speed.
        let way = from - height(&run) - 0.5 * substep * (now.speed - before.speed);
        let change = now.kinetic_energy() - before.kinetic_energy();
        let found = 10.0 * way - run.observables().wall_work;
        assert!((change - found).abs() < 1e-12, "step {step}: {change} {found} J");
    }
    assert_close(carried(&run, 1), 10.0, 1e-6, "the force");
    assert!(drive(&run).speed.abs() < 1e-7, "{:?}", drive(&run));
}

#[test]
fn a_wall_on_springs_that_is_lighter_than_its_grains_may_swing_up() {
    // Five contacts of 2e4 N/m, without dashpots: h < 2 √(M/5k).
    let fastest = |part: f64| {
        let mut scene = on_springs(0.01);
        scene.parameters.damping_ratio = 1e-9;
        let substep = scene.parameters.time_step_secs / f64::from(start(&scene).substeps());
        let mass = 5.0 * 2e4 * (0.5 * substep / part).powi(2);
        scene.motions[0].drive.as_mut().expect("a drive").mass = mass;
        let mut run = start(&scene);
        let mut fastest = 0f64;
        for _ in 0..100 {
            let _ = run.step();
            fastest = fastest.max(drive(&run).speed.abs());
        }
        (fastest, mass)
    };
    let ((calm, heavy), (wild, light)) = (fastest(0.3), fastest(3.0));
    // It falls through no gap, so that its speed is that of a swing about its load.
    assert!(calm < 10.0 / (5.0 * 2e4 * heavy).sqrt() * 10.0, "{calm} m/s of {heavy} kg");
    assert!(wild > 10.0 * calm * (heavy / light).sqrt(), "{wild} m/s of {light} kg, {calm} m/s");
}
