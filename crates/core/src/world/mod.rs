//! Bodies, boundaries, gravity and parameters: plain data, in SI units and f64.

mod boundary;
mod carry;
mod drive;
mod grains;
mod gravity;
mod gravity_turn;
mod motion;
mod motion_check;
mod parameters;
mod periodic;
mod periodic_check;
mod physics;
mod shearing;
mod tilt;

pub use boundary::{Boundary, Disc, Edge};
pub(crate) use carry::{Carry, RigidVelocity};
pub use drive::Drive;
pub use grains::{Grain, Grains};
pub use gravity::Gravity;
pub use gravity_turn::{GravityTurn, TurnCourse, TurningGravity};
pub use motion::{Motion, MotionCourse};
pub(crate) use motion_check::check_motions;
pub(crate) use parameters::MAX_SUBSTEPS;
pub use parameters::{DEBONDING_DISTANCE, FrictionCone, ParameterChanges, Parameters};
pub use periodic::Periodic;
pub use physics::Physics;

use glam::DVec2;
use serde::{Deserialize, Serialize};

use crate::error::Result;

/// Everything that a step reads and moves. Plain data, checked where a simulation takes it on; a running
/// one shows its own and lends none.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct World {
    /// The moving discs.
    pub grains: Grains,
    /// Discs that no grain moves, such as the rough base of the pile.
    pub fixed_discs: Vec<Disc>,
    /// Other shapes that no grain moves.
    pub boundaries: Vec<Boundary>,
    /// How some of both move by themselves.
    pub motions: Vec<Motion>,
    /// The field that accelerates the grains.
    pub gravity: Gravity,
    /// How it turns, if it does: then `gravity` is what it is in the last step.
    pub gravity_turn: Option<TurningGravity>,
    /// Borders that wrap, if there are any.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub periodic: Option<Periodic>,
    /// The diameter d that lengths are measured in, m.
    pub mean_diameter: f64,
}

impl World {
    /// Checks its grains and motions, how its gravity turns, and its borders.
    ///
    /// # Errors
    /// Names the first of them that does not fit.
    pub(crate) fn validate(&self, physics: Physics) -> Result<()> {
        self.grains.validate()?;
        if let Some(TurningGravity { turn, .. }) = &self.gravity_turn {
            turn.check(&self.gravity, physics)?;
        }
        let bodies = (&*self.boundaries, self.fixed_discs.len());
        check_motions(&self.motions, bodies, physics.axes, self.periodic)?;
        let Some(periodic) = self.periodic else { return Ok(()) };
        let fixed = self.fixed_discs.iter().map(|disc| disc.radius);
        let largest_radius = self.grains.radii.iter().copied().chain(fixed).fold(0.0, f64::max);
        let lengths = [largest_radius, self.mean_diameter];
        let bodies = (&*self.boundaries, self.fixed_discs.len(), &*self.motions);
        periodic.check(bodies, &self.gravity, physics, lengths)
    }

    /// Whether anything can move that no grain moves.
    pub fn has_motion(&self) -> bool {
        !self.motions.is_empty() || self.boundaries.iter().any(Boundary::moves_by_itself)
    }

    /// The shortest way between two places that are apart by `offset`, m: across periodic borders where there are
    /// any.
    #[inline(always)]
    pub(crate) fn shortest(&self, offset: DVec2) -> DVec2 {
        match self.periodic {
            None => offset,
            Some(periodic) => periodic.shortest(offset),
        }
    }
}
