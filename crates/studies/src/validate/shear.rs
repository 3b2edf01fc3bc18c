//! Plane shear: friction and solid fraction of grains between rough plates, of which one is drawn along under a constant
//! pressure, against the inertial number.
//!
//! Rigid grains of mass m in a plane have no time of their own: what a shear rate γ̇ does under the pressure P, a force a
//! length, hangs on I = γ̇ √(m/P) alone. In the published definition γ̇ d √(ρ_g/P) the density of a disc is that of its
//! square or of itself, which makes a factor of up to 2/√π = 1.13 in I; the band of the slopes has room for it.
//!
//! γ̇ is the slope of the velocity over the height away from the plates, at which grains slip. T and N are the means of
//! both plates.
//!
//! What is not steady in a layer of height H dies away over (H/d)² I²/(π² T/N) heights of shear, since what hands the
//! momentum on is T = (T/N) P: eleven to eighteen at H = 37 d and I = 0.2. So layers begin with the profile that they
//! are to have, linear from plate to plate, are sheared for three of those before they are watched, and held to what a
//! steady flow must do: pull at both plates alike.

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
/// P, in m g/d: √(m/P) is 0.03 s.
pub(super) const PRESSURE: f64 = 1.0;
/// Solid fraction about which layers have, for their height.
const DENSE: f64 = 0.79;
/// How long the plate takes to press loose grains together, s.
const PRESSING_SECS: f64 = 0.5;
/// How far a layer is sheared at the least, and then again while it is watched, in heights of it.
const STRAINS: [f64; 2] = [1.5, 3.0];
/// How many of the times in which what is not steady dies away a layer is sheared besides, for [`SLOWEST`].
const TIMES_TO_STEADY: f64 = 3.0;
/// T/N of a layer in which it dies away slowly.
const SLOWEST: f64 = 0.4;
const MOMENTS: u32 = 250;
/// Each so many of them solid fractions are taken.
const MOMENTS_OF_CELLS: u32 = 5;
/// What is nearer to a plate says nothing of the inside, in diameters.
const MARGIN: f64 = 2.5;

fn cases(effort: Effort, variant: StepVariant) -> Vec<ExperimentCase> {
    let speeds: &[f64] =
        effort.pick(&[0.03, 0.08, 0.18], &[0.01, 0.02, 0.04, 0.07, 0.11, 0.15, 0.2]);
    let layer = |&inertial: &f64| LayerKind {
        at: vec![("inertial", inertial)],
        inertial,
        bond: 0.0,
        breaking_energy: None,
    };
    layers(effort, variant, &speeds.iter().map(layer).collect::<Vec<_>>())
}

/// What tells a sheared layer from others.
#[derive(Clone, Debug)]
pub(super) struct LayerKind {
    /// Numbers by which cases are looked up.
    pub at: Vec<(&'static str, f64)>,
    /// I that is aimed at.
    pub inertial: f64,
    /// Bond number.
    pub bond: f64,
    /// The work that slowly breaks a bond, in m (γ̇ d)²; that of the stepper's own numbers where there is none.
    pub breaking_energy: Option<f64>,
}

/// Cases of layers; none where the method does not move walls that a force drives.
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

    /// Its height when pressed together, in diameters.
    fn height(&self) -> f64 {
        let area = 0.25 * PI * self.grains();
        area / (DENSE * f64::from(self.cell.wide))
    }

    /// γ̇ that is aimed at, 1/s: √(m/P) = √(d/(g P)), P in m g/d.
    fn rate(&self) -> f64 {
        self.kind.inertial / inertial_secs()
    }

    /// How far it is sheared until its flow is steady, in heights of it (see the module).
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

    /// Shears it until it is steady, and then watches it.
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

/// √(m/P), s.
fn inertial_secs() -> f64 {
    (DIAMETER / (GRAVITY * PRESSURE)).sqrt()
}

/// What the lower plate does to the grains, and the upper one, N.
fn on_plates(moment: &Moment, of_plate: u32) -> [DVec2; 2] {
    let on = |is_upper: bool| -> DVec2 {
        let of_it = moment.contacts.iter().filter(|contact| {
            matches!(contact.other, OtherBody::FixedDisc(disc) if (disc >= of_plate) == is_upper)
        });
        of_it.map(|contact| contact.force).sum()
    };
    [on(false), on(true)]
}

/// The heights between which a layer is looked at, m.
fn inside(moment: &Moment) -> [f64; 2] {
    let top = moment.surroundings.fixed_discs.iter().map(|disc| disc.position.y);
    [MARGIN * DIAMETER, top.fold(0.0, f64::max) - MARGIN * DIAMETER]
}

/// γ̇, 1/s.
fn rate(moment: &Moment) -> f64 {
    let [low, high] = inside(moment);
    let grains = moment.grains.iter().filter(|grain| (low..high).contains(&grain.position.y));
    let points: Vec<(f64, f64)> =
        grains.map(|grain| (grain.position.y, grain.velocity.x)).collect();
    slope(&points)
}

/// The rows of [`judge`].
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
    // The value at I = 0 of the line through a reading of each seed, and its slope.
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

/// How much more the upper plate pulls than the lower one in the layers with the largest value of a number, over both
/// pulls: while a flow is not steady yet, one plate still accelerates it.
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

    /// Under `range` E = η (δc/d)/I², with η = Bond/(2P).
    #[test]
    fn a_bond_takes_the_energy_that_its_layer_asks_for() {
        let (bond, energy, inertial) = (6.0, 3.0, 0.08);
        let kind = LayerKind { at: vec![], inertial, bond, breaking_energy: Some(energy) };
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
                // Grains have sizes, and their mean mass is a few per cent above that of the mean size.
                assert!((found / energy - 1.0).abs() < 0.1, "{found}");
            }
        }
    }
}
