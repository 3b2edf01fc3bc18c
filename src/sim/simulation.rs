//! A running simulation: a world and what is needed to step it.

use std::sync::Arc;

use glam::DVec2;

use super::alarm::Watch;
use super::snapshot::{ContactView, GrainView, Snapshot, Surroundings};
use super::walls::Walls;
use super::{Alarm, Observables, ProblemVisitor, Pull, bonds, schemes, step, travel};
use crate::contact::{Candidates, ContactList, Feature, Reach};
use crate::error::{Error, Result};
use crate::solver::{Method, Problems, SolverSettings};
use crate::world::{Gravity, Parameters, Physics, World};

/// Skin of the candidate search, in units of d. Smaller: the list is built more often; larger: more
/// pairs are looked at in vain. Does not change any result.
const SKIN_IN_DIAMETERS: f64 = 0.2;

/// A world in motion.
///
/// Cloning it gives a second simulation that goes on bitwise as the first one would.
#[derive(Clone, Debug)]
pub struct Simulation {
    pub(super) world: World,
    pub(super) physics: Physics,
    pub(super) parameters: Parameters,
    pub(super) solver: SolverSettings,
    pub(super) candidates: Candidates,
    pub(super) contacts: ContactList,
    pub(super) problems: Problems,
    /// Of the law `range`.
    pub(super) bonds: bonds::Workspace,
    pub(super) observables: Observables,
    /// Σ y_i(0), m, of eq. 11.
    pub(super) initial_heights: f64,
    /// Δt of the impulses in `contacts`, s.
    pub(super) time_step_of_impulses_secs: f64,
    /// The method of the last step: the contacts' memories are its own.
    pub(super) method_of_memories: Option<Method>,
    /// A spring on one grain, from the next step on.
    pub(super) pull: Option<Pull>,
    /// Walls that move.
    pub(super) walls: Walls,
    watch: Watch,
    surroundings: Arc<Surroundings>,
}

impl Simulation {
    /// Sets a world up at t = 0. Pairs touch below a gap of `gap_tolerance` (m, ≥ 0), which is there
    /// for rounding alone.
    ///
    /// # Errors
    /// Names the first field that is outside its range.
    pub fn new(
        world: World,
        physics: Physics,
        parameters: Parameters,
        solver: SolverSettings,
        gap_tolerance: f64,
    ) -> Result<Self> {
        physics.validate()?;
        parameters.validate()?;
        solver.validate()?;
        let diameter = world.mean_diameter;
        if !(diameter > 0.0 && diameter.is_finite()) {
            return Err(Error::value("mean_diameter", diameter, "a finite length > 0 m"));
        }
        let skin = SKIN_IN_DIAMETERS * diameter;
        if !(0.0..0.1 * skin).contains(&gap_tolerance) {
            let allowed = format!("≥ 0 and below {} m", 0.1 * skin);
            return Err(Error::value("gap_tolerance", gap_tolerance, allowed));
        }
        let candidates = Candidates::new(&world, Reach { skin, gap_tolerance })?;
        let surroundings = Arc::new(Surroundings {
            fixed_discs: world.fixed_discs.clone(),
            boundaries: world.boundaries.clone(),
            centre_of_attraction: match world.gravity {
                Gravity::Attraction { centre, .. } => Some(centre),
                Gravity::Uniform { .. } => None,
            },
            mean_diameter: diameter,
            gravity_magnitude: world.gravity.magnitude(),
        });
        let mut simulation = Self {
            initial_heights: world.grains.positions.iter().map(|position| position.y).sum(),
            walls: Walls::default(),
            watch: Watch::new(&world, candidates.features()),
            world,
            physics,
            parameters,
            solver,
            candidates,
            contacts: ContactList::default(),
            problems: Problems::default(),
            bonds: bonds::Workspace::default(),
            observables: Observables::default(),
            time_step_of_impulses_secs: parameters.time_step_secs,
            method_of_memories: None,
            pull: None,
            surroundings,
        };
        step::measure_start(&mut simulation);
        Ok(simulation)
    }

    /// Takes one step.
    ///
    /// # Errors
    /// [`Error::NonFinite`] where a position or velocity is no longer a number; the state is then
    /// left as it is, for looking at.
    pub fn step(&mut self) -> Result<&Observables> {
        match travel::pieces(self) {
            1 => step::take(self)?,
            pieces => travel::take(self, pieces)?,
        }
        let finite = self.is_finite();
        self.watch.look(&self.world, self.candidates.features(), &self.observables, finite);
        if finite {
            return Ok(&self.observables);
        }
        let Parameters { bond, time_step_secs, restitution, friction, .. } = self.parameters;
        Err(Error::NonFinite {
            step: self.observables.step,
            time_secs: self.observables.time_secs,
            bond,
            time_step_secs,
            restitution,
            friction,
        })
    }

    /// Shows the problem of the next step, as its method would get it, to `visitor`; this simulation
    /// stays as it is.
    pub fn next_problem<V: ProblemVisitor>(&self, visitor: V) -> V::Output {
        step::show_problem(&mut self.clone(), visitor)
    }

    pub(super) fn is_finite(&self) -> bool {
        let grains = &self.world.grains;
        // A sum is finite only where every term is (or where an overflow is close enough to count).
        let total = |vectors: &[DVec2]| vectors.iter().sum::<DVec2>().is_finite();
        total(&grains.positions)
            && total(&grains.velocities)
            && grains.angular_velocities.iter().sum::<f64>().is_finite()
    }

    /// The world as it is now.
    pub fn world(&self) -> &World {
        &self.world
    }

    /// The contacts of the last step.
    pub fn contacts(&self) -> &ContactList {
        &self.contacts
    }

