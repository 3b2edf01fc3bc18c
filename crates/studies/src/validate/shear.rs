//! Validates plane shear of a layer of grains between two rough plates, one of which moves along the layer under a
//! constant pressure. Measures the friction and the solid fraction of the layer as functions of the inertial number.
//!
//! Rigid grains have no time scale of their own. The flow of grains of mass m in a plane, at the shear rate γ̇ and
//! under the pressure P (a force per length), therefore only depends on the inertial number I = γ̇ √(m/P). In the
//! published definition γ̇ d √(ρ_g/P) with the diameter d, the density ρ_g refers either to the disc itself or to its
//! bounding square, which changes I by a factor of up to 2/√π = 1.13. The bands of the published slopes include this
//! uncertainty.
//!
//! The shear rate γ̇ is the slope of the velocity over the height, away from the plates, where grains slip. The
//! tangential force T and the normal force N are means over both plates.
//!
//! A transient in a layer of height H decays while the plate moves by (H/d)² I²/(π² T/N) heights, because momentum is
//! transferred by the shear stress (T/N) P. This is eleven to eighteen heights at H = 37 d and I = 0.2. Runs therefore
//! begin with the expected linear velocity profile from plate to plate, and layers are sheared over three such decay
//! lengths before the measurement. In a steady flow both plates exert the same force on the layer, which is checked.

use std::f64::consts::PI;

use glam::DVec2;

use super::experiment::*;
use super::fit::middle;
use super::repose::shuffled;
use super::variants::StepVariant;
use super::watched::{WatchedRun, solid_fraction};
use crate::error::Result;
use crate::fracture_work::with_fracture_work;
use crate::scene::Scene;
use crate::scene::experiments::{ShearCell, shear_of};
use crate::scene::stability::{DIAMETER, GRAVITY};
use crate::sim::{Moment, OtherBody};
use crate::solver::{METHODS, MethodInfo};
use crate::statistics::{mean, slope};
use crate::world::FrictionCone;

pub(super) const EXPERIMENT: Experiment = Experiment {
    name: "shear",
    title: "Plane shear",
    about: "Scene shear with other sizes and speeds, μ = 0.4, ρ = 0.1: friction T/N of the plates and solid fraction \
            between them against I = γ̇ √(m/P), γ̇ measured away from the plates. F. da Cruz et al., Phys. Rev. E 72, \
            021309 (2005): T/N = 0.25 + 1.1 I and φ = 0.81 − 0.3 I for 0.01 < I < 0.2. Methods that take no driven \
            walls are left out.",
    cases: ExperimentCases::Chosen(cases),
    published: PUBLISHED,
    judge,
};

const FRICTION: f64 = 0.4;
const RESTITUTION: f64 = 0.1;
/// Pressure P on the layer, in m g/d, with mass m and diameter d of a grain and gravity g. The time √(m/P) in the
/// inertial number is then 0.03 s.
pub(super) const PRESSURE: f64 = 1.0;
/// Approximate solid fraction of the layers, from which their height is computed.
pub(super) const DENSE: f64 = 0.79;
/// Time at the start of a run in which the plate compresses the loose grains, s. The shear of the layer is counted from
/// the end of this time.
const PRESSING_SECS: f64 = 0.5;
/// Least shear of a layer before the measurement, and shear during the measurement. Shear is the displacement of the
/// plate divided by the height of the layer.
const STRAINS: [f64; 2] = [1.5, 3.0];
/// Additional shear of a layer before the measurement (displacement of the plate divided by the height of the layer),
/// as a multiple of the shear over which a transient decays.
const TIMES_TO_STEADY: f64 = 3.0;
/// Friction T/N of a layer (tangential force divided by normal force) with which the decay of transients is computed.
const SLOWEST: f64 = 0.4;
const MOMENTS: u32 = 250;
/// Number of measurements of forces and shear rate per measurement of the solid fraction, which takes longer to
/// compute.
const MOMENTS_OF_CELLS: u32 = 5;
/// Distance from a plate within which grains are left out of the measurements, in diameters.
const MARGIN: f64 = 2.5;

