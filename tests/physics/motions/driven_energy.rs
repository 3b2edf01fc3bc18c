//! The energy of walls that a force drives is in the budget, under every stepper that moves them.

use super::driven::{by_force, carried, drive, driven, pressed};
use crate::common::*;

/// Steppers that move driven walls, with methods that solve for them.
fn ways() -> impl Iterator<Item = (Stepper, Method)> {
    let methods = |stepper: Stepper| {
        let takes = METHODS.iter().filter(|info| info.takes_drives);
        takes.take(if stepper.uses_method() { METHODS.len() } else { 1 })
    };
    let steppers = Stepper::ALL.iter().copied().filter(|stepper| stepper.info().takes_drives);
    steppers.flat_map(move |stepper| methods(stepper).map(move |info| (stepper, info.method)))
}

/// Two pistons on columns that jump: one from above with damping, and one from the side.
fn jumping(mass: f64) -> Scene {
    let mut scene = pressed(mass);
    for (k, grain) in (0..).zip(&mut scene.grains) {
        grain.velocity = 0.3 * DVec2::from_angle(2.4 * f64::from(k));
    }
    let damped = Drive { damping: 0.3, speed: 0.2, ..by_force(DVec2::NEG_Y, 2.0, mass) };
    scene.periodic = None;
    scene.boundaries.push(plane(-0.02 * DVec2::X, DVec2::X));
    scene.boundaries.push(plane(0.22 * DVec2::X, DVec2::NEG_X));
    scene.motions =
        vec![driven(&[1], damped), driven(&[2], by_force(DVec2::new(1.0, 0.1), 1.0, 3.0 * mass))];
    scene.parameters.restitution = 0.4;
    scene
}

#[test]
fn energy_of_grains_and_driven_walls_changes_by_what_contacts_took_and_forces_gave() {
    for (stepper, method) in ways() {
        for mass in [0.003, 0.1] {
            let mut scene = jumping(mass);
            (scene.stepper, scene.solver.method, scene.solver.tolerance) = (stepper, method, 1e-6);
            scene.solver.max_sweeps = 300;
            let mut run = start(&scene);
            let of = |run: &Simulation| {
                let now = run.observables();
                now.kinetic_energy + now.drive_energy.expect("walls are driven")
            };
            let (first, mut given) = (of(&run), 0.0);
            assert_close(
                run.observables().drive_energy.expect("driven"),
                0.02 * mass,
                1e-12,
                "½MV²",
            );
            for step in 0..150 {
                let before = of(&run);
                take_steps(&mut run, 1);
                let now = run.observables();
                let of_drives = now.drive_work.expect("walls are driven");
                let works = now.normal_work + now.tangential_work - now.wall_work;
                let off = of(&run) - before - works - now.gravity_work - of_drives;
                assert!(
                    off.abs() < 1e-13 + 1e-12 * first,
                    "{stepper} {method} {mass} {step}: {off} J"
                );
                given += of_drives.abs();
            }
            assert!(given > 0.05 * first, "{stepper} {method}: {given} J of {first} J");
        }
    }
}

#[test]
fn a_piston_on_soft_contacts_carries_its_pressure_however_light_it_is() {
    for mass_ratio in [0.01, 1.0, 100.0] {
        let mut scene = pressed(mass_ratio * std::f64::consts::PI * 1e-4);
        scene.stepper = Stepper::TgsSoft;
        let mut run = after(&scene, 1500);
        let mut mean = 0.0;
        for _ in 0..100 {
            take_steps(&mut run, 1);
            mean += carried(&run, 1) / 100.0;
        }
        assert_close(mean, 10.0, 1e-3, &format!("the force of a piston of {mass_ratio}"));
        // It trembles by less than what gravity gives in a step.
        assert!(drive(&run).speed.abs() < 9.8e-3, "{mass_ratio}: {:?}", drive(&run));
    }
}

#[test]
fn under_the_law_range_a_piston_carries_its_pressure_and_catches_what_hits_it() {
    let of_grain = std::f64::consts::PI * 1e-4;
    for mass_ratio in [0.01, 1.0, 100.0] {
        let mut scene = pressed(mass_ratio * of_grain);
        (scene.stepper, scene.parameters.restitution) = (Stepper::Range, 0.5);
        let run = after(&scene, 60);
        assert_close(carried(&run, 1), 10.0, 1e-6, &format!("a piston of {mass_ratio}"));
        scene.grains.truncate(1);
        scene.grains[0].feels_gravity = false;
        scene.grains[0].velocity = DVec2::Y;
        scene.grains[0].position.y = 0.0488;
        scene.motions = vec![driven(&[1], by_force(DVec2::NEG_Y, 0.0, mass_ratio * of_grain))];
        let run = after(&scene, 4);
        let (grain, wall) = (run.velocity(0).y, -drive(&run).speed);
        assert_close(grain + mass_ratio * wall, 1.0, 1e-12, "momentum");
        assert_close(wall, grain, 1e-9, "they go on together");
    }
}

#[test]
fn a_grain_and_a_wall_of_a_mass_part_as_two_free_bodies_do_under_soft_contacts() {
    let of_grain = std::f64::consts::PI * 1e-4;
    for mass_ratio in [0.1, 1.0, 10.0] {
        let mut scene = pressed(mass_ratio * of_grain);
        scene.grains.truncate(1);
        scene.grains[0].feels_gravity = false;
        scene.grains[0].velocity = DVec2::Y;
        scene.grains[0].position.y = 0.0499;
        scene.motions = vec![driven(&[1], by_force(DVec2::NEG_Y, 0.0, mass_ratio * of_grain))];
        (scene.stepper, scene.parameters.restitution) = (Stepper::TgsSoft, 0.5);
        let run = after(&scene, 4);
        let (grain, wall) = (run.velocity(0).y, -drive(&run).speed);
        assert_close(grain + mass_ratio * wall, 1.0, 1e-12, "momentum");
        assert_close(wall - grain, 0.5, 1e-6, "restitution");
    }
}
