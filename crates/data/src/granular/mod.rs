//! The usual quantities of granular physics for a [`Moment`]: stress, fabric, coordination, solid fraction, forces,
//! clusters.
//!
//! ```
//! let mut simulation = slump_core::scene::built_in("pile")?.simulation()?;
//! simulation.take_steps(5)?;
//! let measured = slump_data::granular::measure(&simulation.moment());
//! println!("p = {:.1} N/m, Z = {:.2}", measured.pile.pressure, measured.pile.coordination);
//! # Ok::<(), slump_core::error::Error>(())
//! ```
//!
//! Lengths are in m and forces in N. Stresses in a plane are forces per length, in N/m. Compression is positive,
//! directions are in degrees anticlockwise from the x axis, and an undefined number is NaN. Lost grains and their
//! contacts do not count. Contacts have the forces, normals and gaps of the moment's last step, while grains have the
//! positions after that step.

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
pub use measures::{GrainMeasures, HeapShape, PileMeasures};

use self::cells::PowerCells;
use self::network::{Clusters, Coordination, ForceDistribution, Network};
use crate::sim::{Moment, Surroundings};

/// All measures of a moment.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct MomentMeasures {
    /// The whole pile.
    pub pile: PileMeasures,
    /// Each grain, in the order of the grains.
    pub grains: Vec<GrainMeasures>,
    /// See [`histograms()`].
    pub histograms: Vec<Histogram>,
}

/// Computes all measures together, which is faster than one by one.
pub fn measure(moment: &Moment) -> MomentMeasures {
    let parts = MomentParts::of(moment);
    MomentMeasures {
        pile: PileMeasures::of_parts(&parts),
        grains: GrainMeasures::of_parts(&parts),
        histograms: histograms::of_parts(&parts, moment),
    }
}

/// Intermediate results that several measures use.
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
