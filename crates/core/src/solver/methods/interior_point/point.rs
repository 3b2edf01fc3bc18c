//! The interior point of a solve: where it starts, its step, and how it ends.

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

/// Sweeps before the first factorisation: many steps of a pile at rest need no more.
pub(super) const SWEEPS_FIRST: u32 = 4;
/// Within so many times the tolerance sweeps are tried.
const SWEEPS_FROM: f64 = 10.0;
/// Impulses may grow by this factor over those, and the velocities, that a solve begins with: those of a cold
/// start on a pile of 100 layers do by 10⁴.
const LARGEST_IMPULSE: f64 = 1e7;
/// Sweeps that finish a solve.
const SWEEPS_LAST: u32 = 2;

/// The product of slack and multiplier at the start, over the mean square of what the natural map still
/// changes. Smaller, and contacts that end elsewhere than they began are freed slowly; larger, and a warm
/// start is wasted.
const CENTRE: f64 = 1e3;
/// Factor of that product from one start to the next.
const FURTHER_UP: f64 = 1e3;
/// Bounds of friction below this share of the mean change are none: there is nothing between them to move in.
const LEAST_BOUND: f64 = 1e-10;

/// What is kept where a body has `D` degrees of freedom.
#[derive(Clone, Debug, Default)]
pub(super) struct PathWorkspace<const D: usize> {
    pub graph: ContactGraph,
    pub system: StepMatrix<D>,
    /// By place: a right-hand side, then the change of the velocities.
    pub vector: Vec<[f64; D]>,
    /// By row.
    pub contacts: Vec<PathContact>,
    pub targets: Vec<[f64; PAIRS]>,
    pub step: Vec<PathStep>,
    pub other_step: Vec<PathStep>,
    /// (σ, λ_t) of the rows at the smallest natural map so far.
    pub best: Vec<[f64; 2]>,
    /// The same as the solve began.
    pub first: Vec<[f64; 2]>,
    /// Of the proximal multipliers, by row.
    pub near: Vec<ProximalContact>,
    /// M(V − V_free) of these, by place, kg m/s.
    pub momenta: Vec<[f64; D]>,
    /// Bodies at which a step was stopped.
    pub stopped: Vec<bool>,
}

/// An interior point on its way through a solve.
pub(super) struct InteriorPoint<'a, M: Model, S, const D: usize> {
    pub problem: &'a mut StepProblem<M>,
    pub settings: &'a SolverSettings,
    pub workspace: &'a mut PathWorkspace<D>,
    pub numbers: ContactNumbers,
    pub report: SolveReport,
    /// σ beyond this, m/s, is no part of a solution.
    pub largest_impulse: f64,
    /// The smallest natural map so far, whose impulses are kept.
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

    /// Sweeps up to so many times. True where the stopping test is met.
    pub(super) fn settles_in(&mut self, sweeps: u32) -> bool {
        let sweeps = sweeps.min(self.settings.max_sweeps - self.report.sweeps);
        settles_in(self.problem, self.settings, sweeps, &mut self.report)
    }

    /// True where what the settings stop by is within so many times their tolerance, the natural map being `left`.
    pub(super) fn is_within(&self, left: f64, times: f64) -> bool {
        let tolerance = times * self.settings.tolerance;
        match self.settings.stop {
            StopTest::VelocityError => velocity_error(self.problem).is_within(tolerance),
            _ => left <= tolerance,
        }
    }

    /// Where the solution is near enough, lets sweeps end the solve: they put on their bounds the impulses
    /// that belong there. Where they do not end it, goes back.
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

    /// Gives the rows the impulses of the present point, and the bodies the velocities that they make.
    pub(super) fn take_impulses(&mut self) {
        let contacts = &self.workspace.contacts;
        self.problem.write_impulses(contacts.iter().map(|contact| contact.impulse));
    }

    /// Notes what the solve begins with, and how far from it impulses may lead.
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

    /// True where the impulses are of a size that a solution may have. On a path that leads nowhere they grow, and
    /// all changes become small beside them.
    pub(super) fn is_bounded(&self) -> bool {
        let contacts = &self.workspace.contacts;
        contacts.iter().all(|contact| contact.impulse[0] <= self.largest_impulse)
    }

    /// The same of the rows' impulses.
    pub(super) fn has_bounded_rows(&self) -> bool {
        self.problem.rows().all(|(_, row)| row.shifted_impulse <= self.largest_impulse)
    }

    /// Keeps the rows' impulses, whose natural map is `left`.
    pub(super) fn keep(&mut self, left: f64) {
        self.best = left;
        self.problem.rows.read_impulses(&mut self.workspace.best);
    }

    pub(super) fn go_back(&mut self) {
        self.problem.write_impulses(self.workspace.best.iter().copied());
    }

    /// Begins at the point of the path that is nearest to where the natural map leads.
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
            // The trial waits where the velocity will be.
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
