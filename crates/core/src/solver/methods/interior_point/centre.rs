//! Where a solve begins on the path.

use super::InteriorPoint;
use super::local::Contact;
use super::shape::Shape;
use crate::contact::law;
use crate::solver::friction_model::FrictionModel;
use crate::solver::problem::{Kinematics, Model};

/// The product of slack and multiplier at the start, over the mean square of what the natural map still
/// changes. Smaller, and contacts that end elsewhere than they began are freed slowly; larger, and a warm
/// start is wasted.
const CENTRE: f64 = 1e3;
/// Factor of that product from one start to the next.
const FURTHER_UP: f64 = 1e3;
/// Bounds of friction below this share of the mean change are none: there is nothing between them to move in.
const LEAST_BOUND: f64 = 1e-10;

impl<M: Model, S: Shape, const D: usize> InteriorPoint<'_, M, S, D> {
    /// Begins at the point of the path that is nearest to where the natural map leads.
    pub(super) fn start(&mut self, starts_before: u32) {
        let Self { problem, workspace, shared, .. } = self;
        let holds_opening = problem.friction_model != FrictionModel::Tresca && S::CONE;
        let contacts = &mut workspace.contacts;
        contacts.clear();
        let compliance = 1.0 / M::Kinematics::TANGENTIAL_COMPLIANCE;
        let (mut squares, mut number) = (0.0, 0);
        problem.for_each_velocity(&problem.bodies, |row, [normal, tangential]| {
            let held = problem.held.get(number).copied().unwrap_or(0.0);
            number += 1;
            let (bound, extra) = if holds_opening { (0.0, held) } else { (held, 0.0) };
            let opening = row.restitution_velocity + extra;
            let trial = [
                row.shifted_impulse - normal - opening,
                row.tangential_impulse - compliance * tangential,
            ];
            squares += (row.shifted_impulse - trial[0].max(0.0)).powi(2);
            if M::FRICTION {
                let allowed = if S::CONE || S::LEANS {
                    problem.friction * row.shifted_impulse
                } else {
                    bound
                };
                squares += (row.tangential_impulse - law::coulomb(trial[1], allowed)).powi(2);
            }
            // The trial waits where the velocity will be.
            contacts.push(Contact {
                bound,
                opening,
                velocity: trial,
                compliance: S::COMPLIANCE,
                ..Contact::default()
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
            contact.centre::<S>(*shared, trial, centre);
        }
        self.take_impulses();
    }
}
