//! A primal–dual interior point with a sparse direct factorisation.
//!
//! A convex model of friction (`problem::held`) asks for the impulses p that make
//!
//! > ½‖V‖²_M + Σ m_ij s·σ,  V = V_free + M⁻¹ Hᵀ m (p − c),
//!
//! least among those that it allows; V is unique. With slacks and multipliers (`local`) the solution is where
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
//! A start is the point of the path that is nearest to where the natural map leads from the impulses of the
//! step before, as far along as these are good.
//!
//! Coulomb's law is no convex problem, and its path may turn back (`folds`).

mod centre;
mod convex;
mod folds;
mod local;
mod memory;
mod near;
mod newton_step;
mod proximal;
mod shape;
mod system;
#[cfg(test)]
mod tests;

use std::marker::PhantomData;

use self::local::Shared;
pub(super) use self::memory::InteriorMemory;
use self::memory::Workspace;
use self::shape::{Cone, HalfLine, Leaning, Shape, Strip};
use super::info::{MethodInfo, MethodOrder};
use super::method::Method;
use super::newton;
use super::nsgs::{solve_models, sweep_of_model};
use super::report::SolveReport;
use crate::solver::friction_model::FrictionModel;
use crate::solver::problem::{Kinematics, Model, StepProblem, natural_map};
use crate::solver::settings::SolverSettings;

/// What there is to know of it.
pub(super) const INFO: MethodInfo = MethodInfo {
    method: Method::InteriorPoint,
    name: "interior-point",
    summary: "interior point, sparse direct: the convex models of friction to any tolerance",
    solves: "a convex model of friction, with a certificate; Coulomb's law where its path leads there",
    source: "S. Mehrotra, On the implementation of a primal-dual interior point method (1992)",
    order: MethodOrder::OfSettings,
    takes_models: true,
    takes_drives: false,
    takes_shear: true,
};

/// Sweeps before the first factorisation: many steps of a pile at rest need no more.
const SWEEPS_FIRST: u32 = 4;
/// Where the natural map is below so many times the tolerance, sweeps are tried.
const SWEEPS_FROM: f64 = 10.0;
/// Impulses may grow by this factor over those, and the velocities, that a solve begins with: those of a cold
/// start on a pile of 100 layers do by 10⁴.
const LARGEST_IMPULSE: f64 = 1e7;
/// Sweeps that finish a solve.
const SWEEPS_LAST: u32 = 2;

/// How well a problem is solved on which a step falls back.
const CERTIFIED: SolverSettings = SolverSettings {
    friction_model: FrictionModel::Tresca,
    ..SolverSettings::to_residual(Method::InteriorPoint, 1e-8, 1_000)
};

/// Solves a prepared problem under the model of friction that it was prepared for.
pub(super) fn solve<M: Model>(
    problem: &mut StepProblem<M::Kinematics>,
    memory: &mut InteriorMemory,
    settings: &SolverSettings,
) -> SolveReport {
    solve_models::<M>(problem, settings, |problem| match problem.friction_model {
        _ if !M::FRICTION => convex::<M, HalfLine>(problem, memory, settings),
        FrictionModel::Tresca => convex::<M, Strip>(problem, memory, settings),
        FrictionModel::Associated | FrictionModel::Desaxce => {
            convex::<M, Cone>(problem, memory, settings)
        }
        FrictionModel::Coulomb => coulomb::<M>(problem, memory, settings),
    })
}

fn convex<M: Model, S: Shape>(
    problem: &mut StepProblem<M::Kinematics>,
    memory: &mut InteriorMemory,
    settings: &SolverSettings,
) -> SolveReport {
    let InteriorMemory { one, two, three, .. } = memory;
    match M::Kinematics::DEGREES {
        1 => InteriorPoint::<M, S, 1>::new(problem, settings, one).solve_convex(),
        2 => InteriorPoint::<M, S, 2>::new(problem, settings, two).solve_convex(),
        _ => InteriorPoint::<M, S, 3>::new(problem, settings, three).solve_convex(),
    }
}

/// Puts in the place of what a method came to, which did not solve the problem under Coulomb's law, the solution
/// under bounds of friction at those impulses. Where that is not found, leaves them as they are.
///
/// The bounds are nearer to Coulomb's than those of the step before, on which `tresca` stands.
pub(super) fn fall_back<M: Model>(
    problem: &mut StepProblem<M::Kinematics>,
    memory: &mut InteriorMemory,
    report: SolveReport,
) -> SolveReport {
    let mut impulses = std::mem::take(&mut memory.unsolved);
    read_impulses(problem, &mut impulses);
    problem.bound_by_present::<M>();
    let mut instead = SolveReport::default();
    if problem.held.iter().all(|bound| bound.is_finite()) {
        instead = convex::<M, Strip>(problem, memory, &CERTIFIED);
    }
    let fell_back = instead.converged;
    if !fell_back {
        problem.forget_bounds();
        set_impulses(problem, &impulses);
    }
    memory.unsolved = impulses;
    SolveReport { converged: false, stalled: report.stalled, fell_back, ..instead.after(report) }
}

