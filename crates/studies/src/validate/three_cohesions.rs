//! Validates that one material has one cohesion: sheared layers, cliffs and slopes of the same grains must give the same
//! macroscopic cohesion c (N/m in a plane).
//!
//! By Mohr and Coulomb a material of the friction angle φ slips where the shear stress reaches τ = c + p tan φ, with
//! the pressure p. With the bulk density ρ_b and gravity g, c follows in three ways:
//!
//! 1. **Shear.** τ of a layer between rough plates is measured at several small pressures. c is the intercept of the
//!    line through the points (p, τ), and tan φ its slope.
//! 2. **Cliff.** A vertical cliff is stable up to the height H = (4c/(ρ_b g)) tan(45° + φ/2), if it slips along a plane.
//! 3. **Slope.** A layer of the depth D on a rough base flows from the angle θ on, with
//!    tan θ = tan φ + c/(ρ_b g D cos θ).
//!
//! All ways give the dimensionless cohesion ĉ = c/(ρ_b g d), with the diameter d. It should be proportional to the
//! Bond number. The estimate of H. Rumpf (1970), derived in `validate::cliff`, is ĉ/Bond = Z tan φ/8 with Z contacts per
//! grain.
//!
//! **Why the bands are wide.** They were fixed before the first run. A slip plane gives an upper bound for H, and
//! cliffs of grains may fail in other ways (in `validate::cliff` at 0.32 of a bound that uses Rumpf's c). Slopes and
//! cliffs fail from rest, and shear measures flow: for grains without cohesion, slopes have a tan φ that is about 1.4
//! times as large (`validate::repose`, `validate::shear`). Layers are 6 to 12 d deep, so plates and bases are felt, and
//! slopes are measured about 3° too late at this rate of tilting. Each of these effects is some tens of per cent. So two
//! values of c agree if their ratio is between 1/2 and 2, and exponents agree within 0.3.
//!
//! The main law is `range`, whose bonds do not depend on Δt. `moreau` is run with two time steps: for slow pulls its
//! cohesion does not depend on Δt, and for shocks it grows with Δt, so the exponent of c in Δt should be between 0 and 1.

use std::f64::consts::{FRAC_PI_4, PI};

use glam::DVec2;

use super::collapse::{CollapsingColumn, FLOOR};
use super::experiment::*;
use super::fit::middle;
use super::repose::{FLOWN, shuffled};
use super::shear::{DENSE, inside, on_plates, rate};
use super::variants::{SolveBudget, StepVariant};
use super::watched::{WatchedRun, at_rest, centre_of_mass, loose, settled, solid_fraction};
use crate::error::Result;
use crate::scene::experiments::{ShearCell, half_width, shear_of};
use crate::scene::stability::{DIAMETER, GRAVITY, dry};
use crate::sim::Stepper;
use crate::solver::Method;
use crate::statistics::{mean, slope};
use crate::world::{Disc, GravityTurn, Parameters, Periodic, TurnCourse};

pub(super) const EXPERIMENT: Experiment = Experiment {
    name: "three-cohesions",
    title: "One cohesion in three ways",
    about: "The macroscopic cohesion c of one material with μ = 0.5 (Mohr, Coulomb), as ĉ = c/(ρ_b g d), from the \
            intercept of τ = c + p tan φ in sheared layers, from the Bond number at which a cliff of the height \
            H = (4c/(ρ_b g)) tan(45° + φ/2) just stands (its mean height falls by less than a tenth), and from the angle \
            at which a layer of the depth D begins to flow, tan θ = tan φ + c/(ρ_b g D cos θ). Shear gives the friction of \
            flow, and slopes that of rest. range at Δt = 1e-3 s; moreau at 5e-4 s and 2e-3 s.",
    cases: ExperimentCases::Own(cases),
    published: PUBLISHED,
    judge,
};

