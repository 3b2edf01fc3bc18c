//! Springs and dashpots of discrete elements: how stiff, how damped, and stable up to which substep.
//!
//! **Damping from restitution.** Two discs meet with closing speed v. With ω₀ = √(k/m_ij) and
//! γ = 2ζ m_ij ω₀, δ̈ + 2ζω₀ δ̇ + ω₀² δ = 0 until the force is 0, and from then on they fly. For ζ < 1 write
//! ζ = cos φ, so that δ ∝ e^{−ζω₀t} sin(ω₀ sin φ t). Setting δ̈ = 0 gives ω₀ sin φ t = 2φ, and there
//! the speed is v e^{−ζω₀t}. So
//!
//! > ρ = exp(−2ζ arccos ζ / √(1 − ζ²)),  for ζ > 1  ρ = exp(−2ζ arcosh ζ / √(ζ² − 1)),
//!
//! e^{−2} between the two. It falls with ζ, towards 1/(4ζ²), and reaches 0 at no finite damping:
//! smaller restitutions than [`LEAST_RESTITUTION`] are taken as that.
//!
//! **Critical time step.** Velocities first, then positions, with the forces of the beginning of
//! the substep: a mode of frequency ω and damping ratio ζ has z² − (2 − 2ζωh − ω²h²) z + 1 − 2ζωh = 0,
//! and its first root to leave the unit circle does so at z = −1, where ω²h² + 4ζωh = 4:
//!
//! > h = (2/ω) (√(1 + ζ²) − ζ).
//!
//! If each of the bodies of a contact has z contacts, and each contact its 1/z of their masses, no
//! mode of the whole is faster than the fastest one of a contact by itself, ω² = z k/m_ij, ζ√z.
//! With k_t = k m_t/m_n and γ_t = γ m_t/m_n the tangential mode is as fast as the normal one.

use crate::sim::pull::GRAVITY_IF_NONE;
use crate::world::{MAX_SUBSTEPS, Parameters, Physics, World};

/// Overlap that the weight of a whole pile makes, in d. Smaller: stiffer and dearer, h ∝ its root;
/// larger: softer grains, until their overlap shows in the shape of the pile.
const STATIC_OVERLAP: f64 = 1e-3;
/// Restitution below this is taken as this. Smaller: more damping, and h falls as its root.
const LEAST_RESTITUTION: f64 = 0.02;
/// Substeps are this part of the critical step where their number is left to the scheme. Larger:
/// a collision is cut into fewer substeps, and its restitution is less exact; at 1 it may blow up.
const SAFE_FRACTION: f64 = 0.5;
/// Equal discs that fit around one, in the plane and on a line.
const NEIGHBOURS: [f64; 2] = [6.0, 2.0];
/// Halvings of the interval that the damping ratio is looked for in: down to rounding.
const HALVINGS: u32 = 60;

/// Spring and dashpot of the contacts of a world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpringDashpot {
    /// k, N/m.
    pub stiffness: f64,
    /// ζ of a contact by itself.
    pub damping_ratio: f64,
}

impl SpringDashpot {
    /// Stiff enough for a pile of the world's grains, damped for restitution ρ.
    ///
    /// The load is the weight of a column as high as the grains are many along an axis, √n in the
    /// plane.
    pub fn of(world: &World, axes: u8, restitution: f64) -> Self {
        let masses = &world.grains.masses;
        let count = masses.len() as f64;
        let column = if axes == 1 { count } else { count.sqrt() };
        let g = match world.gravity.magnitude() {
            0.0 => GRAVITY_IF_NONE,
            magnitude => magnitude,
        };
        let load = column * g * masses.iter().sum::<f64>() / count;
        Self {
            stiffness: load / (STATIC_OVERLAP * world.mean_diameter),
            damping_ratio: damping_ratio(restitution),
        }
    }

    /// γ of a contact, N·s/m.
    pub(crate) fn damping(&self, effective_mass: f64) -> f64 {
        2.0 * self.damping_ratio * (self.stiffness * effective_mass).sqrt()
    }

    /// The critical time step, s, of contacts of that effective mass (kg) whose bodies have
    /// `neighbours` contacts each: exact for 1, a lower bound for more.
    pub fn critical_time_step_secs(&self, effective_mass: f64, neighbours: f64) -> f64 {
        let frequency = (neighbours * self.stiffness / effective_mass).sqrt();
        let damping_ratio = self.damping_ratio * neighbours.sqrt();
        2.0 / frequency / (damping_ratio.hypot(1.0) + damping_ratio)
    }
}

/// The ζ that gives a restitution.
fn damping_ratio(restitution: f64) -> f64 {
    let wanted = restitution.max(LEAST_RESTITUTION);
    // At ζ = 1/√ρ it is below ρ for every ρ < 1.
    let (mut low, mut high) = (0.0, 1.0 / wanted.sqrt());
    if wanted == 1.0 {
        return low;
    }
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if restitution_of(middle) > wanted {
            low = middle;
        } else {
            high = middle;
        }
    }
    high
}

/// The restitution that a damping ratio gives.
fn restitution_of(damping_ratio: f64) -> f64 {
    // As a product: near 1 the difference of squares would lose its digits.
    let root = ((1.0 - damping_ratio) * (1.0 + damping_ratio)).abs().sqrt();
    if root == 0.0 {
        return (-2f64).exp();
    }
    // arccos ζ and arcosh ζ, from the root for the same reason.
    let angle = if damping_ratio < 1.0 { root.atan2(damping_ratio) } else { root.asinh() };
    (-2.0 * damping_ratio * angle / root).exp()
}

/// The longest stable substep, s, when the smallest grains have as many neighbours as fit.
pub(super) fn critical_time_step_secs(
    world: &World,
    physics: Physics,
    parameters: &Parameters,
) -> f64 {
    let springs = SpringDashpot::of(world, physics.axes, parameters.restitution);
    let mut smallest = [f64::INFINITY; 2];
    for &mass in &world.grains.masses {
        smallest[1] = smallest[1].min(mass.max(smallest[0]));
        smallest[0] = smallest[0].min(mass);
    }
    let effective_mass = 1.0 / (1.0 / smallest[0] + 1.0 / smallest[1]);
    let neighbours = NEIGHBOURS[usize::from(physics.axes == 1)];
    springs.critical_time_step_secs(effective_mass, neighbours)
}

/// As many substeps as are asked for, or as keep h at the safe fraction of the critical step.
pub(super) fn substeps(world: &World, physics: Physics, parameters: &Parameters) -> u32 {
    if parameters.substeps > 0 {
        return parameters.substeps;
    }
    let longest_secs = SAFE_FRACTION * critical_time_step_secs(world, physics, parameters);
    let count = (parameters.time_step_secs / longest_secs).ceil();
    (count as u32).clamp(1, MAX_SUBSTEPS)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_damping_ratio_inverts_the_restitution() {
        for restitution in [LEAST_RESTITUTION, 0.1, (-2f64).exp(), 0.2, 0.5, 0.9, 0.999] {
            let found = restitution_of(damping_ratio(restitution));
            assert!((found - restitution).abs() < 1e-12, "{restitution} gave {found}");
        }
        assert_eq!(damping_ratio(1.0), 0.0);
        assert_eq!(damping_ratio(0.0), damping_ratio(LEAST_RESTITUTION));
    }
}
