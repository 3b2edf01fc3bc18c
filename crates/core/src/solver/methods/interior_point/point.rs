//! The state of a solve by the interior point method: its start, the largest allowed impulses, and the tests that end
//! it.

use std::marker::PhantomData;

use super::contact::{ContactNumbers, PAIRS, PathContact, PathStep, Shape};
use super::proximal_contact::ProximalContact;
use super::system::StepMatrix;
use crate::contact::law;
use crate::number::Parts;
use crate::solver::kinematics::Model;
use crate::solver::linear::ContactGraph;
use crate::solver::methods::pass::settles_in;
use crate::solver::methods::stopping::SolveReport;
use crate::solver::problem::{StepProblem, natural_map, velocity_error};
use crate::solver::settings::{FrictionModel, SolverSettings, StopTest};

/// Number of sweeps before the first factorisation: many steps of a pile at rest need no more.
pub(super) const SWEEPS_FIRST: u32 = 4;
/// Sweeps are tried if the quantity that the stopping test limits is at most this many times the tolerance.
const SWEEPS_FROM: f64 = 10.0;
/// Largest allowed impulse, relative to the impulses and velocities at the start of a solve. From a cold start on a
/// pile of 100 layers, impulses grow by a factor of 10⁴.
const LARGEST_IMPULSE: f64 = 1e7;
/// Number of sweeps that may finish a solve.
const SWEEPS_LAST: u32 = 2;

/// Product of slack and multiplier at the first start, divided by the mean square of the change that the natural map
/// would make to the impulses. If it were smaller, contacts would change between open, stick and slip only slowly; if
/// it were larger, a warm start would be lost.
const CENTRE: f64 = 1e3;
/// Factor of the product of slack and multiplier from one start to the next.
const FURTHER_UP: f64 = 1e3;
/// Friction bounds below this fraction of the root mean square change of the impulses count as 0, because there is no
/// room between them.
const LEAST_BOUND: f64 = 1e-10;

/// Work memory of a solve whose bodies have `D` degrees of freedom.
#[derive(Clone, Debug, Default)]
pub(super) struct PathWorkspace<const D: usize> {
    pub graph: ContactGraph,
    pub system: StepMatrix<D>,
    /// Right-hand side of the linear system in elimination order, then its solution, the change of the velocities.
    pub vector: Vec<[f64; D]>,
    /// The contacts of the rows. The next three vectors also have one entry per row.
    pub contacts: Vec<PathContact>,
    pub targets: Vec<[f64; PAIRS]>,
    pub step: Vec<PathStep>,
    pub other_step: Vec<PathStep>,
    /// Impulses (σ, λ_t) of the rows with the smallest residual so far, m/s.
    pub best: Vec<[f64; 2]>,
    /// Impulses (σ, λ_t) of the rows at the start of the solve, m/s.
    pub first: Vec<[f64; 2]>,
    /// The contacts of the rows in the proximal multiplier method.
    pub near: Vec<ProximalContact>,
    /// Momenta M(V − V_free) of the bodies in the proximal multiplier method, in elimination order, kg m/s.
    pub momenta: Vec<[f64; D]>,
    /// True for each body with a contact that limited the last step.
    pub stopped: Vec<bool>,
}

/// The state of a solve by the interior point method.
pub(super) struct InteriorPoint<'a, M: Model, S, const D: usize> {
    pub problem: &'a mut StepProblem<M>,
    pub settings: &'a SolverSettings,
    pub workspace: &'a mut PathWorkspace<D>,
    pub numbers: ContactNumbers,
    pub report: SolveReport,
    /// Largest shifted normal impulse σ that a solution may have, m/s.
    pub largest_impulse: f64,
    /// The smallest residual of the natural map so far; `workspace.best` has its impulses.
    pub best: f64,
    pub shape: PhantomData<S>,
}

impl<'a, M: Model, S: Shape, const D: usize> InteriorPoint<'a, M, S, D> {
    pub(super) fn new(
        problem: &'a mut StepProblem<M>,
        settings: &'a SolverSettings,
        workspace: &'a mut PathWorkspace<D>,
    ) -> Self {
        let numbers = ContactNumbers {
            slope: if S::CONE || S::LEANS { problem.law.friction } else { 0.0 },
            tangential_compliance: M::TANGENTIAL_COMPLIANCE,
        };
        Self {
            problem,
            settings,
            workspace,
            numbers,
            report: SolveReport::default(),
            largest_impulse: f64::INFINITY,
            best: f64::INFINITY,
            shape: PhantomData,
        }
    }

    /// Performs up to `sweeps` sweeps. Returns true if the stopping test is met.
    pub(super) fn settles_in(&mut self, sweeps: u32) -> bool {
        let sweeps = sweeps.min(self.settings.max_sweeps - self.report.sweeps);
        settles_in(self.problem, self.settings, sweeps, &mut self.report)
    }

