//! Validates a narrow closed silo: how much of the weight of the grains its bottom carries, and how much its walls (H.
//! A. Janssen 1895).
//!
//! Consider grains of the bulk density ρ_b under gravity g between two walls at a distance W, with the friction
//! coefficient μ_w at the walls. Let the horizontal pressure be K times the vertical pressure p, and let the friction
//! at the walls be fully mobilised. Then a slice of height dz satisfies W dp = ρ_b g W dz − 2 μ_w K p dz, so that at
//! the depth z below the surface
//!
//! > p = λ ρ_b g (1 − e^(−z/λ)),  λ = W/(2 μ_w K),
//!
//! and the bottom carries the fraction (λ/H)(1 − e^(−H/λ)) of the weight of a filling of height H.
//!
//! Friction is fully mobilised if grains slide down the walls, so the bottom is lowered slowly while its load is
//! measured.

use glam::DVec2;

use super::experiment::*;
use super::fit::nearest;
use super::variants::StepVariant;
use super::watched::{WatchedRun, at_rest, centre_of_mass, loose, open_box, settled};
use crate::error::Result;
use crate::scene::Scene;
use crate::scene::stability::{DIAMETER, GRAVITY, dry};
use crate::sim::{OtherBody, Simulation};
use crate::statistics::mean;
use crate::world::{Grain, Motion, MotionCourse};

pub(super) const EXPERIMENT: Experiment = Experiment {
    name: "janssen",
    title: "Load on the bottom of a silo",
    about: "A closed silo 8 d wide, μ = μ_w = 0.5, filled to different heights H; its bottom is lowered by half a diameter, \
            slowly, and weighs what it carries meanwhile. H. A. Janssen 1895: the share (λ/H)(1 − e^(−H/λ)) of the \
            weight, λ = W/(2 μ_w K), K the pressure across over that along.",
    cases: ExperimentCases::Chosen(cases),
    published: PUBLISHED,
    judge,
};

/// Coefficient of friction μ, between grains and at the walls.
const FRICTION: f64 = 0.5;
/// Distance W between the walls, in diameters.
const WIDTH: f64 = 8.0;
/// Number of grains that fill a square, whose side is the distance W between the walls, at a solid fraction of 0.82.
const GRAINS_OF_SQUARE: f64 = 1.04 * WIDTH * WIDTH;
/// Distance by which the bottom of the silo is lowered, in diameters.
const LOWERED: f64 = 0.5;
/// Fraction of the distance by which the bottom of the silo is lowered, after which the load on the bottom is measured.
const WEIGHED_FROM: f64 = 0.2;
/// Speed with which the bottom of the silo is lowered, in √(g d), with gravity g and diameter d.
const SPEED: f64 = 0.02;
/// Larger of the two filling heights of the silo whose loads on the bottom are compared, in units of the distance W
/// between the walls.
const HIGH: f64 = 5.0;
/// Smaller of the two filling heights of the silo whose loads on the bottom are compared, in units of the distance W
/// between the walls.
const HALF_AS_HIGH: f64 = 2.5;

fn cases(effort: Effort, variant: StepVariant) -> Vec<ExperimentCase> {
    let seeds = effort.pick(4, 12);
    let heights: &[f64] = effort
        .pick(&[1.0, HALF_AS_HIGH, HIGH], &[0.5, 1.0, 1.5, HALF_AS_HIGH, 3.5, HIGH, 7.0, 10.0]);
    seeded(heights, seeds, |height, seed| {
        let grains = (height * GRAINS_OF_SQUARE).round();
        let at = [("height", height), ("grains", grains), ("seed", seed as f64)];
        let cost = grains * (1.0 + height) / variant.time_step_secs;
        ExperimentCase::new(&at, cost, move || weigh(grains as usize, seed, variant))
    })
}

fn silo(grains: Vec<Grain>, variant: StepVariant) -> Scene {
    let mut scene = dry("janssen", grains);
    scene.parameters.friction = FRICTION;
    scene.boundaries = open_box(WIDTH);
    variant.apply(&mut scene);
    scene.duration_secs = 60.0;
    scene
}

