//! The update of one contact in a Gauss–Seidel sweep, or of several contacts that share no grain.
//!
//! Let σ be the shifted normal impulse of the contact (the normal impulse plus the largest impulse of cohesion, so that
//! it is never negative) and λ_t its tangential impulse, both reduced impulses (impulse divided by effective mass, m/s:
//! `contact::law`, `solver::kinematics`), v_n and v_t its normal and tangential velocity, ρ v_n^{n−1} its restitution
//! term (restitution times normal velocity before the step), m_n and m_t its effective masses along normal and tangent,
//! and bound(σ) the largest |λ_t| that friction allows. The update is
//!
//! > σ ← max(σ − (v_n + ρ v_n^{n−1}), 0),  λ_t ← clamp(λ_t − v_t · m_t/m_n, ±bound(σ)).
//!
//! The normal impulse does not change v_t, so both velocities are computed once. The first arguments of max and clamp
//! are the trial impulses of the contact: with them its normal velocity would become −ρ v_n^{n−1} and its tangential
//! velocity 0. Friction models other than Coulomb's law limit the same trial impulses by other rules
//! (`problem::friction`).

use crate::contact::{ContactLaw, Lanes};
use crate::solver::kinematics::Model;
use crate::solver::problem::{FixedRow, PairRow, Rolling, Row};

/// The data that the update of a contact needs, except the impulses: normal, restitution term (restitution times the
/// normal velocity before the step, m/s) and effective mass (kg). With several SIMD lanes, one contact per lane.
#[derive(Clone, Copy)]
pub(crate) struct Local<M: Model, T: Lanes> {
    pub normal: M::Normal<T>,
    pub restitution_velocity: T,
    pub effective_mass: T,
}

/// Change of the impulses of all contacts in a sweep; 0 if the change was not measured. With several SIMD lanes, one
/// change per lane.
#[derive(Clone, Copy, Debug, Default)]
pub struct ImpulseChange<T = f64> {
    /// Sum of the squared changes of the contact impulses, (N·s)².
    pub squared: T,
    /// Sum of the absolute changes of the contact impulses, N·s.
    pub absolute: T,
}

impl ImpulseChange {
    /// Adds the change of the impulses of further contacts in the same sweep.
    pub(crate) fn add_all(&mut self, other: Self) {
        self.squared += other.squared;
        self.absolute += other.absolute;
    }
}

impl<T: Lanes> ImpulseChange<T> {
    /// Adds the change of the impulses of one contact, if `MEASURE` is set. The changes of the normal and tangential
    /// impulse are given divided by the effective mass `mass` (kg), m/s.
    #[inline(always)]
    pub(crate) fn add<M: Model, const MEASURE: bool>(
        &mut self,
        mass: T,
        [normal, tangential]: [T; 2],
    ) {
        if MEASURE {
            let normal = mass * normal;
            self.squared += normal * normal;
            self.absolute += normal.magnitude();
            if M::FRICTION {
                let tangential = mass * tangential;
                self.squared += tangential * tangential;
                self.absolute += tangential.magnitude();
            }
        }
    }
}

impl<M: Model, T: Lanes> Local<M, T> {
    /// Returns the normal and tangential velocity of a grain at its contact with a fixed body, m/s. `surface_speed`,
    /// m/s, is the speed of the fixed body's surface along the tangent; the tangential velocity is relative to it. With
    /// several SIMD lanes, one contact per lane.
    #[inline(always)]
    pub(crate) fn velocity(&self, surface_speed: T, i: &M::Body<T>) -> [T; 2] {
        let [normal, tangential] = M::velocity(self.normal, i);
        [normal, tangential - surface_speed]
    }

    /// Solves contacts of grains with fixed bodies: updates the impulses (normal impulse plus cohesion impulse, and
    /// tangential impulse, divided by the effective mass, m/s) and the velocities of the grains. The update first
    /// computes the impulses that would stop the relative motion at each contact, except for a rebound by restitution.
    /// `project` limits them to the impulses that the friction model allows.
    #[inline(always)]
    pub(crate) fn solve_fixed<const MEASURE: bool>(
        &self,
        surface_speed: T,
        impulse: &mut [T; 2],
        i: &mut M::Body<T>,
        change: &mut ImpulseChange<T>,
        project: impl FnOnce([T; 2]) -> [T; 2],
    ) {
        let pushed = self.update(impulse, self.velocity(surface_speed, i), project);
        M::push_single(i, self.normal, pushed);
        change.add::<M, MEASURE>(self.effective_mass, pushed);
    }

