//! The state that a step reads and changes, and the operations common to all steppers: detection of contacts and
//! motion of grains.

use glam::DVec2;
use serde::{Deserialize, Serialize};

use crate::contact::{Candidates, ContactList, LookAhead, PairLaws, Reach, check_distances};
use crate::error::{self, Error, Result};
use crate::sim::pull::{Pull, Push};
use crate::sim::settings::Settings;
use crate::sim::walls::Walls;
use crate::solver::{Model, ModelParts};
use crate::world::{Parameters, Physics, World};

/// Skin of the neighbour search, in mean diameters: pairs with gaps below the skin are listed as candidates for
/// contacts. With a smaller skin the list is rebuilt more often; with a larger skin more pairs are examined in vain.
/// The skin does not change any result.
const SKIN_IN_DIAMETERS: f64 = 0.2;

/// State that a step changes: a world, the contacts of its last step, and the forces that the user applies.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct State {
    pub world: World,
    pub physics: Physics,
    pub candidates: Candidates,
    pub contacts: ContactList,
    /// Moving walls with their velocities. At its beginning each step computes the list of walls and their velocities
    /// again.
    #[serde(skip)]
    pub walls: Walls,
    /// Spring with which the user pulls one grain in the next steps; `None` if the user pulls no grain.
    pub pull: Option<Pull>,
    /// Force on each grain in addition to gravity, N; empty if no grain has such a force.
    pub body_forces: Vec<DVec2>,
    /// True while the user drags a wall. The last entry of the world's `motions` is then the motion of this wall.
    pub is_held: bool,
    /// Time step for which the impulses in `contacts` were computed, s.
    pub time_step_of_impulses_secs: f64,
}

impl State {
    /// Returns the smallest set of features (axes, friction, rotation, rolling resistance, sheared borders) that is
    /// sufficient for this state. The solver is compiled once for each set of features.
    pub(crate) fn leanest_model(&self, parameters: &Parameters) -> ModelParts {
        ModelParts::leanest(self.physics, self.world.periodic, self.largest_friction(parameters))
    }

    /// Returns the coefficients of the contact law for each pair of materials; `None` if the scene gives none, so that
    /// all contacts have the coefficients in `parameters`.
    pub(crate) fn pair_laws(&self, parameters: &Parameters) -> Option<PairLaws> {
        PairLaws::of(&self.world, parameters, self.physics)
    }

    /// Returns two maxima over all contacts that are possible in this state: of the friction coefficient μ and of the
    /// coefficient of rolling friction μ_r.
    pub(crate) fn largest_friction(&self, parameters: &Parameters) -> [f64; 2] {
        match self.pair_laws(parameters) {
            None => [parameters.friction, parameters.rolling_friction],
            Some(laws) => {
                let [friction, rolling, _] = laws.largest(&self.world.grains);
                [friction, rolling]
            }
        }
    }

    /// Returns the number of substeps into which the stepper divides a step.
    pub(crate) fn substeps(&self, settings: &Settings) -> u32 {
        (settings.stepper.info().substeps)(&self.world, self.physics, &settings.parameters)
    }

    /// Begins a step with the time step `time_step_secs` (s). If the time step has changed, rescales the stored
    /// impulses so that the contact forces stay the same. Also sets the velocities of walls and the direction of
    /// gravity.
    pub(crate) fn begin(&mut self, time_step_secs: f64) {
        let before = self.time_step_of_impulses_secs;
        if time_step_secs != before {
            self.contacts.scale_impulses(time_step_secs / before);
            self.time_step_of_impulses_secs = time_step_secs;
        }
        if let Some(turning) = &self.world.gravity_turn {
            self.world.gravity = turning.in_next(time_step_secs);
        }
        self.walls.begin(&self.world, &self.candidates, time_step_secs);
    }

    /// Finds the contacts at the present positions. If `ahead` is given, also adds pairs that may touch within the
    /// step.
    pub(crate) fn detect<M: Model>(&mut self, ahead: Option<LookAhead>) {
        match M::AXES {
            1 => self.detect_on::<1>(ahead),
            _ => self.detect_on::<2>(ahead),
        }
    }

