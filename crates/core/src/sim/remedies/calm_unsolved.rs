//! A step that did not converge, solved once more without bounces.
//!
//! The term ρ v_n^{n−1} can ask wedged contacts for what contradicts itself, and then a step has no solution
//! with it. What the step measures is then the residual of the problem without.

use super::Remedy;
use crate::setting::Value;
use crate::sim::settings::Settings;
use crate::sim::steppers::moreau::set_up::set_up;
use crate::sim::steppers::stepper::Stepper;
use crate::sim::stepping::Stage;
use crate::solver::{Model, SolveReport};

/// The row of the registry.
pub(super) const REMEDY: Remedy = Remedy {
    name: "calm-unsolved",
    taken_by: &[Stepper::Moreau],
    robust: Some(Value::Switch(true)),
};

/// Solves the step anew with ρ = 0, from the impulses of the step before. The work of the solve that failed
/// counts.
pub(in crate::sim) fn solve_again<M: Model>(
    stage: &mut Stage<'_, M>,
    settings: &Settings,
    failed: SolveReport,
) -> SolveReport {
    let mut calm = *settings;
    calm.parameters.restitution = 0.0;
    // Detection at the same places finds the same contacts, and their impulses with them.
    set_up(stage, &calm);
    stage.solve(&calm).after(failed)
}
