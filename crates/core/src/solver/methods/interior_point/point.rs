//! The state of a solve by the interior point method: its first point on the central path, the limit above which
//! impulses do not count as a solution, and the tests that end the solve.

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

/// Number of sweeps before the first factorisation: many time steps of a pile at rest are solved by these sweeps and
/// need no factorisation.
pub(super) const SWEEPS_FIRST: u32 = 4;
/// Error of the impulses, in multiples of the tolerance of the stopping test, at or below which a few sweeps try to
/// finish the solve.
const SWEEPS_FROM: f64 = 10.0;
/// Largest normal impulse that a solution may have, divided by the largest impulse or speed of a contact at the start
/// of a solve (impulses are divided by the effective mass, so that both are in m/s). Without this limit, diverging
/// impulses could count as a solution. In a problem with a solution, a pile of 100 layers, impulses grow by a factor of
/// 10⁴ from zero initial impulses.
const LARGEST_IMPULSE: f64 = 1e7;
/// Number of sweeps that try to finish a solve when the central path is near its end.
const SWEEPS_LAST: u32 = 2;

/// Determines how far from its end a solve starts on the central path: the product of slack and multiplier at the first
/// start, divided by a mean square. This is the mean square of the change of the impulses that one simultaneous update
/// of all contacts by their laws would make. With a smaller number, contacts would change between open, stick and slip
/// only slowly; with a larger number, good initial impulses (warm start) would have no advantage.
const CENTRE: f64 = 1e3;
/// Factor by which the product of slack and multiplier is larger at each further start on the central path.
const FURTHER_UP: f64 = 1e3;
/// A friction bound g counts as 0 if it is below this fraction of the root mean square change that one simultaneous
/// update of all contacts by their laws would make to the initial impulses. The interval from −g to g would otherwise
/// be too narrow for positive slacks at both of its ends.
const LEAST_BOUND: f64 = 1e-10;

/// Work memory of a solve whose bodies have `D` degrees of freedom.
#[derive(Clone, Debug, Default)]
pub(super) struct PathWorkspace<const D: usize> {
    pub graph: ContactGraph,
    pub system: StepMatrix<D>,
    /// Right-hand side of the linear system in elimination order (the order of the bodies in the factorised matrix);
    /// after the solution of the system, the change of the velocities.
    pub vector: Vec<[f64; D]>,
    /// Impulses, slacks and multipliers of all contacts.
    pub contacts: Vec<PathContact>,
    pub targets: Vec<[f64; PAIRS]>,
    pub step: Vec<PathStep>,
    pub other_step: Vec<PathStep>,
    /// The impulses of all contacts that gave the smallest residual so far: normal impulse plus cohesion impulse, and
    /// tangential impulse, divided by the effective mass, m/s.
    pub best: Vec<[f64; 2]>,
    /// Impulses of all contacts at the start of the solve: normal impulse plus cohesion impulse, and tangential
    /// impulse, divided by the effective mass, m/s.
    pub first: Vec<[f64; 2]>,
    /// Impulses and velocities of all contacts in the proximal multiplier method.
    pub near: Vec<ProximalContact>,
    /// Momentum changes of the bodies by contact impulses in the proximal multiplier method, in elimination order (the
    /// order of the bodies in the factorised matrix), kg m/s: the inertia times the difference between
    /// the velocity and the velocity without contacts.
    pub momenta: Vec<[f64; D]>,
    /// True for each body with a contact that limited the length of the last step.
    pub stopped: Vec<bool>,
}

/// The state of a solve by the interior point method.
pub(super) struct InteriorPoint<'a, M: Model, S, const D: usize> {
    pub problem: &'a mut StepProblem<M>,
    pub settings: &'a SolverSettings,
    pub workspace: &'a mut PathWorkspace<D>,
    pub numbers: ContactNumbers,
    pub report: SolveReport,
    /// Limit above which a result does not count as a solution: the largest normal impulse plus cohesion impulse of a
    /// contact, divided by the effective mass, m/s.
    pub largest_impulse: f64,
    /// The smallest residual so far under the friction model of the solve, dimensionless; `workspace.best` has the
    /// impulses with this residual.
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

    /// Performs up to `sweeps` Gauss–Seidel sweeps. Returns true if the stopping test is met.
    pub(super) fn settles_in(&mut self, sweeps: u32) -> bool {
        let sweeps = sweeps.min(self.settings.max_sweeps - self.report.sweeps);
        settles_in(self.problem, self.settings, sweeps, &mut self.report)
    }

    /// Returns true if the error of the present impulses is at most `times` the tolerance. The error is the velocity
    /// error if the stopping test limits the velocity error, otherwise `left`, the residual under the friction model of
    /// the solve.
    pub(super) fn is_within(&self, left: f64, times: f64) -> bool {
        let tolerance = times * self.settings.tolerance;
        match self.settings.stop {
            StopTest::VelocityError => velocity_error(self.problem).is_within(tolerance),
            _ => left <= tolerance,
        }
    }

    /// Tries to finish the solve by a few sweeps, if the error is small enough: unlike the central path, sweeps set
    /// impulses exactly to their bounds. Returns true if the stopping test is then met; otherwise returns to the
    /// present point of the path. `left` is the residual under the friction model of the solve.
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

    /// Sets the impulses of the problem to the present point of the central path, and its bodies to the velocities that
    /// follow from these impulses.
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

    /// Returns true if no normal impulse at the present point of the central path is larger than a solution may have.
    /// On a path that does not lead to a solution, impulses grow without limit. Relative to these impulses all changes
    /// become small, as if the solve converged.
    pub(super) fn is_bounded(&self) -> bool {
        let contacts = &self.workspace.contacts;
        contacts.iter().all(|contact| contact.impulse[0] <= self.largest_impulse)
    }

    /// Returns true if no normal impulse of the problem is larger than a solution may have.
    pub(super) fn has_bounded_rows(&self) -> bool {
        self.problem.rows().all(|(_, row)| row.shifted_impulse <= self.largest_impulse)
    }

    /// Records the present impulses of the problem, whose residual is `left`, as the impulses with the smallest
    /// residual so far.
    pub(super) fn keep(&mut self, left: f64) {
        self.best = left;
        self.problem.rows.read_impulses(&mut self.workspace.best);
    }

    pub(super) fn go_back(&mut self) {
        self.problem.write_impulses(self.workspace.best.iter().copied());
    }

    /// Sets all contacts to a point of the central path, from which the method starts, near the impulses that one
    /// simultaneous update of all contacts by their laws gives. `starts_before` is the number of earlier starts in this
    /// solve, each of which moves the next start further from the end of the path.
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
