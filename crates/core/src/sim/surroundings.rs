//! Copies of boundaries, fixed discs and their motions at one simulated time, from which Slump draws pictures and its
//! interactive window.

use glam::DVec2;
use serde::{Deserialize, Serialize};

use crate::world::{Boundary, Disc, Gravity, Material, Periodic, World};

/// All parts of a picture other than grains: fixed discs and boundaries with their motions, periodic borders, gravity
/// and materials.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Surroundings {
    /// Discs that are not grains: each is at rest, or has a prescribed or force-driven motion.
    pub fixed_discs: Vec<Disc>,
    /// Boundaries of the scene: walls and other shapes that are neither grains nor fixed discs.
    pub boundaries: Vec<Boundary>,
    /// Centre of attraction, m; `None` if gravity is uniform.
    pub centre_of_attraction: Option<DVec2>,
    /// Periodic borders; `None` if the scene has none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub periodic: Option<Periodic>,
    /// Mean diameter d of the grains, m: the unit of all lengths that are given in mean diameters.
    pub mean_diameter: f64,
    /// Gravitational acceleration g of the scene, m/s².
    pub gravity_magnitude: f64,
    /// Materials of the scene, in the order in which grains refer to them by index; empty if the scene names no
    /// materials.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub materials: Vec<Material>,
    /// Motions of boundaries and fixed discs, each with the bodies that it moves; empty if nothing moves except grains.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub moving: Vec<MotionView>,
}

/// Common motion of some boundaries and fixed discs at one simulated time: velocity, rotation and driving force.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MotionView {
    /// Indices of the boundaries that have this motion.
    pub boundaries: Vec<usize>,
    /// Indices of the fixed discs that have this motion.
    pub fixed_discs: Vec<usize>,
    /// Velocity of the bodies, m/s; zero if they turn about a pivot.
    pub velocity: DVec2,
    /// Angular velocity of the bodies, rad/s, positive anticlockwise.
    pub angular_velocity: f64,
    /// Angle by which the bodies have turned since the start, rad.
    #[serde(default)]
    pub turned: f64,
    /// Pivot about which the bodies turn, m.
    pub pivot: DVec2,
    /// Speed of the surface along itself, as of a conveyor belt, m/s; positive along the outward normal turned by +90°.
    pub surface_speed: f64,
    /// True if a force drives the bodies, even if that force is zero at this time.
    #[serde(default)]
    pub is_driven: bool,
    /// Driving force on the bodies, N.
    pub force: DVec2,
}

impl MotionView {
    /// Returns all motions of boundaries and fixed discs of a world, with the velocities that these bodies have in a
    /// step with the time step `time_step_secs` (s).
    fn all(world: &World, time_step_secs: f64) -> Vec<Self> {
        let by_themselves = world.boundaries.iter().enumerate().filter_map(|(index, boundary)| {
            let velocity = boundary.velocity_in(time_step_secs)?.velocity;
            Some(Self { boundaries: vec![index], velocity, ..Self::default() })
        });
        let by_motions = world.motions.iter().map(|motion| {
            let course = motion.velocity_in(time_step_secs);
            let drive = motion.drive.as_ref();
            let driven = drive.map_or(DVec2::ZERO, |drive| drive.speed * drive.axis());
            Self {
                boundaries: motion.boundaries.clone(),
                fixed_discs: motion.fixed_discs.clone(),
                velocity: course.velocity + driven,
                angular_velocity: course.spin,
                turned: motion.turned,
                pivot: course.pivot,
                surface_speed: motion.surface_speed,
                is_driven: drive.is_some(),
                force: drive
                    .map_or(DVec2::ZERO, |drive| drive.force_in(world.periodic) * drive.axis()),
            }
        });
        by_themselves.chain(by_motions).collect()
    }

    /// Returns the velocity of the bodies at the point `place` (m), m/s.
    pub fn velocity_at(&self, place: DVec2) -> DVec2 {
        self.velocity + self.angular_velocity * (place - self.pivot).perp()
    }
}

impl Surroundings {
    /// Returns copies of the parts of a world that pictures show in addition to the grains: boundaries, fixed discs,
    /// periodic borders and materials. Moving bodies get the velocities that they have in a step with the time step
    /// `time_step_secs` (s).
    pub(super) fn of(world: &World, time_step_secs: f64) -> Self {
        Self {
            fixed_discs: world.fixed_discs.clone(),
            boundaries: world.boundaries.clone(),
            centre_of_attraction: match world.gravity {
                Gravity::Attraction { centre, .. } => Some(centre),
                Gravity::Uniform { .. } => None,
            },
            periodic: world.periodic,
            materials: world.materials.clone(),
            mean_diameter: world.mean_diameter,
            gravity_magnitude: world.gravity.magnitude(),
            moving: MotionView::all(world, time_step_secs),
        }
    }
}
