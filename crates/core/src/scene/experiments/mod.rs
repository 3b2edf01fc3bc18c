//! Experiments of granular physics: scenes with grains and moving walls or rotating gravity.

mod flows;
mod shear;

pub(crate) use flows::vibrated;
pub use flows::{
    LEVEL_SECS, SILO_WIDTH, TILT_RATE, collapse, collapse_of, drum, half_width, incline, silo,
    silo_of,
};
pub use shear::{ShearCell, biaxial, shear, shear_of, shear_periodic};

use glam::DVec2;

use super::Scene;
use super::stability::{DIAMETER, dry, view};
use super::tones::tone_in_layers;

use crate::world::{Boundary, Grain, Motion, MotionCourse};

/// The golden ratio minus 1. The fractional parts of its first n multiples are spread evenly over the interval from 0
/// to 1 for every n. They determine the diameters of the grains.
const GOLDEN: f64 = 0.618_033_988_749_894_9;

/// Distance between the centres of neighbouring grains of an initial lattice, in diameters. It is slightly more than
/// the largest diameter, 1.2 mean diameters.
const SPACING: f64 = 1.22;

/// Returns a scene whose grains start at the given positions. Their diameters are spread evenly over [0.8 d, 1.2 d],
/// with the mean diameter d. The positions are in diameters, and no two are closer than 1.2 diameters.
fn of_loose_grains(name: &str, places: impl Iterator<Item = DVec2>) -> Scene {
    let grain = |(index, place): (usize, DVec2)| {
        let part = (GOLDEN * index as f64).fract();
        Grain::at_rest(DIAMETER * place, 0.5 * DIAMETER * (0.8 + 0.4 * part))
    };
    let mut grains: Vec<Grain> = places.enumerate().map(grain).collect();
    tone_in_layers(&mut grains, DIAMETER);
    let mut scene = dry(name, grains);
    scene.parameters.restitution = 0.3;
    scene.parameters.time_step_secs = 5e-4;
    scene
}

/// Returns the initial positions of `grains` grains, in diameters: rows from the height `lowest` upwards, each with as
/// many grains as fit into `width`.
fn lattice(grains: usize, width: f64, lowest: f64) -> impl Iterator<Item = DVec2> {
    let columns = (width / SPACING).floor().max(1.0) as usize;
    let first = -0.5 * SPACING * (columns - 1) as f64;
    (0..grains).map(move |index| {
        let (row, column) = ((index / columns) as f64, (index % columns) as f64);
        DVec2::new(first + SPACING * column, lowest + SPACING * row)
    })
}

/// Converts a position from diameters to m.
fn place(x: f64, y: f64) -> DVec2 {
    DIAMETER * DVec2::new(x, y)
}

/// Returns a box that is open at the top and has its bottom on y = 0. The sizes are in diameters.
fn open_box(half_width: f64, height: f64) -> Boundary {
    let corners =
        [(-half_width, height), (-half_width, 0.0), (half_width, 0.0), (half_width, height)];
    Boundary::Polyline { points: corners.map(|(x, y)| place(x, y)).into() }
}

fn moved(boundary: usize, course: MotionCourse) -> Motion {
    Motion { boundaries: vec![boundary], course: Some(course), ..Motion::default() }
}
