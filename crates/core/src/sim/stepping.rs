//! What all ways to step share: the step's problem on its stage, the cut into pieces, the step's result.

use crate::contact::{ContactList, InTouch, LookAhead};
use crate::sim::settings::Settings;
use crate::sim::state::State;
use crate::solver::{
    Approach, BodySystem, Measures, Memory, Model, MovingSurfaces, ProblemNumbers, Slot,
    SolveReport, StepProblem, cone_of, measure, solve,
};
use crate::world::World;

/// What a step came to.
#[derive(Clone, Copy, Debug, Default)]
pub struct StepResult {
    /// How its problems were solved.
    pub report: SolveReport,
    /// Residual, contacts and works.
    pub measures: Measures,
    /// Work of gravity, body forces and a spring that pulls, J.
    pub gravity_work: f64,
    /// Work of the forces that drive walls, less what their damping took, J.
    pub drive_work: f64,
    /// Of a law with bonds.
    pub bonds: Option<BondEnergies>,
    /// Bonds that ended because their pairs turned, where a bond lives while its gap is below zero.
    pub turned_bonds: u64,
}

/// What bonds took and gave, J.
///
/// A bond that is opened by s has taken C₀ s. It gives that back where it closes, and keeps it where
/// it breaks. So its work is −Δ(C₀ s), and that of its last step −C₀ (opening) until then, with the
/// impulse b m_ij of the time that it lived: −b m_ij ½(v⁺ + v^n), which leaves C₀δ_c in all. What a
/// contact does beyond that is the work of the grains' push on each other.
#[derive(Clone, Copy, Debug, Default)]
pub struct BondEnergies {
    /// Work of this step.
    pub work: f64,
    /// Σ C₀ s of the bonds that live.
    pub stored: f64,
    /// What the bonds took that broke in this step.
    pub broken: f64,
}

impl StepResult {
    /// Of a step in which nothing has happened yet.
    pub fn nothing_yet() -> Self {
        Self { report: SolveReport::nothing_yet(), ..Self::default() }
    }

    /// Counts another piece of the step; what it measures at its end counts for the whole.
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

/// A way to step: one of the registry, or one of your own
/// ([`Simulation::step_by`](crate::sim::Simulation::step_by)).
pub trait Advance {
    /// Takes the state through a step of `settings.parameters.time_step_secs`, and tells what came of it.
    fn advance<M: Model>(&mut self, stage: &mut Stage<'_, M>, settings: &Settings) -> StepResult;
}

/// What a way to step works on. The usual course is [`Stage::prepare`], [`Stage::solve`], [`Stage::move_by`].
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

    /// The world as it is now.
    pub fn world(&self) -> &World {
        &self.state.world
    }

    /// The step's contact problem, once it is prepared.
    pub fn problem(&self) -> &StepProblem<M> {
        self.problem
    }

    /// The same for a method of your own, whose impulses move the bodies ([`BodySystem::new`]).
    pub fn system(&mut self) -> BodySystem<'_, M> {
        BodySystem::new(self.problem)
    }

    /// The contacts of the step; row k of the problem is contact `problem.rows.contacts[k]` of them.
    pub fn contacts(&self) -> &ContactList {
        &self.state.contacts
    }

    /// Begins a step and sets up its problem with the contacts that touch. `rebound` is what the law adds
    /// to v_n of a contact, m/s.
    pub fn prepare(
        &mut self,
        settings: &Settings,
        rebound: impl Fn(Approach) -> f64 + Copy + Sync,
    ) {
        self.prepare_ahead(settings, |_| None, rebound);
    }

    /// The same for a law of finite range that goes by the gap: the contacts are the pairs that are no farther apart than
    /// `range` (m) as the step begins, and all of them pull.
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
        // Each contact has the capture speed of the law.
        self.problem.rows.captures.clear();
    }

    /// The same with the contacts that the step may come to as well, as far as `look_ahead` says of a step
    /// that has begun.
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
        let State { world, physics, contacts, walls, .. } = &mut **state;
        let capture_speed = if physics.cohesion {
            parameters.capture_speed(world.gravity.magnitude())
        } else {
            0.0
        };
        let numbers = ProblemNumbers {
            time_step_secs,
            friction: parameters.friction,
            capture_speed,
            cone: cone_of(*physics, parameters),
        };
        let surface_of = |contact: &_| walls.surface(world, contact);
        let surfaces = walls.any_move().then(|| MovingSurfaces {
            driven: walls.driven(world, time_step_secs).collect(),
            of: &surface_of,
        });
        problem.prepare(world, contacts, numbers, &settings.solver, rebound, surfaces);
        for push in pushes {
            push.apply::<M>(&mut problem.bodies.free);
            push.apply::<M>(&mut problem.bodies.now);
        }
    }

    /// Solves the prepared problem by the method of the settings.
    pub fn solve(&mut self, settings: &Settings) -> SolveReport {
        self.timed(|stage| solve(stage.problem, stage.memory, &settings.solver))
    }

    /// Does what is part of solving.
    pub(super) fn timed<T>(&mut self, solving: impl FnOnce(&mut Self) -> T) -> T {
        let begun = self.state.stopwatch.now();
        let outcome = solving(self);
        let stopwatch = &mut self.state.stopwatch;
        stopwatch.times.solving_secs += stopwatch.now() - begun;
        outcome
    }

    /// Moves the grains by the solution of the problem, for Δt.
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

    /// Cuts a step into pieces of equal length and takes them one after the other: `piece` gets the
    /// settings of a piece and adds what came of it to the result of the whole. A state that is no longer
    /// finite ends it early.
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
