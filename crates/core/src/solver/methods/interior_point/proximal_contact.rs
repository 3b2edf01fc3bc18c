//! A contact in the proximal multiplier method (symbols as in `proximal`).

use super::contact::{ContactNumbers, Shape};
use crate::contact::law;
use crate::solver::linear::Block;

/// Impulses, velocities and friction bound of a contact.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ProximalContact {
    /// p, m/s.
    pub impulse: [f64; 2],
    /// (w, v), m/s.
    pub velocity: [f64; 2],
    /// Change of (w, v) in a whole step, m/s.
    pub change: [f64; 2],
    /// The lagged bound g, m/s.
    pub bound: f64,
}

/// A piece of Π on which its derivative J is constant.
#[derive(Clone, Copy)]
pub(super) enum ProjectionPiece {
    /// True if σ, and if λ, follows the trial.
    Free([bool; 2]),
    /// An edge of the cone; the number is the sign of λ.
    Edge(f64),
}

impl ProjectionPiece {
    /// J R⁻¹/ε: on an edge with direction d it is d dᵀ/(ε dᵀR d).
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
    /// y after a step of length `share`.
    #[inline(always)]
    pub(super) fn trial(&self, numbers: ContactNumbers, compliance: f64, share: f64) -> [f64; 2] {
        let [normal, tangential] =
            [0, 1].map(|part| (self.velocity[part] + share * self.change[part]) / compliance);
        let [shifted, across] = self.impulse;
        [shifted - normal, across - tangential / numbers.tangential_compliance]
    }

    /// Π of a trial.
    #[inline(always)]
    pub(super) fn allowed<S: Shape>(&self, numbers: ContactNumbers, trial: [f64; 2]) -> [f64; 2] {
        if S::CONE {
            return law::nearest_on_cone(numbers.slope, numbers.tangential_compliance, trial);
        }
        [law::signorini(trial[0]), law::coulomb(trial[1], self.bound)]
    }

    /// The piece of Π that contains a trial.
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
