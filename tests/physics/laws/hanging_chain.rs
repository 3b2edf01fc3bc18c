//! A chain of equal discs under a fixed one: it holds while every contact carries less than its C₀.
//!
//! With m the mass of a disc, the contact with the fixed disc has C₀ = Bond·m·g and carries n·m·g;
//! the contact under the k-th disc has C₀ = Bond·(m/2)·g and carries (n − k)·m·g. So the chain holds
//! while n < Bond and n − 1 < Bond/2: a single disc falls off the ceiling at Bond = 1, and a chain of
//! three or more breaks under its first disc, at Bond = 2(n − 1). With two discs both contacts reach
//! their limits together, at Bond = 2.

use crate::common::*;

const RADIUS: f64 = 0.05;
/// Overlap of neighbours, m: rounding of the places, and no more than that.
const OVERLAP: f64 = 1e-12;
const TIME_STEPS: [f64; 4] = [1e-5, 1e-4, 1e-3, 5e-3];

/// n discs below a fixed one. The line lies along gravity: `down` is x on one axis.
fn chain(n: usize, bond: f64, dt: f64, physics: Physics) -> Simulation {
    let down = if physics.axes == 1 { DVec2::X } else { -DVec2::Y };
    let place = |k: usize| k as f64 * (2.0 * RADIUS - OVERLAP) * down;
    let grains = (1..=n).map(|k| Grain::at_rest(place(k), RADIUS)).collect();
    start(&Scene {
        fixed_discs: vec![fixed(DVec2::ZERO, RADIUS)],
        solver: to_residual(1e-11),
        ..scene(physics, G * down, parameters(bond, dt, 0.2, 0.5), grains)
    })
}

/// The lowest Bond that holds n discs.
fn breaking_bond(n: usize) -> f64 {
    (n as f64).max(2.0 * (n as f64 - 1.0))
}

/// Relative distance to the threshold on either side.
const NEAR: f64 = 1e-4;

#[test]
fn a_chain_holds_while_no_contact_carries_more_than_its_cohesion() {
    for dt in TIME_STEPS {
        for physics in [LINE, SMOOTH, Physics::FULL] {
            for n in [1, 2, 4, 7] {
                let bond = breaking_bond(n) * (1.0 + NEAR);
                let mut run = chain(n, bond, dt, physics);
                take_steps(&mut run, 50);
                assert_eq!(run.observables().contacts, n as u32, "Δt {dt}, n {n}");
                let mass = run.grains().masses[0];
                for (contact, impulse) in
                    run.contacts().contacts().iter().zip(run.contacts().impulses())
                {
                    // Grain indices rise downward; a contact's lower disc is the one whose number
                    // is larger, or the only one.
                    let lower = if contact.other as usize >= n { 0 } else { contact.other };
                    let weight = (n - lower as usize) as f64 * mass * G;
                    let force = impulse.normal / dt;
                    assert!(
                        (force + weight).abs() < 1e-8 * n as f64 * mass * G,
                        "Δt {dt}, n {n}: the contact above grain {lower} carries {force}"
                    );
                }
                for velocity in run.velocities() {
                    assert!(velocity.length() < 1e-8 * G * dt, "Δt {dt}, n {n}: hangs still");
                }
            }
        }
    }
}

#[test]
fn a_chain_breaks_above_its_threshold_where_it_is_overloaded() {
    for dt in TIME_STEPS {
        for physics in [LINE, SMOOTH, Physics::FULL] {
            for n in [1, 3, 4, 7] {
                let bond = breaking_bond(n) * (1.0 - NEAR);
                let mut run = chain(n, bond, dt, physics);
                run.step().expect("a finite state");
                assert!(run.observables().converged);
                assert_eq!(run.observables().contacts, n as u32, "all touch at first");
                // NEAR·g opens the overlap within a step or some at each of these time steps.
                let mut steps = 0;
                while run.observables().contacts == n as u32 {
                    run.step().expect("a finite state");
                    steps += 1;
                    assert!(steps < 100, "Δt {dt}, n {n}: it does not break");
                }
                let pairs = run.contacts().contacts().iter();
                let ceiling_holds = pairs.clone().any(|contact| contact.other as usize >= n);
                let first_pair_holds =
                    pairs.clone().any(|contact| (contact.grain, contact.other) == (0, 1));
                assert_eq!(ceiling_holds, n > 1, "Δt {dt}, n {n}: the ceiling's contact");
                assert!(!first_pair_holds, "Δt {dt}, n {n}: the contact under the first disc");
                let rest = pairs.filter(|contact| contact.grain > 0).count();
                assert_eq!(rest, n.saturating_sub(2), "Δt {dt}, n {n}: the others fall together");
            }
        }
    }
}
