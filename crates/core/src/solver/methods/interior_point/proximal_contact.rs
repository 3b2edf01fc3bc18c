//! A contact in the proximal multiplier method: its impulses and velocities, and the projection of its impulses on the
//! impulses that its friction model allows. The method is described in the module `proximal`.

use super::contact::{ContactNumbers, Shape};
use crate::contact::law;
use crate::solver::linear::Block;

/// Impulses, velocities and friction bound of a contact in the proximal multiplier method.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ProximalContact {
    /// Impulses p = (σ, λ) divided by the effective mass, m/s: shifted normal impulse σ (normal impulse plus the
    /// largest impulse of cohesion, so that it is never negative) and tangential impulse λ.
    pub impulse: [f64; 2],
    /// Velocities (w, v), m/s: w is the normal velocity plus the restitution term (restitution times the normal
    /// velocity before the step) and the opening speed that `desaxce` adds, v is the tangential velocity.
    pub velocity: [f64; 2],
    /// Change of the contact's normal and tangential velocity in a Newton step of length 1, m/s.
    pub change: [f64; 2],
    /// Largest tangential impulse under `tresca`, divided by the effective mass, m/s. It stays fixed during a solve. 0
    /// for the models whose friction bound grows with the normal impulse.
    pub bound: f64,
}

/// A region of trial impulses, which are the impulses before their projection on the allowed impulses. The derivative
/// of the projection is constant in the region.
#[derive(Clone, Copy)]
pub(super) enum ProjectionPiece {
    /// One flag for the normal and one for the tangential impulse: true if the projected impulse equals the trial
    /// impulse, false if it is at a bound.
    Free([bool; 2]),
    /// The projected impulse is on an edge of the friction cone, λ = ±μσ with the given sign (tangential impulse λ,
    /// friction coefficient μ, and σ, the normal impulse plus the largest impulse of cohesion).
    Edge(f64),
}

impl ProjectionPiece {
    /// Returns the stiffness J R⁻¹/ε of a contact, dimensionless: with a minus sign it maps a change of the contact's
    /// velocity to the change of the impulses divided by the effective mass. J is the derivative of the projection of
    /// the trial impulses, R = diag(1, m_n/m_t) contains the ratio of the effective masses m_n and m_t along normal and
    /// tangent, and ε is the compliance (`compliance`). On an edge of the cone, whose direction is d, the stiffness is
    /// d dᵀ/(ε dᵀR d).
    pub(super) fn stiffness(self, numbers: ContactNumbers, compliance: f64) -> Block<2> {
        let soft = numbers.tangential_compliance;
        match self {
            Self::Free([normal, tangential]) => {
                let part = |is_free: bool| f64::from(u8::from(is_free)) / compliance;
                [[part(normal), 0.0], [0.0, part(tangential) / soft]]
            }
            Self::Edge(sign) => {
                let along = [1.0, sign * numbers.slope];
                let scale = 1.0 / (compliance * (1.0 + soft * along[1] * along[1]));
                along.map(|row| along.map(|column| scale * row * column))
            }
        }
    }
}

impl ProximalContact {
    /// Returns the trial impulses y = p − R⁻¹(w, v)/ε, m/s, after a Newton step whose length is the fraction `share` of
    /// the full step: p are the present impulses divided by the effective mass, m/s, (w, v) the velocities of the
    /// contact, m/s, ε its dimensionless compliance (`compliance`), and R = diag(1, m_n/m_t) has the ratio of its
    /// effective masses along normal and tangent.
    #[inline(always)]
    pub(super) fn trial(&self, numbers: ContactNumbers, compliance: f64, share: f64) -> [f64; 2] {
        let [normal, tangential] =
            [0, 1].map(|part| (self.velocity[part] + share * self.change[part]) / compliance);
        let [shifted, across] = self.impulse;
        [shifted - normal, across - tangential / numbers.tangential_compliance]
    }

    /// Returns the impulses, m/s, to which `trial` is projected: the impulses that the friction model allows and that
    /// are nearest to the trial impulses `trial`. All are divided by the effective mass.
    #[inline(always)]
    pub(super) fn allowed<S: Shape>(&self, numbers: ContactNumbers, trial: [f64; 2]) -> [f64; 2] {
        if S::CONE {
            return law::nearest_on_cone(numbers.slope, numbers.tangential_compliance, trial);
        }
        [law::signorini(trial[0]), law::coulomb(trial[1], self.bound)]
    }

    /// Returns the region of the projection on the allowed impulses that contains the trial impulses `trial`, m/s.
    #[inline(always)]
    pub(super) fn piece<S: Shape>(
        &self,
        numbers: ContactNumbers,
        trial: [f64; 2],
    ) -> ProjectionPiece {
        if !S::CONE {
            return ProjectionPiece::Free([trial[0] > 0.0, trial[1].abs() < self.bound]);
        }
        let is_inside = trial[1].abs() <= numbers.slope * trial[0];
        if is_inside || self.allowed::<S>(numbers, trial)[0] == 0.0 {
            return ProjectionPiece::Free([is_inside; 2]);
        }
        ProjectionPiece::Edge(1f64.copysign(trial[1]))
    }
}
