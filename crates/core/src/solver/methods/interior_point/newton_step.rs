//! One step along the path: predictor, corrector, and corrections of the products that would be far off.

use super::InteriorPoint;
use super::local::{Contact, Direction};
use super::memory::Workspace;
use super::shape::{PAIRS, Shape};
use super::system::{for_each_change, push_all};
use crate::solver::problem::Model;

/// Least and largest share of the present mean product that a step aims at.
const AIMS: [f64; 2] = [1e-6, 1.0];
/// Share of the longest step that is taken: what is left keeps all off the border.
const OFF_BORDER: f64 = 0.999;
/// Products of a predictor's step count up to so many times the mean product.
const MOST_SECOND_ORDER: f64 = 1e3;
/// Further corrections of a step that is shorter than [`LONG_ENOUGH`].
const CORRECTIONS: u32 = 3;
/// See [`CORRECTIONS`].
const LONG_ENOUGH: f64 = 0.98;
/// Products beyond these shares of the aim are corrected.
const NEAR_AIM: [f64; 2] = [0.1, 10.0];
/// What a correction has to gain in the length of the step.
const WORTH_A_SOLVE: f64 = 0.02;

impl<M: Model, S: Shape, const D: usize> InteriorPoint<'_, M, S, D> {
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
        let Workspace { contacts, targets, step, .. } = &mut *self.workspace;
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
        let Workspace { contacts, step, .. } = &mut *self.workspace;
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
        let Workspace { contacts, step, .. } = &*self.workspace;
        let (mut sum, mut pairs) = (0.0, 0);
        for (at, contact) in contacts.iter().enumerate() {
            let step = if share > 0.0 { step[at] } else { Direction::default() };
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
        let Workspace { contacts, targets, step, other_step, .. } = &mut *self.workspace;
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
        let Workspace { step, other_step, .. } = &mut *self.workspace;
        std::mem::swap(step, other_step);
        None
    }

    /// Makes contacts ready at the present velocities, and sets up and factorises the system of their steps.
    fn assemble(&mut self) {
        let Self { problem, workspace, shared, .. } = self;
        let Workspace { graph, system, contacts, .. } = &mut **workspace;
        let mut of_contacts = contacts.iter_mut();
        problem.for_each_velocity(&problem.bodies, |_, [normal, tangential]| {
            let Some(contact) = of_contacts.next() else { return };
            contact.velocity = [normal + contact.opening, tangential];
            contact.stiffen::<S>(*shared);
        });
        let answers = contacts.iter().map(|contact| contact.stiffness::<S>(*shared));
        system.assemble::<M, S>(problem, graph, answers);
    }

    /// Finds the step to the targets, with the factors that there are; the largest share that can be taken.
    fn find_step(&mut self) -> f64 {
        let Self { problem, workspace, shared, .. } = self;
        let Workspace { graph, system, vector, contacts, targets, step, .. } = &mut **workspace;
        let elimination = &graph.elimination;
        vector.clear();
        vector.resize(problem.bodies.len(), [0.0; D]);
        let loads = contacts.iter().zip(&*targets);
        let loads = loads.map(|(contact, targets)| contact.load::<S>(*shared, targets));
        push_all::<M, D>(problem, elimination, loads, vector);
        system.solve::<S>(elimination, vector);
        step.clear();
        let mut share: f64 = 1.0;
        for_each_change::<M, D>(problem, elimination, vector, |number, change| {
            let contact = &contacts[number];
            let direction = contact.direction::<S>(*shared, &targets[number], change);
            share = share.min(contact.longest::<S>(&direction));
            step.push(direction);
        });
        share
    }
}

/// The targets of the slacks that a contact has, with their numbers.
#[inline(always)]
fn pairs<'a, S: Shape>(
    contact: &Contact,
    targets: &'a mut [f64; PAIRS],
) -> impl Iterator<Item = (usize, &'a mut f64)> {
    targets.iter_mut().enumerate().take(contact.end::<S>()).skip(S::FIRST)
}