fn cases(effort: Effort, variant: StepVariant) -> Vec<ExperimentCase> {
    let speeds: &[f64] =
        effort.pick(&[0.03, 0.08, 0.18], &[0.01, 0.02, 0.04, 0.07, 0.11, 0.15, 0.2]);
    let layer = |&inertial: &f64| LayerKind {
        at: vec![("inertial", inertial)],
        inertial,
        bond: 0.0,
        breaking_energy: None,
        bounds: None,
    };
    layers(effort, variant, &speeds.iter().map(layer).collect::<Vec<_>>())
}

/// Parameters of a sheared layer of grains.
#[derive(Clone, Debug)]
pub(super) struct LayerKind {
    /// Names and values of the parameters that identify this layer among the layers of an experiment.
    pub at: Vec<(&'static str, f64)>,
    /// Nominal inertial number I = γ̇ √(m/P), with the shear rate γ̇, the mass m of a grain and the pressure P. The
    /// measured value differs a little.
    pub inertial: f64,
    /// Bond number.
    pub bond: f64,
    /// Prescribed work that slowly breaks a bond, in m (γ̇ d)², with mass m and diameter d of a grain and shear rate
    /// γ̇; `None` to leave the stepper's parameters unchanged.
    pub breaking_energy: Option<f64>,
    /// Friction cone (bound of friction by the normal force with or without the cohesion force), and touch tolerance
    /// (the gap up to which contacts pull) in diameters d; `None` for the defaults.
    pub bounds: Option<(FrictionCone, f64)>,
}

/// Returns the cases (runs to compute) of sheared layers with one solver variant. There are no cases if the stepper or
/// the solver does not support walls that are driven by a force.
pub(super) fn layers(
    effort: Effort,
    variant: StepVariant,
    kinds: &[LayerKind],
) -> Vec<ExperimentCase> {
    let by_method = |info: &&MethodInfo| info.method == variant.method;
    let takes_drives = METHODS.iter().find(by_method).is_some_and(|info| info.takes_drives);
    if !(variant.stepper.info().takes_drives && takes_drives) {
        return Vec::new();
    }
    let (cell, seeds) = effort.pick(
        (ShearCell { wide: 16, columns: 13, rows: 18 }, 5),
        (ShearCell { wide: 32, columns: 25, rows: 48 }, 8),
    );
    let kinds: Vec<&LayerKind> = kinds.iter().collect();
    seeded(&kinds, seeds, |kind, seed| {
        let layer = ShearedLayer { cell, kind: kind.clone(), seed };
        let at = [&kind.at[..], &[("grains", layer.grains()), ("seed", seed as f64)]].concat();
        let secs = PRESSING_SECS + (layer.strains_to_steady() + STRAINS[1]) / layer.rate();
        let cost = layer.grains() * secs / variant.time_step_secs;
        ExperimentCase::new(&at, cost, move || layer.run(variant))
    })
}

#[derive(Clone, Debug)]
struct ShearedLayer {
    cell: ShearCell,
    kind: LayerKind,
    seed: u64,
}

impl ShearedLayer {
    fn grains(&self) -> f64 {
        f64::from(self.cell.columns) * f64::from(self.cell.rows)
    }

    /// Returns the expected height of the compressed layer, in diameters: the area of its grains divided by the
    /// expected solid fraction and by the width of the layer.
    fn height(&self) -> f64 {
        let area = 0.25 * PI * self.grains();
        area / (DENSE * f64::from(self.cell.wide))
    }

    /// Returns the nominal shear rate γ̇ = I/√(m/P), 1/s, with the inertial number I, the mass m of a grain and the
    /// pressure P. √(m/P) = √(d/(g P)) if P is in m g/d, with diameter d and gravity g.
    fn rate(&self) -> f64 {
        self.kind.inertial / inertial_secs()
    }

    /// Returns the shear (displacement of the plate divided by the height of the layer) after which the flow counts as
    /// steady: the first value of [`STRAINS`], plus [`TIMES_TO_STEADY`] times the shear over which a transient decays,
    /// (H/d)² I²/(π² T/N). H is the height of the layer, d the diameter, I the inertial number, and T/N the friction of
    /// the layer, here [`SLOWEST`].
    fn strains_to_steady(&self) -> f64 {
        let times = (self.height() * self.kind.inertial).powi(2) / (PI * PI * SLOWEST);
        STRAINS[0] + TIMES_TO_STEADY * times
    }

