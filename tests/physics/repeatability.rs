//! Tests that equal runs are bitwise equal, and that a run does not depend on how its scene is written: on its
//! position, mirroring, and the numbering of the grains.

use crate::common::*;

fn collapse() -> Scene {
    let mut scene = paper_pile().expect("the shipped state");
    scene.parameters = parameters(20.0, 2e-3, 0.1, 0.5);
    scene.solver.tolerance = 1e-3;
    scene
}

#[test]
fn a_run_repeats_bitwise_alone_and_in_pools_of_threads() {
    let first = after(&collapse(), 200);
    assert!(first.observables().slump > 0.02, "the pile has moved");
    let again = after(&collapse(), 200);
    assert!(bits(&first) == bits(&again));
    assert_eq!(first.observables(), again.observables());
    for threads in [1, 4] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        let runs: Vec<Simulation> = pool.install(|| {
            use rayon::prelude::*;
            (0..3).into_par_iter().map(|_| after(&collapse(), 200)).collect()
        });
        for inside in runs {
            assert!(bits(&first) == bits(&inside), "{threads} threads");
            assert_eq!(first.observables(), inside.observables(), "{threads} threads");
        }
    }
}

#[test]
fn what_many_grains_do_is_shared_out_over_threads_to_the_same_bits() {
    // Rayon's global thread pool exists once per process: this call fails if another test has made the pool before.
    // Three threads are needed even on a machine with one core.
    let _ = rayon::ThreadPoolBuilder::new().num_threads(3).build_global();
    assert!(rayon::current_num_threads() > 1, "several threads");
    let alone = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
    // A lattice of discs with different velocities. Some discs touch, others are close.
    let at = |k: usize| {
        let [column, row] = [k % 110, k / 110].map(|number| number as f64);
        let shift = 0.05 * DVec2::new((k as f64).sin(), (1.7 * k as f64).cos());
        let velocity = 0.02 * DVec2::new((3.1 * k as f64).cos(), (2.3 * k as f64).sin());
        moving(0.01 * (DVec2::new(column + 0.5 * row, 0.87 * row) + shift), 0.005, velocity)
    };
    for (stepper, method) in every_way() {
        let mut scene = under_g(parameters(20.0, 1e-3, 0.3, 0.5), (0..110 * 160).map(at).collect());
        (scene.stepper, scene.solver.method, scene.solver.max_sweeps) = (stepper, method, 3);
        // Direct methods run the same code with any number of threads. Three steps of them would take as long as the
        // rest of the test.
        if stepper.uses_method() && !matches!(method, Method::Nsgs | Method::NsgsParallel) {
            continue;
        }
        let shared = after(&scene, 3);
        let by_one = alone.install(|| after(&scene, 3));
        let what = format!("{stepper} {}", method.name());
        assert!(
            shared.contacts().contacts().len() > 9_000,
            "{what}: contacts of several stretches"
        );
        assert_eq!(shared.contacts().contacts(), by_one.contacts().contacts(), "{what}");
        assert_eq!(shared.contacts().impulses(), by_one.contacts().impulses(), "{what}");
        assert!(bits(&shared) == bits(&by_one), "{what}");
        assert_eq!(shared.observables(), by_one.observables(), "{what}");
    }
}

#[test]
fn runs_repeat_bitwise_and_clones_go_on_as_the_original() {
    let ranged = Parameters { restitution: 0.1, restitution_threshold: 2.0, ..range(20.0, 1e-3) };
    let bonded = Scene {
        stepper: Stepper::Range,
        solver: SolverSettings { max_sweeps: 20_000, ..solved_by(Method::Newton, 1e-8) },
        ..pressed_pile(60, 0.3, 5, ranged)
    };
    let by_scheme = |stepper: Stepper| {
        let mut pile = by(stepper, 0, paper_pile().expect("the shipped state"));
        pile.parameters = parameters(20.0, 2e-3, 0.1, 0.5);
        (pile, 100, 20, 0.01)
    };
    // In the first scene, the steps 50 to 250 rebuild the list of near pairs at times that depend on earlier steps.
    let runs = ALL_SCHEMES.map(by_scheme);
    for (scene, before, later, least) in
        [(collapse(), 50, 200, 0.0), (bonded, 30, 30, -1.0)].into_iter().chain(runs)
    {
        let stepper = scene.stepper;
        let (mut one, other) = (after(&scene, before), after(&scene, before));
        assert!(one.observables().slump > least, "{stepper}: it moves");
        assert!(bits(&one) == bits(&other), "{stepper}");
        assert_eq!(one.observables(), other.observables(), "{stepper}");
        let mut clone = one.clone();
        take_steps(&mut one, later);
        take_steps(&mut clone, later);
        assert!(bits(&one) == bits(&clone), "{stepper}");
        assert_eq!(one.world(), clone.world(), "{stepper}");
        assert_eq!(one.contacts().impulses(), clone.contacts().impulses(), "{stepper}");
        assert_eq!(one.observables(), clone.observables(), "{stepper}");
    }
}

