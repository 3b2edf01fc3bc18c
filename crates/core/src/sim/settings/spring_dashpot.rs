//! Springs and dashpots of discrete elements: stiffness, damping, and largest stable substep.
//!
//! **Damping from restitution.** Two discs meet with closing speed v. With ω₀ = √(k/m_ij) and γ = 2ζ m_ij ω₀,
//! δ̈ + 2ζω₀ δ̇ + ω₀² δ = 0 until the force is 0; from then on they fly freely. For ζ < 1 write ζ = cos φ, so that
//! δ ∝ e^{−ζω₀t} sin(ω₀ sin φ t). Setting δ̈ = 0 gives ω₀ sin φ t = 2φ, and the speed at this time is v e^{−ζω₀t}. So
//!
//! > ρ = exp(−2ζ arccos ζ / √(1 − ζ²)),  for ζ > 1  ρ = exp(−2ζ arcosh ζ / √(ζ² − 1)),
//!
//! and e^{−2} at ζ = 1. It decreases with ζ, towards 1/(4ζ²), and reaches 0 at no finite damping: restitutions below
//! [`LEAST_RESTITUTION`] are raised to it.
//!
//! **Contact time.** The time at which the force ends (T. Schwager & T. Pöschel, 2007) is
//!
//! > t_c = (2/ω₀) arccos ζ / √(1 − ζ²),  for ζ > 1  t_c = (2/ω₀) arcosh ζ / √(ζ² − 1),
//!
//! which is π/ω₀ without damping, and ρ = e^{−ζω₀t_c}. The discs are still separating at that time.
//!
//! **Work of fracture.** A bonded pair without load rests at the overlap C₀/k, at which N = 0. If it is pulled apart
//! so slowly that the dashpot has no effect, it resists with C₀ − kδ, and with nothing from δ = 0 on:
//!
//! > W = ∫₀^{C₀/k} (C₀ − kδ) dδ = C₀²/(2k).
//!
//! A pair that is thrown apart may lose more. If γ v_n > kδ, spring and dashpot do not push, and the full C₀ pulls. A
//! pair that separates at such a speed loses C₀·C₀/k = 2W, which is the largest possible loss.
//!
//! **Critical time step.** Velocities are updated first, then positions, with the forces of the beginning of the
//! substep. A mode of frequency ω and damping ratio ζ has z² − (2 − 2ζωh − ω²h²) z + 1 − 2ζωh = 0. Its first root
//! leaves the unit circle at z = −1, when ω²h² + 4ζωh = 4:
//!
//! > h = (2/ω) (√(1 + ζ²) − ζ).
//!
//! If each body of a contact has z contacts, and each contact has 1/z of their masses, no mode of the whole system is
//! faster than the fastest mode of a single contact, with ω² = z k/m_ij and damping ratio ζ√z. With k_t = k m_t/m_n
//! and γ_t = γ m_t/m_n the tangential mode is as fast as the normal one.

use crate::error::{Error, Result};
use crate::number::rounded_down;
use crate::sim::pull::acceleration_of_springs;
use crate::sim::settings::fracture_work::effective_mass_of_mean;
use crate::world::{MAX_SUBSTEPS, Parameters, Physics, World};

/// Overlap caused by the weight of a whole pile, in d. If smaller, springs are stiffer and cost more, because h is
/// proportional to its square root; if larger, grains are so soft that their overlap shows in the shape of the pile.
const STATIC_OVERLAP: f64 = 1e-3;
/// Restitutions below this are raised to it. If smaller, damping grows, and h decreases as the square root.
const LEAST_RESTITUTION: f64 = 0.02;
/// Substep as a fraction of the critical time step, if the number of substeps is automatic. If larger, a collision
/// has fewer substeps and its restitution is less exact; at 1 the simulation may become unstable.
const SAFE_FRACTION: f64 = 0.5;
/// Number of equal discs that fit around one, in the plane and on a line.
const NEIGHBOURS: [f64; 2] = [6.0, 2.0];
/// Number of bisections in the search for the damping ratio: down to rounding.
const HALVINGS: u32 = 60;

/// Spring and dashpot of the contacts of a world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpringDashpot {
    /// Stiffness k, N/m.
    pub stiffness: f64,
    /// Damping ratio ζ of a single contact.
    pub damping_ratio: f64,
}

impl SpringDashpot {
    /// Takes stiffness and damping from the parameters. By default the springs are stiff enough for a pile of the
    /// world's grains, and damped for restitution ρ.
    pub fn of(world: &World, axes: u8, parameters: &Parameters) -> Self {
        Self {
            stiffness: match parameters.stiffness {
                0.0 => stiffness_for_weight(world, axes, parameters),
                given => given,
            },
            damping_ratio: match parameters.damping_ratio {
                0.0 => damping_ratio(parameters.restitution),
                given => given,
            },
        }
    }

    /// Damping coefficient γ of a contact, N·s/m.
    pub(crate) fn damping(&self, effective_mass: f64) -> f64 {
        2.0 * self.damping_ratio * (self.stiffness * effective_mass).sqrt()
    }

    /// The critical time step, s, of contacts with this effective mass (kg) whose bodies have `neighbours` contacts
    /// each: exact for 1, a lower bound for more.
    pub fn critical_time_step_secs(&self, effective_mass: f64, neighbours: f64) -> f64 {
        let frequency = (neighbours * self.stiffness / effective_mass).sqrt();
        let damping_ratio = self.damping_ratio * neighbours.sqrt();
        2.0 / frequency / (libm::hypot(damping_ratio, 1.0) + damping_ratio)
    }

