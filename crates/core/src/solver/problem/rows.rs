//! The bodies of a step's contact problem, and its rows: one row with the data of each contact, in the order of the
//! sweep.

use std::ops::{Deref, DerefMut};

use super::rolling::Rolling;
use crate::contact::ContactLaw;
use crate::solver::kinematics::Model;

/// Velocities and masses of the bodies of a step's contact problem, one body per grain.
#[derive(Clone, Debug)]
pub struct Bodies<M: Model> {
    /// Velocities of the grains that follow from the present contact impulses, m/s. A rotation counts as the spin,
    /// radius times angular velocity.
    pub now: Vec<M::Body<f64>>,
    /// Velocities of the grains at the beginning of the step, m/s. A rotation counts as the spin, radius times angular
    /// velocity.
    pub before: Vec<M::Body<f64>>,
    /// Velocities of the grains at the end of the step if no contact acted, m/s. A rotation counts as the spin, radius
    /// times angular velocity.
    pub free: Vec<M::Body<f64>>,
    /// Masses of the grains, kg.
    pub masses: Vec<f64>,
    /// Mean mass of the grains, kg.
    pub mean_mass: f64,
}

impl<M: Model> Default for Bodies<M> {
    fn default() -> Self {
        let [now, before, free] = [(); 3].map(|()| Vec::new());
        Self { now, before, free, masses: Vec::new(), mean_mass: 0.0 }
    }
}

/// The data that a contact with a fixed body and a contact between grains have in common.
///
/// Impulses are reduced impulses λ = P/m_ij, impulse divided by effective mass, in m/s (see `solver::kinematics` and
/// `contact::law`). Code outside this crate can read the rows of a problem, but cannot replace them.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct Row<M: Model> {
    /// Index of grain i, the first body of the contact.
    pub i: u32,
    /// Index of grain j, the second body of the contact; not used in a contact with a fixed body.
    pub j: u32,
    /// Unit normal n of the contact, from body j (or the fixed body) to grain i.
    pub normal: M::Normal<f64>,
    /// The term that the contact law adds to the normal velocity, m/s: the restitution term minus the speed of a moving
    /// wall along the normal (`problem::walls`). The restitution term is the coefficient of restitution times the
    /// normal velocity at the beginning of the step; it is replaced by 0 if the bodies approach each other more slowly
    /// than the threshold of restitution.
    pub restitution_velocity: f64,
    /// Shifted normal impulse σ of the contact, m/s: normal impulse divided by effective mass, plus the capture speed
    /// (the largest impulse of cohesion divided by effective mass, which is the opening speed that cohesion cancels in
    /// one step). So it is never negative.
    pub shifted_impulse: f64,
    /// Tangential impulse λ_t of the contact, divided by the effective mass, m/s.
    pub tangential_impulse: f64,
    /// Effective mass m_ij of the contact, kg.
    pub effective_mass: f64,
}

/// The data of a contact with a fixed body: exactly one cache line (64 bytes) if the model has two axes.
///
/// A separate array for each field made sweeps 1.1 to 1.2 times slower (`assets/reports/parts.md`).
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub struct FixedRow<M: Model> {
    /// The data that contacts with fixed bodies and contacts between grains have in common.
    pub row: Row<M>,
    /// Speed along the tangent, m/s, of the surface that the grain touches; 0 if the surface does not move. The
    /// tangential velocity v_t of the law is relative to this surface.
    pub surface_speed: f64,
}

/// The data of a contact between two grains: exactly one cache line (64 bytes) if the model has two axes.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub struct PairRow<M: Model> {
    /// The data that contacts with fixed bodies and contacts between grains have in common.
    pub row: Row<M>,
    /// Mass ratio g_i: effective mass of the contact divided by the mass of grain i. A reduced impulse (m/s) times g_i
    /// is the change of the velocity of grain i.
    pub share: f64,
}

macro_rules! is_a_row {
    ($name:ident) => {
        impl<M: Model> Deref for $name<M> {
            type Target = Row<M>;

            #[inline(always)]
            fn deref(&self) -> &Row<M> {
                &self.row
            }
        }

        impl<M: Model> DerefMut for $name<M> {
            #[inline(always)]
            fn deref_mut(&mut self) -> &mut Row<M> {
                &mut self.row
            }
        }
    };
}

