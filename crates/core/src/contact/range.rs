//! The law `range`: a bond that exists until it has been stretched by the debonding distance δ_c, whatever the time
//! step.
//!
//! **The law.** Two grains that have touched are bonded. A bond pulls with at most the cohesion force C₀ (N). While
//! the bond is open, it pulls with exactly C₀. It breaks when it has opened by the debonding distance δ_c (m), so
//! breaking it takes the work C₀·δ_c. A pair of effective mass m_ij that is thrown apart faster than the escape speed
//! √(2C₀δ_c/m_ij) separates, and a slower pair does not. A steady pull below C₀ never separates the pair.
//!
//! **Earlier laws of finite range.** The wet law of LMGC90, `IQS_WET_DS_CLB` (its manual, *Contact laws*), applies
//! Signorini's and Coulomb's laws to R_n + C₀ (normal force plus cohesion force) for every pair whose gap is at most
//! the thickness W_thk when the step begins: a constant pull over a finite range, and the shifted friction cone. In
//! `xQS_WET_DS_CLB` broken bonds stay broken, and in `RST_WET_CLB` grains bounce. All three laws depend on the gap and
//! pull during the whole step, as in `examples/wet_law.rs`. In the law `range` a pair pulls only after it has touched,
//! and the pull depends on how far the bond has been stretched since then. Breaking a bond takes the same work at
//! every time step Δt, and collisions bounce.
//!
//! **Why the impulse of a bond is bounded in each step.** A pair that is thrown apart faster than the escape speed
//! breaks its bond within the time √(2δ_c m_ij/C₀). In a step that is much longer than this time, the bond therefore
//! exists only at the beginning of the step. If N ≥ −C₀ were the only condition on the normal force N, the bond could
//! pull for all of Δt. It would then stop any opening slower than C₀Δt/m_ij and take any amount of work, so cohesion
//! would grow with Δt. But a bond pulls only as long as it exists. So its impulse is bounded by C₀·min(Δt, τ), with τ
//! (s) the time at which the bond has opened by δ_c.
//!
//! **The time τ in a step.** Let the bond be stretched by s (m) and open with the speed v (m/s) at the beginning of the
//! step, after the collisions of the step, which are solved first (`sim::steppers::range::bonds`). Let the forces on
//! the two grains, other than the bond itself, change this speed evenly by J (m/s) during the step. The bond changes it
//! by −C, with C = C₀Δt/m_ij (m/s). With the resulting acceleration a (m/s²), the bond is stretched at the time t (s)
//! after the beginning of the step by
//!
//! > s(t) = s + v t + ½ a t²,  a = (J − C)/Δt,
//!
//! and τ is the first root of s(τ) = δ_c. With the remaining opening D = δ_c − s,
//!
//! > τ = 2D / (v + √(v² + 2aD)),
//!
//! or infinite if the root is not real or the denominator is not positive. This formula distinguishes a shock, which
//! gives the speed v, from a load, which gives the change J. A load below C₀ alone (v = 0, J < C) never breaks the
//! bond, however long the step is. A shock is stopped only if the kinetic energy ½ m_ij v² is below the remaining
//! work. For an isolated pair the formula is exact: the step ends with the speed of the continuous motion.
//!
//! If the step does not break the bond, the stretch s grows by Δt·(v + v^n)/2, where v^n is the opening speed at the
//! end of the step. This is exact for a constant force. The bond stores the stretch s and not the gap, which differs
//! from s by the order of Δt². So the work C₀·s equals the work of the impulses. Two bonded grains that circle each
//! other do not tear their bond, although their gap opens by (Δt v_t)²/2d in every step and closes in the next step
//! (v_t: tangential velocity, d: diameter).

use serde::{Deserialize, Serialize};

use super::law;

/// Gap or overlap, in mean diameters, below which a contact counts as exactly closed, because rounding and the
/// tolerance of the solver cause gaps of this size. The solver does not close such a gap or push out such an overlap:
/// it applies the law of a touching contact. Without this allowance each contact of a bonded network would demand a gap
/// of exactly zero. This is impossible, because a bonded network has more contacts than its grains have degrees of
/// freedom.
pub(crate) const TOUCH_IN_DIAMETERS: f64 = 1e-4;

