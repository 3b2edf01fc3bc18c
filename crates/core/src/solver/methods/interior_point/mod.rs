//! A primal–dual interior point with a sparse direct factorisation.
//!
//! A convex model of friction (`problem::friction`) asks for the impulses p that make
//!
//! > ½‖V‖²_M + Σ m_ij s·σ,  V = V_free + M⁻¹ Hᵀ m (p − c),
//!
//! least among those that it allows; V is unique. With slacks and multipliers (`contact`) the solution is where
//! all their products are 0, and the method follows the path on which they are equal and fall (S. Mehrotra,
//! 1992, for predictor and corrector; J. Gondzio, 1996, for further corrections). V is always formed from the
//! impulses, so that rounding does not add up, and impulses are eliminated from each Newton step, which leaves
//! one system for the change of the velocities,
//!
//! > (M + Hᵀ m S⁻¹ H) δV = Hᵀ m S⁻¹ b,
//!
//! a positive definite matrix with a block for each body and each pair that touches. How often one is to be
//! factorised hardly depends on the number of contacts, which is what sets the method apart: sweeps and
//! guesses need more of everything on a larger pile.
//!
//! Where steps become short near the end, as on dense piles, whose contacts carry more than they need, proximal
//! multipliers (`proximal`) end the solve; where the path leads nowhere they are tried from far away.
//!
//! A start is the point of the path that is nearest to where the natural map leads from the impulses that sweeps leave,
//! as far along as these are good.
//!
//! Coulomb's law is no convex problem, and its path may turn back (`path`).

mod contact;
mod path;
mod proximal;
mod system;
#[cfg(test)]
mod tests;

use std::marker::PhantomData;

use self::contact::{
    Cone, ContactNumbers, HalfLine, Leaning, PAIRS, PathContact, PathStep, Shape, Strip,
};
use self::proximal::ProximalContact;
use self::system::StepMatrix;
use super::nsgs::{settles_in, solve_models};
use super::stopping::SolveReport;
use super::wedged::{is_wedged, start_cold};
use crate::contact::law;
use crate::number::Parts;
use crate::solver::kinematics::Model;
use crate::solver::linear::ContactGraph;
use crate::solver::problem::{StepProblem, natural_map, velocity_error};
use crate::solver::settings::{FrictionModel, SolverSettings, StopTest};
use crate::world::FrictionCone;

/// Sweeps before the first factorisation: many steps of a pile at rest need no more.
const SWEEPS_FIRST: u32 = 4;
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

/// A workspace for each number of degrees of freedom; those that are not used hold no memory.
#[derive(Clone, Debug, Default)]
pub(crate) struct InteriorMemory {
    one: PathWorkspace<1>,
    two: PathWorkspace<2>,
    three: PathWorkspace<3>,
}

/// What is kept where a body has `D` degrees of freedom.
#[derive(Clone, Debug, Default)]
struct PathWorkspace<const D: usize> {
    graph: ContactGraph,
    system: StepMatrix<D>,
    /// By place: a right-hand side, then the change of the velocities.
    vector: Vec<[f64; D]>,
    /// By row.
    contacts: Vec<PathContact>,
    targets: Vec<[f64; PAIRS]>,
    step: Vec<PathStep>,
    other_step: Vec<PathStep>,
    /// (σ, λ_t) of the rows at the smallest natural map so far.
    best: Vec<[f64; 2]>,
    /// The same as the solve began.
    first: Vec<[f64; 2]>,
    /// Of the proximal multipliers, by row.
    near: Vec<ProximalContact>,
    /// M(V − V_free) of these, by place, kg m/s.
    momenta: Vec<[f64; D]>,
    /// Bodies at which a step was stopped.
    stopped: Vec<bool>,
}

/// Solves a prepared problem under the model of friction that it was prepared for, without the impulses of the step before
/// where friction wedged these. Where the path of Coulomb's law leads nowhere, `go_on` takes over.
pub(super) fn solve<M: Model>(
    problem: &mut StepProblem<M>,
    memory: &mut InteriorMemory,
    settings: &SolverSettings,
    mut go_on: impl FnMut(&mut StepProblem<M>, &SolverSettings) -> SolveReport,
) -> SolveReport {
    let mut is_first = true;
    solve_models(problem, settings, |problem| {
        if std::mem::take(&mut is_first) && is_wedged(problem) {
            start_cold(problem);
        }
        match problem.friction.model {
            _ if !M::FRICTION => convex::<M, HalfLine>(problem, memory, settings),
            FrictionModel::Tresca => convex::<M, Strip>(problem, memory, settings),
            FrictionModel::Associated | FrictionModel::Desaxce => {
                convex::<M, Cone>(problem, memory, settings)
            }
            _ => coulomb(problem, memory, settings, &mut go_on),
        }
    })
}