    fn detect_on<const AXES: usize>(&mut self, ahead: Option<LookAhead>) {
        let speed_of_border = self.speed_of_border();
        let Self { world, candidates, contacts, walls, .. } = self;
        let Some(ahead) = ahead else {
            candidates.update::<AXES>(world);
            return contacts.detect::<AXES>(world, candidates);
        };
        let slides = 0.5 * speed_of_border * ahead.time_step_secs;
        let way_of_grain =
            |grain: usize| ahead.way_of_grain(world.grains.velocities[grain]) + slides;
        let way_of_walls = ahead.time_step_secs * walls.fastest(world, candidates);
        candidates.update_ahead::<AXES>(world, way_of_grain, ahead.way_of_others(way_of_walls));
        contacts.detect_ahead::<AXES>(world, candidates, ahead, |contact| {
            walls.velocity(world, contact)[0]
        });
    }

    /// Returns the speed of the fastest grain or wall in the present step, m/s. Call this after [`Self::begin`], which
    /// sets the velocities of walls.
    pub(crate) fn fastest(&self) -> f64 {
        self.fastest_with(self.walls.fastest(&self.world, &self.candidates))
    }

    /// Returns the speed of the fastest grain or wall in the next step, m/s, if that step has the length
    /// `time_step_secs`, s.
    pub(crate) fn fastest_in(&self, time_step_secs: f64) -> f64 {
        self.fastest_with(Walls::fastest_in(&self.world, &self.candidates, time_step_secs))
    }

    /// Returns the speed of the fastest grain, or `fastest_wall` if that is larger, m/s. Periodic images of grains
    /// beyond a sheared border slide with the border. The relative velocity of two grains that meet across the border
    /// contains this sliding speed once, so each of the two grains gets half of it: the result includes half of the
    /// sliding speed.
    fn fastest_with(&self, fastest_wall: f64) -> f64 {
        let speeds = self.world.grains.velocities.iter().map(|velocity| velocity.length());
        speeds.fold(fastest_wall, f64::max) + 0.5 * self.speed_of_border()
    }

    /// Returns the sliding speed of periodic images beyond a sheared border relative to their grains, m/s; 0 without
    /// such a border.
    fn speed_of_border(&self) -> f64 {
        self.world.periodic.map_or(0.0, |periodic| periodic.border_speed().abs())
    }

    /// Moves the grains by their velocities: x^n = x^{n−1} + Δt v^n, with the position x and the velocity v of a grain,
    /// the time step Δt, and n for the end of the step (Abramian & Staron 2020, eq. 12). Angles change likewise if
    /// grains turn. Also moves walls and sheared borders, and advances the direction of gravity.
    pub(crate) fn integrate<M: Model>(&mut self, time_step_secs: f64) {
        let grains = &mut self.world.grains;
        for (position, velocity) in grains.positions.iter_mut().zip(&grains.velocities) {
            if M::AXES == 1 {
                position.x += time_step_secs * velocity.x;
            } else {
                *position += time_step_secs * *velocity;
            }
        }
        // This condition is not about the compiled model, because grains keep turning while friction is off.
        if self.physics.rotation {
            for (angle, spin) in grains.angles.iter_mut().zip(&grains.angular_velocities) {
                *angle += time_step_secs * spin;
            }
        }
        if let Some(turning) = &mut self.world.gravity_turn {
            turning.turn.elapsed_secs += time_step_secs;
        }
        if let Some(periodic) = &mut self.world.periodic {
            periodic.slide(time_step_secs);
            self.candidates.slide(time_step_secs * periodic.border_speed());
        }
        if self.walls.any_move() || !self.world.motions.is_empty() {
            self.walls.advance(&mut self.world, &mut self.candidates, time_step_secs);
        }
    }

    /// Returns the changes of the grains' velocities in the next `secs` (s) by two forces: the spring with which the
    /// user pulls a grain, and the forces in `body_forces`. `axes` is the number of space dimensions.
    pub(super) fn pushes(&self, axes: usize, secs: f64) -> Vec<Push> {
        let masses = &self.world.grains.masses;
        let spring = self.pull.and_then(|pull| pull.push(&self.world, axes, secs));
        let forces = self.body_forces.iter().zip(masses).enumerate();
        let forces =
            forces.filter_map(|(grain, (&force, mass))| Push::of(grain, secs / mass * force));
        spring.into_iter().chain(forces).collect()
    }

