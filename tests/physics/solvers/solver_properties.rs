//! Tests properties of every solved step of random piles. The solver's reports are checked against positions,
//! velocities and impulses only.

use std::cell::Cell;

use proptest::prelude::*;

use crate::common::natural_map::{judge, natural_map};
use crate::common::*;

/// Checks a property for `cases` random piles. The seed is fixed, so the piles are the same in each run of the tests.
fn for_random_piles(cases: u32, property: impl Fn(Scene) -> Result<(), TestCaseError>) {
    let bond = prop_oneof![1 => Just(0.0), 4 => 0.0..100.0];
    let friction = prop_oneof![1 => Just(0.0), 4 => 0.0..=1.0];
    let numbers = (bond, friction, 0.0..=1.0, 1e-4..5e-3, 0.0..0.3);
    let kinds = (20usize..=60, any::<u64>(), any::<bool>(), any::<bool>(), any::<bool>());
    let run = |(numbers, kinds)| property(pile(numbers, kinds));
    for_random(cases, (numbers, kinds), run);
}

/// Returns a pile of `count` grains, made from the random seed `seed`. The first tuple has the Bond number, the
/// friction coefficient μ, the restitution ρ, the time step Δt (s) and the size of the velocities (m/s). In the second
/// tuple, `shifted` selects the shifted friction cone (friction bounded by the normal force plus the cohesion force)
/// instead of the compressive one (friction bounded by the pushing part of the normal force only), `warm_start` makes
/// each solve start from the impulses of the previous step, and `turning` lets grains rotate.
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