/// Values of the parameter `way`, the kind of a run: a sheared layer, a cliff, a slope.
const SHEAR: f64 = 0.0;
const CLIFF: f64 = 1.0;
const SLOPE: f64 = 2.0;
/// Laws of the experiment, each a stepper with its time step Δt, s. The parameter `law` of a run is the index.
const LAWS: [(Stepper, f64); 3] =
    [(Stepper::Range, 1e-3), (Stepper::Moreau, 5e-4), (Stepper::Moreau, 2e-3)];
/// Bond numbers of sheared layers and slopes.
const BONDS: [f64; 2] = [8.0, 24.0];
/// Heights of the cliffs, in diameters. The quick pass has the first only.
const HEIGHTS: [f64; 2] = [8.0, 12.0];
/// Height of a cliff divided by half its width. The slip planes from both sides do not meet below the top.
const ASPECT: f64 = 1.2;
/// Decrease of the mean height of a cliff, relative to the first mean height, below which the cliff stands.
const STANDS: f64 = 0.1;
/// Range of the Bond numbers of a cliff, divided by its height in diameters, and the number of bisections in it. The
/// result is exact to 5 %.
const BRACKET: [f64; 2] = [0.5, 8.0];
const BISECTIONS: u32 = 5;
/// Sheared layer: about 10 diameters high.
const CELL: ShearCell = ShearCell { wide: 12, columns: 10, rows: 12 };
/// Pressure on the sheared layer without cohesion, in m g/d, with mass m and diameter d of a grain.
const DRY_PRESSURE: f64 = 6.0;
/// Shear rate, 1/s. It is so low that the inertial number is about 0.04 without cohesion, and less with cohesion.
const SHEAR_RATE: f64 = 4.0;
/// Simulated times, s: shear without cohesion that packs the layer, shear with cohesion before the measurement, and
/// measurement.
const TIMES_SECS: [f64; 3] = [0.3, 0.25, 0.5];
/// Width of a slope, which is periodic, in diameters.
const WIDTH: f64 = 12.0;
/// Angular velocity at which a slope is tilted, rad/s, and the largest angle, rad.
const TILT_RATE: f64 = 0.3;
const STEEPEST: f64 = 1.4;
/// Height below which grains of a slope count as those at the base, in diameters.
const BASE: f64 = 2.0;

#[derive(Clone, Copy, Debug)]
struct Material {
    law: usize,
    bond: f64,
    seed: u64,
}

fn cases(effort: Effort) -> Vec<ExperimentCase> {
    let (seeds, laws, cliffs) = effort.pick((2, 1, 1), (4, LAWS.len(), HEIGHTS.len()));
    let pressures: &[f64] = effort.pick(&[1.0, 6.0], &[1.0, 3.0, 6.0]);
    let depths: &[f64] = effort.pick(&[6.0], &[6.0, 12.0]);
    let mut kinds = vec![(SHEAR, 0, 0.0, DRY_PRESSURE)];
    for law in 0..laws {
        // Of `moreau`, only the layers with the most cohesion and the low cliffs are run.
        let (bonds, heights) = if law == 0 { (&BONDS[..], cliffs) } else { (&BONDS[1..], 1) };
        let sheared = |&bond: &f64| pressures.iter().map(move |&size| (SHEAR, law, bond, size));
        kinds.extend(bonds.iter().flat_map(sheared));
        kinds.extend(HEIGHTS[..heights].iter().map(|&size| (CLIFF, law, 0.0, size)));
    }
    for bond in [0.0, BONDS[0], BONDS[1]] {
        kinds.extend(depths.iter().map(|&size| (SLOPE, 0, bond, size)));
    }
    seeded(&kinds, seeds, |(way, law, bond, size), seed| {
        let material = Material { law, bond, seed };
        let at = [("way", way), ("law", law as f64), ("bond", bond), ("size", size)];
        let at = [&at[..], &[("seed", seed as f64)]].concat();
        let cost = (1.0 + bond) * (1.0 + way) * size;
        ExperimentCase::new(&at, cost, move || match way {
            SHEAR => material.sheared(size),
            CLIFF => material.cliff(size),
            _ => material.tilted(size),
        })
    })
}

