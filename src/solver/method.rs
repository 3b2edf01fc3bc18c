//! The registry of methods.

use serde::{Deserialize, Serialize};

use super::{Model, SolverSettings, StepProblem, newton, nsgs};

/// A method, by the name that command line, scene files and panels use.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    /// Non-linear Gauss–Seidel.
    Nsgs,
    /// Semi-smooth Newton with a sparse factorisation.
    Newton,
}

/// What there is to know of a method.
#[derive(Clone, Copy, Debug)]
pub struct MethodInfo {
    /// The method.
    pub method: Method,
    /// Its name on the command line.
    pub name: &'static str,
    /// One line.
    pub summary: &'static str,
    /// Where it comes from.
    pub source: &'static str,
}

/// All methods.
pub const METHODS: [MethodInfo; 2] = [
    MethodInfo {
        method: Method::Nsgs,
        name: "nsgs",
        summary: "non-linear Gauss-Seidel: one contact after the other, exact for each",
        source: "M. Jean, The non-smooth contact dynamics method (1999)",
    },
    MethodInfo {
        method: Method::Newton,
        name: "newton",
        summary: "semi-smooth Newton, sparse direct: all contacts together, for tight tolerances",
        source: "P. Alart, A. Curnier, generalised Newton methods for contact with friction (1991)",
    },
];

/// How a solve ended.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SolveReport {
    /// Sweeps done.
    pub sweeps: u32,
    /// Matrices factorised.
    pub factorisations: u32,
    /// Whether the stopping test was met.
    pub converged: bool,
}

/// Solves a prepared problem with the method of the settings: moves `problem.bodies` and fills in
/// the rows' impulses.
pub fn solve<M: Model>(
    problem: &mut StepProblem<M::Kinematics>,
    settings: &SolverSettings,
) -> SolveReport {
    if problem.contact_of_row.is_empty() {
        return SolveReport { converged: true, ..SolveReport::default() };
    }
    match settings.method {
        Method::Nsgs => nsgs::solve::<M>(problem, settings),
        Method::Newton => newton::solve::<M>(problem, settings),
    }
}
