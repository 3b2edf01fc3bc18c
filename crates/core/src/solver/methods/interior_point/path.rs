//! Steps along the path, and how far it is followed.
//!
//! A step is a predictor, a corrector, and corrections of the products that would be far off. The path of a convex
//! model leads to its solution.
//!
//! The path of Coulomb's law, which may turn back.
//!
//! Where it does, a Newton step is as long as it likes and next to nothing of it can be taken. The contacts that
//! stop it, and those at the same bodies, are then made soft for a while: their impulses move little in a step,
//! which leads round a fold in a part of the pile while the rest goes on. Sweeps between two starts leave a
//! path that leads nowhere.

use super::contact::{PAIRS, PathContact, PathStep, Shape};
use super::point::{InteriorPoint, PathWorkspace, SWEEPS_FIRST};
use super::system::{for_each_change, push_all};
use crate::solver::kinematics::Model;
use crate::solver::methods::stopping::SolveReport;
use crate::solver::onlooker::{SolveProgress, is_ended};
use crate::solver::problem::{natural_map, velocity_error};

/// Least and largest share of the present mean product that a step aims at.
const AIMS: [f64; 2] = [1e-6, 1.0];
/// Share of the longest step that is taken: what is left keeps all off the border.
const OFF_BORDER: f64 = 0.999;
/// Products of a predictor's step count up to so many times the mean product.
const MOST_SECOND_ORDER: f64 = 1e3;
/// Further corrections of a step that is shorter than [`LONG_ENOUGH`].
const CORRECTIONS: u32 = 3;
const LONG_ENOUGH: f64 = 0.98;
/// Products beyond these shares of the aim are corrected.
const NEAR_AIM: [f64; 2] = [0.1, 10.0];
/// What a correction has to gain in the length of the step.
const WORTH_A_SOLVE: f64 = 0.02;

/// Factorisations without a smaller natural map after which a start is given up.
const PATIENCE: u32 = 15;
/// Where the natural map is below this and not yet small enough, proximal multipliers are to end the solve. On cones they
/// are not tried: paths there do not slow down.
const POLISH_FROM: f64 = 1e-6;
/// Where they did not, they are tried again below this share of it.
const POLISH_AGAIN: f64 = 0.1;
/// Below this share of the velocities' error that sweeps leave the path came nearer to a solution than they. Larger: where
/// there is none, huge impulses are taken for one.
const FAR_NEARER: f64 = 1e-2;
/// Sweeps that stand for a solution where there is none.
const SWEEPS_INSTEAD: u32 = 100;
/// Starts, each further up the path.
const STARTS: u32 = 4;

/// Starts after which the path is left to others.
const FOLDED_STARTS: u32 = 4;
/// Sweeps between two starts.
const SWEEPS_BETWEEN: u32 = 30;
/// Factorisations without half the natural map after which a start is given up.
const FOLDED_PATIENCE: u32 = 8;
/// So many steps in a row that are shorter than [`SHORT_STEP`] end a start, too.
const SHORT_STEPS: u32 = 3;
const SHORT_STEP: f64 = 0.05;
/// Of a step shorter than this, the contacts that stop it are made soft.
const LONG_STEP: f64 = 0.3;
/// Bounds of ε of a contact that is made soft.
const SOFT: [f64; 2] = [1e-3, 1.0];
/// The factor by which that grows.
const SOFTENING: f64 = 30.0;
/// Factor of ε of all others.
const HARDENING: f64 = 0.5;

impl<M: Model, S: Shape, const D: usize> InteriorPoint<'_, M, S, D> {
    /// Takes a step along the path; the share of it that was taken, and the natural map where it leads.
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

    /// Takes a step; the share that was taken.
    pub(super) fn newton_step(&mut self) -> f64 {
        self.assemble();
        let mean = self.mean_product();
        let contacts = self.workspace.contacts.len();
        self.workspace.targets.clear();
        self.workspace.targets.resize(contacts, [0.0; PAIRS]);
        let affine_share = self.find_step();
        let left = self.mean_product_after(affine_share);
        let [least, most] = AIMS;
        // Not `clamp`, which panics where a number is none.
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

    /// Σ x y over their number.
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

    /// Aims anew at products that a longer step would leave far from the aim; the share of the step that can
    /// be taken then, where that is worth it.
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

    /// Makes contacts ready at the present velocities, and sets up and factorises the system of their steps.
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

    /// Finds the step to the targets, with the factors that there are; the largest share that can be taken.
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

    /// Follows the path to its end. Where rounding bars the way, begins again further up.
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
                // Not a number is not below anything.
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
        // Where no velocities satisfy all contacts at once, impulses grow without bound along the path, and nothing is
        // gained. Where that came far nearer to a solution, it was asked for more than rounding allows.
        self.problem.write_impulses(self.workspace.first.iter().copied());
        if !self.settles_in(SWEEPS_INSTEAD)
            && of_path < FAR_NEARER * velocity_error(self.problem).told
        {
            self.go_back();
        }
        self.report.stalled = !self.report.converged && !self.is_spent();
        self.report
    }

    /// True where as many sweeps and factorisations were made as the settings allow, or an onlooker ends the solve.
    pub(super) fn is_spent(&self) -> bool {
        let sweeps = self.report.sweeps + self.report.factorisations;
        sweeps >= self.settings.max_sweeps || is_ended(SolveProgress { sweeps, residual: None })
    }

    /// Follows the path as far as it leads; where that is not to its end, the impulses are the best on the way.
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

    /// Softens what stopped a step of which this share was taken, and hardens the rest.
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

/// The targets of the slacks that a contact has, with their numbers.
#[inline(always)]
fn pairs<'a, S: Shape>(
    contact: &PathContact,
    targets: &'a mut [f64; PAIRS],
) -> impl Iterator<Item = (usize, &'a mut f64)> {
    targets.iter_mut().enumerate().take(contact.end::<S>()).skip(S::FIRST)
}
