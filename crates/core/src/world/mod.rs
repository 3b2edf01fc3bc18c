//! Bodies, boundaries, gravity and parameters: plain data, in SI units and f64.

mod boundary;
mod grains;
mod gravity;
mod materials;
mod motion;
mod motion_check;
mod parameters;
mod periodic;
mod periodic_check;

pub use boundary::{Boundary, Disc, Edge};
pub use grains::{Grain, Grains};
pub use gravity::{Gravity, GravityTurn, TurnCourse, TurningGravity};
pub(crate) use materials::{Cohesion, PairNumbers, check_name};
pub use materials::{Material, MaterialPair, materials_of};
pub(crate) use motion::{Carry, RigidVelocity, direction};
pub use motion::{Drive, Motion, MotionCourse};
pub(crate) use parameters::MAX_SUBSTEPS;
pub use parameters::{DEBONDING_DISTANCE, FrictionCone, ParameterChanges, Parameters};
pub use periodic::Periodic;

use glam::DVec2;
use serde::{Deserialize, Serialize};

use self::materials::check_materials;
use self::motion_check::check_motions;
use crate::error::{Error, Result};

/// Everything that a step reads and moves. Plain data, checked when a simulation takes it over. A running simulation
/// shows its own data but lends no mutable access.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct World {
    /// The moving discs.
    pub grains: Grains,
    /// Discs that grains cannot move, such as the rough base of the pile.
    pub fixed_discs: Vec<Disc>,
    /// Other shapes that grains cannot move.
    pub boundaries: Vec<Boundary>,
    /// Motions of some fixed discs and boundaries.
    pub motions: Vec<Motion>,
    /// The field that accelerates the grains.
    pub gravity: Gravity,
    /// How gravity turns, if it does. Then `gravity` is its value in the last step.
    pub gravity_turn: Option<TurningGravity>,
    /// Periodic borders, if there are any.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub periodic: Option<Periodic>,
    /// The materials of grains, fixed discs and boundaries.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub materials: Vec<Material>,
    /// Contact laws of pairs of materials that differ from the parameters.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub pairs: Vec<MaterialPair>,
    /// The diameter d, the unit of length for relative quantities, m.
    pub mean_diameter: f64,
}

impl World {
    /// A world of grains in a field, without other bodies. `mean_diameter` is d, m.
    pub fn of(grains: Grains, gravity: Gravity, mean_diameter: f64) -> Self {
        Self {
            grains,
            fixed_discs: Vec::new(),
            boundaries: Vec::new(),
            motions: Vec::new(),
            gravity,
            gravity_turn: None,
            periodic: None,
            materials: Vec::new(),
            pairs: Vec::new(),
            mean_diameter,
        }
    }

    /// Checks the grains and motions, the rotation of gravity, and the borders.
    pub(crate) fn validate(&self, physics: Physics) -> Result<()> {
        self.grains.validate()?;
        if let Some(TurningGravity { turn, .. }) = &self.gravity_turn {
            turn.check(&self.gravity, physics)?;
        }
        let Self { boundaries, motions, gravity, .. } = self;
        let fixed_discs = self.fixed_discs.len();
        let walls = [boundaries.len(), fixed_discs];
        let has = [physics.friction, physics.cohesion];
        check_materials(&self.materials, &self.pairs, walls, has)?;
        let is_listed = |number: &&u8| usize::from(**number) < self.materials.len();
        if let Some(number) = self.grains.materials.iter().find(|number| !is_listed(number)) {
            let allowed = "below the number of materials";
            return Err(Error::value("grains.materials", number, allowed));
        }
        check_motions(motions, boundaries, fixed_discs, physics.axes, self.periodic)?;
        let Some(periodic) = self.periodic else { return Ok(()) };
        let fixed = self.fixed_discs.iter().map(|disc| disc.radius);
        let largest_radius = self.grains.radii.iter().copied().chain(fixed).fold(0.0, f64::max);
        let lengths = [largest_radius, self.mean_diameter];
        periodic.check(boundaries, fixed_discs, motions, gravity, physics, lengths)
    }

    /// True if any fixed disc or boundary can move.
    pub fn has_motion(&self) -> bool {
        !self.motions.is_empty() || self.boundaries.iter().any(Boundary::moves_by_itself)
    }

    /// The shortest equivalent of the vector `offset` between two places, m: across periodic borders if there are
    /// any.
    #[inline(always)]
    pub(crate) fn shortest(&self, offset: DVec2) -> DVec2 {
        match self.periodic {
            None => offset,
            Some(periodic) => periodic.shortest(offset),
        }
    }

    /// Speed along x of the image of grain `j` nearest to grain `i`, relative to grain `j`, m/s; 0 without sheared
    /// borders.
    #[inline]
    pub(crate) fn speed_of_image(&self, i: usize, j: usize) -> f64 {
        let places = &self.grains.positions;
        self.periodic.map_or(0.0, |periodic| periodic.speed_of_image(places[i] - places[j]))
    }

    /// Brings all discs back into the periodic cell, if there is one. Returns the work done on grains, J: crossing a
    /// sheared border changes a grain's velocity.
    pub(crate) fn wrap(&mut self) -> f64 {
        let Some(periodic) = self.periodic else { return 0.0 };
        let mut work = 0.0;
        if periodic.is_sheared() {
            let grains = &mut self.grains;
            let moving = grains.positions.iter().zip(&mut grains.velocities).zip(&grains.masses);
            for ((place, velocity), mass) in moving {
                let change = -periodic.border_speed() * periodic.cells_above(place.y);
                work += mass * change * (velocity.x + 0.5 * change);
                velocity.x += change;
            }
        }
        let grains = &mut self.grains;
        for (place, brought_back) in grains.positions.iter_mut().zip(&mut grains.brought_back) {
            let wrapped = periodic.wrap(*place);
            *brought_back += *place - wrapped;
            *place = wrapped;
        }
        for disc in &mut self.fixed_discs {
            disc.position = periodic.wrap(disc.position);
        }
        work
    }
}

/// The physics that a scene needs. Steps are compiled separately for each combination.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Physics {
    /// Number of axes: 1 (all on the x axis) or 2.
    pub axes: u8,
    /// True if contacts carry tangential impulses.
    pub friction: bool,
    /// True if grains turn. Requires friction, because without friction nothing changes a disc's spin.
    pub rotation: bool,
    /// True if contacts can pull.
    pub cohesion: bool,
}

impl Physics {
    /// Two axes, friction, rotation and cohesion.
    pub const FULL: Self = Self { axes: 2, friction: true, rotation: true, cohesion: true };

    pub(crate) fn validate(&self) -> Result<()> {
        match (self.axes, self.friction, self.rotation) {
            (1 | 2, false, true) => {
                Err(Error::value("physics.rotation", true, "false where physics.friction is false"))
            }
            (1, true, _) => Err(Error::value(
                "physics.friction",
                true,
                "false where physics.axes is 1: a line has no tangent",
            )),
            (1 | 2, ..) => Ok(()),
            (axes, ..) => Err(Error::value("physics.axes", axes, "1 or 2")),
        }
    }
}
