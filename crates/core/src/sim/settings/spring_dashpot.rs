//! Springs and dashpots of the discrete-element stepper `dem`: stiffness, damping, and longest stable substep.
//!
//! **Damping from restitution.** Two discs with the effective mass m_ij meet with the closing speed v. Their contact
//! has the stiffness k, the damping coefficient γ and the damping ratio ζ. With ω₀ = √(k/m_ij) and γ = 2ζ m_ij ω₀, the
//! overlap δ obeys δ̈ + 2ζω₀ δ̇ + ω₀² δ = 0 until the contact force is 0. From then on the discs fly freely. For ζ < 1
//! write ζ = cos φ, so that δ ∝ e^{−ζω₀t} sin(ω₀ sin φ t). The force is 0 when δ̈ = 0, that is at ω₀ sin φ t = 2φ, and
//! the speed at this time is v e^{−ζω₀t}. So the restitution is
//!
//! > ρ = exp(−2ζ arccos ζ / √(1 − ζ²)),  for ζ > 1  ρ = exp(−2ζ arcosh ζ / √(ζ² − 1)),
//!
//! and e^{−2} at ζ = 1. The restitution decreases with ζ, towards 1/(4ζ²), and no finite damping makes it 0. So
//! restitutions below [`LEAST_RESTITUTION`] are raised to this value.
//!
//! **Contact time.** The time from the first touch until the contact force is 0 (T. Schwager & T. Pöschel, 2007) is
//!
//! > t_c = (2/ω₀) arccos ζ / √(1 − ζ²),  for ζ > 1  t_c = (2/ω₀) arcosh ζ / √(ζ² − 1),
//!
//! which is π/ω₀ without damping, and ρ = e^{−ζω₀t_c}. The discs are still separating at that time.
//!
//! **Work of fracture.** A bonded pair with the cohesion force C₀ and without load rests at the overlap C₀/k, at which
//! the normal force is 0. If the pair is pulled apart so slowly that the dashpot has no effect, it resists with the
//! force C₀ − kδ until δ = 0, and then no longer. So the work of fracture is
//!
//! > W = ∫₀^{C₀/k} (C₀ − kδ) dδ = C₀²/(2k).
//!
//! A pair that is thrown apart may lose more energy. If γ v_n > kδ, with the opening speed v_n, spring and dashpot do
//! not push, and the full C₀ pulls. A pair that separates at such a speed loses C₀·C₀/k = 2W, which is the largest
//! possible loss.
//!
//! **Critical time step.** A substep of length h first updates the velocities, with the forces at its beginning, and
//! then the positions. A mode of vibration with the frequency ω (rad/s) and the damping ratio ζ changes per substep by
//! a factor z with z² − (2 − 2ζωh − ω²h²) z + 1 − 2ζωh = 0. The mode is unstable if |z| > 1. The first root z to leave
//! the unit circle does so at z = −1, when ω²h² + 4ζωh = 4, at the critical time step
//!
//! > h = (2/ω) (√(1 + ζ²) − ζ).
//!
//! Let each body of a contact have n contacts, and give 1/n of the body's mass to each of them. Then no mode of the
//! whole system is faster than the fastest mode of a single contact, for which ω² = n k/m_ij and the damping ratio is
//! ζ√n. The tangential stiffness is k_t = k m_t/m_n and the tangential damping γ_t = γ m_t/m_n, with the effective
//! masses m_n and m_t along normal and tangent. So the tangential mode is as fast as the normal mode.

use crate::error::{Error, Result};
use crate::number::rounded_down;
use crate::sim::pull::acceleration_of_springs;
use crate::sim::settings::fracture_work::effective_mass_of_mean;
use crate::world::{MAX_SUBSTEPS, Parameters, Physics, World};

/// Overlap at the bottom of a pile, caused by the weight of the whole pile, if the stiffness is chosen automatically,
/// in mean diameters. A smaller value makes springs stiffer; they cost more, because the longest stable substep (part
/// of a step) is proportional to the square root of this value. A larger value makes grains so soft that their overlap
/// shows in the shape of the pile.
const STATIC_OVERLAP: f64 = 1e-3;
/// Smallest restitution that the dashpots reproduce; smaller restitutions are raised to this value. A smaller value
/// requires more damping, and makes the longest stable substep (part of a step) shorter: its length is proportional to
/// the square root of this value.
const LEAST_RESTITUTION: f64 = 0.02;
/// Length of a substep (part of a step) divided by the critical time step, if the number of substeps is automatic. With
/// a larger value a collision has fewer substeps and its restitution is less exact; at 1 the simulation may become
/// unstable.
const SAFE_FRACTION: f64 = 0.5;
/// Number of equal discs that fit around one disc: 6 in the plane, and 2 on a line.
const NEIGHBOURS: [f64; 2] = [6.0, 2.0];
/// Number of bisections in the search for the damping ratio: enough to reach the rounding of `f64`.
const HALVINGS: u32 = 60;

/// Spring and dashpot that act at each contact of a world under the stepper `dem`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpringDashpot {
    /// Stiffness k, N/m.
    pub stiffness: f64,
    /// Damping ratio ζ of a single contact, dimensionless.
    pub damping_ratio: f64,
}

impl SpringDashpot {
    /// Returns the spring and dashpot for these parameters. If the parameter `stiffness` is 0, the stiffness is chosen
    /// from the weight of a pile of the world's grains. If the parameter `damping_ratio` is 0, the damping ratio is
    /// chosen so that collisions have the restitution in the parameters.
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

    /// Returns the damping coefficient γ of a contact with this effective mass (kg), N·s/m.
    pub(crate) fn damping(&self, effective_mass: f64) -> f64 {
        2.0 * self.damping_ratio * (self.stiffness * effective_mass).sqrt()
    }

