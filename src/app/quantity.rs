//! What can be plotted against simulated time.

use serde::{Deserialize, Serialize};

use crate::sim::Observables;

/// Something to plot.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Quantity {
    /// Δy_G.
    Slump,
    /// δ.
    Overlap,
    /// The common residual, on a logarithmic axis.
    Residual,
    /// Kinetic energy.
    Energy,
}

impl Quantity {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Slump, Self::Overlap, Self::Residual, Self::Energy];

    /// Its name on buttons.
    pub fn name(self) -> &'static str {
        match self {
            Self::Slump => "slump",
            Self::Overlap => "overlap",
            Self::Residual => "residual",
            Self::Energy => "energy",
        }
    }

    pub(super) fn title(self, prefix: &str) -> String {
        match self {
            Self::Slump => "slump Δy".to_owned(),
            Self::Overlap => "mean overlap δ/d (%)".to_owned(),
            Self::Residual => "residual".to_owned(),
            Self::Energy => format!("kinetic energy ({prefix}J)"),
        }
    }

    pub(super) fn value(self, row: &Observables) -> f64 {
        match self {
            Self::Slump => row.slump,
            Self::Overlap => 100.0 * row.mean_overlap,
            Self::Residual => row.residual.log10(),
            Self::Energy => row.kinetic_energy,
        }
    }
}
