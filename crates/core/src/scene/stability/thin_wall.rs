//! A fast disc and a wall without thickness. A step longer than the disc's radius can carry its
//! centre past the wall before they ever overlap, or just as they first do; a share of 1 − r/(v Δt)
//! of all phases then goes through.

use glam::DVec2;

use super::{DIAMETER, disc, dry};
use crate::scene::{Scene, View};
use crate::world::{Boundary, Gravity};

/// Where the wall stands, in diameters from the disc's start.
pub const WALL_DISTANCE: f64 = 20.0;

/// A disc that flies `travel` diameters a step, and starts a share `phase` of a step further on.
pub fn thin_wall(travel: f64, phase: f64) -> Scene {
    let mut grain = disc(travel * phase, 0.0);
    let mut scene = dry("thin-wall", Vec::new());
    grain.velocity.x = travel * DIAMETER / scene.parameters.time_step_secs;
    scene.grains = vec![grain];
    scene.gravity = Gravity::Uniform { acceleration: DVec2::ZERO };
    let wall = DIAMETER * WALL_DISTANCE;
    scene.boundaries =
        vec![Boundary::Segment { from: DVec2::new(wall, -wall), to: DVec2::new(wall, wall) }];
    // A little later a disc that is through leaves the view.
    scene.duration_secs = 2.5 * WALL_DISTANCE / travel * scene.parameters.time_step_secs;
    scene.view = Some(View {
        min: DIAMETER * DVec2::new(-5.0, -10.0),
        max: DIAMETER * DVec2::new(WALL_DISTANCE + 35.0, 10.0),
    });
    scene
}
