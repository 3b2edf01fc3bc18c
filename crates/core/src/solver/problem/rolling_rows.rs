//! Rolling resistance of the contacts of a problem: sets its coefficients, computes rolling velocities (reduced radius
//! times relative angular velocity of the two bodies, m/s), and stores the rolling impulses (moment times time step,
//! N·m·s) for the next step.

use super::{MovingSurfaces, NumbersOfContact, Rolling, Row, StepProblem};
use crate::contact::{Contact, ContactList, Numbering, Other, law};
use crate::solver::kinematics::Model;
use crate::world::World;

impl<M: Model> StepProblem<M> {
    /// Sets up the rolling resistance of each contact, if the model has rolling resistance and the coefficient is not
    /// zero. The coefficient of rolling friction μ_r is `friction`, or comes from `numbers_of` if contacts have
    /// different coefficients.
    pub(super) fn fill_rolling(
        &mut self,
        world: &World,
        contacts: &ContactList,
        (friction, numbers_of): (f64, Option<NumbersOfContact<'_>>),
        warm_start: bool,
    ) {
        self.rows.rolling.clear();
        if !M::ROLLING || friction == 0.0 {
            return;
        }
        let (numbering, radii) = (Numbering::of(world), &world.grains.radii);
        for number in 0..self.rows.len() {
            let (row, share) = (self.rows.get(number), self.rows.share(number));
            let index = self.rows.contacts[number] as usize;
            let own_friction = |of: NumbersOfContact<'_>| {
                of(&contacts.contacts()[index], row.effective_mass).rolling_friction
            };
            let friction = numbers_of.map_or(friction, own_friction);
            let own = radii[row.i as usize];
            let lever = match numbering.other(row.j) {
                Other::Grain(j) => radii[j] / (own + radii[j]),
                Other::FixedDisc(disc) => {
                    let radius = world.fixed_discs[disc].radius;
                    radius / (own + radius)
                }
                Other::Feature(_) => 1.0,
            };
            let squares = share * lever * lever + (1.0 - share) * (1.0 - lever) * (1.0 - lever);
            let (radius, compliance) = (lever * own, 2.0 * squares);
            let mut rolling =
                Rolling { impulse: 0.0, friction, radius, lever, compliance, surface_speed: 0.0 };
            if warm_start {
                let stored = contacts.rolling(index);
                let bound = rolling.bound(&self.law_of(number), row.shifted_impulse);
                rolling.impulse = law::coulomb(stored / (radius * row.effective_mass), bound);
            }
            self.rows.rolling.push(rolling);
        }
    }

    /// Sets `surface_speed` of each contact, m/s: the angular velocity of the body that is not a grain, times the
    /// contact's reduced radius (1/R = 1/r_i + 1/r_j, with the radii of the two bodies). It is part of the rolling
    /// velocity.
    pub(super) fn turn_surfaces(&mut self, contacts: &[Contact], surfaces: &MovingSurfaces<'_>) {
        for (rolling, &index) in self.rows.rolling.iter_mut().zip(&self.rows.contacts) {
            let surface = (surfaces.of)(&contacts[index as usize]);
            rolling.surface_speed = surface.map_or(0.0, |surface| rolling.radius * surface.spin);
        }
    }

    /// Stores the rolling impulses (moment times time step, N·m·s) in the list of contacts.
    pub(super) fn store_rolling(&self, contacts: &mut ContactList) {
        let stored = contacts.rolling_mut();
        stored.clear();
        if self.rows.rolling.is_empty() {
            return;
        }
        stored.resize(self.rows.len(), 0.0);
        let rows = self.rows.iter().zip(&self.rows.rolling).zip(&self.rows.contacts);
        for ((row, rolling), &index) in rows {
            stored[index as usize] = rolling.radius * row.effective_mass * rolling.impulse;
        }
    }

    /// Returns the rolling resistance of the contact in row `number`, and its rolling velocity (reduced radius times
    /// relative angular velocity of the two bodies, m/s), which follows from the body velocities `bodies`. Returns
    /// `None` if the problem has no rolling resistance.
    #[inline(always)]
    pub(crate) fn rolling(
        &self,
        number: usize,
        row: &Row<M>,
        bodies: &[M::Body<f64>],
    ) -> Option<(&Rolling, f64)> {
        if !M::ROLLING {
            return None;
        }
        let rolling = self.rows.rolling.get(number)?;
        let j = self.rows.is_pair(number).then(|| &bodies[row.j as usize]);
        Some((rolling, rolling.velocity::<M>(&bodies[row.i as usize], j)))
    }
}
