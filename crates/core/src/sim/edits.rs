//! Interactive edits of a world between two steps: adding or removing a grain, and dragging a wall.
//!
//! An edit changes neither the measurements nor the forces and bonds of contacts between other bodies. In the slump
//! Δy_G (relative drop of the grains' mean height), the initial height of an added grain is the height at which it was
//! added. A removed grain no longer contributes to the slump, neither with its initial nor with its present height.

use std::sync::Arc;

use glam::DVec2;
use serde::{Deserialize, Serialize};

use crate::contact::check_distances;
use crate::error::{self, Error, Result};
use crate::sim::pull::gravity_that_scales;
use crate::sim::simulation::Simulation;
use crate::sim::surroundings::Surroundings;
use crate::world::{Boundary, Disc, Edge, Grain, Motion, MotionCourse};

/// Smallest and largest diameter of a new grain, in mean diameters. Much smaller or larger grains would change the cost
/// of the neighbour search and the conditioning of contact problems.
pub const NEW_GRAIN_DIAMETERS: [f64; 2] = [0.2, 5.0];

/// Interactive change of the world between two steps.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum Edit {
    /// Adds a grain at rest, at the end of the list of grains.
    Add(Disc),
    /// Removes the grain with this index; the indices of later grains decrease by one.
    Remove(u32),
    /// Drags a boundary: the point that [`place_of`] returns for it moves straight to the target, together with the
    /// whole boundary, and stays there until the user releases the boundary.
    Draw {
        /// Index of the dragged boundary.
        boundary: u32,
        /// Point to which the boundary is dragged, m.
        to: DVec2,
    },
    /// Releases the dragged boundary, which then stays at its present position.
    LetGo,
}

/// Returns the point of a boundary that follows the user's pointer if the user drags the boundary, m: the first corner
/// or end, or for a half-space the point by which it is given.
pub fn place_of(boundary: &Boundary) -> DVec2 {
    match boundary.edges().first() {
        Some(Edge::Endless { point, .. }) => *point,
        Some(Edge::Wall([from, _]) | Edge::Side([from, _])) => *from,
        None => DVec2::ZERO,
    }
}

/// Speed of a dragged wall, in √(g·d) with gravity g and the mean diameter d. In a scene with d = 5 mm and Δt = 1 ms
/// the wall moves a fiftieth of a diameter per step, which every stepper tolerates.
const SPEED_OF_HAND: f64 = 0.5;
/// Largest overlap of a new grain with another body that is allowed because it may be due to rounding, in mean
/// diameters.
const ROUNDING: f64 = 1e-9;

impl Simulation {
    /// Applies an edit to the world. The next step is the first step that shows its effects.
    ///
    /// # Errors
    /// The error says in one sentence why the edit is impossible. The simulation is then unchanged.
    pub fn edit(&mut self, edit: &Edit) -> Result<()> {
        match *edit {
            Edit::Add(disc) => self.add_grain(disc, DVec2::ZERO),
            Edit::Remove(grain) => self.remove_grain(grain as usize),
            Edit::Draw { boundary, to } => {
                self.draw(boundary as usize, to).map(|()| self.count_edit())
            }
            Edit::LetGo => {
                self.let_go();
                self.count_edit();
                Ok(())
            }
        }
    }

    fn count_edit(&mut self) {
        self.edits += 1;
        let time_step_secs = self.settings.parameters.time_step_secs;
        self.surroundings = Arc::new(Surroundings::of(&self.state.world, time_step_secs));
    }

