//! Compares the solvers with each other: if a contact problem has one solution, all of them must find it.

use crate::common::*;

/// Returns a scene of a small pile that begins to fall.
fn falling_pile(seed: u64) -> Scene {
    let rain = NewPile { grains: 50, box_width_in_diameters: 9.0, seed, ..NewPile::default() };
    let grains = settle(&rain, |_| true).expect("a pile at rest");
    pile_of(grains, rain.box_width_in_diameters).expect("a pile")
}

fn with(scene: &Scene, method: Method, tolerance: f64) -> Simulation {
    let stop = StopTest::Residual;
    let solver =
        SolverSettings { method, stop, tolerance, max_sweeps: 200_000, ..SolverSettings::SWEEPS };
    Scene { solver, ..scene.clone() }.simulation().expect("a proper scene")
}

/// Checks that all solvers and all orders of sweeps give the same velocities of a frictionless pile. Without friction
/// the velocities of a step are unique.
#[test]
fn all_methods_and_orders_agree_on_the_velocities_of_a_frictionless_pile() {
    for (seed, rotation) in [(1, true), (2, false)] {
        let mut scene = falling_pile(seed);
        scene.parameters.friction = 0.0;
        scene.parameters.bond = 5.0;
        if !rotation {
            scene.physics = Physics { friction: false, rotation: false, ..Physics::FULL };
        }
        let mut fastest = 0f64;
        for _ in 0..12 {
            // All methods start from the same state, because differences between runs grow in a pile.
            let mut by_sweeps = with(&scene, Method::Nsgs, 1e-10);
            assert!(by_sweeps.step().expect("a finite state").converged);
            let orders = Ordering::ALL.iter().map(|order| (Method::Nsgs, *order));
            let methods = METHODS.iter().map(|info| (info.method, Ordering::default()));
            for (method, ordering) in orders.chain(methods) {
                let tolerance = if method == Method::Jacobi { 1e-8 } else { 1e-10 };
                let mut other = with(&scene, method, tolerance);
                let solver = SolverSettings { ordering, ..*other.solver() };
                other.set_solver(solver).expect("proper settings");
                let step = *other.step().expect("a finite state");
                assert!(step.converged, "{method:?} {ordering:?}: {}", step.residual);
                let expected = by_sweeps.velocities();
                for (a, b) in expected.iter().zip(other.velocities()) {
                    fastest = fastest.max(a.length());
                    let allowed = 1e-6 * (tolerance / 1e-10) * fastest.max(1e-3);
                    assert!((*a - *b).length() < allowed, "{method:?} {ordering:?}: {b} for {a}");
                }
            }
            scene = advanced(&scene);
        }
        assert!(fastest > 0.01, "the pile fell, at up to {fastest} m/s");
    }
}

/// Returns a scene whose initial state is the state of the given scene after five steps.
fn advanced(scene: &Scene) -> Scene {
    let mut run = with(scene, Method::Nsgs, 1e-8);
    take_steps(&mut run, 5);
    let grains = run.grains();
    Scene { grains: (0..grains.len()).map(|index| grains.grain(index)).collect(), ..scene.clone() }
}

#[test]
fn newton_solves_nearly_all_steps_of_a_moving_pile_in_less_than_half_the_sweeps() {
    for (cone, rotation, scene) in moving_piles().into_iter().take(3) {
        let run = |method| {
            let mut simulation = with(&scene, method, 1e-8);
            let (mut unsolved, mut sweeps) = (0, 0);
            for _ in 0..200 {
                let step = *simulation.step().expect("a finite state");
                unsolved += u32::from(!step.converged);
                sweeps += step.sweeps;
                assert!(!step.converged || step.residual <= 1e-8 * (1.0 + 1e-6));
            }
            assert!(simulation.observables().kinetic_energy > 0.0);
            (unsolved, sweeps)
        };
        let (unsolved, sweeps) = run(Method::Newton);
        let (_, plain_sweeps) = run(Method::Nsgs);
        assert!(unsolved <= 10, "{unsolved} of 200 steps unsolved ({cone:?}, rotation {rotation})");
        assert!(2 * sweeps < plain_sweeps, "{sweeps} sweeps against {plain_sweeps}");
    }
}

