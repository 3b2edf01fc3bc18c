//! Newton steps along the central path of the interior point method, and the loops that follow the path.
//!
//! A step aims at a target for each product of a slack and its multiplier. It consists of a predictor, a corrector, and
//! further corrections for products that would be far from their target. The path of a convex friction model leads to
//! its solution.
//!
//! The path of Coulomb's law may turn back. At such a fold a Newton step becomes very long, and only a tiny fraction of
//! the step keeps slacks and multipliers positive (is feasible). The contacts that limit the step, and the other
//! contacts of their bodies, then get a larger regularisation ε (a compliance added to a contact) in the next steps, so
//! that their impulses change little in a step. This leads around a fold in one region of the pile while the rest makes
//! progress. If the path does not lead to a solution, sweeps change the impulses before the next start, so that it is
//! on another path.

use super::contact::{PAIRS, PathContact, PathStep, Shape};
use super::point::{InteriorPoint, PathWorkspace, SWEEPS_FIRST};
use super::system::{for_each_change, push_all};
use crate::solver::kinematics::Model;
use crate::solver::methods::stopping::SolveReport;
use crate::solver::onlooker::{SolveProgress, is_ended};
use crate::solver::problem::{natural_map, velocity_error};

/// Minimum and maximum centring parameter: the target for the products of slacks and multipliers in a step, divided by
/// the present mean product.
const AIMS: [f64; 2] = [1e-6, 1.0];
/// Fraction of the longest feasible step that is taken, so that slacks and multipliers stay positive.
const OFF_BORDER: f64 = 0.999;
/// Limit of the second-order term of the corrector, relative to the mean product of slacks and multipliers. This term
/// is the product of the predicted changes of a slack and its multiplier; a term of larger magnitude is replaced by the
/// limit.
const MOST_SECOND_ORDER: f64 = 1e3;
/// Maximum number of corrections of a step after its corrector. Only steps shorter than [`LONG_ENOUGH`] are corrected.
const CORRECTIONS: u32 = 3;
const LONG_ENOUGH: f64 = 0.98;
/// Range of the product of slack and multiplier, relative to its target. A product outside this range is corrected.
const NEAR_AIM: [f64; 2] = [0.1, 10.0];
/// Minimum increase of the step length, as a fraction of the full Newton step, that a correction must achieve. A
/// correction that achieves less is dropped.
const WORTH_A_SOLVE: f64 = 0.02;

/// Number of consecutive factorisations without a new smallest residual, after which an attempt to follow the central
/// path of a convex model ends.
const PATIENCE: u32 = 15;
/// Residual under the friction model of the solve, dimensionless, at or below which proximal multipliers try to finish
/// the solve. They are not used for `associated` and `desaxce`, whose allowed impulses form a cone, because the central
/// path of these models does not slow down near its end.
const POLISH_FROM: f64 = 1e-6;
/// Condition for another attempt with proximal multipliers after a failed attempt: the residual must be at most this
/// fraction of the residual at the failure.
const POLISH_AGAIN: f64 = 0.1;
/// Maximum ratio of two velocity errors at which the result of the central path is kept although it misses the
/// tolerance: the error at the end of the path, divided by the error after [`SWEEPS_INSTEAD`] sweeps. At a larger ratio
/// the result of the sweeps is used. With a larger maximum, huge impulses would count as a solution of a problem that
/// has no solution.
const FAR_NEARER: f64 = 1e-2;
/// Number of Gauss–Seidel sweeps whose result is used if the central path does not lead to a solution.
const SWEEPS_INSTEAD: u32 = 100;
/// Maximum number of attempts to follow the central path of a convex model. Each attempt starts further from the end of
/// the path.
const STARTS: u32 = 4;

