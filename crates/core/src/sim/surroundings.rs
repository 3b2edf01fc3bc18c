//! Boundaries and fixed discs at one moment, for pictures and windows.

use glam::DVec2;
use serde::{Deserialize, Serialize};

use crate::world::{Boundary, Disc, Gravity, Material, Periodic, World};

/// The part of a picture that grains do not change.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Surroundings {
    /// Fixed discs.
    pub fixed_discs: Vec<Disc>,
    /// Other fixed shapes.
    pub boundaries: Vec<Boundary>,
    /// The centre of attraction, m, if the scene has one.
    pub centre_of_attraction: Option<DVec2>,
    /// Periodic borders, if there are any.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub periodic: Option<Periodic>,
    /// The diameter d, the unit of length for relative quantities, m.
    pub mean_diameter: f64,
    /// The scene's g, m/s².
    pub gravity_magnitude: f64,
    /// The scene's materials.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub materials: Vec<Material>,
    /// Motions of some of these bodies.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub moving: Vec<MotionView>,
}

/// Motion or drive of boundaries and fixed discs at one moment.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MotionView {
    /// Indices of the boundaries.
    pub boundaries: Vec<usize>,
    /// Indices of the fixed discs.
    pub fixed_discs: Vec<usize>,
    /// Velocity, m/s; zero if the bodies turn.
    pub velocity: DVec2,
    /// Angular velocity, rad/s, positive anticlockwise.
    pub angular_velocity: f64,
    /// Rotation since the start, rad.
    #[serde(default)]
    pub turned: f64,
    /// Pivot, m.
    pub pivot: DVec2,
    /// Speed of the surface along itself, m/s, along the outward normal turned by +90°.
    pub surface_speed: f64,
    /// True if a force drives the bodies, even if it is zero at the moment.
    #[serde(default)]
    pub is_driven: bool,
    /// Driving force, N.
    pub force: DVec2,
}

impl MotionView {
    /// All motions of a world, in a step of length `time_step_secs`.
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

    /// The velocity of a point of the bodies, m/s.
    pub fn velocity_at(&self, place: DVec2) -> DVec2 {
        self.velocity + self.angular_velocity * (place - self.pivot).perp()
    }
}

impl Surroundings {
    /// The present surroundings of a world, with velocities for a step of length `time_step_secs`.
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