    /// Contact time t_c, s, of two colliding discs with this effective mass (kg) and no cohesion.
    pub fn contact_time_secs(&self, effective_mass: f64) -> f64 {
        let frequency = (self.stiffness / effective_mass).sqrt();
        match angle_and_root(self.damping_ratio) {
            Some((angle, root)) => 2.0 * angle / root / frequency,
            None => 2.0 / frequency,
        }
    }

    /// Work of fracture C₀²/(2k), J, of a bond with cohesion C₀ (N).
    pub fn fracture_work(&self, cohesion_force: f64) -> f64 {
        0.5 * cohesion_force * cohesion_force / self.stiffness
    }
}

/// The stiffness, N/m, at which the weight of a column causes the static overlap. The column is as high as the number
/// of grains along an axis, √n in the plane.
fn stiffness_for_weight(world: &World, axes: u8, parameters: &Parameters) -> f64 {
    let masses = &world.grains.masses;
    let count = masses.len() as f64;
    let column = if axes == 1 { count } else { count.sqrt() };
    let g = acceleration_of_springs(world, parameters);
    let load = column * g * masses.iter().sum::<f64>() / count;
    load / (STATIC_OVERLAP * world.mean_diameter)
}

/// The damping ratio ζ that gives a restitution.
fn damping_ratio(restitution: f64) -> f64 {
    let wanted = restitution.max(LEAST_RESTITUTION);
    // At ζ = 1/√ρ the restitution is below ρ for every ρ < 1.
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

fn restitution_of(damping_ratio: f64) -> f64 {
    match angle_and_root(damping_ratio) {
        Some((angle, root)) => libm::exp(-2.0 * damping_ratio * angle / root),
        None => libm::exp(-2.0),
    }
}

/// arccos ζ and √(1 − ζ²), or arcosh ζ and √(ζ² − 1). `None` at ζ = 1, where their ratio is 1.
fn angle_and_root(damping_ratio: f64) -> Option<(f64, f64)> {
    // A product, because the difference of squares would lose digits near 1.
    let root = ((1.0 - damping_ratio) * (1.0 + damping_ratio)).abs().sqrt();
    // Computed from the root for the same reason.
    let angle =
        if damping_ratio < 1.0 { libm::atan2(root, damping_ratio) } else { libm::asinh(root) };
    (root != 0.0).then_some((angle, root))
}

/// The longest stable substep, s, if the smallest grains have as many neighbours as fit.
pub(super) fn critical_time_step_secs(
    world: &World,
    physics: Physics,
    parameters: &Parameters,
) -> f64 {
    let springs = SpringDashpot::of(world, physics.axes, parameters);
    let mut smallest = [f64::INFINITY; 2];
    for &mass in &world.grains.masses {
        smallest[1] = smallest[1].min(mass.max(smallest[0]));
        smallest[0] = smallest[0].min(mass);
    }
    let effective_mass = 1.0 / (1.0 / smallest[0] + 1.0 / smallest[1]);
    let neighbours = NEIGHBOURS[usize::from(physics.axes == 1)];
    springs.critical_time_step_secs(effective_mass, neighbours)
}

/// Contact time t_c, s, of two grains of the mean mass.
pub(super) fn contact_time_secs(world: &World, physics: Physics, parameters: &Parameters) -> f64 {
    let springs = SpringDashpot::of(world, physics.axes, parameters);
    springs.contact_time_secs(effective_mass_of_mean(world))
}

/// The requested number of substeps, or by default the number that is stable ([`check_substeps`] refuses too many).
pub(super) fn substeps(world: &World, physics: Physics, parameters: &Parameters) -> u32 {
    match parameters.substeps {
        0 => (stable_substeps(world, physics, parameters) as u32).clamp(1, MAX_SUBSTEPS),
        asked => asked,
    }
}

/// Number of substeps that keeps h at the safe fraction of the critical step. Not limited.
pub(in crate::sim) fn stable_substeps(
    world: &World,
    physics: Physics,
    parameters: &Parameters,
) -> f64 {
    let longest_secs = SAFE_FRACTION * critical_time_step_secs(world, physics, parameters);
    (parameters.time_step_secs / longest_secs).ceil()
}

/// Refuses springs so stiff, or steps so long, that the allowed number of substeps is not stable.
pub(super) fn check_substeps(
    world: &World,
    physics: Physics,
    parameters: &Parameters,
) -> Result<()> {
    let Parameters { stiffness, time_step_secs, substeps, .. } = *parameters;
    let most = f64::from(MAX_SUBSTEPS);
    let stable = stable_substeps(world, physics, parameters);
    // `stable` is NaN without grains.
    if substeps > 0 || stable.is_nan() || stable <= most {
        return Ok(());
    }
    let critical_with = |stiffness: f64| {
        let springs = Parameters { stiffness, ..*parameters };
        critical_time_step_secs(world, physics, &springs)
    };
    let need = format!("would need more than {MAX_SUBSTEPS} substeps");
    if stiffness > 0.0 {
        // The critical step decreases as the square root of the stiffness.
        let root = most * SAFE_FRACTION * critical_with(1.0) / time_step_secs;
        let most_stiff = rounded_down(root * root);
        let allowed = format!(
            "at most {most_stiff:e} N/m where dt is {time_step_secs} s: stiffer springs {need}"
        );
        return Err(Error::value("stiffness", stiffness, allowed));
    }
    let longest_secs = rounded_down(most * SAFE_FRACTION * critical_with(stiffness));
    let allowed = format!("at most {longest_secs:e} s where stepper is dem: a longer step {need}");
    Err(Error::value("dt", time_step_secs, allowed))
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
