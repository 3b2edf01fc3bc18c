//! Validates a gas of cohesive discs without gravity and friction: the energy that collisions lose by cohesion, and its
//! dependence on the time step Δt and on the contact law.
//!
//! Consider N discs of mass m. Their temperature is T = ½ m⟨v²⟩, at first T₀, and their energy is N T. In total they
//! collide N R √(T/T₀) times per second, with R = √π n d χ √(T₀/m) (derived in `validate::cooling`). Here n is the
//! number of discs per area, d the diameter, and χ the pair correlation at contact. In collisions the approach speed v
//! of a pair has the mean √(πT/m) and the mean square 4T/m. The effective mass of a pair is m_ij = m/2. ρ is the
//! restitution.
//!
//! **Stepper `range`, ρ = 1.** Each collision makes a bond, and breaking the bond takes the work W = C₀ δ_c, with the
//! cohesion force C₀ and the debonding distance δ_c (bonds pull up to this gap). So dT/dt = −R W √(T/T₀), with the time
//! t:
//!
//! > T = T₀ (1 − t/t₀)²,  t₀ = 2 T₀/(R W),  until T is about W.
//!
//! A pair whose energy is less than W stays bonded. This happens in the fraction W/T of the collisions, and the next
//! collision of such a pair breaks its bond.
//!
//! **Stepper `moreau`, touch tolerance 0.** A pair bounces in the first step that begins with an overlap. In this step,
//! cohesion takes no energy, because the contact pushes: in the contact law of `docs/theory.md`, σ > 0 and u = 0. Here
//! σ is the impulse divided by the effective mass, plus the capture speed, and u = v_n⁺ + ρ v_n⁻ with the normal
//! velocities v_n⁻ before and v_n⁺ after the step. For ρ = 1 the velocity of the pair is reversed. So at the end of the
//! step the pair is as far apart as it was one step before the overlap. It no longer touches, and cohesion does not act
//! in later steps.
//!
//! > Without a loss by restitution, cohesion of any strength takes no energy: T = T₀.
//!
//! For ρ < 1, let g be the gap one step before the overlap, which is evenly distributed in 0 … vΔt. After the bounce
//! the gap is g − (1 − ρ) vΔt. So in the fraction 1 − ρ of the collisions (if ρ ≥ ½) the pair still touches, and opens
//! with the speed w = ρ v. In the next step, cohesion reduces this speed by the capture speed c = C₀Δt/m_ij, which
//! takes the energy ½ m_ij (2 w c − c²). With the loss (1 − ρ²) T by restitution and x = √(T₀/T),
//!
//! > dx/dt = ½ R (1 − ρ²) + ¼ R (1 − ρ) (√π ρ k x − ½ k² x²),  k = c √(m/T₀).
//!
//! For k x ≪ 1 this is Haff's law with an exponential: x = (1 + b) e^{t/2τ} − b, with b = (1 − ρ²) R τ and the time τ,
//! in which cohesion alone lowers T by the factor 1/e:
//!
//! > 1/τ = ½ π ρ (1 − ρ) n d χ C₀Δt/m_ij:  τ Δt is constant.
//!
//! The loss by restitution is measured in the same gas without cohesion. The measured effect of cohesion is fitted by
//! this equation, with an additional factor of the cohesive term, which should be 1.

use std::f64::consts::PI;

use super::cooling::{RESTITUTION, THERMAL_SPEED, collisions_per_distance, gas, side};
use super::experiment::*;
use super::variants::{SolveBudget, StepVariant};
use super::watched::WatchedRun;
use crate::error::Result;
use crate::scene::stability::DIAMETER;
use crate::sim::Stepper;
use crate::solver::Method;
use crate::statistics::slope;
use crate::world::{DEBONDING_DISTANCE, Periodic};

pub(super) const EXPERIMENT: Experiment = Experiment {
    name: "cohesive-cooling",
    title: "Cooling gas with cohesion",
    about: "The same gas in a periodic cell, with cohesion C₀ = m_ij · 5 m/s². Under range with ρ = 1 each collision \
            costs the work of a bond, and T = T₀ (1 − t/t₀)² with Enskog's t₀. Under moreau a pair with ρ = 1 has \
            left when the next step begins, and cohesion takes nothing. With ρ = 0.9 it acts in a tenth of the \
            collisions for one step, and takes energy at a rate proportional to Δt: exponential cooling, \
            1/τ = ½ π ρ (1 − ρ) n d χ C₀Δt/m_ij.",
    cases: ExperimentCases::Own(cases),
    published: PUBLISHED,
    judge,
};

/// Cohesion force divided by the effective mass of a pair, C₀/m_ij, m/s². With this value, breaking a bond of the
/// stepper `range` takes a fortieth of the initial temperature T₀ (an energy), and the capture speed (the opening speed
/// that one step of cohesion stops) is at most a fifth of the thermal speed √(2T₀/m), with the mass m of a disc.
const COHESION: f64 = 5.0;
/// The shorter of the two time steps of the experiment, s.
const SHORT: f64 = 2e-3;
/// The longer of the two time steps of the experiment, s.
const LONG: f64 = 4e-3;
/// Duration of the runs with the stepper `range`, in units of the time in which breaking bonds would take all energy of
/// the gas.
const OF_BONDS: f64 = 0.5;
/// Duration of the runs with the stepper `moreau`, in units of 2/(R (1 − ρ²)), with the collision rate R per disc and
/// the restitution ρ.
const OF_RESTITUTION: f64 = 3.0;
/// Number of simulated times at which the temperature is measured in a run.
const MOMENTS: u32 = 120;