    /// Solves contacts between grains i and j: updates the impulses (normal impulse plus cohesion impulse, and
    /// tangential impulse, divided by the effective mass, m/s) and the velocities of the grains. `share` is the mass
    /// ratio m_ij/m_i: effective mass divided by the mass of grain i. The update first computes the impulses that would
    /// stop the relative motion at each contact, except for a rebound by restitution. `project` limits them to the
    /// impulses that the friction model allows.
    #[inline(always)]
    pub(crate) fn solve_pair<const MEASURE: bool>(
        &self,
        share: T,
        impulse: &mut [T; 2],
        [i, j]: [&mut M::Body<T>; 2],
        change: &mut ImpulseChange<T>,
        project: impl FnOnce([T; 2]) -> [T; 2],
    ) {
        let velocity = M::relative_velocity(self.normal, i, j);
        let pushed = self.update(impulse, velocity, project);
        M::push_pair(i, j, self.normal, pushed, share);
        change.add::<M, MEASURE>(self.effective_mass, pushed);
    }

    /// Updates the impulses (normal impulse plus cohesion impulse, and tangential impulse, divided by the effective
    /// mass, m/s) of contacts that have the given normal and tangential velocities. Returns the change of the two
    /// impulses, m/s. The update first computes the impulses that would stop the relative motion at each contact,
    /// except for a rebound by restitution. `project` limits them to the impulses that the friction model allows.
    #[inline(always)]
    fn update(
        &self,
        impulse: &mut [T; 2],
        [normal_velocity, tangential_velocity]: [T; 2],
        project: impl FnOnce([T; 2]) -> [T; 2],
    ) -> [T; 2] {
        let before = *impulse;
        let closing = normal_velocity + self.restitution_velocity;
        let compliance = closing.same(1.0 / M::TANGENTIAL_COMPLIANCE);
        let after = project([before[0] - closing, before[1] - compliance * tangential_velocity]);
        impulse[0] = after[0];
        let normal_change = after[0] - before[0];
        if !M::FRICTION {
            return [normal_change, normal_change.same(0.0)];
        }
        impulse[1] = after[1];
        [normal_change, after[1] - before[1]]
    }
}

impl<M: Model> FixedRow<M> {
    /// Updates the impulses of this contact of a grain with a fixed body by the contact law, and the velocity of the
    /// grain.
    #[inline(always)]
    pub(crate) fn solve<const MEASURE: bool>(
        &mut self,
        bodies: &mut [M::Body<f64>],
        change: &mut ImpulseChange,
        project: impl FnOnce([f64; 2]) -> [f64; 2],
    ) {
        let mut impulse = self.impulse();
        let i = &mut bodies[self.i as usize];
        let speed = self.surface_speed;
        self.local().solve_fixed::<MEASURE>(speed, &mut impulse, i, change, project);
        [self.shifted_impulse, self.tangential_impulse] = impulse;
    }
}

impl<M: Model> PairRow<M> {
    /// Updates the impulses of this contact between two grains by the contact law, and the velocities of the grains.
    #[inline(always)]
    pub(crate) fn solve<const MEASURE: bool>(
        &mut self,
        bodies: &mut [M::Body<f64>],
        change: &mut ImpulseChange,
        project: impl FnOnce([f64; 2]) -> [f64; 2],
    ) {
        let mut impulse = self.impulse();
        let (mut i, mut j) = (bodies[self.i as usize], bodies[self.j as usize]);
        let both = [&mut i, &mut j];
        self.local().solve_pair::<MEASURE>(self.share, &mut impulse, both, change, project);
        bodies[self.i as usize] = i;
        bodies[self.j as usize] = j;
        [self.shifted_impulse, self.tangential_impulse] = impulse;
    }
}

impl<M: Model> Row<M> {
    /// Updates the rolling impulse of the contact, which depends on the contact's updated normal impulse. `share` is
    /// the mass ratio m_ij/m_i (effective mass divided by the mass of body i), or `None` against a fixed body.
    #[inline(always)]
    pub(crate) fn solve_rolling<const MEASURE: bool>(
        &self,
        rolling: &mut Rolling,
        share: Option<f64>,
        law: &ContactLaw,
        bodies: &mut [M::Body<f64>],
        change: &mut ImpulseChange,
    ) {
        let (i, j) = (self.i as usize, self.j as usize);
        let velocity = rolling.velocity::<M>(&bodies[i], share.map(|_| &bodies[j]));
        let solved = rolling.solved(law, self.shifted_impulse, velocity);
        let added = solved - rolling.impulse;
        rolling.impulse = solved;
        rolling.turn_i::<M>(&mut bodies[i], share.unwrap_or(1.0), added);
        if let Some(share) = share {
            rolling.turn_j::<M>(&mut bodies[j], share, added);
        }
        change.add::<M, MEASURE>(self.effective_mass, [0.0, added]);
    }

    #[inline(always)]
    fn local(&self) -> Local<M, f64> {
        let Self { normal, restitution_velocity, effective_mass, .. } = *self;
        Local { normal, restitution_velocity, effective_mass }
    }
}
