//! The stepping scheme `dem`: springs and dashpots, and the step at which they blow up.

use crate::common::*;
use slump::error::Error;

fn springs(run: &Simulation) -> SpringDashpot {
    let physics = run.physics();
    SpringDashpot::of(run.world(), physics.axes, run.parameters())
}

/// Steps until two discs that meet have parted, and gives speed after over speed before.
fn measured_restitution(scene: &Scene) -> f64 {
    let mut run = start(scene);
    let (before, carried) = (relative_velocity(&run), momentum(&run));
    let mut touched = false;
    for _ in 0..1_000_000 {
        run.step().expect("a finite state");
        let off = momentum(&run).distance(carried);
        assert!(off < 1e-12 * carried.length(), "momentum is kept");
        let now = run.observables().contacts > 0;
        if touched && !now {
            return -relative_velocity(&run).dot(before) / before.length_squared();
        }
        touched |= now;
    }
    panic!("they never parted");
}

#[test]
fn springs_and_dashpots_give_the_restitution_that_is_asked_for() {
    for physics in [LINE, SMOOTH, Physics::FULL] {
        for (restitution, expected) in
            [(0.0, 0.02), (0.02, 0.02), (0.1, 0.1), (0.3, 0.3), (0.5, 0.5), (0.8, 0.8), (1.0, 1.0)]
        {
            let probe = start(&meeting(physics, restitution, 1e-3));
            let critical = springs(&probe).critical_time_step_secs(effective_mass(&probe), 1.0);
            let mut errors = [200.0, 800.0].map(|parts| {
                let scene = by(Stepper::Dem, 1, meeting(physics, restitution, critical / parts));
                measured_restitution(&scene) - expected
            });
            println!("ρ {restitution}: off by {errors:?}");
            // First order in h: a quarter of h, about a quarter of the error.
            assert!(errors[0].abs() < 1e-2, "ρ {restitution}: off by {errors:?}");
            errors.iter_mut().for_each(|error| *error = error.abs());
            assert!(errors[1] < 0.3 * errors[0] + 2e-4, "ρ {restitution}: off by {errors:?}");
        }
    }
}

/// Whether a pair that rests at its cohesive overlap shakes itself up from a small push.
fn shakes_up(restitution: f64, dt_over_critical: f64) -> bool {
    let probe = start(&meeting(LINE, restitution, 1e-3));
    let (mass, springs) = (effective_mass(&probe), springs(&probe));
    let mut scene = meeting(LINE, restitution, 1e-3);
    scene.parameters.time_step_secs = dt_over_critical * springs.critical_time_step_secs(mass, 1.0);
    scene.parameters.bond = 1.0;
    let overlap = mass * G / springs.stiffness;
    scene.grains[1].position.x = 0.25 - overlap;
    scene.grains[0].velocity.x = 0.0;
    let push = 1e-3 * overlap * (springs.stiffness / mass).sqrt();
    scene.grains[1].velocity.x = push;
    let mut run = start(&by(Stepper::Dem, 1, scene));
    (0..3000).any(|_| {
        run.step().expect("a finite state");
        relative_velocity(&run).length() > 10.0 * push
    })
}

#[test]
fn a_pair_of_elements_blows_up_above_its_critical_step_and_not_below() {
    for restitution in [0.0, 0.1, 0.5, 1.0] {
        let (mut stable, mut unstable) = (0.5, 2.0);
        assert!(!shakes_up(restitution, stable) && shakes_up(restitution, unstable));
        for _ in 0..8 {
            let middle = 0.5 * (stable + unstable);
            let place = if shakes_up(restitution, middle) { &mut unstable } else { &mut stable };
            *place = middle;
        }
        println!("ρ {restitution}: {stable} to {unstable} of the critical step");
        assert!((stable - 1.0).abs() < 0.02, "ρ {restitution}: {stable} of the critical step");
    }
    // Without damping the critical step is 2/ω.
    let probe = start(&meeting(LINE, 1.0, 1e-3));
    let (mass, springs) = (effective_mass(&probe), springs(&probe));
    let critical = springs.critical_time_step_secs(mass, 1.0);
    assert_close(critical, 2.0 * (mass / springs.stiffness).sqrt(), 1e-12, "2/ω");
}

#[test]
fn a_step_that_blows_up_ends_in_an_error() {
    // Between walls the disc cannot get away from its own energy.
    let mut scene = meeting(LINE, 0.5, 1e-3);
    scene.grains.truncate(1);
    let wall = |x: f64| plane(x * DVec2::X, -x * DVec2::X);
    scene.boundaries = vec![wall(-0.1499), wall(0.1499)];
    let critical = by(Stepper::Dem, 1, scene.clone()).simulation().expect("sound");
    let critical = critical.critical_time_step_secs().expect("springs");
    for (times, blows_up) in [(0.5, false), (3.0, true)] {
        scene.parameters.time_step_secs = times * critical;
        for substeps in [1, 10] {
            scene.parameters.time_step_secs = times * critical * f64::from(substeps);
            let mut simulation = start(&by(Stepper::Dem, substeps, scene.clone()));
            let failure = (0..2000).find_map(|_| simulation.step().err());
            assert_eq!(matches!(failure, Some(Error::NonFinite { .. })), blows_up, "{failure:?}");
        }
    }
    // A pile blows up too, and comes to an end without a panic, finite or not.
    let mut pile = by(Stepper::Dem, 1, paper_pile().expect("the shipped state"));
    pile.parameters.time_step_secs = 2e-3;
    let mut simulation = start(&pile);
    let failed = (0..200).any(|_| simulation.step().is_err());
    let Observed { kinetic, potential } = observed(&simulation);
    assert!(failed || kinetic > 10.0 * potential.abs(), "{kinetic} J");
    pile.parameters.substeps = 0;
    let simulation = after(&pile, 100);
    let Observed { kinetic, potential } = observed(&simulation);
    assert!(kinetic < 0.5 * potential, "{kinetic} J of {potential} J");
}

struct Observed {
    kinetic: f64,
    potential: f64,
}

fn observed(run: &Simulation) -> Observed {
    let last = run.observables();
    Observed { kinetic: last.kinetic_energy, potential: last.potential_energy }
}