/// Maximum number of attempts to follow the central path of Coulomb's law before another method continues the solve.
const FOLDED_STARTS: u32 = 4;
/// Number of sweeps between two attempts to follow the central path of Coulomb's law.
const SWEEPS_BETWEEN: u32 = 30;
/// Limit of an attempt to follow the central path of Coulomb's law: it ends if the residual does not halve within this
/// number of factorisations.
const FOLDED_PATIENCE: u32 = 8;
/// Number of consecutive short steps after which an attempt to follow the central path of Coulomb's law ends.
const SHORT_STEPS: u32 = 3;
/// Step length, as a fraction of the full Newton step, below which a step along the central path of Coulomb's law
/// counts as short.
const SHORT_STEP: f64 = 0.05;
/// Step length, as a fraction of the full Newton step, below which the contacts that limit the step, and the other
/// contacts of their bodies, get a larger regularisation (a compliance added to a contact).
const LONG_STEP: f64 = 0.3;
/// Minimum and maximum regularisation of a contact that limits a step: a compliance added to the contact, relative to
/// the compliance of a contact whose bodies touch nothing else.
const SOFT: [f64; 2] = [1e-3, 1.0];
/// Factor by which the regularisation (added compliance) of a contact grows per step, if a contact of one of its bodies
/// limits the length of the step.
const SOFTENING: f64 = 30.0;
/// Factor by which the regularisation (added compliance) of a contact falls per step, if no contact of its bodies
/// limits the length of the step.
const HARDENING: f64 = 0.5;

