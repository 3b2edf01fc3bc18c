//! Rolling resistance: a moment M at each contact against the relative spin of its bodies.
//!
//! **Law.** The reduced radius R of bodies with the radii r_i and r_j has 1/R = 1/r_i + 1/r_j, or R = r_i if the other
//! body is a boundary. With the angular velocities ω_i and ω_j (rad/s) and the spins s_i = r_i ω_i and s_j = r_j ω_j
//! (m/s), the rolling velocity v_r (m/s) is
//!
//! > v_r = R (ω_i − ω_j) = a_i s_i − a_j s_j,  s = rω,  a_i = R/r_i,  a_j = R/r_j = 1 − a_i,
//!
//! or a_i s_i − R ω_w against a fixed body that turns with the angular velocity ω_w; a_i is 1 against a boundary. The
//! moment impulse MΔt (Δt: time step) acts on body i, and −MΔt on body j. With the effective mass m_ij, the reduced
//! rolling impulse ψ = MΔt/(R m_ij), in m/s, obeys the law of Coulomb friction,
//!
//! > |ψ| ≤ μ_r σ',  ψ = −μ_r σ' sign(v_r) unless v_r = 0,
//!
//! with μ_r the coefficient of rolling friction, σ' (m/s) the part that bounds friction (`contact::law`) of the shifted
//! normal impulse σ (normal impulse plus the largest impulse of cohesion, so that it is never negative), and v_r at the
//! end of the step. So M does no work while it prevents rolling, and dissipates energy otherwise. J. Ai, J.-F. Chen, J.
//! M. Rotter and J. Y. Ooi (2011) call this a directional constant torque; in this program the moment also acts at v_r
//! = 0.
//!
//! **Response.** With the moment of inertia I = ½mr² of a disc and the mass ratio g_i = m_ij/m_i
//! (`solver::kinematics`), MΔt = R m_ij ψ changes the spins and the rolling velocity by
//!
//! > Δs_i = r_i MΔt/I_i = 2 g_i a_i ψ,  Δs_j = −2 (1 − g_i) a_j ψ,  Δv_r = W ψ,
//! > W = 2 (g_i a_i² + (1 − g_i) a_j²), or 2 a_i² against a fixed body.
//!
//! The update of a contact is ψ ← clamp(ψ − v_r/W, ±μ_r σ'), after the update of σ and of the tangential impulse λ_t,
//! divided by m_ij (m/s). Let v_t be the tangential velocity of the contact (m/s). ψ changes v_t, too, unless g_i a_i =
//! (1 − g_i) a_j, so the updates of λ_t and ψ are two steps of Gauss–Seidel. The error of ψ, which the residual counts,
//! is the change that the update would make. ψ acts on v_r as λ_t acts on v_t, so rolling adds μ_r σ'|v_r| + ψ v_r to
//! the terms of λ_t in the sum S (duality gap) from which `velocity_error` estimates the error of the velocities.

use crate::contact::{ContactLaw, law};
use crate::solver::kinematics::Model;

/// Rolling resistance of a contact: a moment against the relative spin of its two bodies.
#[derive(Clone, Copy, Debug)]
pub struct Rolling {
    /// Reduced rolling impulse ψ, m/s: rolling moment times time step, divided by the effective mass and the reduced
    /// radius R of the contact (1/R = 1/r_i + 1/r_j, with the radii r_i and r_j of the two bodies).
    pub impulse: f64,
    /// Coefficient of rolling friction μ_r.
    pub friction: f64,
    /// Reduced radius R of the contact, m: 1/R = 1/r_i + 1/r_j, with the radii r_i and r_j of the two bodies, or R =
    /// r_i if body i touches a boundary.
    pub radius: f64,
    /// Ratio a_i = R/r_i, dimensionless, of the contact's reduced radius R (1/R = 1/r_i + 1/r_j) to the radius r_i of
    /// body i; r_j is the radius of body j. It is 1 if body i touches a boundary.
    pub lever: f64,
    /// Compliance W, dimensionless: change of the rolling velocity (reduced radius times relative angular velocity of
    /// the two bodies, m/s) per unit of the reduced rolling impulse (rolling moment times time step, divided by reduced
    /// radius and effective mass, m/s).
    pub compliance: f64,
    /// Speed R·ω of a body that is not a grain, m/s, with the contact's reduced radius R (m) and the angular velocity ω
    /// of that body (rad/s); 0 at a contact between grains.
    pub surface_speed: f64,
}

