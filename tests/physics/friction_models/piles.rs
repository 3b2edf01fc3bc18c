//! Piles under every convex model: what is solved is the model, and has one solution.

use crate::common::natural_map::judge;
use crate::common::*;

pub const CONVEX: [FrictionModel; 3] =
    [FrictionModel::Tresca, FrictionModel::Associated, FrictionModel::Desaxce];

/// Piles under every convex model, with both cones where the model takes them.
fn piles(count: usize, bond: f64, speed: f64, dt: f64) -> Vec<Scene> {
    let mut all = Vec::new();
    for (model, restitution, cone) in triples(CONVEX, [0.0, 0.9], FrictionCone::ALL) {
        if model != FrictionModel::Tresca && *cone == FrictionCone::Compressive {
            continue;
        }
        for physics in [UNTURNING, Physics::FULL] {
            let parameters = parameters(bond, dt, restitution, MU_OF_PILES);
            let mut pile = pressed_pile(count, speed, 11, parameters);
            (pile.physics, pile.parameters.cone) = (physics, *cone);
            if !physics.rotation {
                pile.grains.iter_mut().for_each(|grain| grain.angular_velocity = 0.0);
            }
            pile.solver.friction_model = model;
            (pile.solver.tolerance, pile.solver.max_sweeps) = (1e-11, 300_000);
            for method in [Method::Nsgs, Method::InteriorPoint] {
                pile.solver.method = method;
                all.push(pile.clone());
            }
        }
    }
    all
}

fn what(pile: &Scene) -> String {
    let SolverSettings { method, friction_model, .. } = pile.solver;
    let (parameters, turning) = (pile.parameters, pile.physics.rotation);
    let Parameters { cone, restitution, .. } = parameters;
    format!("{method}, {friction_model}, {cone}, rho {restitution}, turning {turning}")
}

#[test]
fn solved_steps_obey_the_model_as_world_data_show_it() {
    for pile in piles(30, 2.0, 0.3, 1e-3) {
        let what = what(&pile);
        let mut simulation = after(&pile, 2);
        let (contacts, impulses) =
            (simulation.contacts().contacts().to_vec(), simulation.contacts().impulses().to_vec());
        let before = simulation.grains().clone();
        let row = *simulation.step().expect("a finite state");
        assert!(row.converged, "{what}: {:?} after {} sweeps", row.model_residual, row.sweeps);
        assert!(row.model_residual.is_some_and(|residual| residual <= 1e-11), "{what}");
        let mut slid = 0;
        let judged = judge(&simulation, &before);
        let now = simulation.contacts();
        for ((contact, found), impulse) in judged.iter().zip(now.contacts()).zip(now.impulses()) {
            let p = impulse.normal + contact.cohesion_impulse;
            let rebound = pile.parameters.restitution * contact.before[0];
            let (mut w, v) = (contact.after[0] + rebound, contact.after[1]);
            let scale = contact.normal_mass * 0.05;
            let small = |value: f64| value.abs() <= 1e-7 * scale;
            let mass = contact.normal_mass;
            if pile.solver.friction_model == FrictionModel::Tresca {
                let then = contacts
                    .iter()
                    .position(|old| (old.grain, old.other) == (found.grain, found.other));
                let Some(then) = then else { continue };
                let rubbing = match pile.parameters.cone {
                    FrictionCone::Shifted => impulses[then].normal + contact.cohesion_impulse,
                    FrictionCone::Compressive => impulses[then].normal,
                };
                let bound = MU_OF_PILES * rubbing.max(0.0);
                assert!(small((-p).max(0.0)) && small(mass * (-w).max(0.0)), "{what}");
                assert!(small(p.min(mass * w)), "{what}: p {p:e}, w {w:e}");
                let stuck = impulse.tangential - contact.tangential_mass * v;
                assert!(small(impulse.tangential - stuck.clamp(-bound, bound)), "{what}");
                slid += usize::from(mass * v.abs() > 1e-3 * scale);
            } else {
                if pile.solver.friction_model == FrictionModel::Desaxce {
                    w += MU_OF_PILES * contact.before[1].abs();
                }
                assert!(small((impulse.tangential.abs() - MU_OF_PILES * p).max(0.0)), "{what}");
                assert!(
                    small(mass * (MU_OF_PILES * v.abs() - w).max(0.0)),
                    "{what}: w {w:e}, v {v:e}"
                );
                let work = p * w + impulse.tangential * v;
                assert!(
                    work.abs() <= 1e-6 * (p.abs() * w.abs()).max(scale * 0.05),
                    "{what}: {work:e}"
                );
                slid += usize::from(mass * v.abs() > 1e-3 * scale);
            }
        }
        assert!(judged.len() > 20 && slid > 3, "{what}: {} contacts, {slid} slide", judged.len());
    }
}

/// μ of [`piles`].
const MU_OF_PILES: f64 = 0.5;

/// Velocities of the bodies where a problem is solved from impulses at random.
struct FromRandomStarts<'a>(&'a SolverSettings, u64);