impl Material {
    fn variant(&self) -> StepVariant {
        let (stepper, time_step_secs) = LAWS[self.law];
        StepVariant { stepper, method: Method::Auto, time_step_secs, budget: SolveBudget::Default }
    }

    /// Shears a layer under a pressure (m g/d), and measures the stresses on the plates, in units of ρ_b g d. Cohesion
    /// begins when the layer is dense.
    fn sheared(&self, pressure: f64) -> Result<RunReadings> {
        let wide = f64::from(CELL.wide);
        let grains = f64::from(CELL.columns) * f64::from(CELL.rows);
        let speed = SHEAR_RATE * 0.25 * PI * grains / (DENSE * wide) * DIAMETER;
        let mut scene = shuffled(shear_of(CELL, pressure, speed), self.seed);
        scene.parameters.restitution = 0.0;
        let top = scene.fixed_discs.iter().fold(0.0, |top: f64, disc| top.max(disc.position.y));
        for grain in &mut scene.grains {
            grain.velocity.x = speed * grain.position.y / top;
        }
        self.variant().apply(&mut scene);
        let [pack_secs, begin_secs, watch_secs] = TIMES_SECS;
        let mut run = WatchedRun::start(&scene)?;
        run.run_until(pack_secs, |_| ())?;
        let parameters = Parameters { bond: self.bond, ..*run.simulation.parameters() };
        run.simulation.set_parameters(parameters)?;
        run.run_until(pack_secs + begin_secs, |_| ())?;
        let (mut forces, mut steps) = ([DVec2::ZERO; 2], 0.0);
        let (mut rates, mut solid_fractions) = (vec![], vec![]);
        run.run_until(pack_secs + begin_secs + watch_secs, |simulation| {
            let state = simulation.moment();
            let now = on_plates(&state, u32::from(CELL.wide));
            forces.iter_mut().zip(now).for_each(|(force, now)| *force += now);
            steps += 1.0;
            rates.push(rate(&state) / SHEAR_RATE);
            if simulation.observables().step.is_multiple_of(25) {
                let [low, high] = inside(&state);
                solid_fractions
                    .push(solid_fraction(&state, |place| (low..high).contains(&place.y)));
            }
        })?;
        let solid_fraction = mean(&solid_fractions).mean;
        let weight = solid_fraction * scene.areal_density * GRAVITY * DIAMETER;
        let unit = 2.0 * steps * weight * wide * DIAMETER;
        let [lower, upper] = forces;
        Ok(run.with([
            ("tangential", (upper.x - lower.x) / unit),
            ("normal", (lower.y - upper.y) / unit),
            ("solid_fraction", solid_fraction),
            ("rate", mean(&rates).mean),
        ]))
    }

    /// Searches the Bond number from which on a cliff of this height (in diameters) stands; NaN if it is outside the
    /// searched range.
    fn cliff(&self, height: f64) -> Result<RunReadings> {
        let grains = (height / (ASPECT * half_width(1, ASPECT))).powi(2).round() as usize;
        let column = CollapsingColumn { grains, aspect: ASPECT, seed: self.seed, bond: 0.0 };
        let settled = column.settled(self.variant())?;
        let ends = BRACKET.map(|end| end * height);
        let [mut falls, mut stands] = ends;
        let mut all = RunReadings::default();
        for _ in 0..BISECTIONS {
            let bond = (falls * stands).sqrt();
            let run = CollapsingColumn { bond, ..column }.released(&settled, self.variant())?;
            let has_stood = run.reading("slump") < STANDS;
            *(if has_stood { &mut stands } else { &mut falls }) = bond;
            all.simulated_secs += run.simulated_secs;
            all.steps += run.steps;
            all.unsolved_steps += run.unsolved_steps;
            all.readings = run.readings;
        }
        let is_inside = falls > ends[0] && stands < ends[1];
        let bond = if is_inside { (falls * stands).sqrt() } else { f64::NAN };
        let height = all.reading("aspect") * half_width(grains, ASPECT);
        all.readings = named([("bond", bond), ("height", height)]);
        Ok(all)
    }

