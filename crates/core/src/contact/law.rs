//! The contact laws, written as projections of the impulse of one contact.
//!
//! Signorini's law with cohesion (Abramian & Staron 2020, eq. 3 and 8, Fig. 2b) requires 0 ≤ N + C₀ ⟂ v̄_n ≥ 0 (both
//! sides are at least 0, and at least one of them is 0), with the normal force N and the cohesion force C₀ (both in
//! newton) and the formal velocity v̄ = (v^n + ρ v^{n−1}) / (1 + ρ). Here v^{n−1} and v^n are the relative velocities
//! (m/s) of the two bodies before and after step number n, and ρ is the restitution. The subscripts n and t denote the
//! normal and the tangential component. Over one step N = P/Δt, with the impulse P (N·s) and the time step Δt (s). A
//! positive factor does not change a complementarity condition, so the law can be divided by the effective mass m_ij.
//! The reduced impulse is λ = P/m_ij (m/s), with a normal component λ_n and a tangential component λ_t. The shifted
//! normal impulse is σ = λ_n + C₀Δt/m_ij (m/s): it includes the largest impulse of cohesion, so that it is never
//! negative. With u = v_n^n + ρ v_n^{n−1} (m/s) the law is
//!
//! > 0 ≤ σ ⟂ u ≥ 0   ⇔   σ = max(σ − u, 0).
//!
//! C₀Δt/m_ij = Bond·a·Δt is the capture speed (m/s), with the Bond number Bond and the acceleration a, which is g
//! unless another acceleration is given. It is the same for all contacts of a scene, unless the scene gives the
//! cohesion for pairs of materials. The law for σ is the law of a contact without cohesion, so cohesion only adds a
//! constant pulling impulse to the impulses that act on the two bodies. Without cohesion the capture speed is 0.
//!
//! Coulomb's law with the friction coefficient μ is |λ_t| ≤ μσ in the shifted cone and |λ_t| ≤ μ max(σ − capture speed,
//! 0) in the compressive cone, in which only the pushing part of the normal impulse bounds friction. Both have the form
//! |λ_t| ≤ μ max(σ − c, 0), with the tip of the cone at c. In the shifted cone c is 0, and every σ that Signorini's law
//! allows is at least 0.

use super::lanes::Lanes;
use crate::world::FrictionCone;

/// Parameters of the contact law that are the same for all contacts of a step.
#[derive(Clone, Copy, Debug, Default)]
pub struct ContactLaw {
    /// Friction coefficient μ.
    pub friction: f64,
    capture_speed: f64,
    /// Position c of the tip of the friction cone on the axis of the shifted normal impulse σ (normal impulse plus the
    /// largest impulse of cohesion, divided by the effective mass), m/s. Friction is possible for σ > c.
    tip: f64,
    cone: FrictionCone,
}

impl ContactLaw {
    /// Returns the law with a friction coefficient μ, a capture speed C₀Δt/m_ij (the opening speed that cohesion
    /// cancels in one step, m/s: cohesion force times time step, divided by effective mass; 0 without cohesion) and a
    /// friction cone.
    #[inline(always)]
    pub fn new(friction: f64, capture_speed: f64, cone: FrictionCone) -> Self {
        let tip = match cone {
            FrictionCone::Shifted => 0.0,
            FrictionCone::Compressive => capture_speed,
        };
        Self { friction, capture_speed, tip, cone }
    }

    /// Returns this law with another capture speed, m/s. The capture speed is the opening speed that cohesion cancels
    /// in one step.
    #[inline(always)]
    pub(crate) fn with_capture_speed(self, capture_speed: f64) -> Self {
        Self::new(self.friction, capture_speed, self.cone)
    }

    /// Capture speed C₀Δt/m_ij = Bond·a·Δt, m/s: the opening speed that cohesion cancels in one step (Bond: Bond
    /// number, C₀: cohesion force, m_ij: effective mass, a: acceleration of cohesion, Δt: time step). 0 in a scene
    /// without cohesion.
    #[inline(always)]
    pub fn capture_speed(&self) -> f64 {
        self.capture_speed
    }

    /// The friction cone of this law: shifted if the normal force plus the cohesion force bounds friction, or
    /// compressive if only a pushing normal force does.
    pub fn cone(&self) -> FrictionCone {
        self.cone
    }

