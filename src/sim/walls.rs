//! Walls that move along their normal (`Boundary::Piston`).
//!
//! In a step each has one velocity: its own, or in its last step what is left of its way over Δt. The
//! contacts see it (`StepProblem::drive`), and with the grains the wall is moved by it.

use glam::DVec2;

use crate::contact::{Candidates, Contact, Numbering, Other};
use crate::world::World;

/// The walls that move in the present step.
#[derive(Clone, Debug, Default)]
pub(crate) struct Walls {
    moving: Vec<Wall>,
}

#[derive(Clone, Copy, Debug)]
struct Wall {
    /// Its number among the boundaries.
    boundary: usize,
    /// Its number among their features.
    feature: usize,
    /// m/s.
    velocity: DVec2,
}

impl Walls {
    /// Begins a step of that length.
    pub(crate) fn begin(&mut self, world: &World, candidates: &Candidates, time_step_secs: f64) {
        let walls = candidates.pistons().iter().map(|&(boundary, feature)| Wall {
            boundary,
            feature,
            velocity: world.boundaries[boundary].velocity(time_step_secs),
        });
        self.moving.clear();
        self.moving.extend(walls.filter(|wall| wall.velocity != DVec2::ZERO));
    }

    /// Whether any wall moves.
    pub(crate) fn any_move(&self) -> bool {
        !self.moving.is_empty()
    }

    /// Speed of the fastest, m/s.
    pub(crate) fn fastest(&self) -> f64 {
        self.moving.iter().map(|wall| wall.velocity.length()).fold(0.0, f64::max)
    }

    /// How fast the other body of a contact comes along its normal, m/s, if it is such a wall.
    #[inline]
    pub(crate) fn speed(&self, world: &World, contact: &Contact) -> f64 {
        if self.moving.is_empty() {
            return 0.0;
        }
        let Other::Feature(feature) = Numbering::of(world).other(contact.other) else { return 0.0 };
        let wall = self.moving.iter().find(|wall| wall.feature == feature);
        wall.map_or(0.0, |wall| wall.velocity.dot(contact.normal))
    }

    /// Moves the walls for `secs`.
    pub(crate) fn advance(&self, world: &mut World, candidates: &mut Candidates, secs: f64) {
        for wall in &self.moving {
            world.boundaries[wall.boundary].advance(secs * wall.velocity);
        }
        let ways = self.moving.iter().map(|wall| (wall.feature, secs * wall.velocity));
        candidates.shift_features(ways);
    }

    /// Speed of the fastest wall in a next step of that length, m/s.
    pub(crate) fn fastest_in(world: &World, candidates: &Candidates, secs: f64) -> f64 {
        let walls = candidates.pistons().iter();
        let speeds = walls.map(|&(wall, _)| world.boundaries[wall].velocity(secs).length());
        speeds.fold(0.0, f64::max)
    }
}
