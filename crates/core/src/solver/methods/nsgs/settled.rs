//! When sweeps have settled.

use crate::solver::methods::shared::update::{Change, squared_impulse};
use crate::solver::problem::{Kinematics, Row, StepProblem};
use crate::solver::settings::{SolverSettings, StopTest};

/// Whether the stopping test is met after a sweep that made this change, by a mean mass (kg) of the
/// grains, by Σ P² ((N·s)²), or by the residual.
pub(in crate::solver::methods) fn is_settled<P>(
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

/// Σ P², (N·s)².
pub(super) fn squared_impulses<K: Kinematics>(problem: &mut StepProblem<K>) -> f64 {
    let squared = |(number, row): (usize, &Row<K>)| {
        squared_impulse(row.effective_mass, problem.reduced_impulse(number, row))
    };
    let fixed_count = problem.fixed_rows.len();
    problem.rows().take(fixed_count).map(squared).sum::<f64>()
        + problem.rows().skip(fixed_count).map(squared).sum::<f64>()
}