    /// Returns true if the quantity that the stopping test limits is at most `times` the tolerance. `left` is the
    /// residual of the natural map.
    pub(super) fn is_within(&self, left: f64, times: f64) -> bool {
        let tolerance = times * self.settings.tolerance;
        match self.settings.stop {
            StopTest::VelocityError => velocity_error(self.problem).is_within(tolerance),
            _ => left <= tolerance,
        }
    }

    /// Performs sweeps that may end the solve, if the solution is near enough: sweeps set impulses exactly to their
    /// bounds. If the sweeps do not end the solve, returns to the present point of the path.
    pub(super) fn finishes(&mut self, left: f64) -> bool {
        if !self.is_within(left, SWEEPS_FROM) || !self.is_bounded() {
            return false;
        }
        let finished = self.settles_in(SWEEPS_LAST);
        if !finished {
            self.take_impulses();
        }
        finished
    }

    /// Sets the impulses of the rows to the present point of the path, and the bodies to the velocities that follow
    /// from them.
    pub(super) fn take_impulses(&mut self) {
        let contacts = &self.workspace.contacts;
        self.problem.write_impulses(contacts.iter().map(|contact| contact.impulse));
    }

    /// Records the impulses at the start of the solve, and the largest impulse that a solution may have.
    pub(super) fn begin(&mut self) {
        let Self { problem, workspace, .. } = self;
        problem.rows.read_impulses(&mut workspace.first);
        let mut largest: f64 = 0.0;
        problem.for_each_velocity(&problem.bodies.now, |row, [normal, tangential]| {
            let closing = (normal + row.restitution_velocity).abs();
            largest = largest.max(row.shifted_impulse + closing).max(tangential.abs());
        });
        self.largest_impulse = LARGEST_IMPULSE * largest;
        self.keep(natural_map(self.problem));
    }

    /// Returns true if no impulse is larger than a solution may have. On a path that does not lead to a solution
    /// impulses grow, and all changes become small relative to them.
    pub(super) fn is_bounded(&self) -> bool {
        let contacts = &self.workspace.contacts;
        contacts.iter().all(|contact| contact.impulse[0] <= self.largest_impulse)
    }

    /// Tests the impulses of the rows in the same way as [`Self::is_bounded`] tests the impulses of the path.
    pub(super) fn has_bounded_rows(&self) -> bool {
        self.problem.rows().all(|(_, row)| row.shifted_impulse <= self.largest_impulse)
    }

    /// Records the impulses of the rows, whose residual is `left`, as the best impulses so far.
    pub(super) fn keep(&mut self, left: f64) {
        self.best = left;
        self.problem.rows.read_impulses(&mut self.workspace.best);
    }

    pub(super) fn go_back(&mut self) {
        self.problem.write_impulses(self.workspace.best.iter().copied());
    }

    /// Moves to the point of the path that is nearest to the result of one update of the natural map. `starts_before`
    /// is the number of earlier starts of this solve, each of which moves the next start further from the end of the
    /// path.
    pub(super) fn start(&mut self, starts_before: u32) {
        let Self { problem, workspace, numbers, .. } = self;
        let opening_lags = problem.friction.model != FrictionModel::Tresca && S::CONE;
        let contacts = &mut workspace.contacts;
        contacts.clear();
        let compliance = 1.0 / M::TANGENTIAL_COMPLIANCE;
        let (mut squares, mut number) = (0.0, 0);
        problem.for_each_velocity(&problem.bodies.now, |row, [normal, tangential]| {
            let lagged = problem.friction.now.get(number).copied().unwrap_or(0.0);
            number += 1;
            let (bound, extra) = if opening_lags { (0.0, lagged) } else { (lagged, 0.0) };
            let trial = [
                row.shifted_impulse - normal - (row.restitution_velocity + extra),
                row.tangential_impulse - compliance * tangential,
            ];
            squares += (row.shifted_impulse - trial[0].positive_part()).powi(2);
            if M::FRICTION {
                let allowed = if S::CONE || S::LEANS {
                    problem.law.friction * row.shifted_impulse
                } else {
                    bound
                };
                squares += (row.tangential_impulse - law::coulomb(trial[1], allowed)).powi(2);
            }
            // `velocity` temporarily contains the trial impulses.
            contacts.push(PathContact {
                bound,
                lag: extra,
                velocity: trial,
                compliance: S::COMPLIANCE,
                ..PathContact::default()
            });
        });
        let mean_square = squares / contacts.len() as f64;
        let centre = CENTRE * mean_square * FURTHER_UP.powi(starts_before as i32);
        let least = LEAST_BOUND * mean_square.sqrt();
        for contact in contacts {
            if contact.bound < least {
                contact.bound = 0.0;
            }
            let trial = contact.velocity;
            contact.centre::<S>(*numbers, trial, centre);
        }
        self.take_impulses();
    }
}
