//! The paper's pile (§3): discs at rest between walls over a rough base; at t = 0 the walls go.

use std::ops::RangeInclusive;

use glam::DVec2;

use super::{NewPile, Scene};
use crate::error::{Error, Result};
use crate::sim::{Remedies, Stepper};
use crate::solver::SolverSettings;
use crate::world::{Disc, Grain, Gravity, Parameters, Physics};

/// d, m.
pub(super) const DIAMETER: f64 = 5e-3;
/// g, m/s².
pub(super) const GRAVITY: f64 = 9.8;
/// Its name.
const NAME: &str = "pile";
/// How wide a base may be asked for.
const BASE_WIDTHS_IN_DIAMETERS: RangeInclusive<f64> = 1.0..=1e5;
/// How far the rough base reaches beyond the box on either side, in heights of the pile: further
/// than any grain of a collapsing pile gets in the paper's second.
const BASE_MARGIN_IN_HEIGHTS: f64 = 5.0;
/// Grains of a pile may be this high above the base, and two diameters more for each of them: the
/// loosest lattice that rain starts from is a column with 1.3 for each.
const LEAST_ROOM_IN_DIAMETERS: f64 = 1000.0;
/// Height of the layers that are told apart by their grey, in diameters.
const LAYER_IN_DIAMETERS: f64 = 2.0;
/// The greys of the layers.
const LAYER_TONES: [u8; 2] = [222, 168];

/// The initial state that all runs of a series share.
const INITIAL_STATE: &str = include_str!("../../../../assets/pile_138.csv");

/// The paper's 138 grains, from the initial state that is shipped with the program.
///
/// # Errors
/// None in a program as shipped; a changed asset is told of with its line.
pub fn paper_pile() -> Result<Scene> {
    let lines = INITIAL_STATE.lines().filter(|line| !line.starts_with('#')).skip(1);
    let disc = |line: &str| {
        let numbers: Vec<f64> = line.split(',').map_while(|number| number.parse().ok()).collect();
        let [x, y, radius] = numbers[..] else {
            return Err(Error::value("assets/pile_138.csv", line, "x,y,radius"));
        };
        Ok(Grain::at_rest(DVec2::new(x, y), radius))
    };
    let grains = lines.map(disc).collect::<Result<_>>()?;
    pile_of(grains, NewPile::default().box_width_in_diameters)
}

/// A pile of the given grains, for a box that was `box_width_in_diameters` wide.
///
/// # Errors
/// Where a grain is so high up that the base, which is as wide as a collapse may reach, would have
/// far more discs than the pile.
pub fn pile_of(mut grains: Vec<Grain>, box_width_in_diameters: f64) -> Result<Scene> {
    let highest = DIAMETER * (LEAST_ROOM_IN_DIAMETERS + 2.0 * grains.len() as f64);
    if let Some(index) = grains.iter().position(|grain| grain.position.y > highest) {
        let found = format!("at y = {} m", grains[index].position.y);
        let allowed =
            format!("within {highest:.3} m of the base where there are {} grains", grains.len());
        return Err(Error::value(format!("grains[{index}]"), found, allowed));
    }
    let height = grains.iter().map(|grain| grain.position.y).fold(0.0, f64::max) / DIAMETER;
    let base_width = box_width_in_diameters + 2.0 * BASE_MARGIN_IN_HEIGHTS * height;
    tone_in_layers(&mut grains, DIAMETER);
    Ok(Scene {
        name: NAME.into(),
        mean_diameter: DIAMETER,
        areal_density: 1.0,
        gap_tolerance: 0.0,
        duration_secs: 1.0,
        physics: Physics::FULL,
        gravity: Gravity::Uniform { acceleration: DVec2::new(0.0, -GRAVITY) },
        stepper: Stepper::Moreau,
        parameters: Parameters {
            bond: 20.0,
            time_step_secs: 1e-3,
            restitution: 0.1,
            friction: 0.5,
            ..Parameters::default()
        },
        solver: SolverSettings::default(),
        remedies: Remedies::default(),
        view: None,
        source: None,
        data: None,
        boundaries: Vec::new(),
        motions: Vec::new(),
        gravity_turn: None,
        periodic: None,
        fixed_discs: rough_base(base_width, DIAMETER),
        grains,
    })
}

/// Fixed discs of diameter d, centres on y = 0 and spaced d, symmetric about x = 0, at least
/// `width_in_diameters` wide.
pub fn rough_base(width_in_diameters: f64, diameter: f64) -> Vec<Disc> {
    let half = (0.5 * width_in_diameters).ceil() as i64;
    (-half..=half)
        .map(|k| Disc { position: DVec2::new(k as f64 * diameter, 0.0), radius: 0.5 * diameter })
        .collect()
}

/// Gives a pile a rough base of that width.
///
/// # Errors
/// Where the width is outside its range, or the scene is no pile.
pub fn put_on_base(scene: &mut Scene, width_in_diameters: f64) -> Result<()> {
    if scene.name != NAME {
        return Err(Error::value("scene", &scene.name, "pile where base-width is given"));
    }
    if !BASE_WIDTHS_IN_DIAMETERS.contains(&width_in_diameters) {
        let (least, most) = BASE_WIDTHS_IN_DIAMETERS.into_inner();
        let allowed = format!("{least} to {most} diameters");
        return Err(Error::value("base-width", width_in_diameters, allowed));
    }
    scene.fixed_discs = rough_base(width_in_diameters, scene.mean_diameter);
    Ok(())
}

/// Gives grains greys by the layer they start in, so that a picture shows what moved where.
pub(crate) fn tone_in_layers(grains: &mut [Grain], diameter: f64) {
    for grain in grains {
        let layer = (grain.position.y / (LAYER_IN_DIAMETERS * diameter)).floor() as i64;
        grain.tone = LAYER_TONES[layer.rem_euclid(LAYER_TONES.len() as i64) as usize];
    }
}
