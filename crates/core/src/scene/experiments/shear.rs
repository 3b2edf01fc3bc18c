//! Scenes of grains under stress: sheared between plates, sheared without walls, and compressed.

use glam::DVec2;

use super::{GOLDEN, SPACING, lattice, moved, of_loose_grains, view};
use crate::scene::Scene;
use crate::scene::stability::{DIAMETER, GRAVITY, floor, half_space};
use crate::world::{Disc, Drive, Motion, MotionCourse, Periodic};

/// Size of a shear cell (grains between two plates): the width of the plates, and the number of grains between them.
#[derive(Clone, Copy, Debug)]
pub struct ShearCell {
    /// Width of the shear cell (grains between two plates) in diameters. It is also the number of discs of each plate.
    pub wide: u8,
    /// Number of columns of grains in the initial lattice.
    pub columns: u8,
    /// Number of rows of grains in the initial lattice.
    pub rows: u8,
}

const CELL: ShearCell = ShearCell { wide: 24, columns: 19, rows: 12 };
/// Vertical distance between neighbouring rows of grains at the start, in diameters.
const ROW_SPACING: f64 = 1.22;
/// Distance at the start from the centres of a plate's discs to the centres of the nearest row of grains, in
/// diameters.
const PLATE_ROOM: f64 = 1.2;
/// Pressure P on the upper plate, in m g/d (mass of a grain, gravity, diameter). With this pressure the inertial time
/// √(m/P) of a grain of mass m is 0.01 s.
const SHEAR_PRESSURE: f64 = 10.0;
/// Speed of the upper plate along the lower plate, m/s. The compressed grains are about 9 diameters high, so the
/// inertial number I = γ̇ √(m/P) is 0.07 (γ̇: shear rate, m: mass of a grain, P: pressure).
const PLATE_SPEED: f64 = 0.6;

/// Returns the scene of plane shear at constant pressure: grains between two rough plates in a periodic cell. The
/// upper plate moves at a given speed and is pressed down by a given pressure (F. da Cruz and others, *Rheophysics of
/// dense granular materials*, Phys. Rev. E 72, 2005).
///
/// The effect of the plates depends only on the inertial number I = γ̇ √(m/P), with the shear rate γ̇ (1/s), the mass
/// m (kg) of a grain of diameter d, and the pressure P (N/m, because the scene is plane). The friction T/N of the
/// plate, the tangential force divided by the normal force, increases with I, and the solid fraction decreases.
/// Gravity does not act on the grains. It only sets the scale of the Bond number.
pub fn shear() -> Scene {
    let mut scene = shear_of(CELL, SHEAR_PRESSURE, PLATE_SPEED);
    scene.parameters.time_step_secs = 2e-4;
    scene.duration_secs = 2.0;
    scene
}

