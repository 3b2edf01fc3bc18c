//! Searches for several solutions of the contact problem in a file. Under Coulomb friction the solution need not be
//! unique. The search starts from several initial guesses of the contact impulses.

use slump_core::with_model;

use super::solution::body_velocities;
use super::{BodyForm, ProblemFile};
use crate::error::{self, Error, Result};
use crate::solver::{Method, Model, SolutionSearch, SolverSettings, velocity_distance};

/// One of several solutions of the contact problem in a file.
#[derive(Clone, Debug, PartialEq)]
pub struct FoundSolution {
    /// Residual of the contact laws, dimensionless: the same measure for all solvers, 0 if all laws are obeyed.
    pub residual: f64,
    /// True if the residual is within the tolerance of the search. If it is false, the solver stopped before it reached
    /// the tolerance. Its result may then be a poor approximation of another solution in the list.
    pub is_solved: bool,
    /// Numbers of the initial guesses that led to this solution. Guess 0 consists of the impulses in the file, guess 1
    /// of zero impulses, and all further guesses of random impulses.
    pub starts: Vec<u32>,
    /// Distance of the velocities of this solution from the velocities of each earlier solution in the list, m/s: root
    /// mean square, weighted with mass.
    pub distances: Vec<f64>,
    /// Body whose translational velocity differs most between this solution and the first solution of the list: its
    /// index, and the magnitude of the velocity difference, m/s.
    pub farthest: (usize, f64),
    /// Velocity (v_x, v_y) and angular velocity ω of each body at the end of the step, m/s and rad/s.
    pub velocities: Vec<[f64; 3]>,
}

/// Largest number of initial guesses that a user may request for one search. The contact problem is solved once for
/// each initial guess.
pub const MOST_STARTS: u32 = 1_000;

/// Searches for several solutions of the contact problem in a file. The file must contain the bodies, because solutions
/// are distinguished by the velocities of the bodies.
///
/// # Errors
/// If the file contains an error or has no bodies, or a parameter of the search is outside its range.
pub fn solutions_of_file(
    file: &ProblemFile,
    search: &SolutionSearch,
) -> Result<Vec<FoundSolution>> {
    let (starts, allowed) = (search.starts, format!("1 to {MOST_STARTS}"));
    error::check((1..=MOST_STARTS).contains(&starts), "starts", starts, allowed)?;
    SolverSettings::to_residual(Method::Nncg, search.tolerance, search.max_sweeps).validate()?;
    // This call only checks the file.
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