/// State of the bond of one contact under the law `range`: whether it exists, and how far it is stretched.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Bond {
    /// True if the bond exists: under the law `range`, if the two bodies have touched and their bond has not broken
    /// since. Under other laws, true if the pair counts as touching, so that cohesion acts.
    pub alive: bool,
    /// Stretch s of the bond, m: the distance by which the two bonded bodies have been pulled apart. 0 if they touch.
    pub stretch: f64,
}

/// Data on how one bond opens during one step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OpeningMotion {
    /// Opening that remains before the bond breaks, D = δ_c − s, m (δ_c: debonding distance, s: stretch).
    pub left: f64,
    /// Speed v at which the two bonded bodies move apart at the beginning of the step, m/s.
    pub speed: f64,
    /// Load J, m/s: change of the opening speed during the step by all forces other than the bond itself.
    pub load: f64,
}

impl OpeningMotion {
    /// Returns the largest reduced impulse (impulse per effective mass) of the bond in a step, C·min(1, τ/Δt) in m/s.
    /// `time_step_secs` is the time step Δt. `capture_speed` is C, the change of speed (m/s) that the force of the
    /// bond causes in a whole step. The bond breaks after the time τ.
    pub(crate) fn bound(&self, capture_speed: f64, time_step_secs: f64) -> f64 {
        let Self { left, speed, load } = *self;
        let acceleration = (load - capture_speed) / time_step_secs;
        let squared = speed * speed + 2.0 * acceleration * left;
        if squared < 0.0 {
            return capture_speed;
        }
        let denominator = speed + squared.sqrt();
        if denominator * time_step_secs <= 2.0 * left {
            return capture_speed;
        }
        capture_speed * 2.0 * left / (denominator * time_step_secs)
    }
}

/// Returns the escape speed √(2C₀δ_c/m_ij), m/s. Two bonded grains that are thrown apart faster than this speed
/// separate. The cohesion force per effective mass, C₀/m_ij (m/s²), is the Bond number `bond` times the acceleration of
/// cohesion `acceleration` (m/s²), and δ_c is the debonding distance `debonding_distance` (m).
pub fn escape_speed(bond: f64, acceleration: f64, debonding_distance: f64) -> f64 {
    (2.0 * law::cohesion_force(bond, 1.0, acceleration) * debonding_distance).sqrt()
}

/// Returns the time √(2δ_c m_ij/C₀), s, in which the cohesion force C₀ of a bond alone moves two grains of effective
/// mass m_ij from rest towards each other by the debonding distance δ_c, `debonding_distance` (m). In the same time the
/// bond stops two grains that separate at the escape speed. C₀/m_ij (m/s²) is the Bond number `bond` times the
/// acceleration of cohesion `acceleration` (m/s²). Infinite without cohesion.
pub(crate) fn bond_time_secs(bond: f64, acceleration: f64, debonding_distance: f64) -> f64 {
    (2.0 * debonding_distance / law::cohesion_force(bond, 1.0, acceleration)).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    const CAPTURE_SPEED: f64 = 2.0;
    const TIME_STEP_SECS: f64 = 0.1;

    fn bound(left: f64, speed: f64, load: f64) -> f64 {
        OpeningMotion { left, speed, load }.bound(CAPTURE_SPEED, TIME_STEP_SECS)
    }

    #[test]
    fn a_load_below_the_cohesion_holds_and_a_shock_takes_the_work() {
        assert_eq!(bound(1e-3, 0.0, 1.9), CAPTURE_SPEED);
        // The escape speed v has v² = 2·(C/Δt)·D, with the capture speed C, the time step Δt and the remaining
        // opening D.
        let escape = (2.0 * CAPTURE_SPEED / TIME_STEP_SECS * 1e-3f64).sqrt();
        assert_eq!(bound(1e-3, 0.99 * escape, 0.0), CAPTURE_SPEED);
        let speed = 1.5 * escape;
        let after = speed - bound(1e-3, speed, 0.0);
        let work = 0.5 * (speed * speed - after * after);
        assert!((work - 0.5 * escape * escape).abs() < 1e-14);
    }

    #[test]
    fn a_load_above_the_cohesion_takes_the_work_on_its_way_out() {
        let (left, load) = (1e-3, 5.0);
        let force = CAPTURE_SPEED / TIME_STEP_SECS;
        let time = bound(left, 0.0, load) / force;
        let acceleration = load / TIME_STEP_SECS - force;
        assert!((0.5 * acceleration * time * time - left).abs() < 1e-15);
    }
}
