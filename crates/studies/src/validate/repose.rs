//! Slopes: how steep the surface lies in a drum that turns, at which angle a layer begins to flow, and that both grow
//! with cohesion.

use std::f64::consts::FRAC_PI_2;

use glam::DVec2;
use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_pcg::Pcg64;

use super::cliff::rank_correlation;
use super::experiment::{Case, Cases, Experiment, Found, Measured, values, with};
use super::quantity::{Provenance, Quantity};
use super::trial::Trial;
use super::way::Way;
use crate::error::Result;
use crate::scene::Scene;
use crate::scene::experiments::{LEVEL_SECS, TILT_RATE, drum, incline};
use crate::sim::Simulation;
use crate::statistics::mean;

pub(super) const EXPERIMENT: Experiment = Experiment {
    name: "repose",
    title: "Drum and incline",
    about: "Scene drum: the direction of the centre of mass from the axis, mean from 1.5 s on, which is the slope of the \
            surface. Scene incline: the tilt at which the centre of mass has gone half a diameter along the bottom. \
            Both without and with cohesion, μ = 0.5.",
    cases: Cases::Chosen(cases),
    judge,
};

/// Scenes, by their number in a case.
const DRUM: f64 = 0.0;
const INCLINE: f64 = 1.0;
/// From when on the drum's slope is taken, s: three radians turned.
const STEADY_SECS: f64 = 1.5;
/// How far the layer goes before it counts as flowing, in diameters.
const FLOWN: f64 = 0.5;

fn cases(quick: bool, way: Way) -> Vec<Case> {
    let seeds = if quick { 4u32 } else { 8 };
    let bonds: &[f64] = if quick { &[0.0, 12.0, 24.0] } else { &[0.0, 5.0, 10.0, 20.0, 30.0] };
    let mut cases = Vec::new();
    for (number, grains, secs) in [(DRUM, 150.0, 3.0), (INCLINE, 300.0, 6.0)] {
        for &bond in bonds {
            for seed in 1..=seeds {
                let at = vec![("scene", number), ("bond", bond), ("seed", f64::from(seed))];
                let run = move || {
                    let make = if number == DRUM { drum } else { incline };
                    let mut scene = shuffled(make(), u64::from(seed));
                    scene.parameters.bond = bond;
                    way.take(&mut scene);
                    if number == DRUM { turn(&scene) } else { tilt(&scene) }
                };
                cases.push(Case {
                    at,
                    cost: grains * secs / way.time_step_secs,
                    run: Box::new(run),
                });
            }
        }
    }
    cases
}

/// The scene with its grains' sizes dealt out anew.
pub(super) fn shuffled(mut scene: Scene, seed: u64) -> Scene {
    let mut radii: Vec<f64> = scene.grains.iter().map(|grain| grain.radius).collect();
    radii.shuffle(&mut Pcg64::seed_from_u64(seed));
    for (grain, radius) in scene.grains.iter_mut().zip(radii) {
        grain.radius = radius;
    }
    scene
}

/// The centre of mass, m.
fn centre(simulation: &Simulation) -> DVec2 {
    let grains = &simulation.world().grains;
    let mass: f64 = grains.masses.iter().sum();
    let sum: DVec2 =
        grains.masses.iter().zip(&grains.positions).map(|(mass, place)| *mass * *place).sum();
    sum / mass
}

fn turn(scene: &Scene) -> Result<Measured> {
    let mut trial = Trial::start(scene)?;
    let mut angles = Vec::new();
    trial.run_until(STEADY_SECS, |_| ())?;
    trial.run_until(scene.duration_secs, |simulation| {
        angles.push((centre(simulation).to_angle() + FRAC_PI_2).to_degrees());
    })?;
    Ok(trial.measured([("angle", mean(&angles).mean)]))
}

fn tilt(scene: &Scene) -> Result<Measured> {
    let mut trial = Trial::start(scene)?;
    trial.run_until(LEVEL_SECS, |_| ())?;
    let start = centre(&trial.simulation).x;
    let far = FLOWN * scene.mean_diameter;
    while (centre(&trial.simulation).x - start).abs() < far
        && trial.simulation.time_secs() < scene.duration_secs
    {
        let time_secs = trial.simulation.time_secs();
        trial.run_until(time_secs + 0.01, |_| ())?;
    }
    // What has not flown at the steepest flows nowhere.
    let angle = TILT_RATE * (trial.simulation.time_secs() - LEVEL_SECS);
    Ok(trial.measured([("angle", angle.to_degrees())]))
}

fn judge(found: &[Found]) -> Vec<Quantity> {
    let seeds = values(found, "seed");
    let list: Vec<String> = values(found, "bond").iter().map(f64::to_string).collect();
    let mut quantities = Vec::new();
    let scenes = [
        (DRUM, "drum", "150 grains", [15.0, 25.0, 40.0], "slopes of discs with μ = 0.5: 20° … 30°"),
        (INCLINE, "incline", "300 grains", [14.0, 22.0, 32.0], "discs with μ = 0.5: 20° … 25°"),
    ];
    for (number, name, grains, band, source) in scenes {
        let of_scene: Vec<Found> = with(found, "scene", number).cloned().collect();
        let system = format!("{grains}, Bond {}, {} seeds", list.join(", "), seeds.len());
        let dry: Vec<f64> = with(&of_scene, "bond", 0.0).map(|one| one.reading("angle")).collect();
        quantities.push(Quantity::new(
            format!("angle without cohesion, {name}, degrees"),
            &system,
            mean(&dry),
            band,
            (Provenance::Memory, source),
        ));
        let trend = |seed: &f64| {
            let pairs: Vec<(f64, f64)> = with(&of_scene, "seed", *seed)
                .map(|one| (one.at("bond"), one.reading("angle")))
                .collect();
            rank_correlation(&pairs)
        };
        quantities.push(Quantity::new(
            format!("rank correlation of angle and Bond, {name}"),
            &system,
            mean(&seeds.iter().map(trend).collect::<Vec<_>>()),
            [0.5, 1.0, f64::INFINITY],
            (Provenance::Memory, "it grows with cohesion"),
        ));
    }
    quantities
}
