//! The registry of methods.

use serde::{Deserialize, Serialize};

use super::{Model, SolverSettings, StepProblem, newton, nsgs};
use crate::error::{Error, Result};

/// A method, by the name that command line, scene files and panels use.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    /// Non-linear Gauss–Seidel.
    Nsgs,
    /// Semi-smooth Newton with a sparse factorisation.
    Newton,
    /// Substeps with soft contacts.
    TgsSoft,
    /// Discrete elements with springs and dashpots.
    Dem,
}

/// What a method replaces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MethodKind {
    /// The solution of a step's problem ([`solve`]).
    Problem,
    /// The whole step.
    Scheme(Scheme),
}

/// A way to step that knows no problem of the whole step. It needs detection and motion between
/// its substeps, so it lives with the step (`sim::schemes`).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scheme {
    /// Substeps with soft contacts.
    TgsSoft,
    /// Discrete elements with springs and dashpots.
    Dem,
}

impl Method {
    /// What the method replaces.
    pub fn kind(self) -> MethodKind {
        match self {
            Self::TgsSoft => MethodKind::Scheme(Scheme::TgsSoft),
            Self::Dem => MethodKind::Scheme(Scheme::Dem),
            _ => MethodKind::Problem,
        }
    }

    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        METHODS.iter().find(|info| info.method == self).map_or("", |info| info.name)
    }
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
pub const METHODS: [MethodInfo; 4] = [
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
    MethodInfo {
        method: Method::TgsSoft,
        name: "tgs-soft",
        summary: "substeps with soft contacts and a relaxing sweep, as game engines step",
        source: "E. Catto, Solver2D (2024)",
    },
    MethodInfo {
        method: Method::Dem,
        name: "dem",
        summary: "smooth discrete elements: springs, dashpots and a constant attraction",
        source: "P. A. Cundall, O. D. L. Strack (1979); S. Luding, Cohesive, frictional powders (2008)",
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
///
/// # Errors
/// Where the method is a scheme, which replaces the step and solves no problem.
pub fn solve<M: Model>(
    problem: &mut StepProblem<M::Kinematics>,
    settings: &SolverSettings,
) -> Result<SolveReport> {
    if problem.contact_of_row.is_empty() {
        return Ok(SolveReport { converged: true, ..SolveReport::default() });
    }
    Ok(match settings.method {
        Method::Nsgs => nsgs::solve::<M>(problem, settings),
        Method::Newton => newton::solve::<M>(problem, settings),
        Method::TgsSoft | Method::Dem => {
            let of_problems =
                METHODS.iter().filter(|info| info.method.kind() == MethodKind::Problem);
            let names: Vec<_> = of_problems.map(|info| info.name).collect();
            let allowed = format!("a method that solves a step's problem ({})", names.join(", "));
            return Err(Error::value("solver", settings.method.name(), allowed));
        }
    })
}
