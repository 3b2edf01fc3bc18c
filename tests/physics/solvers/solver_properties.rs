//! Properties of every solved step, over random piles: what the solver says of itself is judged
//! anew from positions, velocities and impulses alone.

use std::cell::Cell;

use crate::common::natural_map::{judge, natural_map};
use crate::common::*;
use proptest::prelude::*;
use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};

/// Runs a property over `cases` scenes, the same ones every time.
fn for_random_piles(cases: u32, property: impl Fn(Scene) -> Result<(), TestCaseError>) {
    let config = Config { cases, failure_persistence: None, ..Config::default() };
    let random = TestRng::deterministic_rng(RngAlgorithm::ChaCha);
    let mut runner = TestRunner::new_with_rng(config, random);
    let bond = prop_oneof![1 => Just(0.0), 4 => 0.0..100.0];
    let friction = prop_oneof![1 => Just(0.0), 4 => 0.0..=1.0];
    let numbers = (bond, friction, 0.0..=1.0, 1e-4..5e-3, 0.0..0.3);
    let kinds = (20usize..=60, any::<u64>(), any::<bool>(), any::<bool>(), any::<bool>());
    let run = |(numbers, kinds)| property(pile(numbers, kinds));
    runner.run(&(numbers, kinds), run).unwrap_or_else(|failure| panic!("{failure}"));
}

/// A pile from (Bond, μ, ρ, Δt, speed) and (grains, seed, shifted cone, warm start, turning).
fn pile(
    (bond, friction, restitution, dt, speed): (f64, f64, f64, f64, f64),
    (count, seed, shifted, warm_start, turning): (usize, u64, bool, bool, bool),
) -> Scene {
    let cone = if shifted { FrictionCone::Shifted } else { FrictionCone::Compressive };
    let parameters = Parameters { cone, ..parameters(bond, dt, restitution, friction) };
    let mut scene = pressed_pile(count, speed, seed, parameters);
    scene.physics.rotation = turning;
    if !turning {
        scene.grains.iter_mut().for_each(|grain| grain.angular_velocity = 0.0);
    }
    scene.solver = SolverSettings {
        stop: StopTest::Residual,
        tolerance: 1e-7,
        max_sweeps: 3000,
        warm_start,
        ..scene.solver
    };
    scene
}

/// Takes a step; gives the grains before it.
fn step(run: &mut Simulation) -> Grains {
    let before = run.grains().clone();
    run.step().expect("a finite state");
    before
}

#[test]
fn the_residual_reported_is_that_of_the_natural_map() {
    let (converged, not_converged, contacts) = (Cell::new(0), Cell::new(0), Cell::new(0));
    for_random_piles(64, |scene| {
        let mut run = start(&scene);
        for _ in 0..4 {
            let before = step(&mut run);
            let (error, scale, outside) = natural_map(&run, &before);
            let reported = run.observables().residual;
            contacts.set(contacts.get() + run.observables().contacts);
            let off = (error / scale - reported).abs();
            prop_assert!(off < 1e-6 * reported + 1e-12, "{} for {reported}", error / scale);
            prop_assert!(outside < 1e-14 * scale, "{outside:e} outside the cone");
            if run.observables().converged {
                prop_assert!(error / scale <= 1e-7 * (1.0 + 1e-6) + 1e-12);
                converged.set(converged.get() + 1);
            } else {
                prop_assert!(reported > 1e-7);
                let last = run.observables();
                prop_assert!(last.sweeps == 3000 || last.stalled, "{}", last.sweeps);
                not_converged.set(not_converged.get() + 1);
            }
        }
        Ok(())
    });
    let (converged, not_converged) = (converged.get(), not_converged.get());
    assert!(contacts.get() > 50 * (converged + not_converged), "piles: {contacts:?} contacts");
    println!("{converged} steps converged, {not_converged} did not");
    assert!(converged > 100, "{converged} steps converged, {not_converged} did not");
}

#[test]
fn the_impulses_reported_are_those_that_moved_the_grains() {
    for_random_piles(32, |scene| {
        let mut run = start(&scene);
        for _ in 0..3 {
            let before = step(&mut run);
            let world = run.world();
            let (count, dt) = (before.len(), scene.parameters.time_step_secs);
            let mut velocities = before.velocities.clone();
            let mut spins = before.angular_velocities.clone();
            for (k, velocity) in velocities.iter_mut().enumerate() {
                *velocity += dt * world.gravity.acceleration(before.positions[k]);
            }
            let list = run.contacts();
            for (contact, impulse) in list.contacts().iter().zip(list.impulses()) {
                let tangent = contact.normal.perp();
                let push = impulse.normal * contact.normal + impulse.tangential * tangent;
                for (k, sign) in [(contact.grain as usize, 1.0), (contact.other as usize, -1.0)] {
                    if k < count {
                        velocities[k] += sign * push / before.masses[k];
                        spins[k] -= before.radii[k] * impulse.tangential / before.inertia(k);
                    }
                }
            }
            let fastest = velocities.iter().map(|v| v.length()).fold(0.1, f64::max);
            for k in 0..count {
                let off = velocities[k].distance(world.grains.velocities[k]);
                prop_assert!(off < 1e-10 * fastest, "grain {k} moves {off:e} m/s otherwise");
                if scene.physics.rotation && scene.parameters.friction > 0.0 {
                    let off = (spins[k] - world.grains.angular_velocities[k]) * before.radii[k];
                    prop_assert!(off.abs() < 1e-10 * fastest, "grain {k} turns otherwise");
                }
            }
        }
        Ok(())
    });
}

