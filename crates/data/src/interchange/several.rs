//! The solutions of a problem file under Coulomb's law, from several initial guesses.

use slump_core::with_model;

use super::solution::body_velocities;
use super::{BodyForm, ProblemFile};
use crate::error::{Error, Result};
use crate::solver::{Method, Model, SolutionSearch, SolverSettings, velocity_distance};

/// One of the solutions of a problem file.
#[derive(Clone, Debug, PartialEq)]
pub struct FoundSolution {
    /// The common residual.
    pub residual: f64,
    /// True if the residual is within the tolerance of the search. A result that is not may be close to a solution that
    /// other initial guesses reached.
    pub is_solved: bool,
    /// The initial guesses that led to it, counted from 0: the impulses of the file, zero, then random impulses.
    pub starts: Vec<u32>,
    /// Distance of its velocities from those of each earlier solution, m/s: root mean square, weighted with mass.
    pub distances: Vec<f64>,
    /// The grain whose velocity differs most from the first solution, and that difference, m/s.
    pub farthest: (usize, f64),
    /// (v_x, v_y, ω) of each body at the end of the step, m/s and rad/s.
    pub velocities: Vec<[f64; 3]>,
}

/// Largest number of initial guesses in one search.
pub const MOST_STARTS: u32 = 1_000;

/// Searches for solutions of a file's problem.
///
/// # Errors
/// If the file is wrong or has no bodies, or a parameter of the search is outside its range.
pub fn solutions_of_file(
    file: &ProblemFile,
    search: &SolutionSearch,
) -> Result<Vec<FoundSolution>> {
    if !(1..=MOST_STARTS).contains(&search.starts) {
        return Err(Error::value("starts", search.starts, format!("1 to {MOST_STARTS}")));
    }
    SolverSettings::to_residual(Method::Nncg, search.tolerance, search.max_sweeps).validate()?;
    // Checks the file.
    file.delassus()?;
    match &file.bodies {
        Some(bodies) => Ok(with_model!(bodies.parts(file)?, M => find::<M>(bodies, file, search))),
        None => {
            let allowed = "in the problem: its solutions are told apart by their velocities";
            Err(Error::value("bodies", "missing", allowed))
        }
    }
}

fn find<M: Model>(
    bodies: &BodyForm,
    file: &ProblemFile,
    search: &SolutionSearch,
) -> Vec<FoundSolution> {
    let solutions = search.find(&bodies.step_problem::<M>(file));
    let found = solutions.iter().enumerate().map(|(number, solution)| {
        let now = |at: usize| solutions[at].problem.bodies.now.iter().map(M::coordinates);
        let apart = now(0).zip(now(number)).map(|([x, y, _], [u, v, _])| (u - x).hypot(v - y));
        let farthest = apart.enumerate().max_by(|one, other| one.1.total_cmp(&other.1));
        let before = solutions[..number].iter();
        FoundSolution {
            residual: solution.residual,
            is_solved: solution.residual <= search.tolerance,
            starts: solution.starts.clone(),
            distances: before.map(|it| velocity_distance(&it.problem, &solution.problem)).collect(),
            farthest: farthest.unwrap_or_default(),
            velocities: body_velocities(&solution.problem, bodies),
        }
    });
    found.collect()
}