    /// Returns the largest acceleration that gravity and body forces give to any grain, m/s². The search distance for
    /// contacts of the next step depends on it.
    pub(super) fn largest_acceleration(&self) -> f64 {
        let forces = self.body_forces.iter().zip(&self.world.grains.masses);
        let largest = forces.map(|(force, mass)| force.length() / mass).fold(0.0, f64::max);
        self.world.gravity.magnitude() + largest
    }

    /// True if all positions and velocities are finite.
    pub(crate) fn is_finite(&self) -> bool {
        let grains = &self.world.grains;
        // A sum is finite only if all its terms are finite. A sum that overflows, although its terms are finite, counts
        // as not finite, too.
        let total = |vectors: &[DVec2]| vectors.iter().sum::<DVec2>().is_finite();
        total(&grains.positions)
            && total(&grains.velocities)
            && grains.angular_velocities.iter().sum::<f64>().is_finite()
    }

    /// Removes a grain. The impulses of contacts between other bodies do not change.
    pub(crate) fn remove_grain(&mut self, grain: usize) -> Result<()> {
        let number = grain as u32;
        self.world.grains.remove(grain);
        if !self.body_forces.is_empty() {
            self.body_forces.remove(grain);
        }
        self.contacts.remove_body(number);
        self.look_anew()?;
        self.pull = self.pull.filter(|pull| pull.grain != number);
        if let Some(pull) = &mut self.pull {
            pull.grain -= u32::from(pull.grain > number);
        }
        Ok(())
    }

    /// Replaces the world by `world`, which has one more grain at the end of its list.
    pub(crate) fn add_last_grain(&mut self, world: World) -> Result<()> {
        let number = world.grains.len() as u32 - 1;
        self.world = world;
        if !self.body_forces.is_empty() {
            self.body_forces.push(DVec2::ZERO);
        }
        self.contacts.insert_body(number);
        self.look_anew()
    }

    /// Starts the neighbour search again from the present positions: replaces the list of candidate pairs (pairs of
    /// bodies that may touch soon).
    pub(crate) fn look_anew(&mut self) -> Result<()> {
        let skin = SKIN_IN_DIAMETERS * self.world.mean_diameter;
        let gap_tolerance = self.candidates.gap_tolerance();
        self.candidates = Candidates::new(&self.world, Reach { skin, gap_tolerance })?;
        Ok(())
    }
}

/// Largest allowed mean diameter of a scene, in radii of the largest grain. The scene file gives the mean diameter; it
/// is not computed from the grains. Pairs within the skin of the neighbour search are candidates for contacts, and the
/// skin is proportional to the mean diameter, so a larger value would allow worlds in which nearly all pairs are
/// candidates.
const MOST_RADII_OF_DIAMETER: f64 = 200.0;

/// Returns the search distances for contacts in a world. The error says which length is not valid, or so large that
/// each disc would have too many neighbours.
pub(super) fn reach_in(world: &World, gap_tolerance: f64) -> Result<Reach> {
    let diameter = world.mean_diameter;
    let is_length = diameter > 0.0 && diameter.is_finite();
    error::check(is_length, "mean_diameter", diameter, "a finite length > 0 m")?;
    let most = MOST_RADII_OF_DIAMETER * world.grains.radii.iter().copied().fold(0.0, f64::max);
    if diameter > most {
        let allowed = format!("at most {most} m, 100 times the diameter of the largest grain");
        return Err(Error::value("mean_diameter", diameter, allowed));
    }
    let skin = SKIN_IN_DIAMETERS * diameter;
    // If a disc were smaller than the tolerance, all discs within the tolerance would count as touching.
    let least_radius = world.grains.radii.iter().copied().fold(f64::INFINITY, f64::min);
    let most = (0.1 * skin).min(least_radius);
    let allowed = format!("≥ 0 and below {most} m");
    error::check((0.0..most).contains(&gap_tolerance), "gap_tolerance", gap_tolerance, allowed)?;
    check_distances(world)?;
    Ok(Reach { skin, gap_tolerance })
}