/// Solves a problem within the bounds of friction that it has.
#[cfg(test)]
pub(crate) fn solve_within_bounds<M: Model>(
    problem: &mut StepProblem<M>,
    settings: &SolverSettings,
) -> SolveReport {
    let memory = &mut InteriorMemory::default();
    if M::FRICTION {
        convex::<M, Strip>(problem, memory, settings)
    } else {
        convex::<M, HalfLine>(problem, memory, settings)
    }
}

fn convex<M: Model, S: Shape>(
    problem: &mut StepProblem<M>,
    memory: &mut InteriorMemory,
    settings: &SolverSettings,
) -> SolveReport {
    let InteriorMemory { one, two, three } = memory;
    match M::DEGREES {
        1 => InteriorPoint::<M, S, 1>::new(problem, settings, one).solve_convex(),
        2 => InteriorPoint::<M, S, 2>::new(problem, settings, two).solve_convex(),
        _ => InteriorPoint::<M, S, 3>::new(problem, settings, three).solve_convex(),
    }
}

/// Follows the path of Coulomb's law as far as it leads, and has another method go on from there. The
/// compressive cone has a corner at σ = c, which no path goes round.
fn coulomb<M: Model>(
    problem: &mut StepProblem<M>,
    memory: &mut InteriorMemory,
    settings: &SolverSettings,
    go_on: impl FnOnce(&mut StepProblem<M>, &SolverSettings) -> SolveReport,
) -> SolveReport {
    let InteriorMemory { two, three, .. } = memory;
    let report = match M::DEGREES {
        _ if problem.law.cone() == FrictionCone::Compressive => SolveReport::default(),
        2 => InteriorPoint::<M, Leaning, 2>::new(problem, settings, two).follow_path(),
        _ => InteriorPoint::<M, Leaning, 3>::new(problem, settings, three).follow_path(),
    };
    let left = settings.max_sweeps.saturating_sub(report.sweeps);
    if report.converged || left == 0 {
        return report;
    }
    let rest = SolverSettings { max_sweeps: left, ..*settings };
    go_on(problem, &rest).after(report)
}

struct InteriorPoint<'a, M: Model, S, const D: usize> {
    problem: &'a mut StepProblem<M>,
    settings: &'a SolverSettings,
    workspace: &'a mut PathWorkspace<D>,
    numbers: ContactNumbers,
    report: SolveReport,
    /// σ beyond this, m/s, is no part of a solution.
    largest_impulse: f64,
    /// The smallest natural map so far, whose impulses are kept.
    best: f64,
    shape: PhantomData<S>,
}

impl<'a, M: Model, S: Shape, const D: usize> InteriorPoint<'a, M, S, D> {
    fn new(
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
    fn settles_in(&mut self, sweeps: u32) -> bool {
        let sweeps = sweeps.min(self.settings.max_sweeps - self.report.sweeps);
        settles_in(self.problem, self.settings, sweeps, &mut self.report)
    }

    /// Takes a step along the path; the share of it that was taken, and the natural map where it leads.
    fn advance(&mut self) -> (f64, f64) {
        let share = self.newton_step();
        self.report.factorisations += 1;
        self.take_impulses();
        let left = natural_map(self.problem);
        if left < self.best && self.is_bounded() {
            self.keep(left);
        }
        (share, left)
    }

    /// True where what the settings stop by is within so many times their tolerance, the natural map being `left`.
    fn is_within(&self, left: f64, times: f64) -> bool {
        let tolerance = times * self.settings.tolerance;
        match self.settings.stop {
            StopTest::VelocityError => velocity_error(self.problem).is_within(tolerance),
            _ => left <= tolerance,
        }
    }

    /// Where the solution is near enough, lets sweeps end the solve: they put on their bounds the impulses
    /// that belong there. Where they do not end it, goes back.
    fn finishes(&mut self, left: f64) -> bool {
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
    fn take_impulses(&mut self) {
        let contacts = &self.workspace.contacts;
        self.problem.write_impulses(contacts.iter().map(|contact| contact.impulse));
    }

    /// Notes what the solve begins with, and how far from it impulses may lead.
    fn begin(&mut self) {
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
    fn is_bounded(&self) -> bool {
        let contacts = &self.workspace.contacts;
        contacts.iter().all(|contact| contact.impulse[0] <= self.largest_impulse)
    }

    /// The same of the rows' impulses.
    fn has_bounded_rows(&self) -> bool {
        self.problem.rows().all(|(_, row)| row.shifted_impulse <= self.largest_impulse)
    }

    /// Keeps the rows' impulses, whose natural map is `left`.
    fn keep(&mut self, left: f64) {
        self.best = left;
        self.problem.rows.read_impulses(&mut self.workspace.best);
    }

    fn go_back(&mut self) {
        self.problem.write_impulses(self.workspace.best.iter().copied());
    }

    /// Begins at the point of the path that is nearest to where the natural map leads.
    fn start(&mut self, starts_before: u32) {
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