impl ProblemVisitor for FromRandomStarts<'_> {
    type Output = Vec<f64>;

    fn visit<M: Model>(self, problem: &mut Problem<M>, _: &ContactList) -> Vec<f64> {
        let mut random = random(self.1);
        let mut root_masses = Vec::new();
        let mut system = BodySystem::<M>::new(problem, &mut root_masses);
        let mut impulse = || random.random_range(-1.0..1.0) * 0.05;
        let impulses: Vec<_> = (0..system.len())
            .map(|contact| [0, 1].map(|_| impulse() * system.root_mass(contact)))
            .collect();
        system.write(&impulses);
        let report = solve::<M>(problem, &mut Memory::default(), self.0);
        assert!(report.converged, "{report:?}");
        problem.bodies.now.iter().flat_map(M::Kinematics::coordinates).collect()
    }
}

#[test]
fn the_velocities_of_a_convex_model_are_the_same_from_any_start() {
    for pile in piles(25, 20.0, 0.05, 1e-5) {
        let what = what(&pile);
        let run = after(&pile, 3);
        let settings = pile.solver;
        let solution = |seed| run.next_problem(FromRandomStarts(&settings, seed));
        let first = solution(0);
        let fastest = first.iter().fold(0f64, |fastest, speed| fastest.max(speed.abs()));
        assert!(fastest > 1e-3, "{what}: nothing moves");
        for seed in 1..10 {
            for (one, other) in first.iter().zip(solution(seed)) {
                assert!((one - other).abs() < 1e-8 * fastest, "{what}: {one:e} and {other:e}");
            }
        }
    }
}

/// A pile that slumps, as `fallback` says, with too few sweeps a step to solve most of them.
fn pile(method: Method, fallback: Fallback, cone: FrictionCone) -> Simulation {
    let mut scene = built_in("pile").expect("a scene");
    scene.parameters.bond = 20.0;
    scene.parameters.time_step_secs = 1e-3;
    scene.parameters.cone = cone;
    scene.solver = SolverSettings { fallback, max_sweeps: 60, ..solved_by(method, 1e-9) };
    start(&scene)
}

#[test]
fn a_step_that_is_not_solved_falls_back_on_one_that_is_and_says_so() {
    for (cone, method) in pairs(
        FrictionCone::ALL,
        [Method::Nsgs, Method::Nncg, Method::Newton, Method::InteriorPoint],
    ) {
        let what = format!("{method}, {cone}");
        let mut run = pile(method, Fallback::Tresca, *cone);
        let (mut fell_back, mut solved) = (0, 0);
        for _ in 0..60 {
            let row = *run.step().expect("a finite state");
            let told = row.fell_back.expect("it could fall back");
            let of_model = row.model_residual.expect("a residual of what was solved");
            let gap = row.duality_gap.expect("a gap");
            if told {
                fell_back += 1;
                assert!(!row.converged && of_model <= 1e-8, "{what}: {of_model:e}");
                assert!((-1e-14..1e-3).contains(&gap), "{what}: {gap:e}");
                assert!(row.factorisations > 0, "{what}");
            } else {
                solved += 1;
                assert!(row.converged, "{what}: neither");
                assert_eq!((of_model, gap), (row.residual, f64::INFINITY), "{what}");
            }
        }
        assert!(fell_back > 10, "{what}: {fell_back} fell back, {solved} were solved");
    }
}

#[test]
fn auto_falls_back_unless_told_not_to_and_others_do_where_told() {
    let told = |method, fallback| {
        let mut run = pile(method, fallback, FrictionCone::Shifted);
        take_steps(&mut run, 30);
        let places = bits(&run);
        (run.observables().fell_back.is_some(), places)
    };
    let auto = told(Method::Auto, Fallback::OfMethod);
    assert!(auto.0);
    assert_eq!(auto, told(Method::Auto, Fallback::Tresca));
    let without = told(Method::Auto, Fallback::None);
    assert!(!without.0 && without.1 != auto.1);
    assert_eq!(without, told(Method::Newton, Fallback::OfMethod), "auto takes newton here");
}

/// Remedies and the law `range` solve a problem several times; one of the earlier solves may have fallen back.
#[test]
fn a_problem_is_solved_again_after_it_fell_back() {
    let plain = Remedies::default();
    for (stepper, remedies, bond) in [
        (Stepper::Moreau, Remedies { calm_unsolved: true, ..plain }, 20.0),
        (Stepper::Moreau, Remedies { sequential_impacts: true, ..plain }, 0.0),
        (Stepper::Range, plain, 20.0),
    ] {
        let mut scene = built_in("pile").expect("a scene");
        (scene.stepper, scene.remedies, scene.parameters.bond) = (stepper, remedies, bond);
        (scene.parameters.time_step_secs, scene.parameters.restitution) = (1e-3, 0.5);
        scene.solver = SolverSettings {
            fallback: Fallback::Tresca,
            stop: StopTest::Residual,
            tolerance: 1e-9,
            max_sweeps: 40,
            ..SolverSettings::default()
        };
        let mut run = start(&scene);
        let mut fell_back = 0;
        for _ in 0..40 {
            let row = *run.step().expect("a finite state");
            fell_back += u32::from(row.fell_back == Some(true));
            assert!(row.model_residual.is_some() && row.residual.is_finite());
        }
        assert!(fell_back > 10, "{stepper}, {remedies:?}: {fell_back}");
    }
}
