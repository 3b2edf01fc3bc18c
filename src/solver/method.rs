//! The registry of methods.

use serde::{Deserialize, Serialize};

use super::system::{BodySystem, ContactSystem, Vectors};
use super::{
    Model, Ordering, SolverSettings, StepProblem, admm, apgd, jacobi, newton, nncg, nsgs,
    nsgs_parallel, picked,
};
use crate::error::{Error, Result};

/// A method, by the name that command line, scene files and panels use.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    /// Non-linear Gauss–Seidel.
    Nsgs,
    /// Non-linear Gauss–Seidel by colours, in vector registers and on several threads.
    NsgsParallel,
    /// Semi-smooth Newton with a sparse factorisation.
    Newton,
    /// Non-smooth non-linear conjugate gradients over Gauss–Seidel sweeps.
    Nncg,
    /// Accelerated projected gradients with adaptive restart.
    Apgd,
    /// Alternating directions of multipliers with a cached factorisation.
    Admm,
    /// Jacobi with mass splitting.
    Jacobi,
    /// One of the above, by the size of the problem.
    Auto,
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
    /// Whether the order of the settings tells the method in which order to sweep.
    pub fn sweeps_in_order(self) -> bool {
        matches!(self, Self::Nsgs | Self::Newton | Self::Nncg | Self::Auto)
    }

    /// The order of the rows that the method needs where the settings ask for `asked`.
    pub(super) fn ordering(self, asked: Ordering) -> Ordering {
        if self == Self::NsgsParallel { Ordering::Coloured } else { asked }
    }

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
    /// How it works, one line.
    pub summary: &'static str,
    /// What its result solves exactly, one line.
    pub solves: &'static str,
    /// Where it comes from.
    pub source: &'static str,
}

/// What is solved by every method that rests at a zero of the common natural map.
const COULOMB: &str = "Signorini's law with cohesion and Coulomb's law";

/// All methods.
pub const METHODS: [MethodInfo; 10] = [
    MethodInfo {
        method: Method::Nsgs,
        name: "nsgs",
        summary: "non-linear Gauss-Seidel: one contact after the other, exact for each",
        solves: COULOMB,
        source: "M. Jean, The non-smooth contact dynamics method (1999)",
    },
    MethodInfo {
        method: Method::NsgsParallel,
        name: "nsgs-parallel",
        summary: "Gauss-Seidel by colours: four contacts at a time, large piles on several threads",
        solves: COULOMB,
        source: "M. Jean (1999); colours as in M. Renouf, F. Dubois, P. Alart (2004)",
    },
    MethodInfo {
        method: Method::Newton,
        name: "newton",
        summary: "semi-smooth Newton, sparse direct: all contacts together, for tight tolerances",
        solves: COULOMB,
        source: "P. Alart, A. Curnier, generalised Newton methods for contact with friction (1991)",
    },
    MethodInfo {
        method: Method::Nncg,
        name: "nncg",
        summary: "conjugate gradients over Gauss-Seidel sweeps: fewer sweeps to tight tolerances",
        solves: COULOMB,
        source: "M. Silcowitz, S. Niebe, K. Erleben, non-smooth non-linear conjugate gradients (2010)",
    },
    MethodInfo {
        method: Method::Apgd,
        name: "apgd",
        summary: "accelerated projected gradients with restart: all contacts at once, no order",
        solves: "the same, the bound of friction taken anew every iteration",
        source: "H. Mazhar, T. Heyn, D. Negrut, A. Tasora, Nesterov's method for contact (2015)",
    },
    MethodInfo {
        method: Method::Admm,
        name: "admm",
        summary: "alternating directions of multipliers: one cached factorisation, many solves",
        solves: "the same, the bound of friction taken anew every iteration",
        source: "S. Boyd and others (2011); for contact V. Acary, M. Bremond, O. Huber (2018)",
    },
    MethodInfo {
        method: Method::Jacobi,
        name: "jacobi",
        summary: "Jacobi with mass splitting: all contacts at once, each with its part of the mass",
        solves: COULOMB,
        source: "R. Tonge, F. Benevolenski, A. Voroshilov, mass splitting (2012)",
    },
    MethodInfo {
        method: Method::Auto,
        name: "auto",
        summary: "newton up to 1,000 contacts, nncg above, nsgs where sweeps are what is studied",
        solves: COULOMB,
        source: "the charts of speed against accuracy",
    },
    MethodInfo {
        method: Method::TgsSoft,
        name: "tgs-soft",
        summary: "substeps with soft contacts and a relaxing sweep, as game engines step",
        solves: "nothing exactly: contacts are damped springs",
        source: "E. Catto, Solver2D (2024)",
    },
    MethodInfo {
        method: Method::Dem,
        name: "dem",
        summary: "smooth discrete elements: springs, dashpots and a constant attraction",
        solves: "nothing exactly: contacts are damped springs",
        source: "P. A. Cundall, O. D. L. Strack (1979); S. Luding, Cohesive, frictional powders (2008)",
    },
];

/// How a solve ended.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SolveReport {
    /// Sweeps done; iterations where the method has no sweeps.
    pub sweeps: u32,
    /// Matrices factorised.
    pub factorisations: u32,
    /// Whether the stopping test was met.
    pub converged: bool,
    /// Whether a solve that did not converge had stalled, rather than being stopped too early.
    pub stalled: bool,
}

impl SolveReport {
    /// Counts another solve of the same step.
    pub fn add(&mut self, other: Self) {
        self.sweeps += other.sweeps;
        self.factorisations += other.factorisations;
        self.converged &= other.converged;
    }
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
    Ok(match picked(settings, problem.contact_of_row.len()) {
        Method::Nsgs => nsgs::solve::<M>(problem, settings),
        Method::NsgsParallel => nsgs_parallel::solve::<M>(problem, settings),
        Method::Newton => newton::solve::<M>(problem, settings),
        Method::Admm => admm::solve::<M>(problem, settings),
        Method::Nncg | Method::Apgd | Method::Jacobi => {
            let mut vectors = std::mem::take(&mut problem.vectors);
            let system = &mut BodySystem::<M>::new(problem);
            let report = solve_system(system, settings, &mut vectors);
            problem.vectors = vectors;
            // The methods of this arm are among those that need no bodies.
            report.unwrap_or_default()
        }
        Method::Auto | Method::TgsSoft | Method::Dem => {
            let of_problems =
                METHODS.iter().filter(|info| info.method.kind() == MethodKind::Problem);
            let names: Vec<_> = of_problems.map(|info| info.name).collect();
            let allowed = format!("a method that solves a step's problem ({})", names.join(", "));
            return Err(Error::value("solver", settings.method.name(), allowed));
        }
    })
}

/// Solves any contact system, from its present impulses, with the method of the settings. Gives
/// nothing where that method needs bodies.
pub fn solve_system<S: ContactSystem>(
    system: &mut S,
    settings: &SolverSettings,
    vectors: &mut Vectors,
) -> Option<SolveReport> {
    if system.is_empty() {
        return Some(SolveReport { converged: true, ..SolveReport::default() });
    }
    match settings.method {
        // Without bodies there is nothing to factorise.
        Method::Nncg | Method::Auto => Some(nncg::solve(system, settings, vectors)),
        Method::Apgd => Some(apgd::solve(system, settings, vectors)),
        Method::Jacobi => Some(jacobi::solve(system, settings, vectors)),
        _ => None,
    }
}
