//! The bodies that no grain moves, at one moment, as pictures and windows need them.

use glam::DVec2;
use serde::{Deserialize, Serialize};

use crate::world::{Boundary, Disc, Gravity, Periodic, World};

/// The part of a picture that grains do not change.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Surroundings {
    /// Fixed discs.
    pub fixed_discs: Vec<Disc>,
    /// Other fixed shapes.
    pub boundaries: Vec<Boundary>,
    /// The centre of attraction, where the scene has one, m.
    pub centre_of_attraction: Option<DVec2>,
    /// Borders that wrap, if there are any.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub periodic: Option<Periodic>,
    /// The diameter d that lengths are measured in, m.
    pub mean_diameter: f64,
    /// The scene's g, m/s².
    pub gravity_magnitude: f64,
    /// How some of them go.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub moving: Vec<MotionView>,
}

/// How bodies go at one moment that no grain moves, or what drives them.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MotionView {
    /// The boundaries, by their numbers.
    pub boundaries: Vec<usize>,
    /// The fixed discs, by their numbers.
    pub fixed_discs: Vec<usize>,
    /// m/s; none of what turns.
    pub velocity: DVec2,
    /// rad/s, positive anticlockwise.
    pub angular_velocity: f64,
    /// By how much it has turned since the start, rad.
    #[serde(default)]
    pub turned: f64,
    /// What it turns round, m.
    pub pivot: DVec2,
    /// Of a surface that goes round it, m/s, along the outward normal turned by +90°.
    pub surface_speed: f64,
    /// True where a force drives it, be it none for the moment.
    #[serde(default)]
    pub is_driven: bool,
    /// That force, N.
    pub force: DVec2,
}

impl MotionView {
    /// All of a world, in a step of that length.
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

    /// The velocity of a point of it, m/s.
    pub fn velocity_at(&self, place: DVec2) -> DVec2 {
        self.velocity + self.angular_velocity * (place - self.pivot).perp()
    }
}

impl Surroundings {
    /// Those of a world as it is now, and as it goes on in a step of that length.
    pub(super) fn of(world: &World, time_step_secs: f64) -> Self {
        Self {
            fixed_discs: world.fixed_discs.clone(),
            boundaries: world.boundaries.clone(),
            centre_of_attraction: match world.gravity {
                Gravity::Attraction { centre, .. } => Some(centre),
                Gravity::Uniform { .. } => None,
            },
            periodic: world.periodic,
            mean_diameter: world.mean_diameter,
            gravity_magnitude: world.gravity.magnitude(),
            moving: MotionView::all(world, time_step_secs),
        }
    }
}