    /// Sets the centres of all grains, m. Velocities and impulses do not change. A grain that is moved to the other
    /// side of a wall does not count as a grain that went through the wall.
    ///
    /// # Errors
    /// The error says why `positions` are not valid: their number differs from the number of grains, a position is not
    /// finite, a position changes along y in a scene with one axis, or a grain is too close to another disc. The
    /// simulation is then unchanged.
    pub fn set_positions(&mut self, positions: &[DVec2]) -> Result<()> {
        let mut world = self.state.world.clone();
        self.replace("positions", &mut world.grains.positions, positions)?;
        world.grains.brought_back.fill(DVec2::ZERO);
        if let Some(periodic) = world.periodic {
            let places = world.grains.positions.iter_mut().zip(&mut world.grains.brought_back);
            places.for_each(|(place, brought_back)| {
                *brought_back = *place - periodic.wrap(*place);
                *place -= *brought_back;
            });
        }
        check_distances(&world)?;
        self.state.world = world;
        self.state.look_anew()?;
        let mut placed = self.clone();
        placed.observe_start();
        self.watch.place(&placed.state);
        Ok(())
    }

    /// Sets the velocities of all grains, m/s.
    ///
    /// # Errors
    /// The error says why `velocities` are not valid: their number differs from the number of grains, a velocity is not
    /// finite, or a velocity changes along y in a scene with one axis. The simulation is then unchanged.
    pub fn set_velocities(&mut self, velocities: &[DVec2]) -> Result<()> {
        let mut now = self.state.world.grains.velocities.clone();
        self.replace("velocities", &mut now, velocities)?;
        self.state.world.grains.velocities = now;
        Ok(())
    }

    /// Copies `vectors`, one vector per grain, into `there`. The error names `name` if the number of vectors is wrong,
    /// a vector is not finite, or a vector differs along y from the vector that it replaces in a scene with one axis.
    pub(super) fn replace(&self, name: &str, there: &mut [DVec2], vectors: &[DVec2]) -> Result<()> {
        let (count, on_line) = (there.len(), self.state.physics.axes == 1);
        error::check(vectors.len() == count, name, vectors.len(), format!("{count}, one a grain"))?;
        let is_sound =
            |(then, now): (&DVec2, &DVec2)| now.is_finite() && !(on_line && then.y != now.y);
        if let Some(grain) = there.iter().zip(vectors).position(|pair| !is_sound(pair)) {
            let allowed = if on_line { "finite, with y as it was" } else { "finite" };
            return Err(Error::value(format!("{name}[{grain}]"), vectors[grain], allowed));
        }
        there.copy_from_slice(vectors);
        Ok(())
    }

    /// Returns the number of interactive edits since the start.
    pub fn edits(&self) -> usize {
        self.edits as usize
    }

    /// Adds a grain with the given velocity (m/s) at the end of the list of grains.
    ///
    /// # Errors
    /// Fails if there is no room for the grain, if its size is outside [`NEW_GRAIN_DIAMETERS`], if the settings do not
    /// support so small a grain (the contact springs of the stepper `dem` may then need too many substeps), if its
    /// position or velocity is not finite, or if its velocity is not along x in a scene with one axis. The simulation
    /// is then unchanged.
    pub fn add_grain(&mut self, disc: Disc, velocity: DVec2) -> Result<()> {
        let Disc { mut position, radius } = disc;
        let world = &self.state.world;
        let is_sound = velocity.is_finite() && !(self.state.physics.axes == 1 && velocity.y != 0.0);
        let allowed = "finite, and along x where the scene is a line";
        error::check(is_sound, "velocity of a new grain", velocity, allowed)?;
        if self.state.physics.axes == 1 {
            position.y = world.grains.positions[0].y;
        }
        let diameters = 2.0 * radius / world.mean_diameter;
        if !(NEW_GRAIN_DIAMETERS[0]..=NEW_GRAIN_DIAMETERS[1]).contains(&diameters)
            || !position.is_finite()
        {
            let allowed = format!(
                "from {} to {} mean diameters",
                NEW_GRAIN_DIAMETERS[0], NEW_GRAIN_DIAMETERS[1]
            );
            return Err(Error::value("diameter of a new grain", diameters, allowed));
        }
        let position = world.periodic.map_or(position, |periodic| periodic.wrap(position));
        if let Some(what) = self.in_the_way(Disc { position, radius }) {
            return Err(Error::value("place of a new grain", format!("on {what}"), "free"));
        }
        let mut grown = world.clone();
        let density = grown.grains.masses[0] / grown.grains.radii[0].powi(2) / std::f64::consts::PI;
        let others = grown.fixed_discs.len() + grown.boundaries.len();
        let id = grown.grains.count_at_start + others as u32 + grown.grains.added;
        let grain = Grain { velocity, ..Grain::at_rest(position, radius) };
        grown.grains.push(&grain, density, &grown.materials, id);
        grown.grains.added += 1;
        grown.validate(self.state.physics)?;
        self.settings.check_in(&grown, self.state.physics)?;
        self.state.add_last_grain(grown)?;
        self.watch.losses.add(position);
        self.initial_heights += position.y;
        self.count_edit();
        Ok(())
    }

