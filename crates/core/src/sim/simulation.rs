//! A running simulation: a world and what is needed to step it.

mod edits;
mod numbers;
mod saved;

use std::sync::Arc;

use super::alarm::Watch;
use super::check::reach_in;
use super::remedies::max_travel;
use super::snapshot::Surroundings;
use super::state::State;
use super::steady::Steady;
use super::steppers::{Memory, Stepper};
use super::stepping::Advance;
use super::visits::{ProblemVisitor, Show, Start, Step};
use super::walls::Walls;
use super::{Alarm, Observables, Pull, Settings};
use crate::contact::{Candidates, ContactList};
use crate::error::{Error, Result};
use crate::solver::{Slots, SolverSettings};
use crate::threads;
use crate::world::{Parameters, Physics, World};

/// A world in motion.
///
/// Cloning it gives a second simulation that goes on bitwise as the first one would.
#[derive(Clone, Debug)]
pub struct Simulation {
    pub(super) state: State,
    settings: Settings,
    steady: Steady,
    slots: Slots,
    memory: Memory,
    observables: Observables,
    /// Σ y_i(0), m, of eq. 11.
    initial_heights: f64,
    /// The way that the last step was taken: the contacts' memories are its own.
    last_stepper: Option<Stepper>,
    watch: Watch,
    pub(super) surroundings: Arc<Surroundings>,
    /// How often a hand has changed the world.
    edits: u32,
}

impl Simulation {
    /// Sets a world up at t = 0. Pairs touch below a gap of `gap_tolerance` (m, ≥ 0), which is there
    /// for rounding alone.
    ///
    /// # Errors
    /// Names the first field that is outside its range, or that does not go with the others.
    pub fn new(
        mut world: World,
        physics: Physics,
        settings: Settings,
        gap_tolerance: f64,
    ) -> Result<Self> {
        physics.validate()?;
        settings.validate()?;
        world.validate(physics)?;
        settings.check_in(&world, physics)?;
        world.wrap();
        world.tilt(settings.parameters.tilt.to_radians());
        let candidates = Candidates::new(&world, reach_in(&world, gap_tolerance)?)?;
        let surroundings = Arc::new(Surroundings::of(&world, settings.parameters.time_step_secs));
        let mut simulation = Self {
            initial_heights: world.grains.positions.iter().map(|position| position.y).sum(),
            watch: Watch::new(&world, candidates.features(), physics),
            state: State {
                world,
                physics,
                candidates,
                contacts: ContactList::default(),
                walls: Walls::default(),
                pull: None,
                is_held: false,
                time_step_of_impulses_secs: settings.parameters.time_step_secs,
            },
            settings,
            steady: Steady::default(),
            slots: Slots::default(),
            memory: Memory::default(),
            observables: Observables::default(),
            last_stepper: None,
            surroundings,
            edits: 0,
        };
        simulation.observe_start();
        Ok(simulation)
    }

    /// Takes one step.
    ///
    /// # Errors
    /// [`Error::NonFinite`] where a position or velocity is no longer a number; the state is then
    /// left as it is, for looking at.
    pub fn step(&mut self) -> Result<&Observables> {
        self.become_of(Some(self.settings.stepper));
        let mut memory = std::mem::take(&mut self.memory);
        let pieces = max_travel::pieces(&self.state, &self.settings);
        self.take_step(pieces, &mut memory);
        self.watch.look_at_length(memory.take_longest_step_secs(), &self.observables);
        self.memory = memory;
        self.look()
    }

    /// Takes one step in a way of your own, in place of the settings' stepper.
    ///
    /// ```
    /// use slump::sim::{Advance, Outcome, Settings, Stage};
    /// use slump::solver::Model;
    ///
    /// /// Contacts that never throw grains back.
    /// struct Dead;
    ///
    /// impl Advance for Dead {
    ///     fn advance<M: Model>(&mut self, stage: &mut Stage<'_, M>, settings: &Settings) -> Outcome {
    ///         stage.prepare(settings, |_approach| 0.0);
    ///         let report = stage.solve(settings);
    ///         stage.move_by(report, settings)
    ///     }
    /// }
    ///
    /// let mut simulation = slump::scene::built_in("collision")?.simulation()?;
    /// assert_eq!(simulation.step_by(&mut Dead)?.step, 1);
    /// # Ok::<(), slump::error::Error>(())
    /// ```
    ///
    /// # Errors
    /// As [`Simulation::step`].
    pub fn step_by(&mut self, own: &mut (impl Advance + Send)) -> Result<&Observables> {
        self.become_of(None);
        self.take_step(1, own);
        self.look()
    }

    /// The contacts' memories are of one way to step alone.
    fn become_of(&mut self, stepper: Option<Stepper>) {
        if self.last_stepper != stepper {
            self.state.contacts.forget();
            self.last_stepper = stepper;
        }
    }