    /// The physics that this simulation computes.
    pub fn physics(&self) -> Physics {
        self.physics
    }

    /// The parameters of the next step.
    pub fn parameters(&self) -> &Parameters {
        &self.parameters
    }

    /// Changes the parameters from the next step on.
    ///
    /// # Errors
    /// Names the first one outside its range, and changes none.
    pub fn set_parameters(&mut self, parameters: Parameters) -> Result<()> {
        parameters.validate()?;
        self.parameters = parameters;
        Ok(())
    }

    /// The solver settings of the next step.
    pub fn solver(&self) -> &SolverSettings {
        &self.solver
    }

    /// Changes the solver settings from the next step on.
    ///
    /// # Errors
    /// Names the first one outside its range, and changes none.
    pub fn set_solver(&mut self, solver: SolverSettings) -> Result<()> {
        solver.validate()?;
        self.solver = solver;
        Ok(())
    }

    /// Substeps of the next step: 1 where its problem is solved as a whole.
    pub fn substeps(&self) -> u32 {
        schemes::substeps(self)
    }

    /// The longest substep, s, with which the springs of the next step are surely stable; none
    /// where there are no springs.
    pub fn critical_time_step_secs(&self) -> Option<f64> {
        schemes::critical_time_step_secs(self)
    }

    /// What the last step measured; before the first step, the initial state.
    pub fn observables(&self) -> &Observables {
        &self.observables
    }

    /// What went wrong so far, one alarm of a kind.
    pub fn alarms(&self) -> &[Alarm] {
        self.watch.alarms()
    }

    /// Simulated time, s.
    pub fn time_secs(&self) -> f64 {
        self.observables.time_secs
    }

    /// Takes the last grain out of the world. The impulses of all other contacts stay.
    ///
    /// # Errors
    /// Where it is the only one.
    pub fn remove_last_grain(&mut self) -> Result<()> {
        let last = self.world.grains.len() - 1;
        if last == 0 {
            return Err(Error::value("grains", 1, "more than one where one is taken away"));
        }
        self.initial_heights -= self.world.grains.positions[last].y;
        self.world.grains.truncate(last);
        self.contacts.remove_body(last as u32);
        let skin = SKIN_IN_DIAMETERS * self.world.mean_diameter;
        let gap_tolerance = self.candidates.gap_tolerance();
        self.candidates = Candidates::new(&self.world, Reach { skin, gap_tolerance })?;
        self.pull = self.pull.filter(|pull| (pull.grain as usize) < last);
        Ok(())
    }

    /// Sets all velocities to zero and forgets the contacts' impulses.
    pub fn bring_to_rest(&mut self) {
        self.world.grains.velocities.fill(DVec2::ZERO);
        self.world.grains.angular_velocities.fill(0.0);
        self.contacts.scale_impulses(0.0);
        self.contacts.forget();
    }

    /// Multiplies all velocities, as a drag during the last step would have.
    pub fn scale_velocities(&mut self, factor: f64) {
        for velocity in &mut self.world.grains.velocities {
            *velocity *= factor;
        }
        for spin in &mut self.world.grains.angular_velocities {
            *spin *= factor;
        }
    }

    /// This moment, for pictures.
    pub fn snapshot(&self) -> Snapshot {
        let grains = &self.world.grains;
        let mut views: Vec<GrainView> = (0..grains.len())
            .map(|index| GrainView {
                position: grains.positions[index],
                radius: grains.radii[index],
                angle: grains.angles[index],
                velocity: grains.velocities[index],
                angular_velocity: grains.angular_velocities[index],
                overlap: 0.0,
                force: 0.0,
                coordination: 0,
                tone: grains.tones[index],
            })
            .collect();
        let per_time_step = 1.0 / self.time_step_of_impulses_secs;
        let list = self.contacts.contacts().iter().zip(self.contacts.impulses());
        let shown = list.enumerate().filter(|&(index, _)| self.contacts.is_in_touch(index));
        let contacts = shown.map(|(_, (contact, impulse))| {
            let normal_force = impulse.normal * per_time_step;
            let other = contact.other as usize;
            for index in [contact.grain as usize, other] {
                if let Some(view) = views.get_mut(index) {
                    view.overlap = view.overlap.max(-contact.gap);
                    view.force += normal_force.abs();
                    view.coordination += 1;
                }
            }
            ContactView {
                grain: contact.grain,
                other_grain: (other < grains.len()).then_some(contact.other),
                from: grains.positions[contact.grain as usize],
                to: self.far_end(contact.grain as usize, other),
                normal_force,
                tangential_force: impulse.tangential * per_time_step,
                gap: contact.gap,
            }
        });
        let contacts = contacts.collect();
        Snapshot {
            observables: self.observables,
            grains: views,
            contacts,
            surroundings: self.surroundings(),
        }
    }

    /// What no grain moves, where it is now.
    fn surroundings(&self) -> Arc<Surroundings> {
        if self.candidates.pistons().is_empty() {
            return Arc::clone(&self.surroundings);
        }
        let boundaries = self.world.boundaries.clone();
        Arc::new(Surroundings { boundaries, ..Surroundings::clone(&self.surroundings) })
    }

    /// Centre of another disc, or the nearest point of another shape, m.
    fn far_end(&self, grain: usize, other: usize) -> DVec2 {
        let grains = &self.world.grains;
        if let Some(&centre) = grains.positions.get(other) {
            return centre;
        }
        let fixed = other - grains.len();
        if let Some(disc) = self.world.fixed_discs.get(fixed) {
            return disc.position;
        }
        let feature: &Feature = &self.candidates.features()[fixed - self.world.fixed_discs.len()];
        let centre = grains.positions[grain];
        feature.distance(centre).map_or(centre, |(normal, distance)| centre - distance * normal)
    }
}
