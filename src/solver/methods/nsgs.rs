//! Non-linear Gauss–Seidel (M. Jean, 1999): one contact after the other, each solved exactly with
//! the velocities that the ones before it left.
//!
//! For solid discs the local Delassus block is diagonal (W_nt = 0), so a contact's solution is two
//! scalar projections (`shared::update`).

use super::info::{COULOMB, MethodInfo, MethodOrder};
use super::method::Method;
use super::report::SolveReport;
use super::shared::iterate::{is_tested, sweep_until_settled};
use super::shared::update::{Body, Change, Law, squared_impulse};
use crate::solver::ordering::Ordering;
use crate::solver::problem::{Kinematics, Model, Row, StepProblem, residual};
use crate::solver::settings::{SolverSettings, StopTest};

/// What there is to know of it.
pub(super) const INFO: MethodInfo = MethodInfo {
    method: Method::Nsgs,
    name: "nsgs",
    summary: "non-linear Gauss-Seidel: one contact after the other, exact for each",
    solves: COULOMB,
    source: "M. Jean, The non-smooth contact dynamics method (1999)",
    order: MethodOrder::OfSettings,
};

/// Solves a prepared problem by sweeps.
pub(super) fn solve<M: Model>(
    problem: &mut StepProblem<M::Kinematics>,
    _memory: &mut (),
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

/// Whether the stopping test is met after a sweep that made this change, by a mean mass (kg) of the
/// grains, by Σ P² ((N·s)²), or by the residual.
pub(super) fn is_settled<P>(
    problem: &mut P,
    (change, mean_mass): (Change, f64),
    settings: &SolverSettings,
    squared_impulses: impl FnOnce(&mut P) -> f64,
    residual: impl FnOnce(&mut P) -> f64,
) -> bool {
    let tolerance = settings.tolerance;
    match settings.stop {
        // An infinite change is no larger than infinite impulses, and settles nothing.
        StopTest::RelativeChange => {
            change.squared.is_finite()
                && change.squared <= tolerance * tolerance * squared_impulses(problem)
        }
        StopTest::ImpulsePerMass => change.absolute <= tolerance * mean_mass,
        StopTest::Residual => residual(problem) <= tolerance,
    }
}

/// One pass over all contacts.
pub fn sweep<M: Model, const MEASURE: bool>(problem: &mut StepProblem<M::Kinematics>) -> Change {
    directed_sweep::<M, MEASURE, false>(problem)
}

fn directed_sweep<M: Model, const MEASURE: bool, const BACKWARD: bool>(
    problem: &mut StepProblem<M::Kinematics>,
) -> Change {
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
            solve_pair::<M, MEASURE>(&law, row, bodies, &mut change);
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
        solve_pair::<M, MEASURE>(&law, row, bodies, &mut change);
    }
    change
}

/// Solves a contact between two of the bodies.
#[inline(always)]
fn solve_pair<M: Model, const MEASURE: bool>(
    law: &Law,
    row: &mut Row<M::Kinematics>,
    bodies: &mut [Body<M, f64>],
    change: &mut Change,
) {
    let (mut i, mut j) = (bodies[row.i as usize], bodies[row.j as usize]);
    law.solve_pair_row::<M, MEASURE>(row, &mut i, &mut j, change);
    bodies[row.i as usize] = i;
    bodies[row.j as usize] = j;
}

/// Σ P², (N·s)².
fn squared_impulses<K: Kinematics>(problem: &mut StepProblem<K>) -> f64 {
    let squared = |(number, row): (usize, &Row<K>)| {
        squared_impulse(row.effective_mass, problem.reduced_impulse(number, row))
    };
    let fixed_count = problem.fixed_rows.len();
    problem.rows().take(fixed_count).map(squared).sum::<f64>()
        + problem.rows().skip(fixed_count).map(squared).sum::<f64>()
}
