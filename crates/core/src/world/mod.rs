//! Data of a scene in SI units: grains, fixed discs, boundaries, gravity, materials and parameters.

mod boundary;
mod grains;
mod gravity;
mod materials;
mod motion;
mod motion_check;
mod parameters;
mod periodic;
mod periodic_check;
mod physics;

pub use boundary::{Boundary, Disc, Edge};
pub use grains::{Grain, Grains};
pub use gravity::{Gravity, GravityTurn, TurnCourse, TurningGravity};
pub(crate) use materials::{Cohesion, PairNumbers, check_name};
pub use materials::{Material, MaterialPair, materials_of};
pub(crate) use motion::{Carry, RigidVelocity, direction};
pub use motion::{Drive, Motion, MotionCourse};
pub(crate) use parameters::MAX_SUBSTEPS;
pub use parameters::{
    DEBONDING_DISTANCE, FrictionCone, ParameterChanges, Parameters, RESTITUTION_THRESHOLD,
};
pub use periodic::Periodic;
pub use physics::Physics;

use glam::DVec2;
use serde::{Deserialize, Serialize};

use self::materials::check_materials;
use self::motion_check::check_motions;
use crate::error::{Error, Result};

/// The world: the bodies, gravity and periodic borders of a simulation, which a step reads and updates. The fields are
/// public, and a simulation checks them when it takes over the world. The data of a running simulation can be read but
/// not changed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct World {
    /// The grains: discs that move.
    pub grains: Grains,
    /// Fixed discs, such as the rough base of the pile: they are at rest, or have a prescribed or force-driven motion.
    pub fixed_discs: Vec<Disc>,
    /// Walls and other shapes, other than discs, that are at rest or have a prescribed or force-driven motion.
    pub boundaries: Vec<Boundary>,
    /// Prescribed or force-driven motions of fixed discs and boundaries. Bodies without a motion stay at rest.
    pub motions: Vec<Motion>,
    /// Gravity: the acceleration field of the grains.
    pub gravity: Gravity,
    /// Rotation of the direction of gravity. `None` if gravity keeps its direction. Otherwise the field `gravity`
    /// contains the gravity of the last step, or the present gravity if the parameter `tilt` has changed since then.
    pub gravity_turn: Option<TurningGravity>,
    /// Periodic borders of the world. `None` if it has none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub periodic: Option<Periodic>,
    /// The materials of which grains, fixed discs and boundaries consist.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub materials: Vec<Material>,
    /// Contact laws of pairs of materials. A pair that is not listed has the coefficients of the run's parameters.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub pairs: Vec<MaterialPair>,
    /// Mean diameter d that the scene gives, m: the unit of length for settings in diameters.
    pub mean_diameter: f64,
}

impl World {
    /// Returns a world that contains only grains, in a gravity field. `mean_diameter` is the unit of length d, m.
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

    /// Checks that the grains, materials, motions, rotation of gravity and periodic borders are valid.
    pub(crate) fn validate(&self, physics: Physics) -> Result<()> {
        self.grains.validate()?;
        if let Some(TurningGravity { turn, .. }) = &self.gravity_turn {
            turn.check(&self.gravity, physics)?;
        }
        let Self { boundaries, motions, gravity, .. } = self;
        let fixed_discs = self.fixed_discs.len();
        let walls = [boundaries.len(), fixed_discs];
        check_materials(&self.materials, &self.pairs, walls, physics)?;
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

    /// True if any fixed disc or boundary has a motion, prescribed or driven by a force.
    pub fn has_motion(&self) -> bool {
        !self.motions.is_empty() || self.boundaries.iter().any(Boundary::moves_by_itself)
    }

    /// Returns the shortest vector (m) to a point from another point or any periodic image of this other point.
    /// `offset` is the vector (m) to the first point from the other point itself. Without periodic borders the result
    /// is `offset`.
    #[inline(always)]
    pub(crate) fn shortest(&self, offset: DVec2) -> DVec2 {
        match self.periodic {
            None => offset,
            Some(periodic) => periodic.shortest(offset),
        }
    }

    /// Returns the speed along x, m/s, of the periodic image of grain `j` that is nearest to grain `i`, relative to
    /// grain `j` itself. It is 0 if no periodic border is sheared, that is, if images do not move along the borders.
    #[inline]
    pub(crate) fn speed_of_image(&self, i: usize, j: usize) -> f64 {
        let places = &self.grains.positions;
        self.periodic.map_or(0.0, |periodic| periodic.speed_of_image(places[i] - places[j]))
    }

    /// Moves all discs that have left the periodic cell back into it, on the opposite side. Returns the work done on
    /// the grains, J. It is 0 except for sheared borders, beyond which the images of grains move along the border: a
    /// grain that crosses such a border takes the velocity of its image.
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