    fn scene(&self, variant: StepVariant) -> Scene {
        let speed = self.rate() * self.height() * DIAMETER;
        let mut scene = shuffled(shear_of(self.cell, PRESSURE, speed), self.seed);
        scene.parameters.friction = FRICTION;
        scene.parameters.restitution = RESTITUTION;
        scene.parameters.bond = self.kind.bond;
        if let Some((cone, touch_tolerance)) = self.kind.bounds {
            scene.parameters.cone = cone;
            scene.parameters.touch_tolerance = touch_tolerance;
        }
        let top = scene.fixed_discs.iter().fold(0.0, |top: f64, disc| top.max(disc.position.y));
        for grain in &mut scene.grains {
            grain.velocity.x = speed * grain.position.y / top;
        }
        variant.apply(&mut scene);
        if let Some(energy) = self.kind.breaking_energy {
            let mass = scene.areal_density * 0.25 * PI * DIAMETER * DIAMETER;
            let joules = energy * mass * (self.rate() * DIAMETER).powi(2);
            scene.set_settings(with_fracture_work(&scene, scene.settings(), joules));
        }
        scene
    }

    /// Shears the layer until its flow is steady, and then measures inertial number, friction and solid fraction.
    fn run(&self, variant: StepVariant) -> Result<RunReadings> {
        let mut run = WatchedRun::start(&self.scene(variant))?;
        let begin_secs = PRESSING_SECS + self.strains_to_steady() / self.rate();
        let watched_secs = STRAINS[1] / self.rate();
        let (mut forces, mut rates, mut solid_fractions) = ([DVec2::ZERO; 2], vec![], vec![]);
        for moment in 1..=MOMENTS {
            let part = f64::from(moment) / f64::from(MOMENTS);
            run.run_until(begin_secs + part * watched_secs, |_| ())?;
            let state = run.simulation.moment();
            let now = on_plates(&state, u32::from(self.cell.wide));
            forces.iter_mut().zip(now).for_each(|(force, now)| *force += now);
            rates.push(rate(&state));
            if moment.is_multiple_of(MOMENTS_OF_CELLS) {
                let [low, high] = inside(&state);
                solid_fractions
                    .push(solid_fraction(&state, |place| (low..high).contains(&place.y)));
            }
        }
        let [lower, upper] = forces;
        Ok(run.with([
            ("inertial", mean(&rates).mean * inertial_secs()),
            ("friction", (upper.x - lower.x) / (lower.y - upper.y)),
            ("imbalance", (upper.x + lower.x) / (upper.x - lower.x)),
            ("solid_fraction", mean(&solid_fractions).mean),
            ("overlap", run.simulation.observables().mean_overlap),
        ]))
    }
}

/// Returns the time √(m/P) in the inertial number, s, with the mass m of a grain and the pressure P.
fn inertial_secs() -> f64 {
    (DIAMETER / (GRAVITY * PRESSURE)).sqrt()
}

/// Returns the forces of the lower and of the upper plate on the grains, N. The plates consist of fixed discs; the
/// discs of the upper plate have the indices from `of_plate` on.
pub(super) fn on_plates(moment: &Moment, of_plate: u32) -> [DVec2; 2] {
    let on = |is_upper: bool| -> DVec2 {
        let of_it = moment.contacts.iter().filter(|contact| {
            matches!(contact.other, OtherBody::FixedDisc(disc) if (disc >= of_plate) == is_upper)
        });
        of_it.map(|contact| contact.force).sum()
    };
    [on(false), on(true)]
}

/// Returns the lower and the upper height between which shear rate and solid fraction of a layer are measured, m.
pub(super) fn inside(moment: &Moment) -> [f64; 2] {
    let top = moment.surroundings.fixed_discs.iter().map(|disc| disc.position.y);
    [MARGIN * DIAMETER, top.fold(0.0, f64::max) - MARGIN * DIAMETER]
}

/// Returns the measured shear rate γ̇ of a layer, 1/s: the slope of the grains' velocity along the layer over their
/// height.
pub(super) fn rate(moment: &Moment) -> f64 {
    let [low, high] = inside(moment);
    let grains = moment.grains.iter().filter(|grain| (low..high).contains(&grain.position.y));
    let points: Vec<(f64, f64)> =
        grains.map(|grain| (grain.position.y, grain.velocity.x)).collect();
    slope(&points)
}

/// Table of published values as text, with one row for each quantity that the function [`judge`] computes from the
/// runs. A row has the form: name of the quantity | lower end of the band of values that agree, published value, upper
/// end of the band | kind of the source (`read`, `recalled`, `derived` or `exact`): source.
const PUBLISHED: &str = "
    T/N, extended to I = 0 | 0.2 0.25 0.32 | recalled: da Cruz et al. 2005: 0.25
    slope of T/N in I | 0.6 1.1 1.6 | recalled: da Cruz et al. 2005: 1.1
    φ, extended to I = 0 | 0.79 0.81 0.84 | recalled: da Cruz et al. 2005: 0.81
    slope of φ in I | -0.5 -0.3 -0.1 | recalled: da Cruz et al. 2005: −0.3
    T of the plates: their difference over their sum | -0.05 0 0.05 | exact: a steady flow gains no momentum
";

fn judge(all: &Measurements) -> Vec<Measured> {
    let (grains, numbers) = (all.first("grains"), all.list("inertial"));
    let system = format!("{grains} grains, I ≈ {numbers}, {}", all.seeds());
    // The value at the inertial number I = 0, and the slope, of a line fitted to a reading, for each seed.
    let lines = |reading: &str| -> [Vec<f64>; 2] {
        let line = |of_seed: Measurements| {
            let points = of_seed.points(|case| (case.reading("inertial"), case.reading(reading)));
            let (slope, (x, y)) = (slope(&points), middle(&points));
            (y - slope * x, slope)
        };
        all.by_seed(line).into_iter().unzip::<_, _, Vec<_>, Vec<_>>().into()
    };
    let values = [lines("friction"), lines("solid_fraction")].concat();
    let values = values.into_iter().chain([imbalances(all, "inertial")]);
    values.map(|values| (system.clone(), values)).collect()
}

/// Returns the relative difference between the tangential forces of the two plates, for each layer with the largest
/// value of the parameter `name`. The difference is not 0 while one plate still accelerates the flow.
pub(super) fn imbalances(all: &Measurements, name: &str) -> Vec<f64> {
    let most = all.values(name).last().copied().unwrap_or(f64::NAN);
    all.with(name, most).readings("imbalance")
}

#[cfg(test)]
mod tests {
    use super::super::variants::SolveBudget;
    use super::*;
    use crate::fracture_work::fracture_work;
    use crate::sim::Stepper;
    use crate::solver::Method;

