//! Common parts of all steppers: the stage with the step's problem, the division into pieces, and the step's result.

use crate::contact::{ContactList, InTouch, LookAhead};
use crate::sim::settings::Settings;
use crate::sim::state::State;
use crate::solver::{
    Approach, BodySystem, Measures, Memory, Model, MovingSurfaces, NumbersOfContact,
    ProblemNumbers, Slot, SolveReport, StepProblem, cone_of, measure, solve,
};
use crate::world::{Parameters, World};

/// Result of a step.
#[derive(Clone, Copy, Debug, Default)]
pub struct StepResult {
    /// Report of the solves.
    pub report: SolveReport,
    /// Residual, contacts and works.
    pub measures: Measures,
    /// Work of gravity, body forces and a spring that pulls, J.
    pub gravity_work: f64,
    /// Work of the forces that drive walls, minus the loss in the walls' damping, J.
    pub drive_work: f64,
    /// Energies of bonds, under a law with bonds.
    pub bonds: Option<BondEnergies>,
    /// Number of bonds that ended because their pairs turned, under laws whose bonds exist while their gap is
    /// negative.
    pub turned_bonds: u64,
}

/// Energies absorbed and released by bonds, J.
///
/// A bond that is opened by s has absorbed C₀ s. It releases this when it closes, and dissipates it when it breaks.
/// So its work is −Δ(C₀ s). In its last step it is −C₀ times the opening until the break, and with the impulse b m_ij
/// of the time until then it is −b m_ij ½(v⁺ + v^n), which gives C₀δ_c in total. Any further work of a contact is the
/// work of the grains pushing each other.
#[derive(Clone, Copy, Debug, Default)]
pub struct BondEnergies {
    /// Work in this step.
    pub work: f64,
    /// Σ C₀ s of the existing bonds.
    pub stored: f64,
    /// Energy dissipated by the bonds that broke in this step.
    pub broken: f64,
}

impl StepResult {
    /// Result of a step before anything has happened.
    pub fn nothing_yet() -> Self {
        Self { report: SolveReport::nothing_yet(), ..Self::default() }
    }

    /// Adds another piece of the step. Its final measurements become those of the whole step.
    pub fn add(&mut self, piece: Self) {
        let Self { report, measures, gravity_work, drive_work, bonds, turned_bonds } = piece;
        self.report.add(report);
        self.measures.add(measures);
        self.gravity_work += gravity_work;
        self.drive_work += drive_work;
        self.turned_bonds += turned_bonds;
        let earlier = self.bonds.unwrap_or_default();
        self.bonds = bonds.map(|BondEnergies { work, stored, broken }| BondEnergies {
            work: earlier.work + work,
            stored,
            broken: earlier.broken + broken,
        });
    }
}

/// A stepper: one of the registry, or your own ([`Simulation::step_by`](crate::sim::Simulation::step_by)).
pub trait Advance {
    /// Takes the state through a step of `settings.parameters.time_step_secs`, and returns the result.
    fn advance<M: Model>(&mut self, stage: &mut Stage<'_, M>, settings: &Settings) -> StepResult;
}

/// Everything a stepper works on. The usual sequence is [`Stage::prepare`], [`Stage::solve`], [`Stage::move_by`].
#[derive(Debug)]
pub struct Stage<'a, M: Model> {
    pub(crate) state: &'a mut State,
    pub(crate) problem: &'a mut StepProblem<M>,
    pub(crate) part: &'a mut StepProblem<M>,
    pub(crate) memory: &'a mut Memory,
}

impl<'a, M: Model> Stage<'a, M> {
    pub(crate) fn new(state: &'a mut State, slot: &'a mut Slot<M>) -> Self {
        let Slot { problem, part, memory } = slot;
        Self { state, problem, part, memory }
    }

    /// The present world.
    pub fn world(&self) -> &World {
        &self.state.world
    }

    /// The step's contact problem, after it has been prepared.
    pub fn problem(&self) -> &StepProblem<M> {
        self.problem
    }

