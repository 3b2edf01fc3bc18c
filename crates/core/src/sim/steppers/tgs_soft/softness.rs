//! A soft contact in a substep.
//!
//! **Softness.** The spring's force is −k s − γ ṡ at gap s, with ω² = k/m_ij and ζ = γ/(2 m_ij ω). Taken
//! at the end of the substep, s + h v and v, its impulse is σ = −h(ω²(s + h v) + 2ζω v), which with
//! a = 2ζ + hω is σ = −hωa (v + s ω/a). A Gauss–Seidel update asks that of the velocity v + Δσ it makes:
//!
//! > Δσ = −(1 − c)(v + s ω/a) − c σ,  c = 1/(1 + hωa).
//!
//! The spring carries σ, not λ_n: N + C₀ = −k s at rest, as for the smooth discrete elements. Sprung at
//! λ_n, a contact that pulls would rest at a positive gap, where it has no cohesion, and let go.

use super::super::touching::Touching;
use crate::contact::law;
use crate::sim::pull::gravity_that_scales;
use crate::solver::{Kinematics, Model};
use crate::world::{Parameters, World};

/// ω/2π of the springs, in units of √(g/d): 30 Hz for discs of 1 m, as engines have it. Higher: less
/// overlap, but beyond [`FREQUENCY_PER_SUBSTEP`] of the substeps' rate it does not go.
const FREQUENCY: f64 = 10.0;
/// Largest h ω/2π. Higher: the contact is all but rigid, and one sweep no longer gets through a pile.
const FREQUENCY_PER_SUBSTEP: f64 = 0.25;
/// ζ of the springs. Lower: overlap leaves in a hurry, and piles jitter.
const DAMPING_RATIO: f64 = 10.0;
/// Fastest push out of an overlap, in units of √(g·d). Higher: deep overlaps explode; lower: they stay.
const PUSH_OUT_SPEED: f64 = 1.0;

/// What all contacts of a step share.
pub(super) struct Softness {
    substep_secs: f64,
    /// ω/a, 1/s.
    rate: f64,
    /// c.
    compliance: f64,
    /// m/s.
    push_out_speed: f64,
    friction: f64,
}

impl Softness {
    pub(super) fn new(world: &World, parameters: &Parameters, substep_secs: f64) -> Self {
        let diameter = world.mean_diameter;
        let g = gravity_that_scales(world);
        let highest = FREQUENCY_PER_SUBSTEP / substep_secs;
        let frequency = std::f64::consts::TAU * highest.min(FREQUENCY * (g / diameter).sqrt());
        let damping = 2.0 * DAMPING_RATIO + substep_secs * frequency;
        Self {
            substep_secs,
            rate: frequency / damping,
            compliance: 1.0 / (1.0 + substep_secs * frequency * damping),
            push_out_speed: PUSH_OUT_SPEED * (g * diameter).sqrt(),
            friction: parameters.friction,
        }
    }

    /// Projects the impulses of the substep before on what the contact allows now.
    #[inline(always)]
    pub(super) fn warm_start<M: Model>(&self, contact: &mut Touching) -> [f64; 2] {
        let shifted = law::signorini(contact.impulse[0] + contact.capture_speed);
        let bound = self.bound::<M>(shifted, contact.capture_speed);
        contact.impulse =
            [shifted - contact.capture_speed, law::coulomb(contact.impulse[1], bound)];
        contact.impulse
    }

    /// One contact of a sweep, with its relative velocities: the change of its impulses.
    #[inline(always)]
    pub(super) fn solve<M: Model, const SOFT: bool>(
        &self,
        contact: &mut Touching,
        [normal_velocity, tangential_velocity]: [f64; 2],
    ) -> [f64; 2] {
        let (bias, compliance) = if contact.gap > 0.0 {
            (contact.gap / self.substep_secs, 0.0)
        } else if SOFT {
            ((self.rate * contact.gap).max(-self.push_out_speed), self.compliance)
        } else {
            (0.0, 0.0)
        };
        let before = contact.impulse;
        let shifted = before[0] + contact.capture_speed;
        let closing = normal_velocity - contact.wall_speed + bias;
        let [answer, tangential_answer] = contact.answers;
        let change = (1.0 - compliance) * closing / answer + compliance * shifted;
        let shifted = law::signorini(shifted - change);
        contact.impulse[0] = shifted - contact.capture_speed;
        if M::FRICTION {
            let bound = self.bound::<M>(shifted, contact.capture_speed);
            let part = 1.0 / M::Kinematics::TANGENTIAL_COMPLIANCE;
            let slip = tangential_velocity - contact.surface_speed;
            contact.impulse[1] = law::coulomb(before[1] - part * slip / tangential_answer, bound);
        }
        [contact.impulse[0] - before[0], contact.impulse[1] - before[1]]
    }

    #[inline(always)]
    fn bound<M: Model>(&self, shifted: f64, capture_speed: f64) -> f64 {
        if M::FRICTION { M::friction_bound(self.friction, shifted, capture_speed) } else { 0.0 }
    }
}