    /// Checks that breaking a bond takes the prescribed work, and that the debonding distance δ_c of the stepper
    /// `range` then gives the expected dimensionless energy E = η (δ_c/d)/I², with the cohesion η = Bond/(2P), the
    /// pressure P in m g/d, the mass m and diameter d of a grain, gravity g and the inertial number I.
    #[test]
    fn a_bond_takes_the_energy_that_its_layer_asks_for() {
        let (bond, energy, inertial) = (6.0, 3.0, 0.08);
        let kind =
            LayerKind { at: vec![], inertial, bond, breaking_energy: Some(energy), bounds: None };
        let cell = ShearCell { wide: 16, columns: 13, rows: 18 };
        let layer = ShearedLayer { cell, kind, seed: 1 };
        for stepper in [Stepper::Range, Stepper::Dem] {
            let budget = SolveBudget::Sweeps(20);
            let variant =
                StepVariant { stepper, method: Method::Nsgs, time_step_secs: 1e-3, budget };
            let scene = layer.scene(variant);
            let of_nominal = scene.areal_density * 0.25 * PI * DIAMETER * DIAMETER;
            let expected = energy * of_nominal * (layer.rate() * DIAMETER).powi(2);
            let joules = fracture_work(&scene, scene.settings()).expect("a work");
            assert!((joules / expected - 1.0).abs() < 1e-9, "{stepper}: {joules}, not {expected}");
            if stepper == Stepper::Range {
                let strength = bond / (2.0 * PRESSURE);
                let found = strength * scene.parameters.debonding_distance / inertial.powi(2);
                // Grains vary in size, and their mean mass is a few per cent above the mass of a grain of mean size.
                assert!((found / energy - 1.0).abs() < 0.1, "{found}");
            }
        }
    }
}