    /// Returns the critical time step, s: the longest substep (part of a step) that is stable for contacts with this
    /// effective mass (kg) whose bodies have `neighbours` contacts each. The value is exact for one contact per body,
    /// and a lower bound for more contacts.
    pub fn critical_time_step_secs(&self, effective_mass: f64, neighbours: f64) -> f64 {
        let frequency = (neighbours * self.stiffness / effective_mass).sqrt();
        let damping_ratio = self.damping_ratio * neighbours.sqrt();
        2.0 / frequency / (libm::hypot(damping_ratio, 1.0) + damping_ratio)
    }

    /// Returns the contact time t_c, s: the duration of a collision of two discs with this effective mass (kg) without
    /// cohesion.
    pub fn contact_time_secs(&self, effective_mass: f64) -> f64 {
        let frequency = (self.stiffness / effective_mass).sqrt();
        match angle_and_root(self.damping_ratio) {
            Some((angle, root)) => 2.0 * angle / root / frequency,
            None => 2.0 / frequency,
        }
    }

    /// Returns the work of fracture C₀²/(2k), J, of a bond with the cohesion force C₀ (`cohesion_force`, N).
    pub fn fracture_work(&self, cohesion_force: f64) -> f64 {
        0.5 * cohesion_force * cohesion_force / self.stiffness
    }
}

/// Returns the stiffness, N/m, at which the weight of a column of grains causes the overlap [`STATIC_OVERLAP`]. Of n
/// grains the column contains √n in the plane, and all n on a line.
fn stiffness_for_weight(world: &World, axes: u8, parameters: &Parameters) -> f64 {
    let masses = &world.grains.masses;
    let count = masses.len() as f64;
    let column = if axes == 1 { count } else { count.sqrt() };
    let g = acceleration_of_springs(world, parameters);
    let load = column * g * masses.iter().sum::<f64>() / count;
    load / (STATIC_OVERLAP * world.mean_diameter)
}

/// Returns the damping ratio ζ with which a collision has this restitution.
fn damping_ratio(restitution: f64) -> f64 {
    let wanted = restitution.max(LEAST_RESTITUTION);
    // Upper end of the search, 1/√ρ: with this damping ratio the restitution is below the wanted ρ for every ρ < 1.
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

/// Returns the angle (rad) and the root in the formulas for restitution and contact time, for the damping ratio ζ:
/// arccos ζ and √(1 − ζ²) for ζ < 1, or arcosh ζ and √(ζ² − 1) for ζ > 1. Returns `None` at ζ = 1, where both are 0 and
/// the formulas use the limit 1 of the quotient angle/root.
fn angle_and_root(damping_ratio: f64) -> Option<(f64, f64)> {
    // Written as a product, because the difference 1 − ζ² would lose digits near ζ = 1.
    let root = ((1.0 - damping_ratio) * (1.0 + damping_ratio)).abs().sqrt();
    // Computed from the root, because arccos ζ and arcosh ζ would lose digits near ζ = 1.
    let angle =
        if damping_ratio < 1.0 { libm::atan2(root, damping_ratio) } else { libm::asinh(root) };
    (root != 0.0).then_some((angle, root))
}

/// Returns the longest substep (part of a step), s, for which the springs are stable even if the smallest grains have
/// as many neighbours as fit around them.
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

/// Returns the duration t_c of a collision of two grains of the mean mass, s.
pub(super) fn contact_time_secs(world: &World, physics: Physics, parameters: &Parameters) -> f64 {
    let springs = SpringDashpot::of(world, physics.axes, parameters);
    springs.contact_time_secs(effective_mass_of_mean(world))
}

/// Returns the number of substeps (equal parts) of a step: the number in the parameters or, if that is 0, the number
/// for which the springs are stable. [`check_substeps`] refuses parameters that need too many substeps.
pub(super) fn substeps(world: &World, physics: Physics, parameters: &Parameters) -> u32 {
    match parameters.substeps {
        0 => (stable_substeps(world, physics, parameters) as u32).clamp(1, MAX_SUBSTEPS),
        asked => asked,
    }
}

/// Returns the number of substeps (equal parts) per step for which a substep is at most [`SAFE_FRACTION`] of the
/// critical time step. There is no upper limit.
pub(in crate::sim) fn stable_substeps(
    world: &World,
    physics: Physics,
    parameters: &Parameters,
) -> f64 {
    let longest_secs = SAFE_FRACTION * critical_time_step_secs(world, physics, parameters);
    (parameters.time_step_secs / longest_secs).ceil()
}

/// Checks that the automatic number of substeps (equal parts of a step), for which the springs are stable, is at most
/// [`MAX_SUBSTEPS`]. The error names the stiffness if it is too large, or else the time step if it is too long.
pub(super) fn check_substeps(
    world: &World,
    physics: Physics,
    parameters: &Parameters,
) -> Result<()> {
    let Parameters { stiffness, time_step_secs, substeps, .. } = *parameters;
    let most = f64::from(MAX_SUBSTEPS);
    let stable = stable_substeps(world, physics, parameters);
    // Without grains, `stable` is NaN and there is nothing to check.
    if substeps > 0 || stable.is_nan() || stable <= most {
        return Ok(());
    }
    let critical_with = |stiffness: f64| {
        let springs = Parameters { stiffness, ..*parameters };
        critical_time_step_secs(world, physics, &springs)
    };
    let need = format!("would need more than {MAX_SUBSTEPS} substeps");
    if stiffness > 0.0 {
        // Scales from stiffness 1 N/m, because the critical time step is proportional to 1/√stiffness.
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
