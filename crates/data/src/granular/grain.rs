//! What a pile is around each of its grains.

use super::column::columns;
use super::parts::Parts;
use super::stress;
use super::tensor::Tensor;
use crate::sim::Moment;

columns! {
    /// The pile around one grain at one moment. A lost grain has no contacts, and its other numbers are NaN.
    pub struct GrainMeasures {
        /// Contacts with grains and with what does not move.
        coordination: u32, "1";
        /// Whether it carries nothing on: it is one of the pile's rattlers.
        rattler: bool, "1";
        /// a: area of its cell, as far as that belongs to the packing.
        cell_area: f64, "m²";
        /// σ_xx of (1/a) Σ f ⊗ ℓ over its contacts, compression positive: f on the grain, ℓ from the contact point to
        /// its centre. The mean over all grains, weighted by a, is the pile's. NaN without a cell.
        stress_xx: f64, "N/m";
        /// σ_xy: x of the forces, y of the branches.
        stress_xy: f64, "N/m";
        /// σ_yx: y of the forces, x of the branches.
        stress_yx: f64, "N/m";
        /// σ_yy.
        stress_yy: f64, "N/m";
        /// p = (σ_1 + σ_2)/2, half the trace of σ.
        pressure: f64, "N/m";
        /// q = (σ_1 − σ_2)/2 of the symmetric part of σ, never negative.
        deviator: f64, "N/m";
        /// Area of its disc in that of its cell; NaN where the cell is not closed.
        solid_fraction: f64, "1";
    }
}

impl GrainMeasures {
    /// Measures each grain of a pile, in their order.
    pub fn of_each(moment: &Moment) -> Vec<Self> {
        Self::of_parts(&Parts::of(moment))
    }

    pub(super) fn of_parts(parts: &Parts) -> Vec<Self> {
        let Parts { network, cells, coordination, .. } = parts;
        let sums = stress::of_grains(network);
        let of_grain = |(index, sum): (usize, Tensor)| {
            let cell_area = cells.areas[index];
            // A disc within a larger one may have no cell at all.
            let stress = sum.over(if cell_area > 0.0 { cell_area } else { f64::NAN });
            Self {
                coordination: coordination.of_grains[index],
                rattler: coordination.rattlers[index],
                cell_area,
                stress_xx: stress.xx,
                stress_xy: stress.xy,
                stress_yx: stress.yx,
                stress_yy: stress.yy,
                pressure: stress.mean(),
                deviator: stress.deviator(),
                solid_fraction: cells.solid_fractions[index],
            }
        };
        sums.into_iter().enumerate().map(of_grain).collect()
    }
}
