//! A problem file solved: by bodies where the file has them, else by W.

use std::time::Instant;

use serde::{Deserialize, Serialize};

use super::{BodyForm, ProblemFile};
use crate::error::{Error, Result};
use crate::solver::{
    Kinematics, Model, ModelVisitor, SolveReport, SolverSettings, StepProblem, solve,
    solve_delassus, visit_model,
};

/// What a method made of a problem.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Solution {
    /// Number of contacts.
    pub contacts: usize,
    /// The method's name.
    pub method: String,
    /// Whether it worked on bodies, or on W alone.
    pub on_bodies: bool,
    /// Sweeps, or iterations that cost about as much.
    pub sweeps: u32,
    /// Matrices factorised.
    pub factorisations: u32,
    /// Time of the solve alone, s; the least of the repeats.
    pub seconds: f64,
    /// Whether the method says that it got to its tolerance.
    pub converged: bool,
    /// The common residual of `r`, from the file's W and q.
    pub residual: f64,
    /// (v_n, v_t) of each contact at the end of the step, restitution's term included, W r + q, m/s.
    pub u: Vec<f64>,
    /// (P_n, P_t) of each contact, N·s.
    pub r: Vec<f64>,
    /// (v_x, v_y, ω) of each body at the end of the step, m/s and rad/s.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub velocities: Option<Vec<[f64; 3]>>,
}

/// Solves a file's problem `repeats` times (at least once) from its start, with the method of the
/// settings to a residual of their tolerance.
///
/// # Errors
/// Where the file is at fault, or the method cannot take it.
pub fn solve_file(
    file: &ProblemFile,
    settings: &SolverSettings,
    repeats: u32,
) -> Result<Solution> {
    settings.validate()?;
    let mut delassus = file.delassus()?;
    let settings = SolverSettings { warm_start: file.start.is_some(), ..*settings };
    let solved = match &file.bodies {
        Some(bodies) => {
            let solver = OnBodies { bodies, file, settings: &settings, repeats };
            visit_model(bodies.parts(file)?, solver)
        }
        None => {
            let (timed, problem) = least_time(repeats, &delassus, |problem| {
                solve_delassus(problem, &settings)
            });
            let impulses = problem.impulses().collect();
            Solved { timed: (timed.0, timed.1?), impulses, velocities: None }
        }
    };
    let (seconds, report) = solved.timed;
    delassus.set_impulses(solved.impulses.iter().copied());
    Ok(Solution {
        contacts: file.nc,
        method: method_name(settings.method),
        on_bodies: file.bodies.is_some(),
        sweeps: report.sweeps,
        factorisations: report.factorisations,
        seconds,
        converged: report.converged,
        residual: delassus.residual(),
        u: delassus.velocities().flatten().collect(),
        r: solved.impulses.into_iter().flatten().collect(),
        velocities: solved.velocities,
    })
}

struct Solved {
    timed: (f64, SolveReport),
    impulses: Vec<[f64; 2]>,
    velocities: Option<Vec<[f64; 3]>>,
}