fn cases(effort: Effort) -> Vec<ExperimentCase> {
    let (discs, seeds) = effort.pick((400, 4), (2_000, 10));
    let one = (Stepper::Moreau, 1.0, LONG);
    let runs = [SHORT, LONG]
        .map(|secs| [(Stepper::Range, 1.0, secs), (Stepper::Moreau, RESTITUTION, secs)]);
    let kinds = [runs.concat(), vec![one]].concat();
    seeded(&kinds, seeds, |(stepper, restitution, time_step_secs), seed| {
        let run = GasRun { discs, seed, stepper, restitution, time_step_secs };
        let at = [
            ("range", f64::from(u8::from(stepper == Stepper::Range))),
            ("restitution", restitution),
            ("dt", time_step_secs),
            ("discs", f64::from(discs)),
            ("seed", seed as f64),
        ];
        let cost = f64::from(discs) * run.duration_secs() / time_step_secs;
        ExperimentCase::new(&at, cost, move || run.measured())
    })
}

struct CooledGas {
    run: WatchedRun,
    /// Times, s, and the values of x = √(T₀/T) at these times, with the temperature T and the initial temperature T₀.
    points: Vec<(f64, f64)>,
    /// Thermal speed √(2T₀/m) at the start, m/s, with the initial temperature T₀ and the mass m of a disc.
    thermal_speed: f64,
}

#[derive(Clone, Copy, Debug)]
struct GasRun {
    discs: u32,
    seed: u64,
    stepper: Stepper,
    restitution: f64,
    time_step_secs: f64,
}

impl GasRun {
    /// Returns the theoretical number R of collisions at the initial temperature T₀, per disc and second, 1/s.
    /// `thermal_speed` is the initial thermal speed √(2T₀/m), m/s, with the mass m of a disc.
    fn rate(&self, thermal_speed: f64) -> f64 {
        collisions_per_distance(f64::from(self.discs)) * thermal_speed / 2f64.sqrt()
    }

    /// Returns the theoretical time t₀, s, in which breaking bonds would take all energy of the gas. `thermal_speed` is
    /// the initial thermal speed √(2T₀/m), m/s, with the initial temperature T₀ and the mass m of a disc. The formula
    /// is t₀ = 2 T₀/(R W), with the collision rate R per disc and the work W to break a bond. T₀/W is the square of the
    /// thermal speed divided by C₀δ_c/m_ij, with the cohesion force C₀, the debonding distance δ_c and the effective
    /// mass m_ij.
    fn bond_time(&self, thermal_speed: f64) -> f64 {
        let work = COHESION * DEBONDING_DISTANCE * DIAMETER;
        2.0 * thermal_speed.powi(2) / (self.rate(thermal_speed) * work)
    }

    fn duration_secs(&self) -> f64 {
        if self.restitution == 1.0 {
            return OF_BONDS * self.bond_time(THERMAL_SPEED);
        }
        2.0 * OF_RESTITUTION / (self.rate(THERMAL_SPEED) * (1.0 - self.restitution.powi(2)))
    }

    /// Runs the gas with a cohesion force of `cohesion` (m/s²) times the effective mass of a pair, and returns the
    /// measured decrease of its temperature.
    fn cooled(&self, cohesion: f64) -> Result<CooledGas> {
        let mut scene = gas(self.discs as usize, self.seed);
        let half = 0.5 * side(f64::from(self.discs));
        scene.boundaries.clear();
        scene.periodic = Some(Periodic::along_both([-half, half], [-half, half]));
        scene.physics.cohesion = true;
        scene.parameters.bond = 1.0;
        scene.parameters.bond_acceleration = cohesion;
        scene.parameters.restitution = self.restitution;
        scene.parameters.touch_tolerance = 0.0;
        let Self { stepper, time_step_secs, .. } = *self;
        let (method, budget) = (Method::Auto, SolveBudget::Default);
        StepVariant { stepper, method, time_step_secs, budget }.apply(&mut scene);
        let mut run = WatchedRun::start(&scene)?;
        let start = run.simulation.observables().kinetic_energy;
        let mut points = vec![(0.0, 1.0)];
        for moment in 1..=MOMENTS {
            let secs = f64::from(moment) / f64::from(MOMENTS) * self.duration_secs();
            run.run_until(secs, |_| ())?;
            let energy = run.simulation.observables().kinetic_energy;
            points.push((run.simulation.time_secs(), (start / energy).sqrt()));
        }
        let mass: f64 = run.simulation.world().grains.masses.iter().sum();
        Ok(CooledGas { run, points, thermal_speed: (2.0 * start / mass).sqrt() })
    }