/// Returns the scene of grains that are sheared between two plates. `pressure` is the pressure on the upper plate in m
/// g/d (mass of a grain, gravity, diameter), and `speed` is the speed of this plate in m/s.
pub fn shear_of(cell: ShearCell, pressure: f64, speed: f64) -> Scene {
    let ShearCell { wide, columns, rows } = cell;
    let spacing = [f64::from(wide) / f64::from(columns), ROW_SPACING];
    let row = |row: u8| {
        let y = PLATE_ROOM + spacing[1] * f64::from(row);
        (0..columns).map(move |column| DVec2::new(spacing[0] * (f64::from(column) + 0.5), y))
    };
    let mut scene = of_loose_grains("shear", (0..rows).flat_map(row));
    scene.grains.iter_mut().for_each(|grain| grain.feels_gravity = false);
    let top = 2.0 * PLATE_ROOM + spacing[1] * f64::from(rows - 1);
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
        pressure: Some(pressure * of_grain * GRAVITY / DIAMETER),
        mass: f64::from(wide) * of_grain,
        ..Drive::default()
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

/// Number of columns of grains at the start in the scene `shear-periodic`.
const COLUMNS: u32 = 16;
/// Number of rows of grains at the start in the scene `shear-periodic`. This number is even, because every other row is
/// shifted by half a spacing and the rows repeat across the periodic borders.
const ROWS: u32 = 14;
/// Distance between the centres of neighbouring grains at the start, in diameters. It is slightly more than the largest
/// diameter. The grains cover a fraction of 0.74 of the periodic cell (the rectangle that repeats in all directions).
const PERIODIC_SPACING: f64 = 1.11;
/// Largest deviation of a diameter from the mean diameter, relative to the mean diameter.
const SPREAD: f64 = 0.1;
/// Shear rate γ̇ of the scene `shear-periodic`, 1/s: change of the velocity along x (m/s) per metre of height.
const SHEAR_RATE: f64 = 10.0;

/// Returns the scene of shear without walls: grains in a cell with periodic borders, of which the upper slides along
/// the lower (`world::periodic`).
///
/// As long as grains are rigid and do not cohere, only the shear rate γ̇ sets a time scale. So at another shear rate
/// the grains follow the same paths at other times, and stresses are proportional to γ̇² (R. A. Bagnold, *Experiments
/// on a gravity-free dispersion of large solid spheres in a Newtonian fluid under shear*, Proc. R. Soc. A 225, 1954).
/// Gravity does not act on the grains. It only sets the scale of the Bond number.
pub fn shear_periodic() -> Scene {
    let row_height = PERIODIC_SPACING * 0.75f64.sqrt();
    let place = |k: u32| {
        let (row, column) = (k / COLUMNS, k % COLUMNS);
        let shift = if row.is_multiple_of(2) { 0.25 } else { 0.75 };
        DVec2::new(
            PERIODIC_SPACING * (f64::from(column) + shift),
            row_height * (f64::from(row) + 0.5),
        )
    };
    let mut scene = of_loose_grains("shear-periodic", (0..COLUMNS * ROWS).map(place));
    for (index, grain) in (0..).zip(&mut scene.grains) {
        let part = (GOLDEN * f64::from(index)).fract();
        grain.radius = 0.5 * DIAMETER * (1.0 + SPREAD * (2.0 * part - 1.0));
        grain.velocity.x = SHEAR_RATE * grain.position.y;
        grain.feels_gravity = false;
    }
    let size = DVec2::new(PERIODIC_SPACING * f64::from(COLUMNS), row_height * f64::from(ROWS));
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

/// Number of grains in the biaxial test.
const GRAINS: usize = 300;
/// Width of the initial lattice of grains in the biaxial test, in diameters.
const WIDTH: f64 = 19.0;
/// Distance from the centres of the outermost grains to the walls at the start of the biaxial test, in diameters.
const ROOM: f64 = 0.75;
/// Pressure of the side walls on the grains in the biaxial test, in m g/d (mass of a grain, gravity, diameter). A
/// constant force presses each side wall, so the pressure has this value only while the grains are [`HEIGHT`] high.
const CONFINING_PRESSURE: f64 = 10.0;
/// Height of the grains, in diameters, at which the side walls of the biaxial test exert the pressure
/// [`CONFINING_PRESSURE`]: the constant force on a wall is this pressure times this height. In the second part of the
/// test the height decreases from 19.2 to 14.2 diameters.
const HEIGHT: f64 = 18.0;
/// Distance by which the lid moves down in the first part of the biaxial test, in diameters, while the side walls
/// compress the grains.
const CLOSING: f64 = 5.5;
/// Duration of the first part of the biaxial test, in which the side walls compress the grains, s.
const CLOSING_SECS: f64 = 0.35;
/// Distance by which the lid moves down in the second part of the biaxial test, in diameters.
const COMPRESSION: f64 = 5.0;
/// Duration of the second part of the biaxial test, s. With this duration the inertial number γ̇ √(m/P) is 1.4e-3 (γ̇:
/// strain rate, m: mass of a grain, P: pressure).
const COMPRESSION_SECS: f64 = 2.0;

/// Returns the scene of a biaxial test: grains in a box. A constant force presses each side wall inward, and the lid
/// moves down at a given speed. Gravity does not act on the grains.
///
/// First the lid moves down fast onto loose grains while the side walls compress them. Then it moves slowly. The
/// strength of the grains is the ratio σ_yy/σ_xx of their vertical to their horizontal stress, which is in the table
/// `measures` of a recording. Flowing grains reach (1 + sin φ_f)/(1 − sin φ_f), with their friction angle φ_f (Mohr,
/// Coulomb). The force on a side wall is constant, so its pressure increases while the lid moves down slowly: from 0.94
/// to 1.27 times `CONFINING_PRESSURE`, because the height of the box decreases from 19.2 to 14.2 diameters.
pub fn biaxial() -> Scene {
    let mut scene = of_loose_grains("biaxial", lattice(GRAINS, WIDTH, ROOM));
    scene.grains.iter_mut().for_each(|grain| grain.feels_gravity = false);
    // The number of columns of the lattice.
    let columns = (WIDTH / SPACING).floor();
    let rows = (GRAINS as f64 / columns).ceil();
    let half = 0.5 * SPACING * (columns - 1.0) + ROOM;
    let top = 2.0 * ROOM + SPACING * (rows - 1.0);
    scene.boundaries = vec![
        floor(),
        half_space(DVec2::new(-half, 0.0), DVec2::X),
        half_space(DVec2::new(half, 0.0), DVec2::NEG_X),
        half_space(DVec2::new(0.0, top), DVec2::NEG_Y),
    ];
    let of_grain = 0.25 * std::f64::consts::PI * DIAMETER * DIAMETER * scene.areal_density;
    let pressed = |(boundary, direction): (usize, DVec2)| Motion {
        boundaries: vec![boundary],
        drive: Some(Drive {
            direction,
            pressure: Some(CONFINING_PRESSURE * of_grain * GRAVITY / DIAMETER),
            width: Some(HEIGHT * DIAMETER),
            mass: rows * of_grain,
            ..Drive::default()
        }),
        ..Motion::default()
    };
    let down = |by: f64| DVec2::new(0.0, -DIAMETER * by);
    let lid = moved(
        3,
        MotionCourse::Table {
            times_secs: vec![0.0, CLOSING_SECS, CLOSING_SECS + COMPRESSION_SECS],
            offsets: vec![DVec2::ZERO, down(CLOSING), down(CLOSING + COMPRESSION)],
        },
    );
    let sides = [(1, DVec2::X), (2, DVec2::NEG_X)].map(pressed);
    scene.motions = sides.into_iter().chain([lid]).collect();
    scene.duration_secs = CLOSING_SECS + COMPRESSION_SECS;
    scene.view = view(DVec2::new(-half - 2.0, -2.0), DVec2::new(half + 2.0, top + 2.0));
    scene
}