/// Takes a step. Returns the grains as they were before the step.
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
    for_random_piles(16, |mut scene| {
        scene.parameters.friction = 0.0;
        let mut run = start(&scene);
        step(&mut run);
        run.step().expect("a finite state");
        let (world, contacts) = (run.world(), run.contacts());
        let mut full = StepProblem::<SpinningPlane>::default();
        let mut lean = StepProblem::<SmoothPlane>::default();
        let parameters = &scene.parameters;
        let numbers = ProblemNumbers {
            time_step_secs: parameters.time_step_secs,
            friction: parameters.friction,
            rolling_friction: 0.0,
            capture_speed: parameters.capture_speed(world.gravity.magnitude()),
            cone: parameters.cone,
        };
        let rebound = |approach: Approach| parameters.restitution * approach.velocity;
        let settings = SolverSettings { tolerance: 1e-6, max_sweeps: 50, ..scene.solver };
        full.prepare(world, contacts, numbers, &settings, rebound, None, None);
        lean.prepare(world, contacts, numbers, &settings, rebound, None, None);
        solve(&mut full, &mut Memory::default(), &settings);
        solve(&mut lean, &mut Memory::default(), &settings);
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
    // Let x be the offset of the centres and n the normal before the step. Then ‖x + Δt v‖ ≥ n·(x + Δt v), so a new
    // contact overlaps by at most Δt times the closing speed along n. An old contact ends its step with v_n ≥ −ρ
    // v_n^{n−1}, except for the residual: |e_n| = m_n |v_n + ρ v_n^{n−1}|.
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

/// Returns scenes in the plane (without friction and rotation, with friction only, and with friction and rotation),
/// each with both friction cones (friction bounded by the normal force plus the cohesion force, or by the pushing part
/// of the normal force only), and a scene in one dimension. Each has the smallest number of contacts that its first
/// contact problem must have.
fn scenes() -> Vec<(Scene, usize)> {
    let mut scenes = Vec::new();
    for (physics, cone) in pairs(
        [SMOOTH, UNTURNING, Physics::FULL],
        [FrictionCone::Shifted, FrictionCone::Compressive],
    ) {
        let mut scene = pressed_pile(40, 0.1, 3, parameters(10.0, 1e-3, 0.3, 0.4));
        (scene.physics, scene.parameters.cone) = (physics, cone);
        scenes.push((scene, 60));
    }
    let mut line = cradle();
    line.grains[2].position.x = line.grains[0].position.x - 0.999 * line.mean_diameter;
    line.physics = LINE;
    scenes.push((line, 2));
    scenes
}

/// Returns the number of unknown impulse components per contact.
fn entries<M: Model>() -> usize {
    if M::FRICTION { 2 } else { 1 }
}

/// Returns the Delassus operator (which maps impulses to changes of velocities) as a matrix. Each column is the
/// velocity change by a unit impulse; `origin` contains the velocities without impulses.
fn matrix<M: Model>(system: &mut BodySystem<'_, M>, origin: &[[f64; 2]]) -> Vec<Vec<f64>> {
    let entries = entries::<M>();
    let size = entries * origin.len();
    let mut answer = Vec::new();
    let mut matrix = vec![vec![0.0; size]; size];
    for column in 0..size {
        let mut unit = vec![[0.0; 2]; origin.len()];
        unit[column / entries][column % entries] = 1.0;
        system.write(&unit);
        system.velocities(&mut answer);
        for (row, numbers) in matrix.iter_mut().enumerate() {
            let (contact, entry) = (row / entries, row % entries);
            numbers[column] = answer[contact][entry] - origin[contact][entry];
        }
    }
    matrix
}

/// Returns the largest eigenvalue of a matrix by power iteration. Row and column k are first multiplied by `scale(k)`.
fn largest_eigenvalue(matrix: &[Vec<f64>], scale: impl Fn(usize) -> f64) -> f64 {
    let size = matrix.len();
    let mut vector: Vec<f64> = (0..size).map(|index| 1.0 + (index % 7) as f64).collect();
    let mut largest = 0.0;
    for _ in 0..300 {
        let next: Vec<f64> = (0..size)
            .map(|row| {
                let sum = |column: usize| matrix[row][column] * scale(column) * vector[column];
                scale(row) * (0..size).map(sum).sum::<f64>()
            })
            .collect();
        largest = next.iter().map(|x| x * x).sum::<f64>().sqrt();
        vector = next.iter().map(|x| x / largest).collect();
    }
    largest
}

struct Check(usize);

impl ProblemVisitor for Check {
    type Output = ();

    fn visit<M: Model>(self, problem: &mut StepProblem<M>, _: &ContactList) {
        let mut system = BodySystem::<M>::new(problem);
        let count = system.len();
        assert!(count >= self.0, "{count} contacts");
        let (mut origin, mut answer, mut weights) = (Vec::new(), Vec::new(), Vec::new());
        let zero = vec![[0.0; 2]; count];
        system.write(&zero);
        system.velocities(&mut origin);
        system.splitting(&mut weights);
        assert_eq!(weights.len(), count);

        let matrix = matrix(&mut system, &origin);
        let entries = entries::<M>();
        let diagonal = |index: usize| match index % entries {
            0 => 1.0,
            _ => system.tangential_diagonal(index / entries),
        };
        for (row, numbers) in matrix.iter().enumerate() {
            assert!((numbers[row] - diagonal(row)).abs() < 1e-11, "{}", numbers[row]);
            for (number, mirrored) in numbers.iter().zip(matrix.iter().map(|other| other[row])) {
                assert!((number - mirrored).abs() < 1e-11, "{number} and {mirrored}");
            }
        }
        // The splitting bounds the operator A by a diagonal matrix: A ⪯ D⁻¹. So the largest eigenvalue of D^½ A D^½ is
        // at most 1.
        let scale = |index: usize| (weights[index / entries] / diagonal(index)).sqrt();
        let largest = largest_eigenvalue(&matrix, scale);
        assert!(largest < 1.0 + 1e-9, "{largest}");
        assert!(largest > 0.5, "the bound is not idle: {largest}");
        // The impulses after some sweeps are the same after reading and writing them, and the residual is that of the
        // natural map.
        for _ in 0..3 {
            system.sweep();
        }
        let mut impulses = Vec::new();
        system.read(&mut impulses);
        system.velocities(&mut answer);
        let mut error = 0.0;
        for (contact, (&[normal, tangential], [w_n, w_t])) in
            impulses.iter().zip(&answer).enumerate()
        {
            let root = system.root_mass(contact);
            let bound = system.friction_bound(contact, normal);
            let e_n = normal - (normal - w_n).max(0.0);
            let moved = tangential - w_t / system.tangential_diagonal(contact);
            let e_t = if M::FRICTION { tangential - moved.clamp(-bound, bound) } else { 0.0 };
            error += root * root * (e_n * e_n + e_t * e_t);
        }
        let before = system.residual();
        system.write(&impulses);
        assert!((system.residual() - before).abs() < 1e-9 * before);
        let scale = scale_of_residual::<M>(problem);
        let found = residual(problem);
        assert!(found > 0.0 && (error.sqrt() / scale - found).abs() < 1e-9 * found);
    }
}

/// Returns the scale of the residual, ‖(m_n v_n^free, m_t v_t^free)‖, N·s: the norm of the impulses that would stop the
/// contacts. v_n^free and v_t^free are the normal and tangential velocities of a contact at the end of the step without
/// contact impulses (m/s; v_n^free includes the restitution term), m_n and m_t its effective masses in these directions
/// (kg).
fn scale_of_residual<M: Model>(problem: &StepProblem<M>) -> f64 {
    let rows = problem.rows.fixed.iter().map(|row| (&row.row, true));
    let rows = rows.chain(problem.rows.pairs.iter().map(|row| (&row.row, false)));
    let mut sum = 0.0;
    for (row, fixed) in rows {
        let i = &problem.bodies.free[row.i as usize];
        let [normal, tangential] = if fixed {
            M::velocity(row.normal, i)
        } else {
            M::relative_velocity(row.normal, i, &problem.bodies.free[row.j as usize])
        };
        let normal = normal + row.restitution_velocity;
        let tangential = if M::FRICTION { tangential / M::TANGENTIAL_COMPLIANCE } else { 0.0 };
        sum += row.effective_mass.powi(2) * (normal * normal + tangential * tangential);
    }
    sum.sqrt()
}

#[test]
fn scaled_variables_have_a_symmetric_operator_with_a_known_diagonal() {
    for (scene, contacts) in scenes() {
        start(&scene).next_problem(Check(contacts));
    }
}