impl<M: Model, S: Shape, const D: usize> InteriorPoint<'_, M, S, D> {
    /// Takes a step along the central path. Returns the step length, as a fraction of the full Newton step, and the
    /// residual after the step under the friction model of the solve, dimensionless.
    pub(super) fn advance(&mut self) -> (f64, f64) {
        let share = self.newton_step();
        self.report.factorisations += 1;
        self.take_impulses();
        let left = natural_map(self.problem);
        if left < self.best && self.is_bounded() {
            self.keep(left);
        }
        (share, left)
    }

    /// Takes a Newton step along the central path, with predictor and corrections. Returns its length as a fraction of
    /// the full Newton step.
    pub(super) fn newton_step(&mut self) -> f64 {
        self.assemble();
        let mean = self.mean_product();
        let contacts = self.workspace.contacts.len();
        self.workspace.targets.clear();
        self.workspace.targets.resize(contacts, [0.0; PAIRS]);
        let affine_share = self.find_step();
        let left = self.mean_product_after(affine_share);
        let [least, most] = AIMS;
        // `max` and `min` replace NaN by a limit; `clamp` would keep NaN.
        let aim = (left / mean).powi(5).max(least).min(most) * mean;
        let most_second_order = MOST_SECOND_ORDER * mean;
        let PathWorkspace { contacts, targets, step, .. } = &mut *self.workspace;
        let all = contacts.iter().zip(targets).zip(&*step);
        for ((contact, targets), step) in all {
            for (pair, target) in pairs::<S>(contact, targets) {
                let product = step.slack[pair] * step.multiplier[pair];
                let product = product.max(-most_second_order).min(most_second_order);
                *target = aim - affine_share * product;
            }
        }
        let mut share = self.find_step();
        for _ in 0..CORRECTIONS {
            if share >= LONG_ENOUGH {
                break;
            }
            let Some(longer) = self.corrected(share, aim.max(1e-3 * mean)) else { break };
            share = longer;
        }
        let share = if share < 1.0 { OFF_BORDER * share } else { 1.0 };
        let PathWorkspace { contacts, step, .. } = &mut *self.workspace;
        for (contact, step) in contacts.iter_mut().zip(&*step) {
            contact.advance::<S>(step, share);
        }
        share
    }

    /// Returns the mean of the products of slacks and multipliers over all contacts, (m/s)², which is 0 at the end of
    /// the central path.
    pub(super) fn mean_product(&self) -> f64 {
        self.mean_product_after(0.0)
    }

    fn mean_product_after(&self, share: f64) -> f64 {
        let PathWorkspace { contacts, step, .. } = &*self.workspace;
        let (mut sum, mut pairs) = (0.0, 0);
        for (at, contact) in contacts.iter().enumerate() {
            let step = if share > 0.0 { step[at] } else { PathStep::default() };
            let end = contact.end::<S>();
            pairs += end - S::FIRST;
            for pair in S::FIRST..end {
                sum += (contact.slack[pair] + share * step.slack[pair])
                    * (contact.multiplier[pair] + share * step.multiplier[pair]);
            }
        }
        sum / pairs as f64
    }

    /// Recomputes the step with corrected targets for the products (slack times multiplier) that a longer step would
    /// move far from `aim`, (m/s)². `share` is the present step length. Returns the new step length, or `None` if the
    /// correction lengthens the step too little.
    fn corrected(&mut self, share: f64, aim: f64) -> Option<f64> {
        let longer = (1.5 * share + 0.2).min(1.0);
        let [least, most] = NEAR_AIM.map(|factor| factor * aim);
        let PathWorkspace { contacts, targets, step, other_step, .. } = &mut *self.workspace;
        for ((contact, targets), step) in contacts.iter().zip(targets).zip(&*step) {
            for (pair, target) in pairs::<S>(contact, targets) {
                let product = (contact.slack[pair] + longer * step.slack[pair])
                    * (contact.multiplier[pair] + longer * step.multiplier[pair]);
                *target += (product.max(least).min(most) - product).max(-most);
            }
        }
        std::mem::swap(step, other_step);
        let corrected = self.find_step();
        if corrected >= share + WORTH_A_SOLVE {
            return Some(corrected);
        }
        let PathWorkspace { step, other_step, .. } = &mut *self.workspace;
        std::mem::swap(step, other_step);
        None
    }

    /// Updates the contacts to the present velocities, and assembles and factorises the linear system of a Newton step.
    fn assemble(&mut self) {
        let Self { problem, workspace, numbers, .. } = self;
        let PathWorkspace { graph, system, contacts, .. } = &mut **workspace;
        let mut of_contacts = contacts.iter_mut();
        problem.for_each_velocity(&problem.bodies.now, |row, [normal, tangential]| {
            let Some(contact) = of_contacts.next() else { return };
            contact.velocity = [normal + (row.restitution_velocity + contact.lag), tangential];
            contact.stiffen::<S>(*numbers);
        });
        let answers = contacts.iter().map(|contact| contact.stiffness::<S>(*numbers));
        system.assemble::<M, S>(problem, graph, answers);
    }

    /// Computes the Newton step to the target products (slack times multiplier) with the present factors of the matrix.
    /// Returns the longest step length, at most 1, that keeps slacks and multipliers positive.
    fn find_step(&mut self) -> f64 {
        let Self { problem, workspace, numbers, .. } = self;
        let PathWorkspace { graph, system, vector, contacts, targets, step, .. } = &mut **workspace;
        let elimination = &graph.elimination;
        vector.clear();
        vector.resize(elimination.body_at.len(), [0.0; D]);
        let loads = contacts.iter().zip(&*targets);
        let loads = loads.map(|(contact, targets)| contact.load::<S>(*numbers, targets));
        push_all(problem, elimination, loads, vector);
        system.solve::<S>(elimination, vector);
        step.clear();
        let mut share: f64 = 1.0;
        for_each_change(problem, elimination, vector, |number, change| {
            let contact = &contacts[number];
            let direction = contact.direction::<S>(*numbers, &targets[number], change);
            share = share.min(contact.longest::<S>(&direction));
            step.push(direction);
        });
        share
    }

    /// Solves a convex problem: follows the central path to its end. If rounding prevents that, starts again further
    /// from the end of the path. If no attempt succeeds, tries proximal multipliers, then sweeps.
    pub(super) fn solve_convex(mut self) -> SolveReport {
        if self.settles_in(SWEEPS_FIRST) {
            return self.report;
        }
        self.workspace.graph.analyse(self.problem);
        self.begin();
        for start in 0..STARTS {
            self.start(start);
            let (mut best, mut since_best) = (f64::INFINITY, 0);
            let mut polish_from = if S::CONE { 0.0 } else { POLISH_FROM };
            while since_best < PATIENCE {
                if self.is_spent() {
                    break;
                }
                let (_, left) = self.advance();
                if self.finishes(left) {
                    return self.report;
                }
                if left <= polish_from {
                    if self.is_bounded() && self.polish() {
                        return self.report;
                    }
                    self.take_impulses();
                    polish_from = POLISH_AGAIN * left;
                }
                // NaN compares false, so a residual of NaN counts as no progress.
                since_best = if left < best { 0 } else { since_best + 1 };
                best = best.min(left);
                if left.is_nan() {
                    break;
                }
            }
            self.go_back();
        }
        if self.solve_from_far() {
            return self.report;
        }
        self.go_back();
        let of_path = velocity_error(self.problem).told;
        // If no velocities satisfy all contacts at once, impulses grow without bound along the path. Then the result of
        // sweeps is used. If the path came much nearer to a solution than sweeps do, the result of the path is kept:
        // the tolerance was smaller than rounding allows.
        self.problem.write_impulses(self.workspace.first.iter().copied());
        if !self.settles_in(SWEEPS_INSTEAD)
            && of_path < FAR_NEARER * velocity_error(self.problem).told
        {
            self.go_back();
        }
        self.report.stalled = !self.report.converged && !self.is_spent();
        self.report
    }

    /// Returns true if sweeps and factorisations together have reached the maximum number of sweeps, or if an onlooker
    /// (a callback that watches the progress) ends the solve.
    pub(super) fn is_spent(&self) -> bool {
        let sweeps = self.report.sweeps + self.report.factorisations;
        sweeps >= self.settings.max_sweeps || is_ended(SolveProgress { sweeps, residual: None })
    }

    /// Follows the central path of Coulomb's law as far as possible. If the end is not reached, the problem keeps the
    /// impulses with the smallest residual.
    pub(super) fn follow_path(mut self) -> SolveReport {
        if self.settles_in(SWEEPS_FIRST) {
            return self.report;
        }
        self.workspace.graph.analyse(self.problem);
        self.begin();
        for start in 0..FOLDED_STARTS {
            if start > 0 && self.settles_in(SWEEPS_BETWEEN) {
                return self.report;
            }
            self.start(0);
            if self.leads_to_end() {
                return self.report;
            }
            self.go_back();
        }
        self.report
    }

    fn leads_to_end(&mut self) -> bool {
        let (mut milestone, mut since_milestone) = (f64::INFINITY, 0);
        let mut short_steps = 0;
        while since_milestone < FOLDED_PATIENCE && short_steps < SHORT_STEPS && !self.is_spent() {
            let (share, left) = self.advance();
            if left.is_nan() {
                return false;
            }
            if self.finishes(left) {
                return true;
            }
            self.soften(share);
            short_steps = if share < SHORT_STEP { short_steps + 1 } else { 0 };
            since_milestone += 1;
            if left < 0.5 * milestone {
                (milestone, since_milestone) = (left, 0);
            }
        }
        false
    }

    /// Increases the regularisation (added compliance) of all contacts of the bodies whose contacts limited the last
    /// step, which had the length `share`. Decreases the regularisation of all other contacts.
    fn soften(&mut self, share: f64) {
        let Self { problem, workspace, .. } = self;
        let PathWorkspace { contacts, step, stopped, .. } = &mut **workspace;
        let [least, most] = SOFT;
        let fixed_count = problem.rows.fixed.len();
        stopped.clear();
        stopped.resize(problem.bodies.now.len(), false);
        if share < LONG_STEP {
            for (number, row) in problem.rows() {
                if contacts[number].longest::<S>(&step[number]) < LONG_STEP {
                    stopped[row.i as usize] = true;
                    if number >= fixed_count {
                        stopped[row.j as usize] = true;
                    }
                }
            }
        }
        for (number, row) in problem.rows() {
            let compliance = &mut contacts[number].compliance;
            let is_near =
                stopped[row.i as usize] || number >= fixed_count && stopped[row.j as usize];
            *compliance = if is_near {
                (SOFTENING * *compliance).max(least).min(most)
            } else {
                (HARDENING * *compliance).max(S::COMPLIANCE)
            };
        }
    }
}

/// Iterates over the constraints that a contact uses. Yields for each the index of its slack and multiplier, and the
/// target for the product of the two.
#[inline(always)]
fn pairs<'a, S: Shape>(
    contact: &PathContact,
    targets: &'a mut [f64; PAIRS],
) -> impl Iterator<Item = (usize, &'a mut f64)> {
    targets.iter_mut().enumerate().take(contact.end::<S>()).skip(S::FIRST)
}