/// Settings with which [`Simulation::next_problem`] solves the contact problem of the next step. The result is the
/// solver's report and the residual.
struct Solve(SolverSettings);

impl ProblemVisitor for Solve {
    type Output = (SolveReport, f64);

    fn visit<M: Model>(self, problem: &mut StepProblem<M>, _: &ContactList) -> Self::Output {
        let report = solve(problem, &mut Memory::default(), &self.0);
        (report, residual(problem))
    }
}

/// Two sets of settings with which [`Simulation::next_problem`] solves the contact problem of the next step: with the
/// first settings, and then, from this solution, with the second settings. The result is both reports of the solver.
pub struct SolveTwice(pub SolverSettings, pub SolverSettings);

impl ProblemVisitor for SolveTwice {
    type Output = [SolveReport; 2];

    fn visit<M: Model>(self, problem: &mut StepProblem<M>, _: &ContactList) -> Self::Output {
        let mut memory = Memory::default();
        [self.0, self.1].map(|settings| solve(problem, &mut memory, &settings))
    }
}

/// Returns piles that begin to fall, with both friction cones (friction bounded by the normal force plus the cohesion
/// force, or by the pushing part of the normal force only), with and without rotation. The last pile has no cohesion.
fn moving_piles() -> [(FrictionCone, bool, Scene); 4] {
    let (shifted, compressive) = (FrictionCone::Shifted, FrictionCone::Compressive);
    let kinds = [
        (3, shifted, true, 10.0),
        (4, compressive, true, 10.0),
        (5, shifted, false, 10.0),
        (6, shifted, true, 0.0),
    ];
    kinds.map(|(seed, cone, rotation, bond)| {
        let mut scene = falling_pile(seed);
        scene.physics.rotation = rotation;
        scene.parameters = Parameters { cone, bond, ..scene.parameters };
        (cone, rotation, scene)
    })
}

/// Returns states of falling piles, computed by Gauss–Seidel sweeps. Piles are chaotic: if another method computed the
/// states, the contact problems of all tests would change.
fn moments() -> Vec<Simulation> {
    let mut moments = Vec::new();
    for (_, _, mut scene) in moving_piles() {
        // If the touch tolerance closes gaps, a warm start of the method `admm` is worse than a cold start.
        scene.parameters.touch_tolerance = 0.0;
        let mut run = with(&scene, Method::Nsgs, 1e-8);
        for _ in 0..6 {
            take_steps(&mut run, 20);
            moments.push(run.clone());
        }
    }
    moments
}

/// Solves the contact problem of the next step from a state with these settings. Returns the solver's report and the
/// residual.
fn next_with(moment: &Simulation, solver: SolverSettings) -> (SolveReport, f64) {
    let mut run = moment.clone();
    run.set_solver(solver).expect("proper settings");
    run.next_problem(Solve(solver))
}

/// Returns the residual to which a method must solve the problems of these tests. It is larger for Jacobi's method,
/// which converges slowly.
fn tight_for(method: Method) -> f64 {
    if method == Method::Jacobi { 1e-5 } else { 1e-8 }
}

#[test]
fn every_method_solves_nearly_all_steps_of_moving_piles() {
    let moments = moments();
    for info in METHODS.iter() {
        let tolerance = tight_for(info.method);
        let mut solved = 0;
        for moment in &moments {
            let solver = SolverSettings { method: info.method, tolerance, ..*moment.solver() };
            let solver = SolverSettings { max_sweeps: 30_000, ..solver };
            let (report, residual) = next_with(moment, solver);
            assert_eq!(report.converged, residual <= tolerance, "{}", info.name);
            solved += usize::from(report.converged);
        }
        println!("{}: {solved} of {}", info.name, moments.len());
        assert!(10 * solved >= 8 * moments.len(), "{} solved {solved}", info.name);
    }
}