impl Rolling {
    /// Returns the largest reduced rolling impulse (rolling moment times time step, divided by reduced radius and
    /// effective mass, m/s) that the contact's shifted normal impulse `shifted_impulse` allows: the normal impulse plus
    /// the largest impulse of cohesion, so that it is never negative, divided by the effective mass, m/s.
    #[inline(always)]
    pub(crate) fn bound(&self, law: &ContactLaw, shifted_impulse: f64) -> f64 {
        self.friction * law::signorini(law.rubbing(shifted_impulse))
    }

    /// Returns the reduced rolling impulse (rolling moment times time step, divided by reduced radius and effective
    /// mass, m/s) that satisfies the law of rolling resistance. `velocity` is the rolling velocity (reduced radius
    /// times relative angular velocity of the two bodies, m/s) under the present impulse.
    #[inline(always)]
    pub(crate) fn solved(&self, law: &ContactLaw, shifted_impulse: f64, velocity: f64) -> f64 {
        let trial = self.impulse - velocity / self.compliance;
        law::coulomb(trial, self.bound(law, shifted_impulse))
    }

    /// Returns the error of the present reduced rolling impulse (rolling moment times time step, divided by reduced
    /// radius and effective mass, m/s): its difference from the impulse that satisfies the law of rolling resistance at
    /// the present rolling velocity `velocity`, m/s.
    #[inline(always)]
    pub(crate) fn error(&self, law: &ContactLaw, shifted_impulse: f64, velocity: f64) -> f64 {
        self.impulse - self.solved(law, shifted_impulse, velocity)
    }

    /// Returns the rolling velocity of body i relative to body j or to the fixed body, m/s: the reduced radius of the
    /// contact times the relative angular velocity.
    #[inline(always)]
    pub(crate) fn velocity<M: Model>(&self, i: &M::Body<f64>, j: Option<&M::Body<f64>>) -> f64 {
        let of_j = j.map_or(self.surface_speed, |j| (1.0 - self.lever) * M::coordinates(j)[2]);
        self.lever * M::coordinates(i)[2] - of_j
    }

    /// Returns the derivatives, dimensionless, of the rolling velocity (reduced radius times relative angular velocity
    /// of the two bodies, m/s) with respect to the velocity of body j if `on_j` is true, else of body i. The velocity
    /// of a body has three components, all in m/s: x, y and spin (radius times angular velocity).
    #[inline(always)]
    pub(crate) fn gradient(&self, on_j: bool) -> [f64; 3] {
        [0.0, 0.0, if on_j { self.lever - 1.0 } else { self.lever }]
    }

    /// Applies a reduced rolling impulse (rolling moment times time step, divided by reduced radius and effective mass,
    /// m/s) to body i. `share` is the effective mass of the contact divided by the mass of body i.
    #[inline(always)]
    pub(crate) fn turn_i<M: Model>(&self, i: &mut M::Body<f64>, share: f64, impulse: f64) {
        turn::<M>(i, 2.0 * share * self.lever * impulse);
    }

    /// Applies a reduced rolling impulse (rolling moment times time step, divided by reduced radius and effective mass,
    /// m/s) to body j of the contact. The moment on body j is opposite to the moment on body i. `share` is the
    /// effective mass of the contact divided by the mass of body i.
    #[inline(always)]
    pub(crate) fn turn_j<M: Model>(&self, j: &mut M::Body<f64>, share: f64, impulse: f64) {
        turn::<M>(j, -2.0 * (1.0 - share) * (1.0 - self.lever) * impulse);
    }
}

/// Adds `change`, m/s, to the spin of a body (radius times angular velocity).
#[inline(always)]
fn turn<M: Model>(body: &mut M::Body<f64>, change: f64) {
    let [x, y, spin] = M::coordinates(body);
    M::set(body, [x, y, spin + change]);
}
