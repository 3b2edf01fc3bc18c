//! Bodies, boundaries, gravity and parameters: plain data, in SI units and f64.

mod boundary;
mod grains;
mod gravity;
mod parameters;
mod physics;

pub use boundary::{Boundary, Disc, Edge};
pub use grains::{Grain, Grains};
pub use gravity::Gravity;
pub(crate) use parameters::MAX_SUBSTEPS;
pub use parameters::{DEBONDING_DISTANCE, FrictionCone, ParameterChanges, Parameters};
pub use physics::Physics;

use serde::{Deserialize, Serialize};

/// Everything that a step reads and moves. Plain data, checked where a simulation takes it on; a running
/// one shows its own and lends none.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct World {
    /// The moving discs.
    pub grains: Grains,
    /// Discs that never move, such as the rough base of the pile.
    pub fixed_discs: Vec<Disc>,
    /// Other shapes that no grain moves.
    pub boundaries: Vec<Boundary>,
    /// The field that accelerates the grains.
    pub gravity: Gravity,
    /// The diameter d that lengths are measured in, m.
    pub mean_diameter: f64,
}