is_a_row!(FixedRow);
is_a_row!(PairRow);

impl<M: Model> Row<M> {
    /// Returns the shifted normal impulse (normal impulse plus the largest impulse of cohesion, so that it is never
    /// negative) and the tangential impulse, both divided by the effective mass, m/s.
    #[inline(always)]
    pub fn impulse(&self) -> [f64; 2] {
        [self.shifted_impulse, self.tangential_impulse]
    }
}

impl<M: Model> FixedRow<M> {
    /// Returns the normal and tangential velocity of the grain at its contact with the fixed body, m/s. The tangential
    /// velocity is relative to the surface of the fixed body. The normal velocity is relative to a body at rest,
    /// because the speed of a moving wall along the normal is part of `restitution_velocity`.
    #[inline(always)]
    pub fn velocity(&self, bodies: &[M::Body<f64>]) -> [f64; 2] {
        let [normal, tangential] = M::velocity(self.normal, &bodies[self.i as usize]);
        [normal, tangential - self.surface_speed]
    }
}

impl<M: Model> PairRow<M> {
    /// Returns the normal and tangential velocity of grain i relative to grain j at the contact, m/s.
    #[inline(always)]
    pub fn velocity(&self, bodies: &[M::Body<f64>]) -> [f64; 2] {
        M::relative_velocity(self.normal, &bodies[self.i as usize], &bodies[self.j as usize])
    }
}

/// The data of a step's contacts, one row per contact. Row numbers count the contacts with fixed bodies first, then the
/// contacts between grains, each in the order of the sweep (`problem::order`).
#[derive(Clone, Debug, Default)]
pub struct ContactRows<M: Model> {
    /// Rows (the data of one contact each) of contacts with fixed bodies.
    pub fixed: Vec<FixedRow<M>>,
    /// Rows (the data of one contact each) of contacts between grains.
    pub pairs: Vec<PairRow<M>>,
    /// Index of each row's contact in the list of detected contacts.
    pub contacts: Vec<u32>,
    /// Capture speed of each contact (the opening speed that cohesion cancels in one step: cohesion force times time
    /// step, divided by effective mass), m/s, if contacts have different capture speeds (contact law `range`, pairs of
    /// materials); else empty. Sweeps with the shifted friction cone do not need it, because in this cone the sum of
    /// normal impulse and cohesion impulse bounds friction, and this sum is stored.
    pub captures: Vec<f64>,
    /// Friction coefficient μ of each contact, if pairs of materials have their own coefficients; else empty.
    pub frictions: Vec<f64>,
    /// Coefficient of restitution ρ of each contact, if pairs of materials have their own coefficients; else empty.
    pub restitutions: Vec<f64>,
    /// The rolling resistance of each contact; empty without rolling friction.
    pub rolling: Vec<Rolling>,
}

impl<M: Model> ContactRows<M> {
    /// Returns the number of rows, one per contact.
    pub fn len(&self) -> usize {
        self.fixed.len() + self.pairs.len()
    }

    /// Returns true if there are no rows (no contacts).
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Removes all rows (contacts).
    pub(crate) fn clear(&mut self) {
        self.fixed.clear();
        self.pairs.clear();
        self.contacts.clear();
        self.captures.clear();
        self.frictions.clear();
        self.restitutions.clear();
        self.rolling.clear();
    }

    /// Iterates over the rows (the data of one contact each) in the order of their numbers.
    pub fn iter(&self) -> impl Iterator<Item = &Row<M>> {
        self.fixed.iter().map(|row| &row.row).chain(self.pairs.iter().map(|row| &row.row))
    }

    /// Iterates over mutable references to the rows (the data of one contact each) in the order of their numbers.
    pub(crate) fn iter_mut(&mut self) -> impl Iterator<Item = &mut Row<M>> {
        let fixed = self.fixed.iter_mut().map(|row| &mut row.row);
        fixed.chain(self.pairs.iter_mut().map(|row| &mut row.row))
    }

