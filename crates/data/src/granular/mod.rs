//! The quantities that granular physics is written in, of a [`Moment`]: stress, fabric, coordination, solid fraction,
//! forces, clusters.
//!
//! ```
//! let mut simulation = slump::scene::built_in("pile")?.simulation()?;
//! simulation.take_steps(5)?;
//! let measured = slump::granular::measure(&simulation.moment());
//! println!("p = {:.1} N/m, Z = {:.2}", measured.pile.pressure, measured.pile.coordination);
//! # Ok::<(), slump::error::Error>(())
//! ```
//!
//! Lengths are in m and forces in N, so that stresses, which are forces a length in a plane, are in N/m. Compression is
//! positive, directions are in degrees from the x axis anticlockwise, and a number that does not exist is NaN. Grains
//! that are lost count nowhere, nor do their contacts. Contacts have the forces, normals and gaps of the moment's last
//! step, while grains are where that step has brought them.

mod cells;
mod clusters;
mod column;
mod coordination;
mod forces;
mod grain;
mod histograms;
mod network;
mod parts;
mod pile;
mod stress;
mod tensor;

pub use column::{Column, Value};
pub use grain::GrainMeasures;
pub use histograms::{Histogram, histograms};
pub use pile::PileMeasures;

use crate::sim::Moment;

/// All that is measured of a moment.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Measured {
    /// The whole pile.
    pub pile: PileMeasures,
    /// Each grain, in their order.
    pub grains: Vec<GrainMeasures>,
    /// See [`histograms()`].
    pub histograms: Vec<Histogram>,
}

/// Measures all at once, which takes less than one after the other.
pub fn measure(moment: &Moment) -> Measured {
    let parts = parts::Parts::of(moment);
    Measured {
        pile: PileMeasures::of_parts(&parts),
        grains: GrainMeasures::of_parts(&parts),
        histograms: histograms::of_parts(&parts, moment),
    }
}