/// Returns a scene of an overlapping pile. Each step may take enough sweeps for the result to have the symmetry of the
/// scene.
fn pressed(bond: f64) -> Scene {
    let mut scene = pressed_pile(40, 0.05, 11, parameters(bond, 1e-3, 0.3, 0.4));
    scene.solver.max_sweeps = 200;
    scene
}

fn largest_distance(a: &[DVec2], b: &[DVec2], map: impl Fn(DVec2) -> DVec2) -> f64 {
    a.iter().zip(b).map(|(&a, &b)| map(a).distance(b)).fold(0.0, f64::max)
}

#[test]
fn a_moved_scene_moves_alike() {
    let shift = DVec2::new(1.25, -0.7);
    for bond in [0.0, 20.0] {
        let here = pressed(bond);
        let mut there = here.clone();
        there.grains.iter_mut().for_each(|grain| grain.position += shift);
        there.fixed_discs.iter_mut().for_each(|disc| disc.position += shift);
        // Only a few steps are compared, because piles are chaotic and rounding errors grow.
        let (here, there) = (after(&here, 5), after(&there, 5));
        let (a, b) = (here.grains(), there.grains());
        assert!(here.observables().contacts > 60, "{}", here.observables().contacts);
        assert!(here.observables().kinetic_energy > 1e-7, "{}", here.observables().kinetic_energy);
        assert!(largest_distance(&a.velocities, &b.velocities, |v| v) < 1e-11);
        assert!(largest_distance(&a.positions, &b.positions, |x| x + shift) < 1e-13);
        assert_eq!(here.observables().contacts, there.observables().contacts);
    }
}

#[test]
fn a_mirrored_scene_moves_mirrored() {
    let mirror = |vector: DVec2| DVec2::new(-vector.x, vector.y);
    for bond in [0.0, 20.0] {
        let mut scene = pressed(bond);
        let right = after(&scene, 30);
        for grain in &mut scene.grains {
            grain.position = mirror(grain.position);
            grain.velocity = mirror(grain.velocity);
            grain.angular_velocity = -grain.angular_velocity;
        }
        scene.fixed_discs.iter_mut().for_each(|disc: &mut Disc| {
            disc.position = mirror(disc.position);
        });
        let left = after(&scene, 30);
        let (a, b) = (right.grains(), left.grains());
        // No operation of a step distinguishes left from right, so even rounding errors are mirrored.
        assert_eq!(largest_distance(&a.positions, &b.positions, mirror), 0.0);
        assert_eq!(largest_distance(&a.velocities, &b.velocities, mirror), 0.0);
        assert!(a.angles.iter().zip(&b.angles).all(|(a, b)| a == &-b));
        assert!(a.angles.iter().any(|angle| angle.abs() > 1e-3), "they turned");
    }
}

#[test]
fn renumbered_grains_move_alike_where_the_solution_is_unique() {
    // Without friction the velocities that solve a step are unique. The order of a sweep follows the numbering of the
    // grains, and may change the velocities only within the tolerance.
    for bond in [0.0, 20.0] {
        let mut scene = Scene { physics: SMOOTH, solver: tight(), ..pressed(bond) };
        scene.grains.iter_mut().for_each(|grain| grain.angular_velocity = 0.0);
        let forth = after(&scene, 5);
        assert!(forth.observables().converged && forth.observables().contacts > 60);
        scene.grains.reverse();
        scene.fixed_discs.reverse();
        let back = after(&scene, 5);
        let mut velocities = back.grains().velocities.clone();
        velocities.reverse();
        let off = largest_distance(forth.velocities(), &velocities, |v| v);
        assert!(off < 1e-9, "off by {off:e}");
        assert!(off > 0.0, "another order of the sweep was taken");
    }
}

