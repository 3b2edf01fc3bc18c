//! The law `range`: a bond that lives until it has been stretched by δ_c, whatever the time step.
//!
//! **The law.** Two grains that have touched are bonded. A bond pulls with at most C₀, and as long as
//! it is open it pulls with just that, until it has opened by the debonding distance δ_c: breaking it
//! takes the work C₀·δ_c. So a pair thrown apart faster than the escape speed √(2C₀δ_c/m_ij) parts, and
//! a slower one does not; a steady pull below C₀ never parts it.
//!
//! **Older laws of finite range.** The wet law of LMGC90, `IQS_WET_DS_CLB` (its manual, *Contact laws*), has Signorini's and
//! Coulomb's laws on R_n + C₀ for every pair whose gap is at most W_thk as the step begins: a constant pull over a finite range,
//! and the shifted cone. Its `xQS_WET_DS_CLB` lets what is broken stay so. Both go by the gap, pull through the whole of a step,
//! and do not bounce; `examples/wet_law.rs` is such a law. Here a pair pulls once it has touched, by what has stretched it
//! since; breaking it takes the same work at every Δt; and what meets bounces.
//!
//! **Why a step needs a bound of its own.** A step that is long against the time of a break,
//! √(2δ_c m_ij/C₀), sees nothing of it but its beginning. If all it knows is N ≥ −C₀, the bond may pull
//! for all of Δt, stops any opening slower than C₀Δt/m_ij, and takes any work: cohesion grows with Δt.
//! A bond pulls no longer than it lives, so its impulse is bounded by C₀·min(Δt, τ), with τ the time at
//! which it has opened by δ_c.
//!
//! **τ in a step.** Let the bond be stretched by s and open with v at the beginning of the step, once
//! the shocks of the step have gone through (`sim::steppers::range::bonds`), and let the other forces on the two grains
//! change that speed by J during the step, evenly. With C = C₀Δt/m_ij the pair opens as
//!
//! > s(t) = s + v t + ½ a t²,  a = (J − C)/Δt,
//!
//! and τ is the first root of s(τ) = δ_c: with D = δ_c − s,
//!
//! > τ = 2D / (v + √(v² + 2aD)),
//!
//! never where the root is not real or the denominator not positive. A shock (v) and a load (J) are
//! told apart here: a load below C₀ alone (v = 0, J < C) never breaks the bond, however long the step,
//! while a shock is stopped only if ½m v² is below the work that is left. For a pair by itself this is
//! exact: the step ends with the speed that the continuous motion has.
//!
//! Where the step does not break the bond, the stretch grows by Δt·(v + v^n)/2, exact for a constant
//! force. That is what the bond remembers, and not the gap, which is of the order of Δt² off it: the
//! work C₀·s is then that of the impulses, and a pair that turns about itself, whose gap opens in every
//! step by (Δt v_t)²/2d and closes in the next, does not tear its bond.

use serde::{Deserialize, Serialize};

use super::law;

/// Gaps and overlaps below this many diameters are the rounding and the solver's tolerance. A contact
/// with less neither has its gap closed nor its overlap pushed out, and it bounces. Without that room
/// every contact of a bonded network, which has more contacts than its grains have ways to move, would
/// ask for a gap of zero and could not get it.
pub(crate) const TOUCH_IN_DIAMETERS: f64 = 1e-4;

/// A contact's bond.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Bond {
    /// True where the pair has touched since it last parted.
    pub alive: bool,
    /// s: how far it has been opened against its pull, m; 0 where the pair touches.
    pub stretch: f64,
}

/// The opening of one bond during one step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OpeningMotion {
    /// D = δ_c − s, m.
    pub left: f64,
    /// v, m/s.
    pub speed: f64,
    /// J: what the other forces add to v in the step, m/s.
    pub load: f64,
}

impl OpeningMotion {
    /// C·min(1, τ/Δt), m/s: the largest reduced impulse that the bond can take up in a step of
    /// `time_step_secs` in which its force alone would change the speed by `capture_speed` (C).
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

/// √(2C₀δ_c/m_ij), m/s, where C₀/m_ij is Bond times that acceleration (m/s²): a pair that is thrown apart faster parts.
pub fn escape_speed(bond: f64, acceleration: f64, debonding_distance: f64) -> f64 {
    (2.0 * law::cohesion_force(bond, 1.0, acceleration) * debonding_distance).sqrt()
}

/// √(2δ_c m_ij/C₀), s: the time in which the pull of a bond alone would open it, or close it, by δ_c.
/// Infinite without cohesion.
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
        // v² = 2·(C/Δt)·D is the escape speed.
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
