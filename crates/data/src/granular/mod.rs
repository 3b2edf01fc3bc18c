//! Computes the usual quantities of granular physics from a [`Moment`], the full state of a simulation at one instant:
//! stress, fabric, coordination, solid fraction, forces, clusters.
//!
//! ```
//! let mut simulation = slump_core::scene::built_in("pile")?.simulation()?;
//! simulation.take_steps(5)?;
//! let measured = slump_data::granular::measure(&simulation.moment());
//! println!("p = {:.1} N/m, Z = {:.2}", measured.pile.pressure, measured.pile.coordination);
//! # Ok::<(), slump_core::error::Error>(())
//! ```
//!
//! Lengths are in m and forces in N. In a plane a stress is a force per length, in N/m. Compression is positive,
//! directions are in degrees anticlockwise from the x axis, and an undefined quantity is NaN. Lost grains (grains that
//! went through a wall or left the scene) and their contacts do not count. Forces, normals and gaps of contacts are
//! those of the last step before the snapshot, and the positions of grains are those at the end of that step.

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

/// All measures of a snapshot: of the pile, around each grain, and histograms.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct MomentMeasures {
    /// Measures of the whole pile.
    pub pile: PileMeasures,
    /// Measures around each grain, in the order of the grains in the snapshot.
    pub grains: Vec<GrainMeasures>,
    /// Histograms of forces, directions, contacts and overlaps ([`histograms()`]).
    pub histograms: Vec<Histogram>,
}

/// Computes all measures of a snapshot in one call. One call is faster than separate calls, because the measures share
/// intermediate results.
pub fn measure(moment: &Moment) -> MomentMeasures {
    let parts = MomentParts::of(moment);
    MomentMeasures {
        pile: PileMeasures::of_parts(&parts),
        grains: GrainMeasures::of_parts(&parts),
        histograms: histograms::of_parts(&parts, moment),
    }
}

/// Intermediate results of a snapshot that several measures use.
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
