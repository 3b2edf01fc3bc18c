//! Non-linear Gauss–Seidel on W (M. Jean, 1999): one contact after the other, each solved exactly
//! with the impulses that the ones before it left.

use super::DelassusProblem;
use crate::error::{Error, Result};
use crate::solver::iterate::is_tested;
use crate::solver::{
    METHODS, Method, SolveReport, SolverSettings, StopTest, Vectors, solve_system,
};

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
        let info = METHODS.iter().find(|info| info.method == settings.method);
        let allowed = "one that works on W alone, for the problem says nothing of its bodies";
        Error::value("method", info.map_or("unknown", |info| info.name), allowed)
    })
}

fn sweeps(problem: &mut DelassusProblem, settings: &SolverSettings) -> SolveReport {
    for sweeps in 1..=settings.max_sweeps {
        problem.sweep();
        if is_tested(sweeps, settings) && problem.is_solved(settings) {
            return SolveReport { sweeps, converged: true, ..SolveReport::default() };
        }
    }
    SolveReport { sweeps: settings.max_sweeps, ..SolveReport::default() }
}

impl DelassusProblem {
    /// One pass over all contacts.
    pub fn sweep(&mut self) {
        if self.compressive_cone { self.pass::<true>() } else { self.pass::<false>() }
    }

    fn pass<const COMPRESSIVE_CONE: bool>(&mut self) {
        for contact in 0..self.len() {
            let free = self.velocity_of_others(contact);
            self.impulses[contact] = self.rows[contact].local.solve::<COMPRESSIVE_CONE>(free);
        }
    }
}
