//! Random contact problems that have a solution: proximal multipliers, which end a solve or stand in for the path, find
//! the velocities that the path leads to.

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use super::*;
use crate::contact::ContactLaw;
use crate::solver::problem::{FixedRow, PairRow, Row};
use crate::solver::{Line, Plane, SmoothPlane, SpinningPlane, StopTest};

const FRICTION: f64 = 0.6;

/// Contacts of bodies of different masses. Nothing has to move for them (what is added to v_n is positive), so that
/// there is a solution.
fn problem<M: Model>(seed: u64, model: FrictionModel) -> StepProblem<M> {
    let (bodies, contacts) = (40, 90);
    let mut random = Pcg64::seed_from_u64(seed);
    let law = ContactLaw::new(FRICTION, 0.1, FrictionCone::Shifted);
    let mut problem = StepProblem::<M> { law, ..StepProblem::default() };
    problem.bodies.mean_mass = 1.0;
    problem.friction.model = model;
    problem.rows.contacts.extend(0..contacts);
    for _ in 0..bodies {
        problem.bodies.masses.push(random.random_range(0.2..5.0));
        let speeds = [(); 3].map(|()| random.random_range(-1.0..1.0));
        problem.bodies.free.push(M::from_coordinates(speeds));
    }
    problem.bodies.before = problem.bodies.free.clone();
    for contact in 0..contacts {
        let i = random.random_range(0..bodies);
        let j = (i + random.random_range(1..6)) % bodies;
        let angle: f64 = random.random_range(0.0..std::f64::consts::TAU);
        let normal = match M::AXES {
            1 => [angle.cos().signum(), 0.0],
            _ => [angle.cos(), angle.sin()],
        };
        let (of_i, of_j) = (problem.bodies.masses[i], problem.bodies.masses[j]);
        let is_fixed = contact % 6 == 0;
        let share = if is_fixed { 1.0 } else { of_j / (of_i + of_j) };
        // Drawn before the row's own numbers.
        let surface_speed = if is_fixed { random.random_range(-0.1..0.1) } else { 0.0 };
        let row = Row {
            i: i as u32,
            j: j as u32,
            normal: M::normal(normal),
            restitution_velocity: random.random_range(0.0..0.3),
            shifted_impulse: random.random_range(0.0..1.0),
            tangential_impulse: 0.0,
            effective_mass: of_i * share,
        };
        if is_fixed {
            problem.rows.fixed.push(FixedRow { row, surface_speed });
        } else {
            problem.rows.pairs.push(PairRow { row, share });
        }
        problem.friction.now.push(match model {
            FrictionModel::Tresca => random.random_range(0.0..0.2),
            _ => 0.0,
        });
    }
    problem.form_velocities();
    problem
}

/// Velocities that the path leads to, and those that proximal multipliers alone do, with their factorisations.
fn both_ways<M: Model, S: Shape, const D: usize>(
    seed: u64,
    model: FrictionModel,
) -> ([Vec<[f64; 3]>; 2], u32) {
    let stop = StopTest::Residual;
    let settings = SolverSettings { stop, tolerance: 1e-10, ..SolverSettings::default() };
    let mut by_path = problem::<M>(seed, model);
    let mut from_far = by_path.clone();
    let mut workspace = PathWorkspace::<D>::default();
    let report =
        InteriorPoint::<M, S, D>::new(&mut by_path, &settings, &mut workspace).solve_convex();
    assert!(report.converged, "seed {seed}, {model}: {report:?}");

    let mut solver = InteriorPoint::<M, S, D>::new(&mut from_far, &settings, &mut workspace);
    solver.workspace.graph.analyse(solver.problem);
    solver.begin();
    solver.start(0);
    assert!(solver.best > 0.1, "seed {seed}, {model}: it is far");
    assert!(solver.solve_from_far(), "seed {seed}, {model}: {}", solver.best);
    let factorisations = solver.report.factorisations;
    let velocities =
        |problem: &StepProblem<M>| problem.bodies.now.iter().map(M::coordinates::<f64>).collect();
    ([velocities(&by_path), velocities(&from_far)], factorisations)
}

fn proximal_multipliers_agree<M: Model, S: Shape, const D: usize>(model: FrictionModel) {
    let mut all = Vec::new();
    for seed in 0..40 {
        let ([by_path, from_far], factorisations) = both_ways::<M, S, D>(seed, model);
        let pairs = by_path.iter().flatten().zip(from_far.iter().flatten());
        let most = pairs.map(|(one, other)| (one - other).abs()).fold(0.0, f64::max);
        assert!(most < 1e-7, "seed {seed}, {model}: {most:e}");
        all.push(factorisations);
    }
    all.sort_unstable();
    assert!(all[39] <= 120, "{model}: {} in the median, {} at most", all[20], all[39]);
}

#[test]
fn proximal_multipliers_find_the_velocities_that_the_path_leads_to() {
    proximal_multipliers_agree::<SpinningPlane, Strip, 3>(FrictionModel::Tresca);
    proximal_multipliers_agree::<Plane, Strip, 2>(FrictionModel::Tresca);
    proximal_multipliers_agree::<SpinningPlane, Cone, 3>(FrictionModel::Associated);
    proximal_multipliers_agree::<Plane, Cone, 2>(FrictionModel::Associated);
}

#[test]
fn they_do_without_friction() {
    proximal_multipliers_agree::<SmoothPlane, HalfLine, 2>(FrictionModel::Coulomb);
    proximal_multipliers_agree::<Line, HalfLine, 1>(FrictionModel::Coulomb);
}

#[test]
fn what_the_path_leaves_is_polished_in_a_few_factorisations() {
    let loose = SolverSettings { stop: StopTest::Residual, tolerance: 1e-5, ..Default::default() };
    let tight = SolverSettings { tolerance: 1e-10, ..loose };
    let (mut polished, mut factorisations) = (0, 0);
    for seed in 0..40 {
        let mut problem = problem::<SpinningPlane>(seed, FrictionModel::Tresca);
        let mut workspace = PathWorkspace::<3>::default();
        let path =
            InteriorPoint::<SpinningPlane, Strip, 3>::new(&mut problem, &loose, &mut workspace);
        assert!(path.solve_convex().converged);
        let mut solver =
            InteriorPoint::<SpinningPlane, Strip, 3>::new(&mut problem, &tight, &mut workspace);
        solver.begin();
        solver.take_impulses();
        assert!(
            natural_map::<SpinningPlane>(solver.problem) > tight.tolerance,
            "seed {seed}: it is loose"
        );
        polished += u32::from(solver.polish());
        factorisations += solver.report.factorisations;
    }
    assert!(
        polished >= 36 && factorisations <= 400,
        "{polished} of 40, {factorisations} factorisations"
    );
}
