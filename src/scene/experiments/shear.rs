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

/// Width of the cell, in diameters, and so the number of discs of a plate.
const WIDE: u8 = 24;
/// Columns and rows of the grains at the start, and their distances in diameters.
const COLUMNS: u8 = 19;
const ROWS: u8 = 12;
const SPACING: [f64; 2] = [WIDE as f64 / COLUMNS as f64, 1.22];
/// From a plate to the nearest row, in diameters.
const ROOM: f64 = 1.2;
/// P, in m g/d: √(m/P) is 0.01 s.
const PRESSURE: f64 = 10.0;
/// Speed of the upper plate, m/s. Pressed together the grains are some 9 d high, and I is 0.07.
const SPEED: f64 = 0.6;

/// 228 grains between two plates.
pub(crate) fn shear() -> Scene {
    let row = |row: u8| {
        let y = ROOM + SPACING[1] * f64::from(row);
        (0..COLUMNS).map(move |column| DVec2::new(SPACING[0] * (f64::from(column) + 0.5), y))
    };
    let mut scene = of_loose_grains("shear", (0..ROWS).flat_map(row));
    scene.grains.iter_mut().for_each(|grain| grain.feels_gravity = false);
    let top = 2.0 * ROOM + SPACING[1] * f64::from(ROWS - 1);
    let plate = |y: f64| {
        (0..WIDE).map(move |k| Disc {
            position: DIAMETER * DVec2::new(f64::from(k) + 0.5, y),
            radius: 0.5 * DIAMETER,
        })
    };
    scene.fixed_discs = plate(0.0).chain(plate(top)).collect();
    scene.periodic = Some(Periodic { x: [0.0, DIAMETER * f64::from(WIDE)] });
    let of_grain = 0.25 * std::f64::consts::PI * DIAMETER * DIAMETER * scene.areal_density;
    let drive = Drive {
        direction: DVec2::NEG_Y,
        force: None,
        pressure: Some(PRESSURE * of_grain * GRAVITY / DIAMETER),
        width: None,
        mass: f64::from(WIDE) * of_grain,
        damping: 0.0,
        speed: 0.0,
    };
    let course = MotionCourse::Straight { direction: DVec2::X, speed: SPEED, travel: None };
    scene.motions = vec![Motion {
        fixed_discs: (usize::from(WIDE)..2 * usize::from(WIDE)).collect(),
        course: Some(course),
        drive: Some(drive),
        ..Motion::default()
    }];
    scene.parameters.time_step_secs = 2e-4;
    scene.duration_secs = 2.0;
    scene.view = view(DVec2::new(-0.5, -1.0), DVec2::new(f64::from(WIDE) + 0.5, top + 1.0));
    scene
}
