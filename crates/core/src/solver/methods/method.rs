//! The methods by name.

use serde::{Deserialize, Serialize};

/// A method, by the name that command line, scene files and panels use.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
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
    /// Interior point with a sparse factorisation, for the convex models of friction.
    InteriorPoint,
    /// One of the above, by the size of the problem.
    Auto,
}
