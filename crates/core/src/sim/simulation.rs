//! The type [`Simulation`]: a world with everything that is needed to advance it step by step.

use std::sync::Arc;

use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::contact::{Candidates, ContactList};
use crate::error::{Error, Result, check};
use crate::sim::alarm::{AlarmKind, Watch};
use crate::sim::observables::{self, Observables};
use crate::sim::settings::{Settings, Stepper};
use crate::sim::state::{State, reach_in};
use crate::sim::steppers::StepperMemory;
use crate::sim::stepping::{Advance, Stage, StepResult};
use crate::sim::surroundings::Surroundings;
use crate::sim::walls::Walls;
use crate::sim::{Alarm, Pull, remedies};
use crate::solver::{Model, ModelParts, Slots, Slotted, SolverSettings, StepProblem};
use crate::world::{Parameters, Physics, World};
use crate::{threads, with_model};

/// A simulation of a world.
///
/// A clone, and a simulation written to a file and read back, give results that equal those of the original bit by bit.
/// A file omits data on which no result depends: the contact problem, which every step recomputes, and data that
/// solvers keep from one solve to the next (`tests/program/restart/` checks this for all solvers).
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(remote = "Self", deny_unknown_fields)]
pub struct Simulation {
    pub(super) state: State,
    pub(super) settings: Settings,
    steady: Steady,
    #[serde(skip)]
    slots: Slots,
    memory: StepperMemory,
    observables: Observables,
    /// Sum of the initial heights of all grains, Σ y_i(0), m (Abramian & Staron 2020, eq. 11).
    pub(super) initial_heights: f64,
    /// Stepper whose data contacts keep from the last step; `None` at the start and after [`Simulation::step_by`].
    last_stepper: Option<Stepper>,
    pub(super) watch: Watch,
    pub(super) surroundings: Arc<Surroundings>,
    /// Number of interactive edits since the start.
    pub(super) edits: u32,
}

