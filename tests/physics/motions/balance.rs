//! What moving bodies do to energy and momentum, and whether their work is told apart.

use crate::common::*;

/// A pile on a base that is shaken both ways, beside a wall that slides along itself and into it, and a belt.
fn shaken() -> Scene {
    let mut scene = pressed_pile(40, 0.3, 5, parameters(2.0, 1e-3, 0.3, 0.5));
    let amplitude = DVec2::new(1e-3, 1e-3);
    let shaken = MotionCourse::Sine { amplitude, frequency_hz: 20.0, phase: 0.0 };
    scene.boundaries = vec![
        level(),
        plane(-0.017 * DVec2::X, DVec2::X),
        Boundary::Segment { from: DVec2::new(0.02, -1.0), to: DVec2::new(0.02, 1.0) },
    ];
    let discs = (0..scene.fixed_discs.len()).collect();
    scene.motions = vec![
        Motion { fixed_discs: discs, ..goes(&[0], shaken) },
        goes(&[1], straight(DVec2::new(0.05, -0.3))),
        belt(&[2], 0.4),
    ];
    scene.solver.max_sweeps = 100;
    scene
}

#[test]
fn the_budget_of_energy_is_closed_among_bodies_that_move() {
    for (stepper, method) in every_way_that_balances() {
        let mut scene = shaken();
        (scene.stepper, scene.solver.method) = (stepper, method);
        let mut run = start(&scene);
        let mut energy = run.observables().kinetic_energy;
        let (mut scale, mut of_walls) = (energy, 0.0);
        for _ in 0..100 {
            let now = *run.step().expect("a finite state");
            let works = now.normal_work + now.tangential_work + now.gravity_work;
            let change = now.kinetic_energy - energy;
            scale += works.abs();
            let off = (change - works).abs();
            // A method that comes to no end leaves wedged grains large impulses, which cancel, but not their rounding.
            let impulses = run.contacts().impulses().iter();
            let rounding: f64 = impulses.map(|it| it.normal.abs() + it.tangential.abs()).sum();
            assert!(
                off < 1e-11 * scale + 1e-13 * rounding,
                "{stepper}, {method}: {change} by {works}"
            );
            energy = now.kinetic_energy;
            of_walls += now.wall_work;
        }
        assert!(of_walls > 0.0, "{stepper}, {method}: the walls put energy in, {of_walls} J");
    }
}

#[test]
fn momentum_comes_from_gravity_and_from_what_is_no_grain_alone() {
    for stepper in [Stepper::Moreau, Stepper::TgsSoft] {
        let mut run = start(&Scene { stepper, ..shaken() });
        let momentum = |run: &Simulation| -> DVec2 {
            let grains = run.grains();
            grains.masses.iter().zip(&grains.velocities).map(|(&mass, &v)| mass * v).sum()
        };
        let weight: f64 = run.grains().masses.iter().sum::<f64>() * 9.8;
        for _ in 0..60 {
            let before = momentum(&run);
            run.step().expect("a finite state");
            let numbering = Numbering::of(run.world());
            let list = run.contacts();
            let from_outside: DVec2 = list
                .contacts()
                .iter()
                .zip(list.impulses())
                .filter(|(contact, _)| !matches!(numbering.other(contact.other), Other::Grain(_)))
                .map(|(contact, impulse)| {
                    impulse.normal * contact.normal + impulse.tangential * contact.normal.perp()
                })
                .sum();
            let change = momentum(&run) - before;
            let expected = from_outside - 1e-3 * weight * DVec2::Y;
            assert!(change.distance(expected) < 1e-13, "{stepper}: {change} by {expected}");
        }
    }
}

/// At constant speed a wall lifts a grain by the work m g h, and gives it ½mv² and as much again in the shock.
#[test]
fn the_work_of_a_wall_is_what_it_lifts() {
    for (stepper, method) in every_way() {
        let speed = 0.2;
        let grain = Grain::at_rest(DVec2::new(0.05, 0.0), 0.05);
        let mut scene = Scene {
            boundaries: vec![plane(DVec2::ZERO, DVec2::X)],
            motions: vec![goes(&[0], straight(speed * DVec2::X))],
            ..scene(LINE, -9.8 * DVec2::X, parameters(0.0, 1e-3, 0.0, 0.0), vec![grain])
        };
        (scene.stepper, scene.solver.method) = (stepper, method);
        let mut run = start(&scene);
        let (mut of_wall, mut of_gravity) = (0.0, 0.0);
        for _ in 0..1000 {
            let now = run.step().expect("a finite state");
            (of_wall, of_gravity) = (of_wall + now.wall_work, of_gravity + now.gravity_work);
        }
        let mass = run.grains().masses[0];
        let what = format!("{stepper}, {method}");
        assert_close(of_wall, mass * speed * (speed + 9.8), 2e-3, &what);
        assert_close(of_gravity, -mass * 9.8 * speed, 2e-3, &what);
    }
}

/// Without bounces what contacts take is never less than nothing: not even where walls put energy in.
#[test]
fn contacts_take_what_walls_give_beyond_the_grains_own() {
    let mut scene = shaken();
    scene.parameters.restitution = 0.0;
    scene.parameters.bond = 0.0;
    scene.solver.max_sweeps = 2000;
    let mut run = after(&scene, 5);
    let mut taken = 0.0;
    for _ in 0..200 {
        let now = *run.step().expect("a finite state");
        let of_contacts = now.normal_work + now.tangential_work - now.wall_work;
        assert!(of_contacts < 1e-7, "{of_contacts} J");
        taken += of_contacts;
    }
    assert!(taken < -1e-4, "{taken} J");
}
