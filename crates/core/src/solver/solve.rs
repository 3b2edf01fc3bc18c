//! Solves the contact problem of a step with the method that the settings name.

use super::kinematics::Model;
use super::methods::{Memory, SolveReport, solve_by_method};
use super::problem::{StepProblem, is_solved};
use super::settings::SolverSettings;

/// Solves a prepared contact problem with the method of the settings. Changes the velocities in `problem.bodies` and
/// the impulses of `problem.rows`.
///
/// ```
/// use slump_core::contact::ContactList;
/// use slump_core::sim::ProblemVisitor;
/// use slump_core::solver::{Memory, Method, Model, SolverSettings, StepProblem, residual, solve};
///
/// /// The residual after a solve with one method.
/// struct Left(Method);
///
/// impl ProblemVisitor for Left {
///     type Output = f64;
///
///     fn visit<M: Model>(self, problem: &mut StepProblem<M>, _: &ContactList) -> f64 {
///         let settings = SolverSettings { method: self.0, ..SolverSettings::default() };
///         solve(problem, &mut Memory::default(), &settings);
///         residual(problem)
///     }
/// }
///
/// let simulation = slump_core::scene::built_in("column")?.simulation()?;
/// assert!(simulation.next_problem(Left(Method::Newton)) < 1e-3);
/// # Ok::<(), slump_core::error::Error>(())
/// ```
// `inline(never)`: the function is compiled once per model, in this crate, and callers do not compile it again.
#[inline(never)]
pub fn solve<M: Model>(
    problem: &mut StepProblem<M>,
    memory: &mut Memory,
    settings: &SolverSettings,
) -> SolveReport {
    if problem.rows.is_empty() {
        return SolveReport::nothing_yet();
    }
    let mut report = solve_by_method(problem, memory, settings);
    report.converged &= is_solved(problem, settings);
    report.stalled &= !report.converged;
    report
}
