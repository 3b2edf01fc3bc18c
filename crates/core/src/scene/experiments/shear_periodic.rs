//! Shear without walls: a cell whose borders are one and the same line each, and whose upper border slides along the
//! lower one (`world::shearing`).
//!
//! Nothing but the shear rate γ̇ has a time in it, as long as grains are rigid and do not cohere. So the same grains at
//! another rate take the same way in other times, and stresses grow with γ̇² (R. A. Bagnold, *Experiments on a
//! gravity-free dispersion of large solid spheres in a Newtonian fluid under shear*, Proc. R. Soc. A 225, 1954).
//! Grains do not feel gravity, which says how strong a Bond number is.

use glam::DVec2;

use super::{GOLDEN, of_loose_grains, view};
use crate::scene::Scene;
use crate::scene::stability::DIAMETER;
use crate::world::Periodic;

/// Columns and rows of grains at the start; rows in even number, since every other is half a place on.
const COLUMNS: u32 = 16;
const ROWS: u32 = 14;
/// Distance of neighbours at the start, in diameters: that of the largest two and a bit. Grains cover 0.74 of the cell.
const SPACING: f64 = 1.11;
/// How far diameters go from the mean, as a part of it.
const SPREAD: f64 = 0.1;
/// γ̇, 1/s.
const SHEAR_RATE: f64 = 10.0;

/// 224 grains that go with the shear at the start.
pub fn shear_periodic() -> Scene {
    let row_height = SPACING * 0.75f64.sqrt();
    let place = |k: u32| {
        let (row, column) = (k / COLUMNS, k % COLUMNS);
        let shift = if row.is_multiple_of(2) { 0.25 } else { 0.75 };
        DVec2::new(SPACING * (f64::from(column) + shift), row_height * (f64::from(row) + 0.5))
    };
    let mut scene = of_loose_grains("shear-periodic", (0..COLUMNS * ROWS).map(place));
    for (index, grain) in (0..).zip(&mut scene.grains) {
        let part = (GOLDEN * f64::from(index)).fract();
        grain.radius = 0.5 * DIAMETER * (1.0 + SPREAD * (2.0 * part - 1.0));
        grain.velocity.x = SHEAR_RATE * grain.position.y;
        grain.feels_gravity = false;
    }
    let size = DVec2::new(SPACING * f64::from(COLUMNS), row_height * f64::from(ROWS));
    let borders = |period: f64| [0.0, DIAMETER * period];
    scene.periodic = Some(Periodic {
        shear_rate: SHEAR_RATE,
        ..Periodic::along_both(borders(size.x), borders(size.y))
    });
    scene.parameters.restitution_threshold = 0.0;
    scene.parameters.time_step_secs = 1e-4;
    scene.duration_secs = 1.0;
    scene.view = view(DVec2::splat(-1.0), size + 1.0);
    scene
}
