//! Rolling resistance: a moment M of each contact against the relative spin of its bodies.
//!
//! **Law.** With the reduced radius R, 1/R = 1/r_i + 1/r_j, or R = r_i against a boundary, the rolling velocity is
//!
//! > v_r = R (ω_i − ω_j) = a_i s_i − a_j s_j,  s = rω,  a_i = R/r_i,  a_j = R/r_j = 1 − a_i,
//!
//! or a_i s_i − R ω_w against a fixed body that turns with ω_w; a_i is 1 against a boundary. The moment impulse MΔt
//! acts on i, and its opposite on j. The reduced form ψ = MΔt/(R m_ij), in m/s, obeys the law of Coulomb friction,
//!
//! > |ψ| ≤ μ_r σ',  ψ = −μ_r σ' sign(v_r) unless v_r = 0,
//!
//! with σ' the part of σ that bounds friction (`contact::law`), and v_r at the end of the step. So M does no work while
//! it prevents rolling, and dissipates otherwise. J. Ai, J.-F. Chen, J. M. Rotter and J. Y. Ooi (2011) call this a
//! directional constant torque; here the torque also holds at v_r = 0.
//!
//! **Response.** With I = ½mr² and g_i as in `solver::kinematics`, MΔt = R m_ij ψ changes the spins by
//!
//! > Δs_i = r_i MΔt/I_i = 2 g_i a_i ψ,  Δs_j = −2 (1 − g_i) a_j ψ,  Δv_r = W ψ,
//! > W = 2 (g_i a_i² + (1 − g_i) a_j²), or 2 a_i² against a fixed body.
//!
//! The update of a contact is ψ ← clamp(ψ − v_r/W, ±μ_r σ'), after that of (σ, λ_t). ψ changes v_t, too, unless
//! g_i a_i = (1 − g_i) a_j, so the updates of λ_t and ψ are two steps of Gauss–Seidel. The error in the natural map is
//! the change that the update would make. ψ acts on v_r as λ_t acts on v_t, so it adds μ_r σ'|v_r| + ψ v_r to the gap
//! in `velocity_error`.

use crate::contact::{ContactLaw, law};
use crate::solver::kinematics::Model;

/// Rolling resistance of a contact.
#[derive(Clone, Copy, Debug)]
pub struct Rolling {
    /// ψ, m/s.
    pub impulse: f64,
    /// μ_r.
    pub friction: f64,
    /// R, m.
    pub radius: f64,
    /// a_i = R/r_i.
    pub lever: f64,
    /// W = ∂v_r/∂ψ.
    pub compliance: f64,
    /// R times the angular velocity of a fixed body, m/s.
    pub surface_speed: f64,
}

impl Rolling {
    /// The largest |ψ| at a shifted normal impulse σ, m/s.
    #[inline(always)]
    pub(crate) fn bound(&self, law: &ContactLaw, shifted_impulse: f64) -> f64 {
        self.friction * law::signorini(law.rubbing(shifted_impulse))
    }

    /// The ψ, m/s, that solves the contact if its v_r is now `velocity`, m/s.
    #[inline(always)]
    pub(crate) fn solved(&self, law: &ContactLaw, shifted_impulse: f64, velocity: f64) -> f64 {
        let trial = self.impulse - velocity / self.compliance;
        law::coulomb(trial, self.bound(law, shifted_impulse))
    }

    /// The error of ψ in the natural map, m/s.
    #[inline(always)]
    pub(crate) fn error(&self, law: &ContactLaw, shifted_impulse: f64, velocity: f64) -> f64 {
        self.impulse - self.solved(law, shifted_impulse, velocity)
    }

    /// v_r of body i, relative to body j or to the fixed body, m/s.
    #[inline(always)]
    pub(crate) fn velocity<M: Model>(&self, i: &M::Body<f64>, j: Option<&M::Body<f64>>) -> f64 {
        let of_j = j.map_or(self.surface_speed, |j| (1.0 - self.lever) * M::coordinates(j)[2]);
        self.lever * M::coordinates(i)[2] - of_j
    }

    /// Derivative of v_r by the coordinates of i (`on_j` false) or j.
    #[inline(always)]
    pub(crate) fn gradient(&self, on_j: bool) -> [f64; 3] {
        [0.0, 0.0, if on_j { self.lever - 1.0 } else { self.lever }]
    }

    /// Applies ψ to body i, whose g_i is `share`.
    #[inline(always)]
    pub(crate) fn turn_i<M: Model>(&self, i: &mut M::Body<f64>, share: f64, impulse: f64) {
        turn::<M>(i, 2.0 * share * self.lever * impulse);
    }

    /// Applies ψ to body j.
    #[inline(always)]
    pub(crate) fn turn_j<M: Model>(&self, j: &mut M::Body<f64>, share: f64, impulse: f64) {
        turn::<M>(j, -2.0 * (1.0 - share) * (1.0 - self.lever) * impulse);
    }
}

/// Adds to s = rω of a body, m/s.
#[inline(always)]
fn turn<M: Model>(body: &mut M::Body<f64>, change: f64) {
    let [x, y, spin] = M::coordinates(body);
    M::set(body, [x, y, spin + change]);
}
