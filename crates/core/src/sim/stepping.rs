//! Code that all steppers use: the stage (the data on which a stepper works), the division of a step into pieces, and
//! the result of a step.

use crate::contact::{ContactList, InTouch, LookAhead};
use crate::sim::settings::Settings;
use crate::sim::state::State;
use crate::solver::{
    Approach, BodySystem, Measures, Memory, Model, MovingSurfaces, NumbersOfContact,
    ProblemNumbers, Slot, SolveReport, StepProblem, cone_of, measure, solve,
};
use crate::world::{Parameters, World};

/// Result of a step: solver report, measurements and works.
#[derive(Clone, Copy, Debug, Default)]
pub struct StepResult {
    /// Report of the contact solver for the step. If the step is divided into pieces or needs several solves, the
    /// sweeps and factorisations of all of them are added.
    pub report: SolveReport,
    /// Residual of the step, numbers of contacts, and works of the contact forces.
    pub measures: Measures,
    /// Work of gravity, of body forces and of the spring with which the user pulls a grain, in the step, J.
    pub gravity_work: f64,
    /// Work in the step of the forces that drive walls, minus the loss in the walls' damping, J.
    pub drive_work: f64,
    /// Energies that bonds absorbed and released in the step; `None` under a contact law without bonds.
    pub bonds: Option<BondEnergies>,
    /// Number of bonds between two grains that ended in the step because the two grains circled each other, which opens
    /// the gap, and not because of the pull on the bond. The steppers `moreau`, `tgs-soft` and `avbd` count such bonds;
    /// for other steppers the number is 0.
    pub turned_bonds: u64,
}

/// Energies that bonds absorb and release in a step, J.
///
/// A bond with the cohesion force C₀ (N) that is stretched by s (m) has absorbed the energy C₀ s. The bond releases
/// this energy when it closes, and dissipates it when it breaks. So the work of a bond in a step is −C₀ times the
/// change of s. In the step in which a bond breaks, its work is −C₀ times the distance by which the contact opens until
/// the break. The code computes this work as −b m_ij ½(v⁺ + v^n): the negative product of the impulse of the bond until
/// the break, b m_ij (b in m/s, effective mass m_ij in kg), and the mean of two opening speeds of the contact, v⁺ after
/// the collisions of the step and v^n at the end of the step (m/s). A bond that breaks at the stretch δ_c has
/// dissipated C₀δ_c in total. The bond does only a part of the work of a contact's normal force; the rest is done by
/// the repulsion between the grains.
#[derive(Clone, Copy, Debug, Default)]
pub struct BondEnergies {
    /// Work of all bonds in this step, J.
    pub work: f64,
    /// Energy stored in the bonds that exist after this step, J: the sum over these bonds of cohesion force times
    /// stretch.
    pub stored: f64,
    /// Energy dissipated by the bonds that broke in this step, J.
    pub broken: f64,
}

impl StepResult {
    /// Returns the value to which the results of the pieces of a divided step are added: all works are 0, and nothing
    /// has been solved.
    pub fn nothing_yet() -> Self {
        Self { report: SolveReport::nothing_yet(), ..Self::default() }
    }

    /// Adds the result of the next piece of a divided step. Measurements at the end of this piece replace those of
    /// earlier pieces; works and sweeps are added.
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

/// A stepper: one of Slump's own steppers (`moreau`, `range`, `tgs-soft`, `avbd`, `dem`), or a stepper that you write
/// ([`Simulation::step_by`](crate::sim::Simulation::step_by)).
pub trait Advance {
    /// Takes one step of length `settings.parameters.time_step_secs` and returns its result.
    fn advance<M: Model>(&mut self, stage: &mut Stage<'_, M>, settings: &Settings) -> StepResult;
}

/// Data on which a stepper works: the state of the simulation and the contact problem of the step. A stepper usually
/// calls [`Stage::prepare`], [`Stage::solve`] and [`Stage::move_by`], in this order.
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

    /// Returns the world in its present state.
    pub fn world(&self) -> &World {
        &self.state.world
    }

    /// Returns the contact problem of the step, after [`Stage::prepare`] has set it up.
    pub fn problem(&self) -> &StepProblem<M> {
        self.problem
    }

    /// Returns the contact problem of the step in the form in which a solver of your own can read and change its
    /// impulses. Impulses that your solver sets change the velocities of the bodies at once ([`BodySystem::new`]).
    pub fn system(&mut self) -> BodySystem<'_, M> {
        BodySystem::new(self.problem)
    }

    /// Returns the contacts of the step. Row k of the problem describes contact `problem.rows.contacts[k]` of this
    /// list.
    pub fn contacts(&self) -> &ContactList {
        &self.state.contacts
    }

    /// Begins a step: detects the touching pairs and sets up their contact problem. `rebound` returns the term (m/s)
    /// that the contact law adds to the normal velocity v_n of a contact at the end of the step. For the coefficient of
    /// restitution ρ, this term is ρ v_n^{n−1}, with the normal velocity v_n^{n−1} at the beginning of the step.
    pub fn prepare(
        &mut self,
        settings: &Settings,
        rebound: impl Fn(Approach) -> f64 + Copy + Sync,
    ) {
        self.prepare_ahead(settings, |_| None, rebound);
    }

    /// Like [`prepare`](Self::prepare), for a contact law whose pull has a finite range: the contacts are all pairs
    /// with gaps up to `range` (m) at the beginning of the step, and all of them can pull.
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
            // Without pairs of materials, all contacts have the capture speed of the common contact law.
            self.problem.rows.captures.clear();
        }
    }

    /// Like [`prepare`](Self::prepare), with additional contacts for pairs that may touch within the step. `look_ahead`
    /// returns the search distances for these pairs; it is called after the walls have received their velocities of the
    /// step.
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

    /// Solves the contact problem that [`Stage::prepare`] has set up, with the solver of the settings, and returns the
    /// solver's report.
    pub fn solve(&mut self, settings: &Settings) -> SolveReport {
        solve(self.problem, self.memory, &settings.solver)
    }

    /// Moves the grains by one time step Δt with the velocities of the solved problem, and stores the impulses in the
    /// contacts. Returns the result of the step, which contains `report`, the report of the solver.
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

    /// Divides a step into `count` pieces of equal length and takes them one after the other. The closure `piece`
    /// receives the settings of one piece, whose time step is the length of the piece, and adds its result to the
    /// result of the whole step. If a position or velocity is no longer finite, the step ends early.
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
