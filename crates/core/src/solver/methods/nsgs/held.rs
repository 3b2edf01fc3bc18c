//! Gauss–Seidel for the models of friction that hold something while a step is solved (`problem::held`): a
//! contact's update is the projection of the model, and what is held may be taken anew for a further solve.

use super::settled::{is_settled, squared_impulses};
use crate::solver::friction_model::FrictionModel;
use crate::solver::methods::report::SolveReport;
use crate::solver::methods::shared::iterate::{is_tested, sweep_until_settled};
use crate::solver::methods::shared::update::{Body, Change};
use crate::solver::ordering::Ordering;
use crate::solver::problem::{
    Bound, Held, Kinematics, LawNumbers, Model, Row, StepProblem, held_residual,
};
use crate::solver::settings::{SolverSettings, StopTest};

/// Sweeps under Coulomb's law after which contacts that have not been solved yet take their bounds. They are
/// few and far between but in the first step of a run.
const SWEEPS_FOR_NEW_BOUNDS: u32 = 10;

/// Solves a problem by `solve_once` as often as the settings ask for, what its model of friction holds taken
/// anew each time. The step is solved where the last solve is: those before it only say what that one holds.
pub(in crate::solver::methods) fn solve_models<M: Model>(
    problem: &mut StepProblem<M::Kinematics>,
    settings: &SolverSettings,
    mut solve_once: impl FnMut(&mut StepProblem<M::Kinematics>) -> SolveReport,
) -> SolveReport {
    if !M::FRICTION || problem.friction_model == FrictionModel::Coulomb {
        return solve_once(problem);
    }
    problem.hold_as_at_start();
    if problem.has_new_bounds() {
        for _ in 0..SWEEPS_FOR_NEW_BOUNDS {
            pass::<M, Bound, false>(problem, false);
        }
        problem.fix_new_bounds::<M>();
    }
    let mut report = solve_once(problem);
    for _ in 1..settings.model_solves {
        problem.hold_anew::<M>();
        report = solve_once(problem).after(report);
    }
    report
}

/// Solves the problem of the model once.
pub(super) fn solve<M: Model, H: Held>(
    problem: &mut StepProblem<M::Kinematics>,
    settings: &SolverSettings,
) -> SolveReport {
    let sweep = |problem: &mut StepProblem<M::Kinematics>, sweeps| {
        let backward = settings.ordering == Ordering::Symmetric && sweeps % 2 == 0;
        if is_tested(sweeps, settings) {
            return tested::<M, H>(problem, settings, backward);
        }
        pass::<M, H, false>(problem, backward);
        false
    };
    sweep_until_settled(problem, settings, sweep, |problem| held_residual::<M, H>(problem))
}

/// One pass, and whether the stopping test is met after it.
pub(super) fn tested<M: Model, H: Held>(
    problem: &mut StepProblem<M::Kinematics>,
    settings: &SolverSettings,
    backward: bool,
) -> bool {
    let change = if settings.stop == StopTest::Residual {
        pass::<M, H, false>(problem, backward)
    } else {
        pass::<M, H, true>(problem, backward)
    };
    let mean_mass = problem.mean_mass;
    is_settled(problem, (change, mean_mass), settings, squared_impulses, |problem| {
        held_residual::<M, H>(problem)
    })
}

/// One pass over all contacts, from the last to the first where it goes backward.
fn pass<M: Model, H: Held, const MEASURE: bool>(
    problem: &mut StepProblem<M::Kinematics>,
    backward: bool,
) -> Change {
    let law = LawNumbers::of(problem);
    let StepProblem { bodies, fixed_rows, pair_rows, held, .. } = problem;
    let (of_fixed, of_pairs) = held.split_at(fixed_rows.len());
    let mut change = Change::default();
    if backward {
        for (row, &held) in pair_rows.iter_mut().zip(of_pairs).rev() {
            solve_pair::<M, H, MEASURE>(law, (row, held), bodies, &mut change);
        }
        for (row, &held) in fixed_rows.iter_mut().zip(of_fixed).rev() {
            solve_single::<M, H, MEASURE>(law, (row, held), bodies, &mut change);
        }
        return change;
    }
    for (row, &held) in fixed_rows.iter_mut().zip(of_fixed) {
        solve_single::<M, H, MEASURE>(law, (row, held), bodies, &mut change);
    }
    for (row, &held) in pair_rows.iter_mut().zip(of_pairs) {
        solve_pair::<M, H, MEASURE>(law, (row, held), bodies, &mut change);
    }
    change
}

/// Solves a contact of one of the bodies with a fixed one.
#[inline(always)]
fn solve_single<M: Model, H: Held, const MEASURE: bool>(
    law: LawNumbers,
    (row, held): (&mut Row<M::Kinematics>, f64),
    bodies: &mut [Body<M, f64>],
    change: &mut Change,
) {
    let i = &mut bodies[row.i as usize];
    let velocity = row.velocity(i);
    let impulse = update::<M, H>(law, (row, held), velocity);
    M::Kinematics::push_single(i, row.normal, impulse);
    change.add::<M, MEASURE>(row.effective_mass, impulse);
}

/// Solves a contact between two of the bodies.
#[inline(always)]
fn solve_pair<M: Model, H: Held, const MEASURE: bool>(
    law: LawNumbers,
    (row, held): (&mut Row<M::Kinematics>, f64),
    bodies: &mut [Body<M, f64>],
    change: &mut Change,
) {
    let (mut i, mut j) = (bodies[row.i as usize], bodies[row.j as usize]);
    let velocity = M::Kinematics::relative_velocity(row.normal, &i, &j);
    let impulse = update::<M, H>(law, (row, held), velocity);
    M::Kinematics::push_pair(&mut i, &mut j, row.normal, impulse, row.share());
    bodies[row.i as usize] = i;
    bodies[row.j as usize] = j;
    change.add::<M, MEASURE>(row.effective_mass, impulse);
}

/// Solves a contact at the given (v_n, v_t) and returns the change of (λ_n, λ_t).
#[inline(always)]
fn update<M: Model, H: Held>(
    law: LawNumbers,
    (row, held): (&mut Row<M::Kinematics>, f64),
    [normal_velocity, tangential_velocity]: [f64; 2],
) -> [f64; 2] {
    let [normal, tangential] = [row.shifted_impulse, row.tangential_impulse];
    let closing = normal_velocity + row.restitution_velocity;
    let compliance = 1.0 / M::Kinematics::TANGENTIAL_COMPLIANCE;
    let trial = [normal - closing, tangential - compliance * tangential_velocity];
    [row.shifted_impulse, row.tangential_impulse] = H::project::<M>(law, held, trial);
    [row.shifted_impulse - normal, row.tangential_impulse - tangential]
}