    /// True if the friction coefficient times the shifted normal impulse (normal impulse plus the largest impulse of
    /// cohesion, so that it is never negative) bounds friction. The tip of the friction cone is then at a shifted
    /// normal impulse of 0.
    #[inline(always)]
    pub(crate) fn all_rubs(&self) -> bool {
        self.tip == 0.0
    }

    /// Returns σ − c, m/s: the part of the shifted normal impulse σ that bounds friction. σ is the normal impulse per
    /// effective mass plus the capture speed (the opening speed that cohesion cancels in one step), and c is its value
    /// at the tip of the friction cone. If σ − c is negative, friction is not possible.
    #[inline(always)]
    pub(crate) fn rubbing<T: Lanes>(&self, shifted_impulse: T) -> T {
        shifted_impulse - shifted_impulse.same(self.tip)
    }

    /// Returns the largest tangential impulse per effective mass (m/s) that the friction cone allows. The argument is
    /// the shifted normal impulse: the normal impulse per effective mass plus the capture speed (the opening speed that
    /// cohesion cancels in one step), m/s.
    #[inline(always)]
    pub fn friction_bound<T: Lanes>(&self, shifted_impulse: T) -> T {
        shifted_impulse.same(self.friction) * signorini(self.rubbing(shifted_impulse))
    }
}

/// Returns the cohesion force, newton: Bond number times effective mass (kg) times the acceleration of cohesion (m/s²).
/// In Abramian & Staron 2020, eq. 10, this acceleration is g.
pub(crate) fn cohesion_force(bond: f64, effective_mass: f64, acceleration: f64) -> f64 {
    bond * effective_mass * acceleration
}

/// Projects a shifted normal impulse σ onto the allowed values σ ≥ 0. σ is the normal impulse per effective mass plus
/// the capture speed (the opening speed that cohesion cancels in one step), m/s.
#[inline(always)]
pub(crate) fn signorini<T: Lanes>(shifted_impulse: T) -> T {
    shifted_impulse.larger(shifted_impulse.same(0.0))
}

/// Projects a tangential impulse onto the interval from −`bound` to `bound`, both in the same unit.
#[inline(always)]
pub(crate) fn coulomb<T: Lanes>(tangential_impulse: T, bound: T) -> T {
    tangential_impulse.larger(-bound).smaller(bound)
}

/// Returns the point (σ, λ_t) of the friction cone |λ_t| ≤ μσ that is nearest to the trial point `trial` = (a, b). Both
/// points consist of a shifted normal impulse (normal impulse plus the largest impulse of cohesion) and a tangential
/// impulse, per effective mass, m/s. μ is the friction coefficient. Distances are measured in the metric diag(1, c)
/// with the tangential compliance c = m_n/m_t: the effective mass m_n along the normal, divided by the effective mass
/// m_t along the tangent. The result is the trial point itself if |b| ≤ μa, the apex (0, 0) of the cone if a + μc|b| ≤
/// 0, and otherwise the point of the nearer edge that
///
/// > minimises ½(σ − a)² + ½c(μσ − |b|)²:  σ = (a + μc|b|)/(1 + μ²c),  λ_t = ±μσ.
#[inline(always)]
pub(crate) fn nearest_on_cone(
    friction: f64,
    tangential_compliance: f64,
    [normal, tangential]: [f64; 2],
) -> [f64; 2] {
    let across = tangential.abs();
    if across <= friction * normal {
        return [normal, tangential];
    }
    let pull = friction * tangential_compliance;
    let shifted = signorini((normal + pull * across) / (1.0 + friction * pull));
    [shifted, (friction * shifted).copysign(tangential)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_contact_pulls_no_harder_than_its_cohesion() {
        let capture_speed = 2.0;
        let projected =
            |reduced_impulse: f64| signorini(reduced_impulse + capture_speed) - capture_speed;
        assert_eq!(projected(-3.0), -2.0);
        assert_eq!(projected(-1.0), -1.0);
        assert_eq!(projected(4.0), 4.0);
    }

    #[test]
    fn the_two_cones_differ_where_the_contact_pulls() {
        let pulling = 1.0;
        let bound = |cone| ContactLaw::new(0.5, 2.0, cone).friction_bound(pulling);
        assert_eq!(bound(FrictionCone::Shifted), 0.5);
        assert_eq!(bound(FrictionCone::Compressive), 0.0);
        assert_eq!(coulomb(-3.0, 0.5), -0.5);
    }
}