    fn take_step(&mut self, pieces: u32, advance: &mut (impl Advance + Send)) {
        let Self { state, settings, slots, observables, initial_heights, .. } = self;
        let parts = state.leanest_model(&settings.parameters);
        let initial_heights = *initial_heights;
        state.contacts.begin_step(observables.step + 1);
        let step = Step { state, settings, pieces, advance, observables, initial_heights };
        threads::together(step.state.world.grains.len(), || slots.visit(parts, step));
        let work_of_crossing = state.world.wrap();
        if let Some(border_work) = &mut observables.border_work {
            *border_work += work_of_crossing;
            observables.kinetic_energy += work_of_crossing;
        }
    }

    fn look(&mut self) -> Result<&Observables> {
        let finite = self.state.is_finite();
        let State { world, candidates, .. } = &self.state;
        let walls = (candidates.features(), world.has_motion());
        self.watch.look(world, walls, &mut self.observables, finite);
        if finite {
            return Ok(&self.observables);
        }
        let Observables { step, time_secs, .. } = self.observables;
        let Parameters { bond, time_step_secs, restitution, friction, .. } =
            self.settings.parameters;
        Err(Error::NonFinite { step, time_secs, bond, time_step_secs, restitution, friction })
    }

    /// Measures the initial state.
    fn observe_start(&mut self) {
        let Self { state, settings, slots, memory, observables, initial_heights, .. } = self;
        let parts = state.leanest_model(&settings.parameters);
        *observables = slots
            .visit(parts, Start { state, settings, memory, initial_heights: *initial_heights });
    }

    /// Shows the first problem of the next step, as its method would get it, to `visitor`: that of the
    /// first piece where the step is cut, with its shocks passed where they are solved apart. This
    /// simulation stays as it is.
    pub fn next_problem<V: ProblemVisitor>(&self, visitor: V) -> V::Output {
        let Self { mut state, settings, mut slots, mut memory, .. } = self.clone();
        let parts = state.leanest_model(&settings.parameters);
        state.contacts.begin_step(self.observables.step + 1);
        let pieces = max_travel::pieces(&state, &settings);
        let settings = &settings.over(settings.parameters.time_step_secs / f64::from(pieces));
        slots.visit(parts, Show { state: &mut state, memory: &mut memory, settings, visitor })
    }

    /// The world as it is now.
    pub fn world(&self) -> &World {
        &self.state.world
    }

    /// The contacts of the last step.
    pub fn contacts(&self) -> &ContactList {
        &self.state.contacts
    }

    /// The physics that this simulation computes.
    pub fn physics(&self) -> Physics {
        self.state.physics
    }

    /// How the next step is taken.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// The parameters of the next step.
    pub fn parameters(&self) -> &Parameters {
        &self.settings.parameters
    }

    /// How well the next step is solved.
    pub fn solver(&self) -> &SolverSettings {
        &self.settings.solver
    }

    /// Changes the settings from the next step on.
    ///
    /// # Errors
    /// Names the first one outside its range, or that does not go with the others, and changes none.
    pub fn change(&mut self, settings: Settings) -> Result<()> {
        settings.validate()?;
        settings.check_in(&self.state.world, self.state.physics)?;
        self.state.world.tilt(settings.parameters.tilt.to_radians());
        if settings.parameters.time_step_secs != self.settings.parameters.time_step_secs {
            self.steady = Steady::since(&self.observables);
        }
        self.settings = settings;
        Ok(())
    }

    /// Changes the parameters from the next step on.
    ///
    /// # Errors
    /// As [`Self::change`].
    pub fn set_parameters(&mut self, parameters: Parameters) -> Result<()> {
        self.change(Settings { parameters, ..self.settings })
    }

    /// Changes how well steps are solved, from the next one on.
    ///
    /// # Errors
    /// As [`Simulation::change`].
    pub fn set_solver(&mut self, solver: SolverSettings) -> Result<()> {
        self.change(Settings { solver, ..self.settings })
    }

    /// The spring that acts on a grain in the next step, if there is one.
    pub fn pull(&self) -> Option<Pull> {
        self.state.pull
    }

    /// Ties a spring to a grain from the next step on, or takes it away. A spring to a grain that
    /// does not exist is none.
    pub fn set_pull(&mut self, pull: Option<Pull>) {
        let exists = |pull: &Pull| (pull.grain as usize) < self.state.world.grains.len();
        self.state.pull = pull.filter(|pull| exists(pull) && pull.target.is_finite());
    }

    /// What the last step measured; before the first step, the initial state.
    pub fn observables(&self) -> &Observables {
        &self.observables
    }

    /// What went wrong so far, one alarm of a kind.
    pub fn alarms(&self) -> &[Alarm] {
        self.watch.alarms()
    }

    /// The step whose end is nearest to a simulated time (s), as long as Δt stays as it is.
    pub fn step_at(&self, secs: f64) -> u64 {
        self.steady.step_at(secs, &self.settings.parameters)
    }

    /// Whether a grain went through a wall or left the world.
    pub(super) fn is_lost(&self, grain: usize) -> bool {
        self.watch.is_lost(grain)
    }

    /// Simulated time, s.
    pub fn time_secs(&self) -> f64 {
        self.observables.time_secs
    }
}