fn weigh(grains: usize, seed: u64, variant: StepVariant) -> Result<RunReadings> {
    let settled = settled(&silo(loose(grains, WIDTH, seed), variant))?;
    let mut scene = silo(at_rest(&settled), variant);
    let speed = SPEED * (GRAVITY * DIAMETER).sqrt();
    let course = MotionCourse::Straight { direction: DVec2::NEG_Y, speed, travel: None };
    scene.motions = vec![Motion { boundaries: vec![0], course: Some(course), ..Motion::default() }];
    let mut run = WatchedRun::start(&scene)?;
    let secs = LOWERED * DIAMETER / speed;
    run.run_until(WEIGHED_FROM * secs, |_| ())?;
    let mut loads = Vec::new();
    run.run_until(secs, |simulation| loads.push(on_bottom(simulation)))?;
    let mass: f64 = run.simulation.world().grains.masses.iter().sum();
    // The height of the filling is twice the height of its centre of mass above the bottom, because the surface is
    // uneven.
    let height = 2.0 * (centre_of_mass(&run.simulation).y / DIAMETER + LOWERED);
    Ok(run.with([
        ("share", mean(&loads).mean / (mass * GRAVITY)),
        ("height", height),
        ("load", mean(&loads).mean),
    ]))
}

/// Returns the vertical force between the grains and the bottom of the silo, N.
fn on_bottom(simulation: &Simulation) -> f64 {
    let contacts = simulation.moment().contacts.into_iter();
    let of_bottom = contacts.filter(|contact| contact.other == OtherBody::Boundary(0));
    of_bottom.map(|contact| contact.force.y).sum()
}

/// Returns the fraction of the weight that the bottom of the silo carries according to Janssen. `heights` is the
/// filling height divided by Janssen's length λ.
fn share(heights: f64) -> f64 {
    -(-heights).exp_m1() / heights
}

/// Fits Janssen's law to points (filling height, fraction of the weight that the bottom carries) by least squares.
/// Returns Janssen's length λ, in the unit of the heights, and the root mean square deviation of the fractions from the
/// law.
fn length_of(points: &[(f64, f64)]) -> [f64; 2] {
    let misfit = |length: f64| -> f64 {
        let square = |(height, found): &(f64, f64)| (found - share(height / length)).powi(2);
        (points.iter().map(square).sum::<f64>() / points.len() as f64).sqrt()
    };
    let length = nearest(points.iter().map(|point| point.0).fold(0.0, f64::max), misfit);
    [length, misfit(length)]
}

/// Table of published values as text, with one row for each quantity that the function [`judge`] computes from the
/// runs. A row has the form: name of the quantity | lower end of the band of values that agree, published value, upper
/// end of the band | kind of the source (`read`, `recalled`, `derived` or `exact`): source.
const PUBLISHED: &str = "
    K of Janssen's λ = W/(2 μ_w K) | 0.35 0.7 1.1 | recalled: Janssen 1895; K of 0.4 … 1 for grains
    deviation of the share from Janssen's law, r.m.s. | 0 0.03 0.1 | recalled: Janssen 1895
    load of a filling 5 W high over that of one half as high | 0.8 1.1 1.5 \
        | recalled: Janssen 1895 with K = 0.7: 1.1; without friction 2
";

fn judge(all: &Measurements) -> Vec<Measured> {
    let system = format!("{} grains in 8 d, {}", all.list("grains"), all.seeds());
    let (ratios, misfits): (Vec<f64>, Vec<f64>) = all
        .by_seed(|of_seed| {
            let points = of_seed.points(|case| (case.reading("height"), case.reading("share")));
            let [length, misfit] = length_of(&points);
            (WIDTH / (2.0 * FRICTION * length), misfit)
        })
        .into_iter()
        .unzip();
    let gains = all.by_seed(|of_seed| {
        let load = |height| of_seed.with("height", height).reading("load");
        load(HIGH) / load(HALF_AS_HIGH)
    });
    [ratios, misfits, gains].map(|values| (system.clone(), values)).into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_length_of_janssen_is_found_again() {
        for length in [0.3, 11.0, 150.0] {
            let points: Vec<(f64, f64)> = [8.0, 20.0, 40.0]
                .into_iter()
                .map(|height| (height, share(height / length)))
                .collect();
            let [found, misfit] = length_of(&points);
            assert!((found / length - 1.0).abs() < 0.01 && misfit < 1e-3, "{found} for {length}");
        }
    }
}