    /// Returns true if row `number` is a contact between grains.
    #[inline(always)]
    pub fn is_pair(&self, number: usize) -> bool {
        number >= self.fixed.len()
    }

    /// Returns row `number`, the data of a contact.
    pub(crate) fn get(&self, number: usize) -> &Row<M> {
        match number.checked_sub(self.fixed.len()) {
            None => &self.fixed[number],
            Some(number) => &self.pairs[number],
        }
    }

    /// Returns a mutable reference to row `number`, the data of a contact.
    pub(crate) fn get_mut(&mut self, number: usize) -> &mut Row<M> {
        match number.checked_sub(self.fixed.len()) {
            None => &mut self.fixed[number],
            Some(number) => &mut self.pairs[number],
        }
    }

    /// Returns the effective mass of the contact in row `number` divided by the mass of its grain i; 1 if the contact
    /// is with a fixed body.
    #[inline(always)]
    pub(crate) fn share(&self, number: usize) -> f64 {
        number.checked_sub(self.fixed.len()).map_or(1.0, |number| self.pairs[number].share)
    }

    /// Returns the speed along the tangent, m/s, of the surface that the grain touches at the contact in row `number`;
    /// 0 for a contact between grains.
    #[inline(always)]
    pub(crate) fn surface_speed(&self, number: usize) -> f64 {
        self.fixed.get(number).map_or(0.0, |row| row.surface_speed)
    }

    /// Returns the capture speed (the opening speed that cohesion cancels in one step) of the contact in row `number`,
    /// m/s: its own, or the capture speed of `law` if the contacts have no own capture speeds.
    #[inline(always)]
    pub(super) fn capture(&self, number: usize, law: &ContactLaw) -> f64 {
        if self.captures.is_empty() { law.capture_speed() } else { self.captures[number] }
    }

    /// Returns the contact law of the contact in row `number`: `law`, or if pairs of materials have their own
    /// coefficients, `law` with the contact's own friction coefficient and capture speed (the opening speed that
    /// cohesion cancels in one step, m/s).
    #[inline(always)]
    pub(crate) fn law(&self, number: usize, law: &ContactLaw) -> ContactLaw {
        law_of_row([&self.frictions, &self.captures], number, law)
    }

    /// Adds a copy of the contact data in row `number` of `others`, modified by `change`. The entry of the list
    /// `contacts` for this copy is `number`, instead of the index of a detected contact.
    pub(crate) fn push_copy(
        &mut self,
        others: &Self,
        number: usize,
        change: impl FnOnce(&mut Row<M>),
    ) {
        match number.checked_sub(others.fixed.len()) {
            None => {
                self.fixed.push(others.fixed[number]);
                self.fixed.last_mut().map(|row| &mut row.row)
            }
            Some(number) => {
                self.pairs.push(others.pairs[number]);
                self.pairs.last_mut().map(|row| &mut row.row)
            }
        }
        .map(change);
        self.contacts.push(number as u32);
    }

    /// Copies the impulses of all contacts, m/s, to `impulses`, which is cleared first: a pair per contact with the
    /// shifted normal impulse (normal impulse plus the largest impulse of cohesion, so that it is never negative) and
    /// the tangential impulse, both divided by the effective mass. If the problem has rolling resistance, a second pair
    /// (ψ, 0) per contact follows, with the reduced rolling impulse ψ (rolling moment times time step, divided by
    /// reduced radius and effective mass).
    pub(crate) fn read_impulses(&self, impulses: &mut Vec<[f64; 2]>) {
        impulses.clear();
        impulses.extend(self.iter().map(Row::impulse));
        impulses.extend(self.rolling.iter().map(|rolling| [rolling.impulse, 0.0]));
    }
}

/// Returns the contact law of the contact in row `number`: `law` with the contact's own friction coefficient and
/// capture speed (the opening speed that cohesion cancels in one step, m/s), or `law` itself if the list of friction
/// coefficients is empty.
#[inline(always)]
pub(crate) fn law_of_row(
    [frictions, captures]: [&[f64]; 2],
    number: usize,
    law: &ContactLaw,
) -> ContactLaw {
    match frictions.get(number) {
        None => *law,
        Some(&friction) => ContactLaw::new(friction, captures[number], law.cone()),
    }
}