/// Follows the path of Coulomb's law as far as it leads, and has Newton's method go on from there. The
/// compressive cone has a corner at σ = c, which no path goes round.
fn coulomb<M: Model>(
    problem: &mut StepProblem<M::Kinematics>,
    memory: &mut InteriorMemory,
    settings: &SolverSettings,
) -> SolveReport {
    let InteriorMemory { two, three, newton, .. } = memory;
    let report = match M::Kinematics::DEGREES {
        _ if M::COMPRESSIVE_CONE => SolveReport::default(),
        2 => InteriorPoint::<M, Leaning, 2>::new(problem, settings, two).follow_path(),
        _ => InteriorPoint::<M, Leaning, 3>::new(problem, settings, three).follow_path(),
    };
    let left = settings.max_sweeps.saturating_sub(report.sweeps);
    if report.converged || left == 0 {
        return report;
    }
    let rest = SolverSettings { max_sweeps: left, ..*settings };
    newton::solve::<M>(problem, newton, &rest).after(report)
}

/// One solve.
struct InteriorPoint<'a, M: Model, S, const D: usize> {
    problem: &'a mut StepProblem<M::Kinematics>,
    settings: &'a SolverSettings,
    workspace: &'a mut Workspace<D>,
    shared: Shared,
    report: SolveReport,
    /// σ beyond this, m/s, is no part of a solution.
    largest_impulse: f64,
    /// The smallest natural map so far, whose impulses are kept.
    best: f64,
    shape: PhantomData<S>,
}

impl<'a, M: Model, S: Shape, const D: usize> InteriorPoint<'a, M, S, D> {
    fn new(
        problem: &'a mut StepProblem<M::Kinematics>,
        settings: &'a SolverSettings,
        workspace: &'a mut Workspace<D>,
    ) -> Self {
        let shared = Shared {
            slope: if S::CONE || S::LEANS { problem.friction } else { 0.0 },
            tangential_compliance: M::Kinematics::TANGENTIAL_COMPLIANCE,
        };
        Self {
            problem,
            settings,
            workspace,
            shared,
            report: SolveReport::default(),
            largest_impulse: f64::INFINITY,
            best: f64::INFINITY,
            shape: PhantomData,
        }
    }

    /// Sweeps up to so many times; whether the stopping test is met.
    fn settles_in(&mut self, sweeps: u32) -> bool {
        for _ in 0..sweeps.min(self.settings.max_sweeps - self.report.sweeps) {
            self.report.sweeps += 1;
            if sweep_of_model::<M>(self.problem, self.settings) {
                self.report.converged = true;
                break;
            }
        }
        self.report.converged
    }

    /// Takes a step along the path; the share of it that was taken, and the natural map where it leads.
    fn advance(&mut self) -> (f64, f64) {
        let share = self.newton_step();
        self.report.factorisations += 1;
        self.take_impulses();
        let left = natural_map::<M>(self.problem);
        if left < self.best && self.is_bounded() {
            self.keep(left);
        }
        (share, left)
    }

    /// Where the natural map is small enough, lets sweeps end the solve: they put on their bounds the impulses
    /// that belong there. Where they do not end it, goes back.
    fn finishes(&mut self, left: f64) -> bool {
        if left > SWEEPS_FROM * self.settings.tolerance || !self.is_bounded() {
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
        let rows = self.problem.fixed_rows.iter_mut().chain(&mut self.problem.pair_rows);
        for (row, contact) in rows.zip(&self.workspace.contacts) {
            [row.shifted_impulse, row.tangential_impulse] = contact.impulse;
        }
        self.problem.form_velocities();
    }

    /// Notes what the solve begins with, and how far from it impulses may lead.
    fn begin(&mut self) {
        let Self { problem, workspace, .. } = self;
        read_impulses(problem, &mut workspace.first);
        let mut largest: f64 = 0.0;
        problem.for_each_velocity(&problem.bodies, |row, [normal, tangential]| {
            let closing = (normal + row.restitution_velocity).abs();
            largest = largest.max(row.shifted_impulse + closing).max(tangential.abs());
        });
        self.largest_impulse = LARGEST_IMPULSE * largest;
        self.keep(natural_map::<M>(self.problem));
    }

    /// Whether the impulses are of a size that a solution may have. On a path that leads nowhere they grow, and
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
        read_impulses(self.problem, &mut self.workspace.kept);
    }

    /// Goes back to what was kept.
    fn go_back(&mut self) {
        set_impulses(self.problem, &self.workspace.kept);
    }
}

/// (σ, λ_t) of the rows; `impulses` is cleared first.
fn read_impulses<K: Kinematics>(problem: &StepProblem<K>, impulses: &mut Vec<[f64; 2]>) {
    impulses.clear();
    impulses.extend(problem.rows().map(|(_, row)| [row.shifted_impulse, row.tangential_impulse]));
}

/// Gives the rows impulses (σ, λ_t), and the bodies the velocities that they make.
fn set_impulses<K: Kinematics>(problem: &mut StepProblem<K>, impulses: &[[f64; 2]]) {
    let rows = problem.fixed_rows.iter_mut().chain(&mut problem.pair_rows);
    for (row, &impulse) in rows.zip(impulses) {
        [row.shifted_impulse, row.tangential_impulse] = impulse;
    }
    problem.form_velocities();
}