#[test]
fn every_method_honours_every_stopping_test_and_the_limit() {
    let moments = moments();
    for (moment, info) in pairs(moments.iter().step_by(5), METHODS.iter()) {
        for (stop, tolerance) in [
            (StopTest::RelativeChange, 1e-5),
            (StopTest::ImpulsePerMass, 1e-4),
            (StopTest::Residual, 1e-4),
        ] {
            let settings = SolverSettings {
                method: info.method,
                stop,
                tolerance,
                max_sweeps: 100_000,
                warm_start: false,
                ..SolverSettings::SWEEPS
            };
            let mut run = moment.clone();
            run.set_solver(settings).expect("proper settings");
            let [first, again] = run.next_problem(SolveTwice(settings, settings));
            let name = format!("{} {stop:?}", info.name);
            assert!(first.converged && again.converged, "{name}: {first:?}");
            assert!(first.sweeps > 1, "{name}: {first:?}");
            if stop == StopTest::Residual {
                let most = first.sweeps.div_ceil(4);
                assert!(again.sweeps <= most, "a warm start, {name}: {again:?}, {first:?}");
            }
            let hasty = SolverSettings { tolerance: 1e-14, max_sweeps: 5, ..settings };
            let (report, residual) = next_with(moment, hasty);
            assert!(!report.converged && report.sweeps <= 5, "{name}: {report:?}");
            assert!(residual <= 1.0, "{name}: {residual}");
        }
    }
}

#[test]
fn a_step_without_contacts_is_solved_by_every_method() {
    let mut scene = cradle();
    scene.grains.truncate(1);
    for info in METHODS.iter() {
        scene.solver.method = info.method;
        let mut run = start(&scene);
        let step = *run.step().expect("a finite state");
        assert!(step.converged && step.sweeps == 0 && step.contacts == 0, "{}", info.name);
    }
}

#[test]
fn settings_that_are_left_out_have_their_defaults() {
    let json = r#"{"method":"nsgs","tolerance":1e-6,"max_sweeps":5000,"warm_start":true}"#;
    let settings: SolverSettings = serde_json::from_str(json).expect("settings");
    let given = SolverSettings {
        method: Method::Nsgs,
        tolerance: 1e-6,
        max_sweeps: 5000,
        warm_start: true,
        ..SolverSettings::default()
    };
    assert_eq!(settings, given);
}

#[test]
fn every_method_keeps_the_cradle_closed_where_the_exact_answer_is_closed() {
    for info in METHODS.iter() {
        let mut scene = cradle();
        scene.solver.method = info.method;
        scene.solver.tolerance = 1e-12;
        scene.parameters.time_step_secs = 5e-4;
        let mut run = start(&scene);
        let mut met = false;
        while run.time_secs() < scene.duration_secs {
            met |= run.step().expect("a finite state").contacts == 2;
        }
        let positions = run.places();
        let gap = positions[1].x - positions[0].x - scene.mean_diameter;
        assert!(met, "k reached the pair");
        assert!(gap < 1e-6, "{}: the bond is open by {gap} m", info.name);
    }
}

#[test]
fn the_default_sweeps_a_large_pile_that_flows_and_solves_one_that_stands() {
    let box_width_in_diameters = 45.0;
    let deposition = Deposition::DropAndRoll;
    let new = NewPile {
        grains: 1_100,
        box_width_in_diameters,
        seed: 3,
        deposition,
        ..NewPile::default()
    };
    let mut scene =
        pile_of(settle(&new, |_| true).expect("a pile"), box_width_in_diameters).expect("a scene");
    scene.parameters.time_step_secs = 1e-3;
    let mut last = |bond| {
        scene.parameters.bond = bond;
        let mut run = scene.simulation().expect("a proper scene");
        (0..60).for_each(|_| _ = run.step().expect("a finite state"));
        *run.observables()
    };
    let flowing = last(0.0);
    assert!(flowing.contacts > 1_000 && flowing.slump > 0.01, "{flowing:?}");
    assert_eq!((flowing.factorisations, flowing.converged), (0, false));
    let standing = last(100.0);
    assert!(standing.converged && standing.slump.abs() < 1e-3, "{standing:?}");
}