impl Simulation {
    /// Creates a simulation of `world` at time 0. Pairs with a gap below `gap_tolerance` (m, ≥ 0) count as touching;
    /// this tolerance only allows for rounding.
    ///
    /// # Errors
    /// The error names the first part of the arguments that is outside its range or incompatible with another part.
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
            watch: Watch::default(),
            state: State {
                world,
                physics,
                candidates,
                contacts: ContactList::default(),
                walls: Walls::default(),
                pull: None,
                body_forces: Vec::new(),
                is_held: false,
                time_step_of_impulses_secs: settings.parameters.time_step_secs,
            },
            settings,
            steady: Steady::default(),
            slots: Slots::default(),
            memory: StepperMemory::default(),
            observables: Observables::default(),
            last_stepper: None,
            surroundings,
            edits: 0,
        };
        simulation.observe_start();
        simulation.watch = Watch::new(&simulation.state);
        Ok(simulation)
    }

    /// Takes one step.
    ///
    /// # Errors
    /// [`Error::NonFinite`] if a position, a velocity or the kinetic energy is no longer finite. The simulation keeps
    /// these values for inspection.
    pub fn step(&mut self) -> Result<&Observables> {
        self.watch.look_ahead(&self.observables, &self.settings);
        self.become_of(Some(self.settings.stepper));
        let mut memory = std::mem::take(&mut self.memory);
        let pieces = remedies::pieces(&self.state, &self.settings);
        self.take_step(pieces, &mut memory);
        if let longest @ Some(_) = memory.range.longest_step_secs.take() {
            self.watch.raise(AlarmKind::BreakUnseen, &self.observables, longest);
        }
        self.memory = memory;
        self.look()
    }

    /// Takes one step with your own stepper instead of the stepper of the settings.
    ///
    /// ```
    /// use slump_core::sim::{Advance, StepResult, Settings, Stage};
    /// use slump_core::solver::Model;
    ///
    /// /// Contacts that never throw grains back.
    /// struct Dead;
    ///
    /// impl Advance for Dead {
    ///     fn advance<M: Model>(&mut self, stage: &mut Stage<'_, M>, settings: &Settings) -> StepResult {
    ///         stage.prepare(settings, |_approach| 0.0);
    ///         let report = stage.solve(settings);
    ///         stage.move_by(report, settings)
    ///     }
    /// }
    ///
    /// let mut simulation = slump_core::scene::built_in("collision")?.simulation()?;
    /// assert_eq!(simulation.step_by(&mut Dead)?.step, 1);
    /// # Ok::<(), slump_core::error::Error>(())
    /// ```
    ///
    /// # Errors
    /// The errors of [`Simulation::step`].
    pub fn step_by(&mut self, own: &mut (impl Advance + Send)) -> Result<&Observables> {
        self.watch.look_ahead(&self.observables, &self.settings);
        self.become_of(None);
        self.take_step(1, own);
        self.look()
    }

    /// Clears the data that contacts keep from the last step if a stepper other than `stepper` has stored them.
    fn become_of(&mut self, stepper: Option<Stepper>) {
        if self.last_stepper != stepper {
            self.state.contacts.forget();
            self.last_stepper = stepper;
        }
    }

    fn take_step(&mut self, pieces: u32, advance: &mut (impl Advance + Send)) {
        self.state.contacts.begin_step(self.observables.step + 1);
        let parts = self.state.leanest_model(&self.settings.parameters);
        threads::together(self.state.world.grains.len(), || {
            with_model!(parts, M => self.take_step_of::<M>(pieces, advance));
        });
        let work_of_crossing = self.state.world.wrap();
        if let Some(border_work) = &mut self.observables.border_work {
            *border_work += work_of_crossing;
            self.observables.kinetic_energy += work_of_crossing;
        }
    }

    /// Takes one step, divided into `pieces` shorter steps of equal length.
    fn take_step_of<M: Slotted>(&mut self, pieces: u32, advance: &mut impl Advance) {
        let Self {
            state, settings, slots, observables, initial_heights, last_stepper, watch, ..
        } = self;
        let stage = &mut Stage::<M>::new(state, M::slot(slots));
        let mut result = if pieces == 1 {
            advance.advance(stage, settings)
        } else {
            stage.state.contacts.begin_sums();
            stage.in_pieces(pieces, settings, StepResult::nothing_yet(), |stage, piece, result| {
                result.add(advance.advance(stage, piece));
            })
        };
        if settings.solves_models() {
            result.measures.measure_as_a_model();
        }
        let time_step_secs = settings.parameters.time_step_secs;
        // Only the step of a solver can be unsolved: other steppers have no tolerance that their residual could miss.
        let is_solved = last_stepper.is_none_or(Stepper::uses_method);
        result.report.converged &= !is_solved || result.measures.residual.is_finite();
        *observables =
            observables::after_step(stage, result, time_step_secs, observables, *initial_heights);
        if result.turned_bonds > 0 {
            watch.count_turned_bonds(settings, observables, result.turned_bonds);
        }
    }

    fn look(&mut self) -> Result<&Observables> {
        // A state whose kinetic energy overflows counts as not finite, too, because nothing can be measured of it.
        let finite = self.state.is_finite() && self.observables.kinetic_energy.is_finite();
        let Self { state, settings, watch, observables, .. } = self;
        // Does not count `dem`, whose springs return stored energy, nor `avbd`, whose works do not balance its energy.
        let is_balanced = |stepper| !matches!(stepper, Stepper::Dem | Stepper::Avbd);
        if finite && self.last_stepper.is_some_and(is_balanced) {
            watch.count_work(state, settings, observables);
        }
        watch.look(state, settings, observables, finite);
        if finite {
            return Ok(&self.observables);
        }
        let advice = watch.advice_on_overflow(settings);
        let Observables { step, time_secs, .. } = self.observables;
        let Parameters { bond, time_step_secs, restitution, friction, .. } =
            self.settings.parameters;
        Err(Error::NonFinite {
            step,
            time_secs,
            bond,
            time_step_secs,
            restitution,
            friction,
            advice,
        })
    }

    /// Finds the contacts at the present positions, and computes the observables as for an initial state.
    pub(super) fn observe_start(&mut self) {
        let Self { state, settings, slots, memory, observables, initial_heights, .. } = self;
        with_model!(state.leanest_model(&settings.parameters), M => {
            memory.prepare(&mut Stage::<M>::new(state, M::slot(slots)), settings);
            *observables = observables::at_start::<M>(state, settings, *initial_heights);
        });
    }

    /// Passes the contact problem of the next step to `visitor`, as the solver will first receive it: for the first
    /// piece if the step is divided into pieces, and with the velocities after collisions if collisions are solved
    /// separately. Does not change this simulation.
    pub fn next_problem<V: ProblemVisitor>(&self, visitor: V) -> V::Output {
        let (parts, mut slots, contacts) = self.prepared();
        with_model!(parts, M => visitor.visit::<M>(&mut M::slot(&mut slots).problem, &contacts))
    }

    /// Prepares the next step in a copy. Returns the mechanics that the step computes (such as friction), its contact
    /// problem and its contacts. Not generic, so that it is compiled only in this crate.
    fn prepared(&self) -> (ModelParts, Slots, ContactList) {
        let Self { mut state, settings, mut slots, mut memory, .. } = self.clone();
        let parts = state.leanest_model(&settings.parameters);
        state.contacts.begin_step(self.observables.step + 1);
        let pieces = remedies::pieces(&state, &settings);
        let settings = &settings.over(settings.parameters.time_step_secs / f64::from(pieces));
        with_model!(parts, M => {
            memory.set_up(&mut Stage::<M>::new(&mut state, M::slot(&mut slots)), settings);
        });
        (parts, slots, state.contacts)
    }

    /// Returns the world in its present state.
    pub fn world(&self) -> &World {
        &self.state.world
    }

    /// Returns the contacts of the last step.
    pub fn contacts(&self) -> &ContactList {
        &self.state.contacts
    }

    /// Returns the physics that this simulation computes, such as friction and rotation.
    pub fn physics(&self) -> Physics {
        self.state.physics
    }

    /// Returns the settings of the next step.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Returns the parameters of the next step.
    pub fn parameters(&self) -> &Parameters {
        &self.settings.parameters
    }

    /// Returns the solver settings of the next step.
    pub fn solver(&self) -> &SolverSettings {
        &self.settings.solver
    }

    /// Changes the settings from the next step on.
    ///
    /// # Errors
    /// The error names the first setting that is out of range or does not suit the world; then no setting changes.
    pub fn change(&mut self, settings: Settings) -> Result<()> {
        settings.validate()?;
        settings.check_in(&self.state.world, self.state.physics)?;
        self.state.world.tilt(settings.parameters.tilt.to_radians());
        if settings.parameters.time_step_secs != self.settings.parameters.time_step_secs {
            self.steady = Steady::since(&self.observables);
        }
        let is_start = self.observables.step == 0 && self.last_stepper.is_none();
        if settings != std::mem::replace(&mut self.settings, settings) && is_start {
            self.begin_again()?;
        }
        Ok(())
    }

    /// Detects the contacts of the initial state again, because their order depends on the stepper. So a simulation
    /// whose settings change before its first step equals, bit for bit, a simulation created with these settings.
    fn begin_again(&mut self) -> Result<()> {
        let state = &mut self.state;
        state.candidates = state.candidates.unbuilt(&state.world)?;
        state.contacts = ContactList::default();
        state.time_step_of_impulses_secs = self.settings.parameters.time_step_secs;
        (self.slots, self.memory) = Default::default();
        self.observe_start();
        Ok(())
    }

    /// Changes the parameters from the next step on.
    ///
    /// # Errors
    /// The errors of [`Self::change`].
    pub fn set_parameters(&mut self, parameters: Parameters) -> Result<()> {
        self.change(Settings { parameters, ..self.settings })
    }

    /// Changes the solver settings from the next step on.
    ///
    /// # Errors
    /// The errors of [`Simulation::change`].
    pub fn set_solver(&mut self, solver: SolverSettings) -> Result<()> {
        self.change(Settings { solver, ..self.settings })
    }

    /// Returns the spring with which the user pulls a grain in the next step, if there is one.
    pub fn pull(&self) -> Option<Pull> {
        self.state.pull
    }

    /// Attaches a spring to a grain from the next step on, or removes the present spring if `pull` is `None`, names no
    /// grain of this simulation, or has a target that is not finite.
    pub fn set_pull(&mut self, pull: Option<Pull>) {
        let exists = |pull: &Pull| (pull.grain as usize) < self.state.world.grains.len();
        self.state.pull = pull.filter(|pull| exists(pull) && pull.target.is_finite());
    }

    /// Returns the measurements after the last step, or of the initial state before the first step.
    pub fn observables(&self) -> &Observables {
        &self.observables
    }

    /// Returns the alarms (warnings of a failure) raised so far, at most one of each kind.
    pub fn alarms(&self) -> &[Alarm] {
        &self.watch.alarms
    }

    /// Returns the alarm that the next step will raise because grains were placed in overlap; `None` if they were not.
    pub fn alarm_on_placed(&self) -> Option<Alarm> {
        self.watch.of_placed(&self.observables, &self.settings)
    }

    /// Clears the alarms. Each kind of alarm is raised only once, so this allows a run that continues with other
    /// settings to raise them again. Alarms on grains that went through a wall or left the world stay.
    pub fn forget_alarms(&mut self) {
        let stays = [AlarmKind::GrainLost, AlarmKind::GrainLeft];
        self.watch.alarms.retain(|alarm| stays.contains(&alarm.kind));
    }

    /// Returns the number of the step that ends nearest to the simulated time `secs` (s) if Δt stays constant.
    pub fn step_at(&self, secs: f64) -> u64 {
        self.steady.step_at(secs, &self.settings.parameters)
    }

    /// True if this grain went through a wall or left the world.
    pub(super) fn is_lost(&self, grain: usize) -> bool {
        self.watch.losses.lost[grain]
    }

    /// Returns the simulated time, s.
    pub fn time_secs(&self) -> f64 {
        self.observables.time_secs
    }
}