    /// The step's contact problem for your own solver, whose impulses move the bodies ([`BodySystem::new`]).
    pub fn system(&mut self) -> BodySystem<'_, M> {
        BodySystem::new(self.problem)
    }

    /// The contacts of the step. Row k of the problem is contact `problem.rows.contacts[k]` of this list.
    pub fn contacts(&self) -> &ContactList {
        &self.state.contacts
    }

    /// Begins a step and sets up its problem with the touching contacts. `rebound` returns the term that the law adds
    /// to v_n of a contact, m/s.
    pub fn prepare(
        &mut self,
        settings: &Settings,
        rebound: impl Fn(Approach) -> f64 + Copy + Sync,
    ) {
        self.prepare_ahead(settings, |_| None, rebound);
    }

    /// Like [`prepare`](Self::prepare), for a law of finite range that depends on the gap: the contacts are the pairs
    /// with gaps up to `range` (m) as the step begins, and all of them pull.
    pub fn prepare_within(
        &mut self,
        settings: &Settings,
        range: f64,
        rebound: impl Fn(Approach) -> f64 + Copy + Sync,
    ) {
        let time_step_secs = settings.parameters.time_step_secs;
        let in_touch = InTouch::Within(range);
        let ahead = LookAhead { time_step_secs, distance: range, reach: range, in_touch };
        self.prepare_ahead(settings, |_| Some(ahead), rebound);
        if self.problem.rows.frictions.is_empty() {
            // Each contact has the capture speed of the law.
            self.problem.rows.captures.clear();
        }
    }

    /// Like [`prepare`](Self::prepare), with the contacts that may form within the step, as determined by
    /// `look_ahead` once the step has begun.
    pub(crate) fn prepare_ahead(
        &mut self,
        settings: &Settings,
        look_ahead: impl FnOnce(&State) -> Option<LookAhead>,
        rebound: impl Fn(Approach) -> f64 + Copy + Sync,
    ) {
        let Self { state, problem, .. } = self;
        let parameters = &settings.parameters;
        let time_step_secs = parameters.time_step_secs;
        state.begin(time_step_secs);
        let ahead = look_ahead(state);
        state.detect::<M>(ahead);
        let pushes = state.pushes(M::AXES, time_step_secs);
        let laws = state.pair_laws(parameters);
        let State { world, physics, contacts, candidates, walls, .. } = &mut **state;
        let largest = laws.as_ref().map(|laws| laws.largest(&world.grains));
        let capture_speed = match largest {
            Some([.., cohesion_per_mass]) => cohesion_per_mass * time_step_secs,
            None if physics.cohesion => parameters.capture_speed(world.gravity.magnitude()),
            None => 0.0,
        };
        let bond = largest.map_or(parameters.bond, |_| capture_speed);
        let numbers = ProblemNumbers {
            time_step_secs,
            friction: largest.map_or(parameters.friction, |[friction, ..]| friction),
            rolling_friction: largest
                .map_or(parameters.rolling_friction, |[_, rolling, _]| rolling),
            capture_speed,
            cone: cone_of(*physics, &Parameters { bond, ..*parameters }),
        };
        let numbers_of = laws.map(|laws| {
            let (world, candidates) = (&*world, &*candidates);
            move |contact: &_, mass| laws.numbers(world, candidates, contact, mass)
        });
        let numbers_of = numbers_of.as_ref().map(|of| of as NumbersOfContact<'_>);
        let surface_of = |contact: &_| walls.surface(world, contact);
        let surfaces = walls.any_move().then(|| MovingSurfaces {
            driven: walls.driven(world, time_step_secs).collect(),
            of: &surface_of,
        });
        problem.prepare(world, contacts, numbers, &settings.solver, rebound, surfaces, numbers_of);
        for push in pushes {
            push.apply::<M>(&mut problem.bodies.free);
            push.apply::<M>(&mut problem.bodies.now);
        }
    }

    /// Solves the prepared problem with the solver of the settings.
    pub fn solve(&mut self, settings: &Settings) -> SolveReport {
        self.timed(|stage| solve(stage.problem, stage.memory, &settings.solver))
    }

    /// Runs `solving` and counts its time as solving time.
    pub(super) fn timed<T>(&mut self, solving: impl FnOnce(&mut Self) -> T) -> T {
        let begun = self.state.stopwatch.now();
        let outcome = solving(self);
        let stopwatch = &mut self.state.stopwatch;
        stopwatch.times.solving_secs += stopwatch.now() - begun;
        outcome
    }

    /// Moves the grains for Δt with the solution of the problem.
    pub fn move_by(&mut self, report: SolveReport, settings: &Settings) -> StepResult {
        let Self { state, problem, .. } = self;
        let measures = measure(problem);
        problem.store_impulses(&mut state.contacts);
        let drive_work = state.walls.take_driven(&mut state.world, &problem.walls.driven);
        let mut gravity_work = 0.0;
        for (index, body) in problem.bodies.now.iter().enumerate() {
            M::store(body, &mut state.world, index);
            let (before, free) = (&problem.bodies.before[index], &problem.bodies.free[index]);
            let mass = state.world.grains.masses[index];
            gravity_work += M::work_of_gravity(before, body, free, mass);
        }
        state.integrate::<M>(settings.parameters.time_step_secs);
        StepResult { report, measures, gravity_work, drive_work, ..StepResult::nothing_yet() }
    }

    /// Divides a step into pieces of equal length and takes them one after the other. `piece` receives the settings
    /// of a piece and adds its result to that of the whole step. A state that is no longer finite ends the step
    /// early.
    pub fn in_pieces(
        &mut self,
        count: u32,
        settings: &Settings,
        mut result: StepResult,
        mut piece: impl FnMut(&mut Self, &Settings, &mut StepResult),
    ) -> StepResult {
        let part = settings.over(settings.parameters.time_step_secs / f64::from(count));
        for _ in 0..count {
            piece(self, &part, &mut result);
            if !self.state.is_finite() {
                break;
            }
        }
        result
    }
}
