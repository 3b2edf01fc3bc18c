//! Tests of the interior point method with random contact problems that have a solution: proximal multipliers find the
//! same velocities as the central path of the method, no matter whether they finish a solve or replace the path.

use super::*;
use crate::contact::ContactLaw;
use crate::solver::methods::random_problem::random_problem;
use crate::solver::problem::natural_map;
use crate::solver::{Line, Plane, SmoothPlane, SpinningPlane, StopTest};

const FRICTION: f64 = 0.6;

/// Returns a random contact problem under a friction model. The problem has a solution, because bodies at rest satisfy
/// the laws of all contacts.
fn problem<M: Model>(seed: u64, model: FrictionModel) -> StepProblem<M> {
    let law = ContactLaw::new(FRICTION, 0.1, FrictionCone::Shifted);
    let mut problem = random_problem::<M>(seed, law, 40, 90, 6, 0.0..0.3);
    problem.friction.model = model;
    let bound = |number: usize| match model {
        FrictionModel::Tresca => 0.2 * (0.618 * number as f64).fract(),
        _ => 0.0,
    };
    problem.friction.now.extend((0..problem.rows.len()).map(bound));
    problem
}

/// Solves one problem twice: by following the central path of the interior point method, and by proximal multipliers
/// only. Returns both results for the velocities, and the number of factorisations of the proximal multipliers.
fn both_ways<M: Model, S: Shape, const D: usize>(
    seed: u64,
    model: FrictionModel,
) -> ([Vec<[f64; 3]>; 2], u32) {
    let stop = StopTest::Residual;
    let settings = SolverSettings { stop, tolerance: 1e-10, ..SolverSettings::SWEEPS };
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
    let loose =
        SolverSettings { stop: StopTest::Residual, tolerance: 1e-5, ..SolverSettings::SWEEPS };
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