    /// Tilts a layer of this depth (in diameters) until its grains have moved by [`FLOWN`].
    fn tilted(&self, depth: f64) -> Result<RunReadings> {
        let count = (depth * WIDTH * DENSE * 4.0 / PI).round() as usize;
        let mut grains = loose(count, WIDTH, self.seed);
        grains.iter_mut().for_each(|grain| grain.position.y += 0.6 * DIAMETER);
        let mut scene = dry("incline", grains);
        let half = 0.5 * WIDTH;
        let disc = |k: u32| Disc {
            position: DIAMETER * DVec2::new(f64::from(k) + 0.5 - half, 0.0),
            radius: 0.5 * DIAMETER,
        };
        scene.fixed_discs = (0..WIDTH as u32).map(disc).collect();
        scene.periodic = Some(Periodic::along_x([-half, half].map(|x| x * DIAMETER)));
        scene.duration_secs = 60.0;
        self.variant().apply(&mut scene);
        let settled = settled(&scene)?;
        let depth = 2.0 * (centre_of_mass(&settled.simulation).y / DIAMETER - FLOOR);
        scene.grains = at_rest(&settled);
        scene.parameters.bond = self.bond;
        let course = TurnCourse::Rate { rate: TILT_RATE };
        scene.gravity_turn = Some(GravityTurn { course, elapsed_secs: 0.0 });
        let mut run = WatchedRun::start(&scene)?;
        let start = run.simulation.moment().grains;
        loop {
            let time_secs = run.simulation.time_secs();
            run.run_until(time_secs + 0.01, |_| ())?;
            let now = run.simulation.moment().grains;
            // The mean shift, in diameters, of all grains that were below a height at the start.
            let shift_below = |height: f64| {
                let pairs = start.iter().zip(&now);
                let low = pairs.filter(|(start, _)| start.position.y < height * DIAMETER);
                let shifts = low.map(|(start, now)| (now.unwrapped - start.unwrapped).x / DIAMETER);
                mean(&shifts.collect::<Vec<_>>()).mean
            };
            let (shift, angle) = (shift_below(f64::INFINITY), TILT_RATE * time_secs);
            if shift >= FLOWN || angle >= STEEPEST {
                let angle = if shift >= FLOWN { angle } else { f64::NAN };
                let at_base = ("at_base", shift_below(BASE) / shift);
                return Ok(run.with([("angle", angle), ("depth", depth), at_base]));
            }
        }
    }
}

/// Returns the intercept and the slope of the least-squares line through points (x, y).
fn line(points: &[(f64, f64)]) -> [f64; 2] {
    let (slope, (x, y)) = (slope(points), middle(points));
    [y - slope * x, slope]
}

/// Returns the cohesion ĉ and tan φ of the sheared layers of one Bond number.
fn of_shear(layers: &Measurements) -> [f64; 2] {
    line(&layers.points(|run| (run.reading("normal"), run.reading("tangential"))))
}

/// Returns the cohesion ĉ of a material of which cliffs stand up to this height, in diameters.
fn of_cliff(height: f64, tan_phi: f64) -> f64 {
    height / (4.0 * (FRAC_PI_4 + 0.5 * tan_phi.atan()).tan())
}

/// Returns tan φ and ĉ/Bond of slopes. Slopes that did not flow are left out.
fn of_slopes(slopes: &Measurements) -> [f64; 2] {
    let flowing = slopes.such_that(|run| run.reading("angle").is_finite());
    line(&flowing.points(|run| {
        let angle = run.reading("angle");
        (run.at("bond") / (run.reading("depth") * angle.cos()), angle.tan())
    }))
}