/// Checks that the default solver gives the same step for two numberings of five discs: three on a floor and two on top
/// of them, all overlapping. If friction bounds came from sweeps in the order of the numbering, swapping the two upper
/// discs in the list would change the angular velocity of the last disc by 0.08 rad/s.
#[test]
fn by_default_a_step_does_not_depend_on_the_numbering_of_its_discs() {
    let discs = [
        ([0.00097, 0.49705], 0.5027, [-0.17128, -0.10068]),
        ([1.00146, 0.49668], 0.50055, [0.1642, -0.1569]),
        ([1.99838, 0.50073], 0.50236, [-0.11799, -0.0961]),
        ([0.50254, 1.36448], 0.50383, [-0.05409, -0.0818]),
        ([1.50264, 1.36366], 0.50166, [-0.05375, -0.13139]),
    ];
    let grains = discs
        .map(|(place, radius, velocity): ([f64; 2], _, [f64; 2])| {
            moving(place.into(), radius, velocity.into())
        })
        .to_vec();
    let step = |order: [usize; 5], solver: SolverSettings| {
        let grains = order.map(|disc| grains[disc].clone()).to_vec();
        let numbers = parameters(0.0, 1e-3, 0.5, 0.5);
        let run =
            after(&Scene { boundaries: vec![level()], solver, ..under_g(numbers, grains) }, 1);
        let mut spins = [0.0; 5];
        for (at, disc) in order.into_iter().enumerate() {
            spins[disc] = run.grains().angular_velocities[at];
        }
        spins
    };
    let apart = |solver| {
        let [one, other] = [[0, 1, 2, 3, 4], [0, 1, 2, 4, 3]].map(|order| step(order, solver));
        one.iter().zip(other).map(|(one, other)| (one - other).abs()).fold(0.0, f64::max)
    };
    let found = apart(SolverSettings::default());
    assert!(found < 1e-4, "{found:e} rad/s apart");
    let bounded = apart(SolverSettings::BOUNDED);
    assert!(bounded > 0.01, "bounds of friction that sweeps make: {bounded:e} rad/s apart");
}

/// Returns a scene of a hanging chain of 12 discs. If a solve starts from zero impulses, it needs dozens of sweeps; if
/// it starts from the impulses of the previous step, it needs one.
fn chain() -> Scene {
    let radius = 0.05;
    let place = |k: usize| -DVec2::Y * (k as f64 * (2.0 * radius - 1e-9));
    Scene {
        fixed_discs: vec![fixed(DVec2::ZERO, radius)],
        solver: to_residual(1e-11),
        ..under_g(
            parameters(50.0, 1e-3, 0.1, 0.5),
            (1..=12).map(|k| Grain::at_rest(place(k), radius)).collect(),
        )
    }
}

/// Takes one step, solved to a residual of 1e-8. Returns the number of sweeps.
fn sweeps_of_next_step(run: &mut Simulation, warm_start: bool) -> u32 {
    let settings = SolverSettings { warm_start, ..to_residual(1e-8) };
    run.set_solver(settings).expect("proper settings");
    run.step().expect("a finite state");
    run.observables().sweeps
}

#[test]
fn a_contact_that_goes_leaves_the_others_their_impulses() {
    // An additional disc comes before the chain in the order of contacts and falls off the fixed disc.
    let mut scene = chain();
    let place = DVec2::new(0.1 - 1e-9, 0.0);
    let velocity = DVec2::new(3.0, 0.0);
    scene.grains.insert(0, Grain { velocity, ..Grain::at_rest(place, 0.05) });
    let mut run = after(&scene, 1);
    assert_eq!(run.observables().contacts, 13);
    let next = sweeps_of_next_step(&mut run.clone(), false);
    assert!(next > 20, "a cold start is dear: {next} sweeps");
    assert_eq!(sweeps_of_next_step(&mut run, true), 1);
    assert_eq!(run.observables().contacts, 12, "one has gone");
}

#[test]
fn a_change_of_the_time_step_leaves_the_forces() {
    let mut run = after(&chain(), 10);
    assert!(sweeps_of_next_step(&mut run.clone(), false) > 20, "a cold start is dear");
    let forces = |run: &Simulation| -> Vec<f64> {
        run.snapshot().contacts.iter().map(|contact| contact.normal_force).collect()
    };
    let before = forces(&run);
    for dt in [5e-4, 4e-3, 1e-3] {
        let mut parameters = *run.parameters();
        parameters.time_step_secs = dt;
        run.set_parameters(parameters).expect("proper parameters");
        for (now, then) in forces(&run).iter().zip(&before) {
            assert_close(*now, *then, 1e-7, "a force between two steps");
        }
        assert_eq!(sweeps_of_next_step(&mut run, true), 1, "Δt {dt}");
        for (now, then) in forces(&run).iter().zip(&before) {
            assert_close(*now, *then, 1e-7, "a force");
        }
    }
}
