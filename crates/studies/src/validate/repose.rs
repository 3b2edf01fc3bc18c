//! Validates slopes of grains: the angle of the surface in a rotating drum, the angle at which a layer on a tilted
//! plane begins to flow, and the increase of both angles with cohesion.

use std::f64::consts::FRAC_PI_2;

use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_pcg::Pcg64;

use super::experiment::*;
use super::fit::rank_correlation;
use super::variants::StepVariant;
use super::watched::{WatchedRun, centre_of_mass};
use crate::error::Result;
use crate::scene::Scene;
use crate::scene::experiments::{LEVEL_SECS, TILT_RATE, drum, incline};
use crate::statistics::mean;

pub(super) const EXPERIMENT: Experiment = Experiment {
    name: "repose",
    title: "Drum and incline",
    about: "Scene drum: the direction of the centre of mass from the axis, mean from 1.5 s on, which is the slope of the \
            surface. Scene incline: the tilt at which the centre of mass has gone half a diameter along the bottom. \
            Both without and with cohesion, μ = 0.5.",
    cases: ExperimentCases::Chosen(cases),
    published: PUBLISHED,
    judge,
};

/// Value of the parameter that says which scene a run simulates: a rotating drum.
const DRUM: f64 = 0.0;
/// Value of the parameter that says which scene a run simulates: a tilted plane.
const INCLINE: f64 = 1.0;
/// Simulated time from which on the slope in the drum is measured, s. The drum has then turned by three radians.
const STEADY_SECS: f64 = 1.5;
/// Displacement along the tilted plane, in diameters. A layer of grains counts as flowing if its centre of mass has
/// moved by this distance.
pub(super) const FLOWN: f64 = 0.5;

fn cases(effort: Effort, variant: StepVariant) -> Vec<ExperimentCase> {
    let seeds = effort.pick(4, 8);
    let bonds: &[f64] = effort.pick(&[0.0, 12.0, 24.0], &[0.0, 5.0, 10.0, 20.0, 30.0]);
    let mut cases = Vec::new();
    for (scene, grains, secs) in [(DRUM, 150.0, 3.0), (INCLINE, 300.0, 6.0)] {
        cases.extend(seeded(bonds, seeds, |bond, seed| {
            let at = [("scene", scene), ("bond", bond), ("seed", seed as f64)];
            let run = move || {
                let make = if scene == DRUM { drum } else { incline };
                let mut made = shuffled(make(), seed);
                made.parameters.bond = bond;
                variant.apply(&mut made);
                if scene == DRUM { turn(&made) } else { tilt(&made) }
            };
            ExperimentCase::new(&at, grains * secs / variant.time_step_secs, run)
        }));
    }
    cases
}

/// Returns the scene after the radii of its grains have been exchanged at random, so that each seed gives another
/// initial state.
pub(super) fn shuffled(mut scene: Scene, seed: u64) -> Scene {
    let mut radii: Vec<f64> = scene.grains.iter().map(|grain| grain.radius).collect();
    radii.shuffle(&mut Pcg64::seed_from_u64(seed));
    for (grain, radius) in scene.grains.iter_mut().zip(radii) {
        grain.radius = radius;
    }
    scene
}

fn turn(scene: &Scene) -> Result<RunReadings> {
    let mut run = WatchedRun::start(scene)?;
    let mut angles = Vec::new();
    run.run_until(STEADY_SECS, |_| ())?;
    run.run_until(scene.duration_secs, |simulation| {
        angles.push((centre_of_mass(simulation).to_angle() + FRAC_PI_2).to_degrees());
    })?;
    Ok(run.with([("angle", mean(&angles).mean)]))
}

fn tilt(scene: &Scene) -> Result<RunReadings> {
    let mut run = WatchedRun::start(scene)?;
    run.run_until(LEVEL_SECS, |_| ())?;
    let start = centre_of_mass(&run.simulation).x;
    let far = FLOWN * scene.mean_diameter;
    while (centre_of_mass(&run.simulation).x - start).abs() < far
        && run.simulation.time_secs() < scene.duration_secs
    {
        let time_secs = run.simulation.time_secs();
        run.run_until(time_secs + 0.01, |_| ())?;
    }
    // If the layer does not flow, this is the largest angle of the run.
    let angle = TILT_RATE * (run.simulation.time_secs() - LEVEL_SECS);
    Ok(run.with([("angle", angle.to_degrees())]))
}

/// Table of published values as text, with one row for each quantity that the function [`judge`] computes from the
/// runs. A row has the form: name of the quantity | lower end of the band of values that agree, published value, upper
/// end of the band | kind of the source (`read`, `recalled`, `derived` or `exact`): source.
const PUBLISHED: &str = "
    angle without cohesion, drum, degrees | 18 25 32 | recalled: slopes of discs with μ = 0.5: 20° … 30°
    rank correlation of angle and Bond, drum | 0.5 1 1 | recalled: it grows with cohesion
    angle without cohesion, incline, degrees | 18 22.5 27 | recalled: discs with μ = 0.5: 20° … 25°
    rank correlation of angle and Bond, incline | 0.5 1 1 | recalled: it grows with cohesion
";

fn judge(all: &Measurements) -> Vec<Measured> {
    let of = |(scene, grains)| {
        let of_scene = all.with("scene", scene);
        let system = format!("{grains} grains, Bond {}, {}", all.list("bond"), all.seeds());
        let trends = of_scene.by_seed(|of_seed| {
            rank_correlation(&of_seed.points(|case| (case.at("bond"), case.reading("angle"))))
        });
        let dry = of_scene.with("bond", 0.0).readings("angle");
        [dry, trends].map(|values| (system.clone(), values))
    };
    [(DRUM, 150), (INCLINE, 300)].into_iter().flat_map(of).collect()
}
