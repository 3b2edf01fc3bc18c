//! Non-linear Gauss–Seidel on W (M. Jean, 1999): one contact after the other, each solved exactly
//! with the impulses that the ones before it left.

use super::problem::DelassusProblem;
use crate::error::{Error, Result};
use crate::solver::methods::{Method, SolveReport, Vectors, solve_system, sweep_until_settled};
use crate::solver::settings::{SolverSettings, StopTest};

/// The residual, which costs as much as a sweep, is looked at where ‖ΔP‖₂ of a sweep is at most this
/// many times the error allowed: what a sweep changes is about the error before it. A smaller number
/// risks a sweep in vain, a larger one a look in vain.
const NEAR: f64 = 2.0;
/// It is looked at after every so many sweeps in any case.
const TEST_INTERVAL: u32 = 16;

/// Solves a problem from its present impulses with the method of the settings, to a residual of
/// their tolerance.
///
/// # Errors
/// Where the method needs bodies, or the settings another stopping test.
pub fn solve_delassus(
    problem: &mut DelassusProblem,
    settings: &SolverSettings,
) -> Result<SolveReport> {
    settings.validate()?;
    if settings.stop != StopTest::Residual {
        let allowed = "residual where there are no bodies";
        return Err(Error::value("stop", format!("{:?}", settings.stop), allowed));
    }
    if settings.method == Method::Nsgs {
        return Ok(sweeps(problem, settings));
    }
    solve_system(problem, settings, &mut Vectors::default()).ok_or_else(|| {
        let allowed = "one that works on W alone, for the problem says nothing of its bodies";
        Error::value("method", settings.method.name(), allowed)
    })
}

fn sweeps(problem: &mut DelassusProblem, settings: &SolverSettings) -> SolveReport {
    let near = NEAR * settings.tolerance * problem.scale;
    let sweep = |problem: &mut DelassusProblem, sweeps: u32| {
        let squared_change = problem.sweep();
        let is_tested = squared_change <= near * near
            || sweeps.is_multiple_of(TEST_INTERVAL)
            || sweeps == settings.max_sweeps;
        is_tested && problem.is_solved(settings)
    };
    sweep_until_settled(problem, settings, sweep, |problem| problem.residual())
}

impl DelassusProblem {
    /// One pass over all contacts; gives Σ‖ΔP‖², (N·s)².
    pub(crate) fn sweep(&mut self) -> f64 {
        if self.compressive_cone { self.pass::<true>() } else { self.pass::<false>() }
    }

    fn pass<const COMPRESSIVE_CONE: bool>(&mut self) -> f64 {
        let mut squared_change = 0.0;
        for contact in 0..self.len() {
            let free = self.velocity_of_others(contact);
            let now = self.rows[contact].local.solve::<COMPRESSIVE_CONE>(free);
            let before = std::mem::replace(&mut self.impulses[contact], now);
            let change = [now[0] - before[0], now[1] - before[1]];
            squared_change += change[0] * change[0] + change[1] * change[1];
        }
        squared_change
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solver::delassus::blocks::Triplets;
    use crate::world::FrictionCone;

    /// Two contacts on opposite sides of one body, which close at 1 m/s
    /// each: u₀ + u₁ = −2 m/s whatever the impulses, so that not both can be ≥ 0.
    #[test]
    fn a_problem_without_solution_is_told_from_one_that_was_stopped_too_early() {
        let matrix = Triplets {
            row: vec![0, 0, 1, 2, 2, 3],
            col: vec![0, 2, 1, 0, 2, 3],
            val: vec![1.0, -1.0, 1.0, -1.0, 1.0, 1.0],
        };
        let free_velocities = [-1.0, 0.0, -1.0, 0.0];
        let settings = SolverSettings {
            stop: StopTest::Residual,
            max_sweeps: 100_000,
            ..SolverSettings::default()
        };
        let problem = |free: &[f64]| {
            DelassusProblem::new(&matrix, free, &[0.0; 2], &[0.0; 2], FrictionCone::Shifted)
        };
        let mut infeasible = problem(&free_velocities).expect("a valid problem");
        let report = solve_delassus(&mut infeasible, &settings).expect("a method that works on W");
        assert!(report.stalled && !report.converged && report.sweeps < 10_000, "{report:?}");

        let mut feasible = problem(&[-1.0, 0.0, 2.0, 0.0]).expect("a valid problem");
        let report = solve_delassus(&mut feasible, &settings).expect("a method that works on W");
        assert!(report.converged && !report.stalled, "{report:?}");
    }
}