    /// Returns the kind of body that a new disc would overlap, such as `a wall`; `None` if there is room for the disc.
    fn in_the_way(&self, disc: Disc) -> Option<&'static str> {
        let (world, candidates) = (&self.state.world, &self.state.candidates);
        let reach = disc.radius - ROUNDING * world.mean_diameter;
        let overlaps = |place: DVec2, radius: f64| {
            world.shortest(place - disc.position).length() < reach + radius
        };
        let mut grains = world.grains.positions.iter().zip(&world.grains.radii);
        if grains.any(|(place, radius)| overlaps(*place, *radius)) {
            return Some("another one");
        }
        if world.fixed_discs.iter().any(|fixed| overlaps(fixed.position, fixed.radius)) {
            return Some("a fixed disc");
        }
        let is_in_wall = |feature| {
            let distance = candidates.distance(world, feature, disc.position);
            distance.is_some_and(|(_, distance)| distance < reach)
        };
        (0..candidates.features().len()).any(is_in_wall).then_some("a wall")
    }

    /// Removes a grain from the world. The impulses of contacts between other bodies do not change.
    ///
    /// # Errors
    /// Fails if no grain has this index, or if it is the only grain.
    pub fn remove_grain(&mut self, grain: usize) -> Result<()> {
        let count = self.state.world.grains.len();
        let allowed = format!("below {count}, the number of grains");
        error::check(grain < count, "grain", grain, allowed)?;
        error::check(count != 1, "grains", 1, "more than one where one is taken away")?;
        self.initial_heights -= self.state.world.grains.positions[grain].y;
        self.watch.remove(grain);
        self.state.remove_grain(grain)?;
        self.count_edit();
        Ok(())
    }

    fn draw(&mut self, boundary: usize, to: DVec2) -> Result<()> {
        let mut world = self.state.world.clone();
        let refuse = |why: &str| Err(Error::value("wall", why, "one that nothing else moves"));
        let Some(shape) = world.boundaries.get(boundary) else {
            return refuse("drawn until time passes");
        };
        if shape.moves_by_itself() {
            return refuse("a piston");
        }
        // Only one boundary is dragged at a time, so a new drag releases the previous boundary.
        if self.state.is_held {
            world.motions.pop();
        }
        if world.motions.iter().any(|motion| motion.boundaries.contains(&boundary)) {
            return refuse("moved by the scene");
        }
        let speed = SPEED_OF_HAND * (gravity_that_scales(&world) * world.mean_diameter).sqrt();
        let way = to - place_of(shape);
        let travel = Some(way.length());
        let course = MotionCourse::Straight { direction: way, speed, travel };
        let goes = way.is_finite() && way != DVec2::ZERO;
        world.motions.push(Motion {
            boundaries: vec![boundary],
            course: goes.then_some(course),
            ..Motion::default()
        });
        world.validate(self.state.physics)?;
        self.state.world = world;
        self.state.is_held = true;
        self.state.candidates.find_seams(&self.state.world);
        self.watch.losses.let_walls_move(self.state.candidates.features());
        Ok(())
    }

    fn let_go(&mut self) {
        if std::mem::take(&mut self.state.is_held) {
            self.state.world.motions.pop();
            self.state.candidates.find_seams(&self.state.world);
        }
    }
}
