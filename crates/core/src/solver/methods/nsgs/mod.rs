//! Non-linear Gauss–Seidel (M. Jean, 1999): one contact after the other, each solved exactly with
//! the velocities that the ones before it left.
//!
//! For solid discs the local Delassus block is diagonal (W_nt = 0), so a contact's solution is two
//! scalar projections (`shared::update`).

mod driven;
mod held;
mod settled;

pub(super) use self::held::solve_models;
pub(super) use self::settled::is_settled;

use self::settled::squared_impulses;
use super::info::{COULOMB, MethodInfo, MethodOrder};
use super::method::Method;
use super::report::SolveReport;
use super::shared::iterate::{is_tested, sweep_until_settled};
use super::shared::update::{Change, Law};
use crate::solver::friction_model::FrictionModel;
use crate::solver::ordering::Ordering;
use crate::solver::problem::{Bound, Model, Opening, StepProblem, residual};
use crate::solver::settings::{SolverSettings, StopTest};

/// What there is to know of it.
pub(super) const INFO: MethodInfo = MethodInfo {
    method: Method::Nsgs,
    name: "nsgs",
    summary: "non-linear Gauss-Seidel: one contact after the other, exact for each",
    solves: COULOMB,
    source: "M. Jean, The non-smooth contact dynamics method (1999)",
    order: MethodOrder::OfSettings,
    takes_models: true,
    takes_drives: true,
    takes_shear: true,
};

/// Solves a prepared problem by sweeps, under the model of friction that it was prepared for.
pub(super) fn solve<M: Model>(
    problem: &mut StepProblem<M::Kinematics>,
    _memory: &mut (),
    settings: &SolverSettings,
) -> SolveReport {
    solve_models::<M>(problem, settings, |problem| match problem.friction_model {
        FrictionModel::Tresca if M::FRICTION => held::solve::<M, Bound>(problem, settings),
        FrictionModel::Associated | FrictionModel::Desaxce if M::FRICTION => {
            held::solve::<M, Opening>(problem, settings)
        }
        _ => solve_coulomb::<M>(problem, settings),
    })
}

/// One sweep of the model of friction that a problem was prepared for, and whether the stopping test is met
/// after it.
pub(super) fn sweep_of_model<M: Model>(
    problem: &mut StepProblem<M::Kinematics>,
    settings: &SolverSettings,
) -> bool {
    match problem.friction_model {
        FrictionModel::Tresca if M::FRICTION => held::tested::<M, Bound>(problem, settings, false),
        FrictionModel::Associated | FrictionModel::Desaxce if M::FRICTION => {
            held::tested::<M, Opening>(problem, settings, false)
        }
        _ => tested_sweep::<M>(problem, settings),
    }
}

fn solve_coulomb<M: Model>(
    problem: &mut StepProblem<M::Kinematics>,
    settings: &SolverSettings,
) -> SolveReport {
    let sweep = |problem: &mut StepProblem<M::Kinematics>, sweeps| {
        let backward = settings.ordering == Ordering::Symmetric && sweeps % 2 == 0;
        match (is_tested(sweeps, settings), backward) {
            (true, false) => return tested::<M, false>(problem, settings),
            (true, true) => return tested::<M, true>(problem, settings),
            (false, false) => sweep::<M, false>(problem),
            (false, true) => directed_sweep::<M, false, true>(problem),
        };
        false
    };
    sweep_until_settled(problem, settings, sweep, |problem| residual::<M>(problem))
}

/// One sweep, and whether the stopping test is met after it.
pub(super) fn tested_sweep<M: Model>(
    problem: &mut StepProblem<M::Kinematics>,
    settings: &SolverSettings,
) -> bool {
    tested::<M, false>(problem, settings)
}

fn tested<M: Model, const BACKWARD: bool>(
    problem: &mut StepProblem<M::Kinematics>,
    settings: &SolverSettings,
) -> bool {
    let change = if settings.stop == StopTest::Residual {
        directed_sweep::<M, false, BACKWARD>(problem)
    } else {
        directed_sweep::<M, true, BACKWARD>(problem)
    };
    let mean_mass = problem.mean_mass;
    is_settled(problem, (change, mean_mass), settings, squared_impulses, |problem| {
        residual::<M>(problem)
    })
}

/// One pass over all contacts.
pub fn sweep<M: Model, const MEASURE: bool>(problem: &mut StepProblem<M::Kinematics>) -> Change {
    directed_sweep::<M, MEASURE, false>(problem)
}

fn directed_sweep<M: Model, const MEASURE: bool, const BACKWARD: bool>(
    problem: &mut StepProblem<M::Kinematics>,
) -> Change {
    if problem.is_driven() {
        return driven::pass::<M, MEASURE, BACKWARD>(problem);
    }
    #[cfg(target_arch = "x86_64")]
    if std::arch::is_x86_feature_detected!("avx") {
        // SAFETY: the processor has just been asked.
        return unsafe { sweep_with_avx::<M, MEASURE, BACKWARD>(problem) };
    }
    pass::<M, MEASURE, BACKWARD>(problem)
}

/// The same operations in the same order, and so bitwise the same result, in the three-operand
/// encoding, which saves the copies that the older one needs.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx")]
fn sweep_with_avx<M: Model, const MEASURE: bool, const BACKWARD: bool>(
    problem: &mut StepProblem<M::Kinematics>,
) -> Change {
    pass::<M, MEASURE, BACKWARD>(problem)
}

#[inline(always)]
fn pass<M: Model, const MEASURE: bool, const BACKWARD: bool>(
    problem: &mut StepProblem<M::Kinematics>,
) -> Change {
    let law = Law::of(problem);
    let StepProblem { bodies, fixed_rows, pair_rows, .. } = problem;
    let mut change = Change::default();
    if BACKWARD {
        for row in pair_rows.iter_mut().rev() {
            law.solve_pair_among::<M, MEASURE>(row, bodies, &mut change);
        }
        for row in fixed_rows.iter_mut().rev() {
            law.solve_single_row::<M, MEASURE>(row, &mut bodies[row.i as usize], &mut change);
        }
        return change;
    }
    for row in fixed_rows {
        law.solve_single_row::<M, MEASURE>(row, &mut bodies[row.i as usize], &mut change);
    }
    for row in pair_rows {
        law.solve_pair_among::<M, MEASURE>(row, bodies, &mut change);
    }
    change
}
