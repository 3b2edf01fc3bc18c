//! What proximal multipliers know of one contact: Π, its pieces, and y.

use super::local::Shared;
use super::shape::Shape;
use crate::contact::law;
use crate::solver::linear::Block;

/// A contact on its way.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Near {
    /// p, m/s.
    pub impulse: [f64; 2],
    /// (w, v), m/s.
    pub velocity: [f64; 2],
    /// What a whole step adds to it, m/s.
    pub change: [f64; 2],
    /// What is held of the bound g, m/s.
    pub bound: f64,
}

/// A piece of Π, on which J is the same.
#[derive(Clone, Copy)]
pub(super) enum Piece {
    /// Whether σ, and whether λ, follow the trial.
    Free([bool; 2]),
    /// An edge of the cone, by the sign of λ.
    Edge(f64),
}

impl Piece {
    /// J R⁻¹/ε: on an edge of direction d it is d dᵀ/(ε dᵀR d).
    pub(super) fn stiffness(self, shared: Shared, compliance: f64) -> Block<2> {
        let soft = shared.tangential_compliance;
        match self {
            Self::Free([normal, tangential]) => {
                let part = |is_free: bool| f64::from(u8::from(is_free)) / compliance;
                [[part(normal), 0.0], [0.0, part(tangential) / soft]]
            }
            Self::Edge(sign) => {
                let along = [1.0, sign * shared.slope];
                let scale = 1.0 / (compliance * (1.0 + soft * along[1] * along[1]));
                along.map(|row| along.map(|column| scale * row * column))
            }
        }
    }
}

impl Near {
    /// y after a share of a step.
    #[inline(always)]
    pub(super) fn trial(&self, shared: Shared, compliance: f64, share: f64) -> [f64; 2] {
        let [normal, tangential] =
            [0, 1].map(|part| (self.velocity[part] + share * self.change[part]) / compliance);
        let [shifted, across] = self.impulse;
        [shifted - normal, across - tangential / shared.tangential_compliance]
    }

    /// Π.
    #[inline(always)]
    pub(super) fn allowed<S: Shape>(&self, shared: Shared, trial: [f64; 2]) -> [f64; 2] {
        if S::CONE {
            return law::nearest_on_cone(shared.slope, shared.tangential_compliance, trial);
        }
        [law::signorini(trial[0]), law::coulomb(trial[1], self.bound)]
    }

    /// The piece of Π that a trial is in.
    #[inline(always)]
    pub(super) fn piece<S: Shape>(&self, shared: Shared, trial: [f64; 2]) -> Piece {
        if !S::CONE {
            return Piece::Free([trial[0] > 0.0, trial[1].abs() < self.bound]);
        }
        let is_inside = trial[1].abs() <= shared.slope * trial[0];
        if is_inside || self.allowed::<S>(shared, trial)[0] == 0.0 {
            return Piece::Free([is_inside; 2]);
        }
        Piece::Edge(1f64.copysign(trial[1]))
    }
}
