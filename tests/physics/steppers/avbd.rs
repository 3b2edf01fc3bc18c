//! The stepper `avbd`: what it is made for, and what it does not hold.

use crate::common::*;

/// Discs on one another along x, the uppermost so many times as large as the others, on a fixed one.
fn column(count: usize, ratio: f64) -> Scene {
    let radius = 0.1;
    let apart = 2.0 * radius * (1.0 - 1e-9);
    let mut grains: Vec<Grain> = (0..count)
        .map(|level| Grain::at_rest(DVec2::X * apart * (level + 1) as f64, radius))
        .collect();
    let top = DVec2::X * (apart * count as f64 + (1.0 + ratio) * radius);
    grains.push(Grain::at_rest(top, ratio * radius));
    let scene = scene(LINE, -G * DVec2::X, parameters(0.0, 1e-3, 0.0, 0.0), grains);
    let fixed_discs = vec![fixed(DVec2::ZERO, radius)];
    by(Stepper::Avbd, 0, Scene { fixed_discs, ..scene })
}

#[test]
fn a_disc_of_a_thousand_masses_rests_on_light_ones() {
    let run = after(&column(4, 1000f64.sqrt()), 3000);
    let grains = run.grains();
    let mut carried: f64 = grains.masses.iter().sum();
    let mut impulses = run.contacts().impulses().iter();
    let of_pairs = run.contacts().contacts().iter().zip(impulses.by_ref());
    let mut forces: Vec<f64> = of_pairs.map(|(_, impulse)| impulse.normal / 1e-3).collect();
    forces.sort_by(|one, other| other.total_cmp(one));
    assert_eq!(forces.len(), 5);
    for (force, mass) in forces.iter().zip(&grains.masses) {
        assert_close(*force / G, carried, 1e-2, "what a contact carries");
        carried -= mass;
    }
    let fastest = grains.velocities.iter().map(|velocity| velocity.length()).fold(0.0, f64::max);
    assert!(fastest < 0.1 * G * 1e-3, "a tenth of what gravity does in a step: {fastest:e} m/s");
}

#[test]
fn a_pair_that_meets_stays_together_and_keeps_its_momentum_as_far_as_iterations_get() {
    for physics in [LINE, SMOOTH, Physics::FULL] {
        let mut run = start(&by(Stepper::Avbd, 0, meeting(physics, 0.5, 1e-3)));
        let (before, carried) = (relative_velocity(&run), momentum(&run));
        take_steps(&mut run, 2);
        assert_eq!(run.observables().contacts, 1, "they met");
        let (after, lost) = (relative_velocity(&run), momentum(&run) - carried);
        assert!(after.length() < 1e-2 * before.length(), "{after} is left of {before}");
        assert!(lost.length() < 1e-2 * carried.length(), "{lost} of {carried} is lost");
    }
}

/// What works leave unexplained of a step's change of kinetic energy, J.
fn unexplained(before: f64, after: &Observables) -> f64 {
    let works = after.gravity_work + after.normal_work + after.tangential_work;
    (after.kinetic_energy - before - works).abs()
}

#[test]
fn the_energy_that_iterations_leave_unexplained_goes_as_a_column_comes_to_rest() {
    let mut run = start(&column(9, 1.0));
    let mut left = Vec::new();
    for _ in 0..2000 {
        let before = run.observables().kinetic_energy;
        let after = run.step().expect("a finite state");
        assert!(after.residual.is_finite(), "{after:?}");
        left.push(unexplained(before, after));
    }
    let (first, last) = (left[..10].iter().copied().fold(0.0, f64::max), left[1999]);
    assert!(first > 1e-9, "ten iterations do not solve ten discs: {first:e} J");
    assert!(last < 1e-6 * first, "{last:e} J of {first:e} J");
}

#[test]
fn a_disc_sticks_below_the_friction_angle_and_slides_above() {
    let mu = 0.5;
    for (slope, sticks) in [(0.98 * mu, true), (0.7, false)] {
        let down = DVec2::new(slope, -1.0).normalize();
        let disc = Grain::at_rest(DVec2::new(0.0, 0.1), 0.1);
        let mut pile = scene(UNTURNING, G * down, parameters(0.0, 1e-3, 0.0, mu), vec![disc]);
        pile.boundaries = vec![level()];
        let mut run = after(&by(Stepper::Avbd, 0, pile), 200);
        let velocity = run.velocity(0).x;
        take_steps(&mut run, 200);
        let gained = run.velocity(0).x - velocity;
        if sticks {
            assert!(gained.abs() < 1e-6, "it sticks: {gained:e} m/s");
        } else {
            assert_close(gained / 0.2, down.x * G + mu * down.y * G, 2e-3, "how it slides");
        }
    }
}