/// Table of values as text, with one row for each quantity that the function [`judge`] computes from the runs. A row
/// has the form: name of the quantity | lower end of the band of values that agree, published value, upper end of the
/// band | kind of the source (`read`, `recalled`, `derived` or `exact`): source. The rows of `moreau` are the last.
const PUBLISHED: &str = "
    ĉ/Bond, shear | 0.08 0.16 0.32 | derived: Rumpf 1970: Z tan φ/8 with Z = 3.6
    ĉ/Bond, cliffs | 0.08 0.16 0.32 | derived: Rumpf 1970: Z tan φ/8 with Z = 3.6
    ĉ/Bond, slopes | 0.08 0.16 0.32 | derived: Rumpf 1970: Z tan φ/8 with Z = 3.6
    ĉ of cliffs over that of shear | 0.5 1 2 | derived: Mohr, Coulomb
    ĉ of slopes over that of shear | 0.5 1 2 | derived: Mohr, Coulomb
    ĉ of cliffs over that of slopes | 0.5 1 2 | derived: Mohr, Coulomb
    exponent of ĉ in Bond, shear | 0.7 1 1.3 | derived: c is proportional to Bond
    exponent of the height in Bond, cliffs | 0.7 1 1.3 | derived: c is proportional to Bond
    exponent of ĉ in Bond, slopes | 0.7 1 1.3 | derived: c is proportional to Bond
    tan φ without cohesion, shear | 0.22 0.3 0.38 | derived: T/N + 1.1 I of other experiments, μ = 0.4 to 0.5
    tan φ of cohesive shear over that without cohesion | 0.7 1 1.3 | derived: Mohr, Coulomb
    tan φ of slopes over that of shear without cohesion | 0.9 1.3 1.7 | derived: friction of rest exceeds that of flow
    shear rate inside over that of the plates, Bond 24 | 0.7 1 1.2 | derived: no slip at rough plates
    shift at the base over mean shift, slopes, Bond 24 | 0 0.3 0.7 | derived: layers fail inside
    moreau: exponent of ĉ in Δt, shear | 0.02 0.3 1 | derived: 0 for slow pulls, more for shocks
    moreau: exponent of ĉ in Δt, cliffs | 0.02 0.3 1 | derived: 0 for slow pulls, more for shocks
    moreau, Δt = 5e-4 s: ĉ/Bond, shear | 0.08 0.16 0.32 | derived: Rumpf 1970: Z tan φ/8 with Z = 3.6
    moreau, Δt = 5e-4 s: ĉ/Bond, cliffs | 0.08 0.16 0.32 | derived: Rumpf 1970: Z tan φ/8 with Z = 3.6
";

fn judge(all: &Measurements) -> Vec<Measured> {
    let of = |way: f64| all.with("way", way).with("law", 0.0);
    let [pressures, heights, depths] = [SHEAR, CLIFF, SLOPE].map(|way| of(way).list("size"));
    let system = format!("P = {pressures} m g/d, H = {heights} d, D = {depths} d, {}", all.seeds());
    let seeds = all.by_seed(|runs| of_seed(&runs));
    let count = seeds.first().map_or(0, Vec::len);
    let values = |index: usize| seeds.iter().map(|numbers| numbers[index]).collect();
    (0..count).map(|index| (system.clone(), values(index))).collect()
}

