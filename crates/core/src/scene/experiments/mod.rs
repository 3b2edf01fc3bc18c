//! Experiments of granular physics: grains among bodies that move.

pub mod biaxial;
pub mod collapse;
pub mod drum;
pub mod incline;
pub mod shear;
pub mod shear_periodic;
pub mod silo;
mod vibrated;

pub use biaxial::biaxial;
pub use collapse::{collapse, collapse_of, half_width};
pub use drum::drum;
pub use incline::{LEVEL_SECS, RATE, incline};
pub use shear::{ShearCell, shear, shear_of};
pub use shear_periodic::shear_periodic;
pub use silo::{WIDTH as SILO_WIDTH, silo, silo_of};
pub(crate) use vibrated::vibrated;

use glam::DVec2;

use super::pile::tone_in_layers;
use super::stability::{DIAMETER, dry};
use super::{Scene, View};
use crate::solver::Method;
use crate::world::Grain;

/// The golden mean less 1: its multiples are spread evenly over an interval, however many there are.
const GOLDEN: f64 = 0.618_033_988_749_894_9;

/// Distance of grains on a lattice, in diameters.
const SPACING: f64 = 1.22;

/// A scene whose grains fall from where they are put, with diameters spread evenly over [0.8 d, 1.2 d]. Places are in
/// diameters, more than 1.2 apart.
fn of_loose_grains(name: &str, places: impl Iterator<Item = DVec2>) -> Scene {
    let grain = |(index, place): (usize, DVec2)| {
        let part = (GOLDEN * index as f64).fract();
        Grain::at_rest(DIAMETER * place, 0.5 * DIAMETER * (0.8 + 0.4 * part))
    };
    let mut grains: Vec<Grain> = places.enumerate().map(grain).collect();
    tone_in_layers(&mut grains, DIAMETER);
    let mut scene = dry(name, grains);
    scene.parameters.restitution = 0.3;
    scene.parameters.restitution_threshold = 2.0;
    scene.parameters.time_step_secs = 5e-4;
    scene.solver.method = Method::Auto;
    scene
}

/// Places of so many grains, row by row from a height on, as many side by side as a width has room for, in diameters.
fn lattice(grains: usize, width: f64, lowest: f64) -> impl Iterator<Item = DVec2> {
    let columns = (width / SPACING).floor().max(1.0) as usize;
    let first = -0.5 * SPACING * (columns - 1) as f64;
    (0..grains).map(move |index| {
        let (row, column) = ((index / columns) as f64, (index % columns) as f64);
        DVec2::new(first + SPACING * column, lowest + SPACING * row)
    })
}

/// What pictures show, given in diameters.
fn view(min: DVec2, max: DVec2) -> Option<View> {
    Some(View { min: DIAMETER * min, max: DIAMETER * max })
}