    fn measured(&self) -> Result<RunReadings> {
        let CooledGas { run, points, thermal_speed } = self.cooled(COHESION)?;
        let last = points.last().map_or(f64::NAN, |(_, x)| *x);
        if self.restitution == 1.0 {
            let roots: Vec<(f64, f64)> = points.iter().map(|(t, x)| (*t, 1.0 / x)).collect();
            let (early, late) = roots.split_at(roots.len() / 2);
            return Ok(run.with([
                ("time", -1.0 / slope(&roots) / self.bond_time(thermal_speed)),
                ("straightness", slope(late) / slope(early)),
                ("kept", last.powi(-2)),
            ]));
        }
        let without = slope(&self.cooled(0.0)?.points);
        Ok(run.with([("factor", self.factor(&points, without, thermal_speed))]))
    }

    /// Returns the ratio f of the measured effect of cohesion to the predicted effect, by least squares. With the
    /// temperature T, its initial value T₀ and x = √(T₀/T), it is the factor f in x − 1 − a t = f ∫ ¼ R (1 − ρ) (√π ρ k
    /// x − ½ k² x²) dt. a is dx/dt without cohesion (`without`, 1/s). R is the collision rate per disc, ρ the
    /// restitution, and k the capture speed times √(m/T₀), with the mass m of a disc.
    fn factor(&self, points: &[(f64, f64)], without: f64, thermal_speed: f64) -> f64 {
        let rho = self.restitution;
        let k = 2f64.sqrt() * COHESION * self.time_step_secs / thermal_speed;
        let rate = |x: f64| {
            0.25 * self.rate(thermal_speed)
                * (1.0 - rho)
                * (PI.sqrt() * rho * k * x - 0.5 * (k * x).powi(2))
        };
        let (mut integral, mut xy, mut xx) = (0.0, 0.0, 0.0);
        for pair in points.windows(2) {
            let ((from, before), (to, x)) = (pair[0], pair[1]);
            integral += 0.5 * (to - from) * (rate(before) + rate(x));
            xy += integral * (x - 1.0 - without * to);
            xx += integral * integral;
        }
        xy / xx
    }
}

/// Table of published values as text, with one row for each quantity that the function [`judge`] computes from the
/// runs. A row has the form: name of the quantity | lower end of the band of values that agree, published value, upper
/// end of the band | kind of the source (`read`, `recalled`, `derived` or `exact`): source. t₀ is the time in which
/// breaking bonds would take all energy of the gas, 1/τ the rate at which cohesion lowers the temperature. The bands of
/// t₀ are as wide as that of the cooling time in `validate::cooling`. The bands of 1/τ are wider, because only a tenth
/// of the collisions of 2,000 discs determines this rate.
const PUBLISHED: &str = "
    range: t₀ over that of kinetic theory, short Δt | 0.9 1 1.1 | derived: Enskog's rate, work of a bond
    range: t₀ over that of kinetic theory, long Δt | 0.9 1 1.1 | derived: Enskog's rate, work of a bond
    range: slope of √T in the second half over the first, short Δt | 0.9 1 1.1 | derived: T = T₀ (1 − t/t₀)²
    moreau, ρ = 1: T at the end over T₀, long Δt | 0.98 1 1.001 | derived: a pair that bounces is no longer in touch
    moreau, ρ = 0.9: 1/τ over that of kinetic theory, short Δt | 0.75 1 1.25 | derived: one step of cohesion
    moreau, ρ = 0.9: 1/τ over that of kinetic theory, long Δt | 0.75 1 1.25 | derived: one step of cohesion
    moreau, ρ = 0.9: 1/τ at long Δt over that at short Δt | 1.6 2 2.4 | derived: τ Δt is constant
";

fn judge(all: &Measurements) -> Vec<Measured> {
    let system =
        format!("{} discs, Δt = {} s, {}", all.first("discs"), all.list("dt"), all.seeds());
    let of = |is_range: f64, restitution: f64, secs: f64, reading: &str| {
        all.with("range", is_range)
            .with("restitution", restitution)
            .with("dt", secs)
            .readings(reading)
    };
    let [short, long] = [SHORT, LONG].map(|secs| of(0.0, RESTITUTION, secs, "factor"));
    let ratios = short.iter().zip(&long).map(|(short, long)| long / short * LONG / SHORT).collect();
    let values = [
        of(1.0, 1.0, SHORT, "time"),
        of(1.0, 1.0, LONG, "time"),
        of(1.0, 1.0, SHORT, "straightness"),
        of(0.0, 1.0, LONG, "kept"),
        short,
        long,
        ratios,
    ];
    values.map(|values| (system.clone(), values)).into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gas_pays_for_bonds_under_range_and_keeps_its_energy_under_moreau() {
        let run = |stepper| {
            let run =
                GasRun { discs: 100, seed: 3, stepper, restitution: 1.0, time_step_secs: LONG };
            run.measured().expect("a gas that stays finite")
        };
        let time = run(Stepper::Range).reading("time");
        assert!((time - 1.0).abs() < 0.2, "{time}");
        let kept = run(Stepper::Moreau).reading("kept");
        assert!((0.98..1.001).contains(&kept), "{kept}");
    }
}