/// Returns the numbers of one seed in the order of [`PUBLISHED`].
fn of_seed(runs: &Measurements) -> Vec<f64> {
    let of = |way: f64, law: f64| runs.with("way", way).with("law", law);
    let exponent = |[low, high]: [f64; 2], base: f64| (high / low).ln() / base.ln();
    let [few, many] = BONDS;
    let dry = of(SHEAR, 0.0).with("bond", 0.0);
    let tan_phi = dry.reading("tangential") / dry.reading("normal");
    let sheared = |law: f64, bond: f64| of_shear(&of(SHEAR, law).with("bond", bond));
    let [[weak, weak_phi], [strong, strong_phi]] = BONDS.map(|bond| sheared(0.0, bond));
    let shear = 0.5 * (weak / few + strong / many);
    let cliffs = |law: f64| {
        let of_one = |(height, bond)| of_cliff(height, tan_phi) / bond;
        let points = of(CLIFF, law).points(|run| (run.reading("height"), run.reading("bond")));
        mean(&points.into_iter().map(of_one).collect::<Vec<_>>()).mean
    };
    let cliff = cliffs(0.0);
    let logarithms = |run: &MeasuredCase| (run.reading("bond").ln(), run.reading("height").ln());
    let [slope_phi, slope] = of_slopes(&of(SLOPE, 0.0));
    let of_bond = |bond: f64| {
        let cohesion = |run: &&MeasuredCase| {
            let angle = run.reading("angle");
            run.reading("depth") * (angle.sin() - slope_phi * angle.cos())
        };
        let values = of(SLOPE, 0.0).with("bond", bond).0;
        let values = values.iter().map(cohesion).filter(|cohesion| cohesion.is_finite());
        mean(&values.collect::<Vec<_>>()).mean
    };
    let mut numbers = vec![
        shear,
        cliff,
        slope,
        cliff / shear,
        slope / shear,
        cliff / slope,
        exponent([weak, strong], many / few),
        line(&of(CLIFF, 0.0).points(logarithms))[1],
        exponent(BONDS.map(of_bond), many / few),
        tan_phi,
        0.5 * (weak_phi + strong_phi) / tan_phi,
        slope_phi / tan_phi,
        mean(&of(SHEAR, 0.0).with("bond", many).readings("rate")).mean,
        mean(&of(SLOPE, 0.0).with("bond", many).readings("at_base")).mean,
    ];
    if !of(CLIFF, 1.0).0.is_empty() {
        let [short, long] = [1.0, 2.0].map(|law| [sheared(law, many)[0] / many, cliffs(law)]);
        let exponents = [0, 1].map(|way| exponent([short[way], long[way]], LAWS[2].1 / LAWS[1].1));
        numbers.extend(exponents.into_iter().chain(short));
    }
    numbers
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Checks that the numbers of runs that obey Mohr's and Coulomb's laws with one cohesion are those of this cohesion.
    #[test]
    fn one_cohesion_is_found_in_three_ways() {
        let (tan_phi, per_bond) = (0.35, 0.17);
        let steepness = (FRAC_PI_4 + 0.5 * f64::atan(tan_phi)).tan();
        let case = |way: f64, bond: f64, readings: [(&str, f64); 2]| {
            let at = vec![("way", way), ("law", 0.0), ("bond", bond), ("seed", 1.0)];
            let run = RunReadings { readings: named(readings), ..RunReadings::default() };
            MeasuredCase { at, run, wall_secs: 1.0 }
        };
        let mut cases = Vec::new();
        for bond in [0.0, BONDS[0], BONDS[1]] {
            for size in [2.0, 4.0, 9.0] {
                let cohesion = per_bond * bond;
                let stresses = [("normal", size), ("tangential", cohesion + size * tan_phi)];
                cases.push(case(SHEAR, bond, stresses));
                // The angle at which sin θ − tan φ cos θ = ĉ/D is φ + asin(ĉ cos φ/D).
                let (phi, depth) = (f64::atan(tan_phi), 3.0 * size);
                let angle = phi + (cohesion / depth * phi.cos()).asin();
                cases.push(case(SLOPE, bond, [("angle", angle), ("depth", depth)]));
            }
        }
        for height in HEIGHTS {
            let bond = height / (4.0 * per_bond * steepness);
            cases.push(case(CLIFF, 0.0, [("height", height), ("bond", bond)]));
        }
        let numbers: Vec<f64> =
            judge(&Measurements(cases.iter().collect())).iter().map(|(_, of)| of[0]).collect();
        let expected =
            [per_bond, per_bond, per_bond, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, tan_phi, 1.0, 1.0];
        for (number, expected) in numbers.iter().zip(expected) {
            assert!((number / expected - 1.0).abs() < 1e-9, "{number}, not {expected}");
        }
    }
}