/// Step number and simulated time (s) at the last change of the time step Δt.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Steady {
    step: u64,
    time_secs: f64,
}

impl Steady {
    fn since(observables: &Observables) -> Self {
        let Observables { step, time_secs, .. } = *observables;
        Self { step, time_secs }
    }

    /// Returns the number of the step that ends nearest to the simulated time `secs` (s) if Δt stays constant.
    fn step_at(self, secs: f64, parameters: &Parameters) -> u64 {
        self.step.saturating_add(parameters.steps_in(secs - self.time_secs))
    }
}

/// Visitor that receives the contact problem of the next step before it is solved ([`Simulation::next_problem`]).
pub trait ProblemVisitor {
    /// Result that the visitor returns.
    type Output;
    /// Receives the contact problem. Row `k` of the problem describes contact `problem.rows.contacts[k]` in `contacts`.
    fn visit<M: Model>(self, problem: &mut StepProblem<M>, contacts: &ContactList) -> Self::Output;
}

impl Serialize for Simulation {
    fn serialize<S: Serializer>(&self, serializer: S) -> std::result::Result<S::Ok, S::Error> {
        Self::serialize(self, serializer)
    }
}

impl<'de> Deserialize<'de> for Simulation {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> std::result::Result<Self, D::Error> {
        Self::deserialize(deserializer)?.complete().map_err(D::Error::custom)
    }
}

impl Simulation {
    /// Checks that the parts of a simulation read from a file fit together, because no later code checks this.
    /// Recomputes the data that a file omits.
    fn complete(mut self) -> Result<Self> {
        self.settings.validate()?;
        self.state.physics.validate()?;
        self.state.world.validate(self.state.physics)?;
        self.settings.check_in(&self.state.world, self.state.physics)?;
        self.state.candidates = self.state.candidates.complete(&self.state.world)?;
        let Self { state, watch, .. } = &self;
        let grains = state.world.grains.len();
        let bodies = grains + state.world.fixed_discs.len() + state.candidates.features().len();
        let is_pull = state.pull.is_none_or(|pull| (pull.grain as usize) < grains);
        let forces = state.body_forces.len();
        for (field, is_sound) in [
            ("contacts", state.contacts.is_sound(bodies, grains)),
            ("watch", watch.losses.is_of(grains)),
            ("pull", is_pull),
            ("body_forces", forces == 0 || forces == grains),
        ] {
            check(is_sound, field, "of other grains", "of those of the state")?;
        }
        let is_hand = !state.is_held || !state.world.motions.is_empty();
        check(is_hand, "hand", "on no wall", "on the wall of the last motion")?;
        Ok(self)
    }
}
