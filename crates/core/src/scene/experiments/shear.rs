//! Plane shear at constant pressure: grains between two rough plates in a periodic cell, of which the upper one is drawn
//! along at a given speed and pressed down by a given pressure (F. da Cruz and others, *Rheophysics of dense granular
//! materials*, Phys. Rev. E 72, 2005).
//!
//! What the plates do to the grains hangs on I = γ̇ √(m/P) alone, with γ̇ the shear rate, m the mass of a grain of
//! diameter d and P the pressure, a force a length in a plane: the friction T/N of the plate grows with I, the solid
//! fraction shrinks. Grains do not feel gravity, which says how strong a Bond number is.

use glam::DVec2;

use super::{of_loose_grains, view};
use crate::scene::Scene;
use crate::scene::stability::{DIAMETER, GRAVITY};
use crate::world::{Disc, Drive, Motion, MotionCourse, Periodic};

/// How many grains and how large the plates are.
#[derive(Clone, Copy, Debug)]
pub struct ShearCell {
    /// Width of the cell, in diameters, and so the number of discs of a plate.
    pub wide: u8,
    /// Columns of the grains at the start.
    pub columns: u8,
    /// Rows of them.
    pub rows: u8,
}

/// That of the scene.
const CELL: ShearCell = ShearCell { wide: 24, columns: 19, rows: 12 };
/// Distance of rows at the start, in diameters.
const ROW_SPACING: f64 = 1.22;
/// From a plate to the nearest row, in diameters.
const ROOM: f64 = 1.2;
/// P, in m g/d: √(m/P) is 0.01 s.
const PRESSURE: f64 = 10.0;
/// Speed of the upper plate, m/s. Pressed together the grains are some 9 d high, and I is 0.07.
const SPEED: f64 = 0.6;

/// 228 grains between two plates.
pub fn shear() -> Scene {
    let mut scene = shear_of(CELL, PRESSURE, SPEED);
    scene.parameters.time_step_secs = 2e-4;
    scene.duration_secs = 2.0;
    scene
}

/// Grains between two plates, the upper one under a pressure in m g/d and with a speed in m/s.
pub fn shear_of(cell: ShearCell, pressure: f64, speed: f64) -> Scene {
    let ShearCell { wide, columns, rows } = cell;
    let spacing = [f64::from(wide) / f64::from(columns), ROW_SPACING];
    let row = |row: u8| {
        let y = ROOM + spacing[1] * f64::from(row);
        (0..columns).map(move |column| DVec2::new(spacing[0] * (f64::from(column) + 0.5), y))
    };
    let mut scene = of_loose_grains("shear", (0..rows).flat_map(row));
    scene.grains.iter_mut().for_each(|grain| grain.feels_gravity = false);
    let top = 2.0 * ROOM + spacing[1] * f64::from(rows - 1);
    let plate = |y: f64| {
        (0..wide).map(move |k| Disc {
            position: DIAMETER * DVec2::new(f64::from(k) + 0.5, y),
            radius: 0.5 * DIAMETER,
        })
    };
    scene.fixed_discs = plate(0.0).chain(plate(top)).collect();
    scene.periodic = Some(Periodic::along_x([0.0, DIAMETER * f64::from(wide)]));
    let of_grain = 0.25 * std::f64::consts::PI * DIAMETER * DIAMETER * scene.areal_density;
    let drive = Drive {
        direction: DVec2::NEG_Y,
        force: None,
        pressure: Some(pressure * of_grain * GRAVITY / DIAMETER),
        width: None,
        mass: f64::from(wide) * of_grain,
        damping: 0.0,
        speed: 0.0,
    };
    let course = MotionCourse::Straight { direction: DVec2::X, speed, travel: None };
    scene.motions = vec![Motion {
        fixed_discs: (usize::from(wide)..2 * usize::from(wide)).collect(),
        course: Some(course),
        drive: Some(drive),
        ..Motion::default()
    }];
    scene.view = view(DVec2::new(-0.5, -1.0), DVec2::new(f64::from(wide) + 0.5, top + 1.0));
    scene
}
