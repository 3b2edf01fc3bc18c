//! The quantities that granular physics is written in, of a [`Moment`]: stress, fabric, coordination, solid fraction,
//! forces, clusters.
//!
//! ```
//! let mut simulation = slump_core::scene::built_in("pile")?.simulation()?;
//! simulation.take_steps(5)?;
//! let measured = slump_data::granular::measure(&simulation.moment());
//! println!("p = {:.1} N/m, Z = {:.2}", measured.pile.pressure, measured.pile.coordination);
//! # Ok::<(), slump_core::error::Error>(())
//! ```
//!
//! Lengths are in m and forces in N, so that stresses, which are forces a length in a plane, are in N/m. Compression is
//! positive, directions are in degrees from the x axis anticlockwise, and a number that does not exist is NaN. Grains
//! that are lost count nowhere, nor do their contacts. Contacts have the forces, normals and gaps of the moment's last
//! step, while grains are where that step has brought them.

mod cells;
mod fields;
mod histograms;
mod mean_flow;
mod measures;
mod network;
mod stress;

pub use crate::column_spec::{CellValue, ColumnSpec};
pub use fields::Fields;
pub(crate) use fields::box_of;
pub use histograms::{Histogram, histograms};
pub use measures::{GrainMeasures, PileMeasures};

use self::cells::PowerCells;
use self::network::{Clusters, Coordination, ForceDistribution, Network};
use crate::sim::{Moment, Surroundings};

/// All that is measured of a moment.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct MomentMeasures {
    /// The whole pile.
    pub pile: PileMeasures,
    /// Each grain, in their order.
    pub grains: Vec<GrainMeasures>,
    /// See [`histograms()`].
    pub histograms: Vec<Histogram>,
}

/// Measures all at once, which takes less than one after the other.
pub fn measure(moment: &Moment) -> MomentMeasures {
    let parts = MomentParts::of(moment);
    MomentMeasures {
        pile: PileMeasures::of_parts(&parts),
        grains: GrainMeasures::of_parts(&parts),
        histograms: histograms::of_parts(&parts, moment),
    }
}

/// What several measures are made of, found once.
struct MomentParts<'a> {
    network: Network<'a>,
    cells: PowerCells,
    coordination: Coordination,
    forces: ForceDistribution,
    clusters: Clusters,
    surroundings: &'a Surroundings,
}

impl<'a> MomentParts<'a> {
    fn of(moment: &'a Moment) -> Self {
        let network = Network::of(moment);
        Self {
            cells: PowerCells::of(&network, &moment.surroundings),
            coordination: Coordination::of(&network),
            forces: ForceDistribution::of(&network),
            clusters: Clusters::of(&network),
            surroundings: &moment.surroundings,
            network,
        }
    }
}