#[test]
fn a_step_that_needs_more_sweeps_than_allowed_says_so() {
    for_random_piles(16, |mut scene| {
        for stop in [StopTest::Residual, StopTest::RelativeChange, StopTest::ImpulsePerMass] {
            scene.solver.stop = stop;
            scene.solver.max_sweeps = 1;
            let mut hasty = start(&scene);
            step(&mut hasty);
            prop_assert!(!hasty.observables().converged, "{stop:?}");
            prop_assert_eq!(hasty.observables().sweeps, 1);
            prop_assert!(hasty.observables().residual > 1e-7);
        }
        Ok(())
    });
}

#[test]
fn the_frictionless_model_computes_what_the_full_one_does_without_friction() {
    type Full = StepModel<SpinningPlane, true>;
    type Lean = StepModel<Plane, false>;
    for_random_piles(16, |mut scene| {
        scene.parameters.friction = 0.0;
        let mut run = start(&scene);
        step(&mut run);
        run.step().expect("a finite state");
        let (world, contacts) = (run.world(), run.contacts());
        let mut full = StepProblem::<SpinningPlane>::default();
        let mut lean = StepProblem::<Plane>::default();
        let parameters = &scene.parameters;
        let numbers = ProblemNumbers {
            time_step_secs: parameters.time_step_secs,
            friction: parameters.friction,
            capture_speed: parameters.capture_speed(world.gravity.magnitude()),
            cone: parameters.cone,
        };
        let rebound = |approach: Approach| parameters.restitution * approach.velocity;
        let settings = SolverSettings { tolerance: 1e-6, max_sweeps: 50, ..scene.solver };
        full.prepare::<Full>(world, contacts, numbers, &settings, rebound);
        lean.prepare::<Lean>(world, contacts, numbers, &settings, rebound);
        solve::<Full>(&mut full, &mut Memory::default(), &settings);
        solve::<Lean>(&mut lean, &mut Memory::default(), &settings);
        for (a, b) in full.bodies.now.iter().zip(&lean.bodies.now) {
            prop_assert_eq!(a.velocity, b.velocity);
        }
        let mut ends = lean.bodies.now.iter().zip(&lean.bodies.free);
        prop_assert!(ends.any(|(end, free)| end.velocity != free.velocity), "contacts acted");
        Ok(())
    });
}

#[test]
fn physics_without_cohesion_is_bond_zero_bitwise() {
    for_random_piles(16, |scene| {
        let without = Scene {
            physics: Physics { cohesion: false, ..scene.physics },
            parameters: Parameters { bond: 70.0, ..scene.parameters },
            ..scene.clone()
        };
        let zero = Scene { parameters: Parameters { bond: 0.0, ..scene.parameters }, ..scene };
        let with = Scene { parameters: without.parameters, ..zero.clone() };
        let [mut without, mut zero, mut with] = [&without, &zero, &with].map(start);
        for _ in 0..5 {
            for run in [&mut without, &mut zero, &mut with] {
                step(run);
            }
        }
        prop_assert_eq!(without.grains(), zero.grains());
        prop_assert_eq!(without.contacts().impulses(), zero.contacts().impulses());
        prop_assert!(with.world().grains != zero.world().grains, "cohesion would have acted");
        Ok(())
    });
}

#[test]
fn overlap_grows_by_no_more_than_one_steps_travel() {
    // With R = r_i + r_j and x the offset of the centres, ‖x + Δt v‖ ≥ n·(x + Δt v) for the normal n
    // before: a new contact overlaps by no more than Δt times the closing speed along n. An old one
    // ends its step with v_n ≥ −ρ v_n^{n−1} but for the residual: |e_n| = m_n |v_n + ρ v_n^{n−1}|.
    let (old, new) = (Cell::new(0), Cell::new(0));
    for_random_piles(32, |scene| {
        let mut run = start(&scene);
        let (dt, restitution) = (scene.parameters.time_step_secs, scene.parameters.restitution);
        let mut earlier = step(&mut run);
        let mut known: Vec<Contact> = run.contacts().contacts().to_vec();
        for _ in 0..6 {
            let before = step(&mut run);
            let (_, scale, _) = natural_map(&run, &before);
            let error = run.observables().residual * scale;
            let contacts = run.contacts().contacts();
            for (judged, contact) in judge(&run, &before).iter().zip(contacts) {
                let lowest = -restitution * judged.before[0].max(0.0) - error / judged.normal_mass;
                prop_assert!(judged.after[0] >= lowest - 1e-12, "{contact:?}");
                let same = |c: &Contact| (c.grain, c.other) == (contact.grain, contact.other);
                if known.iter().any(same) {
                    old.set(old.get() + 1);
                    continue;
                }
                let (i, j) = (contact.grain as usize, contact.other as usize);
                let count = before.len();
                let fixed = |j: usize| (scene.fixed_discs[j - count].position, DVec2::ZERO);
                let grain = |k: usize| (earlier.positions[k], before.velocities[k]);
                let (place, velocity) = if j < count { grain(j) } else { fixed(j) };
                let normal = (grain(i).0 - place).normalize();
                let closed = -dt * normal.dot(grain(i).1 - velocity);
                prop_assert!(-contact.gap <= closed + 1e-15, "{contact:?} closed {closed:e}");
                new.set(new.get() + 1);
            }
            known = contacts.to_vec();
            earlier = before;
        }
        Ok(())
    });
    assert!(old.get() > 1000 && new.get() > 100, "{} old, {} new contacts", old.get(), new.get());
}
