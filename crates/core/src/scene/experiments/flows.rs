//! Scenes of flowing grains: a collapsing column, a silo, an incline, a drum and a shaken box.

use std::f64::consts::TAU;

use glam::DVec2;

use super::{SPACING, lattice, moved, of_loose_grains, open_box, place, view};
use crate::number::Parts;
use crate::scene::stability::{DIAMETER, GRAVITY, floor, half_space};
use crate::scene::{Scene, rough_base};
use crate::world::{
    Boundary, Disc, Grain, GravityTurn, Motion, MotionCourse, TurnCourse, direction,
};

/// Number of grains of a column whose half-width R₀ and height H₀ are one grain diameter d each: a rectangle of 2 d by
/// d, of which the grains (area π d²/4 each) cover a fraction of 0.82.
const GRAINS_OF_SQUARE: f64 = 2.09;
/// Distance by which each of the two gates of the scene `collapse` is pulled away from the column, m.
const GATE_WAY: f64 = 3.0;
/// Time in which each of the two gates of the scene `collapse` is pulled away from the column, s. The gates then move
/// at 15 m/s, faster than grains can follow.
const GATE_SECS: f64 = 0.2;
/// Half-width of the rough floor of the scene `collapse`, divided by the largest half-width that a collapsed column
/// with the aspect ratio (height by half-width) of the scene is known to reach. Farther out, the floor is smooth.
const REACH: f64 = 1.3;

/// Returns the half-width R₀, in diameters, of a column with this number of grains and the aspect ratio H₀/R₀ (H₀:
/// height).
pub fn half_width(grains: usize, aspect: f64) -> f64 {
    (grains as f64 / (GRAINS_OF_SQUARE * aspect)).sqrt()
}

/// Returns the scene of a collapsing column: grains between two gates over a rough floor. The gates are pulled away
/// faster than grains can follow, and the column spreads to both sides.
///
/// The column has the half-width R₀ and the height H₀, with the aspect ratio a = H₀/R₀. At a solid fraction of 0.82
/// it has 2 a R₀² · 0.82/(π/4) = 2.09 a R₀²/d² grains of diameter d.
pub fn collapse() -> Scene {
    let (grains, aspect) = (400, 2.0);
    let half = half_width(grains, aspect);
    let loose = of_loose_grains("collapse", lattice(grains, 2.0 * half, 1.2));
    let mut scene = collapse_of(loose, half, 0.7);
    scene.duration_secs = 2.5;
    scene.view = view(DVec2::new(-5.4 * half, -2.0), DVec2::new(5.4 * half, 3.6 * half));
    scene
}

/// Adds two gates and a floor to a scene of grains, so that they form a column that collapses when the gates open.
/// `half` is the half-width of the column, in diameters. The gates start to move at the time `release_secs` (s).
pub fn collapse_of(mut scene: Scene, half: f64, release_secs: f64) -> Scene {
    let top = |grain: &Grain| grain.position.y + grain.radius;
    let aspect = scene.grains.iter().map(top).fold(0.0, f64::max) / (half * DIAMETER);
    // Half-width of the rough floor: the largest half-width that collapsed columns are known to reach, times a margin.
    let reach = REACH * half * (1.0 + (2.5 * aspect).max(3.25 * libm::pow(aspect, 0.7)));
    scene.fixed_discs = rough_base(2.0 * reach, DIAMETER);
    let gate = |side: f64| half_space(DVec2::new(side * half, 0.0), DVec2::new(-side, 0.0));
    scene.boundaries = vec![floor(), gate(-1.0), gate(1.0)];
    let pulled = |(gate, side): (usize, f64)| {
        let times_secs = vec![0.0, release_secs, release_secs + GATE_SECS];
        let offsets = vec![DVec2::ZERO, DVec2::ZERO, DVec2::new(side * GATE_WAY, 0.0)];
        moved(gate, MotionCourse::Table { times_secs, offsets })
    };
    scene.motions = [(1, -1.0), (2, 1.0)].map(pulled).into();
    scene
}

/// Width of the silo, in diameters.
pub const SILO_WIDTH: f64 = 26.0;
/// Height of the side walls of the silo, in diameters.
const SILO_HEIGHT: f64 = 60.0;
/// Distance from the bottom of the silo down to the floor that catches the grains, in diameters.
const FLOOR_DEPTH: f64 = 30.0;
/// Distance by which the plate that closes the orifice of the silo falls, m.
const PLATE_WAY: f64 = 1.0;
/// Time in which the plate that closes the orifice of the silo falls, s. It is so short that the plate falls faster
/// than grains.
const PLATE_SECS: f64 = 0.1;

/// Returns the scene of a silo with a flat bottom and an orifice in its middle. A plate closes the orifice at first.
/// When the plate falls away, grains flow out onto a floor below.
pub fn silo() -> Scene {
    let mut scene = silo_of(of_loose_grains("silo", lattice(450, SILO_WIDTH, 0.7)), 7.0, 0.5);
    scene.duration_secs = 2.5;
    scene.view =
        view(DVec2::new(-0.8 * SILO_WIDTH, -FLOOR_DEPTH - 1.0), DVec2::new(0.8 * SILO_WIDTH, 30.0));
    scene
}

/// Adds a silo to a scene of grains. `orifice` is the width of its orifice, in diameters. The plate that closes the
/// orifice falls away at the time `release_secs` (s).
pub fn silo_of(mut scene: Scene, orifice: f64, release_secs: f64) -> Scene {
    let side = |sign: f64| Boundary::Polyline {
        points: vec![
            place(sign * 0.5 * SILO_WIDTH, SILO_HEIGHT),
            place(sign * 0.5 * SILO_WIDTH, 0.0),
            place(sign * 0.5 * orifice, 0.0),
        ],
    };
    let plate =
        Boundary::Segment { from: place(-0.5 * orifice, 0.0), to: place(0.5 * orifice, 0.0) };
    let floor = half_space(DVec2::new(0.0, -FLOOR_DEPTH), DVec2::Y);
    scene.boundaries = vec![side(-1.0), side(1.0), plate, floor];
    let times_secs = vec![0.0, release_secs, release_secs + PLATE_SECS];
    let offsets = vec![DVec2::ZERO, DVec2::ZERO, DVec2::new(0.0, -PLATE_WAY)];
    scene.motions = vec![moved(2, MotionCourse::Table { times_secs, offsets })];
    scene
}

/// Width of the box that is tilted in the scene `incline`, in diameters.
const INCLINE_WIDTH: f64 = 40.0;
/// Height of the walls of the box that is tilted in the scene `incline`, in diameters.
const INCLINE_HEIGHT: f64 = 30.0;
/// Simulated time during which the box of the scene `incline` is level, so that the grains come to rest, before it is
/// tilted, s.
pub const LEVEL_SECS: f64 = 0.4;
/// Angular velocity at which the box of the scene `incline` is tilted, rad/s.
pub const TILT_RATE: f64 = 0.12;
/// Angle from the horizontal at which the tilting of the box of the scene `incline` ends, rad.
const STEEPEST: f64 = 0.72;

/// Returns the scene of an incline: a layer of grains in a flat box with a rough bottom that is tilted slowly. The
/// layer stays at rest up to some angle, and then its surface flows. The scene turns gravity instead of the box, so in
/// pictures the box stays level.
pub fn incline() -> Scene {
    let mut scene = of_loose_grains("incline", lattice(300, INCLINE_WIDTH, 1.2));
    let tilting_secs = STEEPEST / TILT_RATE;
    let times_secs = vec![0.0, LEVEL_SECS, LEVEL_SECS + tilting_secs];
    let course = TurnCourse::Table { times_secs, angles: vec![0.0, 0.0, STEEPEST] };
    scene.gravity_turn = Some(GravityTurn { course, elapsed_secs: 0.0 });
    scene.fixed_discs = rough_base(INCLINE_WIDTH - 2.0, DIAMETER);
    scene.boundaries = vec![open_box(0.5 * INCLINE_WIDTH, INCLINE_HEIGHT)];
    scene.duration_secs = LEVEL_SECS + tilting_secs;
    scene.view = view(
        DVec2::new(-0.55 * INCLINE_WIDTH, -2.0),
        DVec2::new(0.55 * INCLINE_WIDTH, 0.5 * INCLINE_WIDTH),
    );
    scene
}

/// Inner radius of the drum, in diameters of a grain.
const DRUM_RADIUS: f64 = 12.0;
/// Number of sides of the drum's polygonal wall, and number of the discs on this wall. The centres of neighbouring
/// discs are about one diameter apart.
const DRUM_SIDES: usize = 72;
/// Angular velocity Ω of the drum, rad/s. With the radius R of the drum, Ω²R/g is 0.05. At this value grains roll down
/// a steady slope.
const DRUM_RATE: f64 = 2.0;

/// Returns the scene of a drum that turns about its axis and is two fifths full. Discs that turn with the drum make
/// its wall rough. Every sixth of these discs is larger, so that the rotation is visible.
pub fn drum() -> Scene {
    let columns = |row: i32| {
        let y = SPACING * f64::from(row) - 0.78 * DRUM_RADIUS;
        let wide = ((DRUM_RADIUS - 1.4).powi(2) - y * y).positive_part().sqrt();
        let half = (wide / SPACING).floor() as i32;
        (-half..=half).map(move |column| DVec2::new(SPACING * f64::from(column), y))
    };
    let mut scene = of_loose_grains("drum", (0..12).flat_map(columns).take(150));
    let on_rim = |k: usize, radius: f64| {
        DIAMETER * radius * direction(TAU * (k % DRUM_SIDES) as f64 / DRUM_SIDES as f64)
    };
    let rough = |k: usize| Disc {
        position: on_rim(k, DRUM_RADIUS),
        radius: DIAMETER * if k.is_multiple_of(6) { 0.6 } else { 0.3 },
    };
    scene.fixed_discs = (0..DRUM_SIDES).map(rough).collect();
    let points = (0..=DRUM_SIDES).map(|k| on_rim(k, DRUM_RADIUS)).collect();
    scene.boundaries = vec![Boundary::Polyline { points }];
    let course = MotionCourse::Rotation { pivot: DVec2::ZERO, rate: DRUM_RATE, travel: None };
    scene.motions = vec![Motion { fixed_discs: (0..DRUM_SIDES).collect(), ..moved(0, course) }];
    scene.duration_secs = 3.0;
    scene.view = view(DVec2::splat(-DRUM_RADIUS - 1.0), DVec2::splat(DRUM_RADIUS + 1.0));
    scene
}

/// Half-width of the shaken box, in diameters.
const HALF_WIDTH: f64 = 8.0;
/// Height of the walls of the shaken box, in diameters.
const BOX_HEIGHT: f64 = 30.0;
/// Radius of the one large grain in the shaken box, in diameters of the other grains.
const LARGE: f64 = 1.5;
/// Frequency at which the box is shaken, Hz.
const FREQUENCY_HZ: f64 = 10.0;
/// Largest acceleration of the shaken box, in units of gravity g. If it is above 1, the grains are thrown up.
const ACCELERATION: f64 = 3.0;

/// Returns the scene of a shaken box with 120 grains and one large grain.
pub(crate) fn vibrated() -> Scene {
    let large = DVec2::new(0.0, 2.0 * SPACING + LARGE);
    let columns = |row: i32| {
        let y = 0.7 + SPACING * f64::from(row);
        (-5..=5).map(move |column| DVec2::new(1.2 * SPACING * f64::from(column), y))
    };
    let is_free = |place: &DVec2| place.distance(large) > LARGE + 0.65;
    let places = (0..12).flat_map(columns).filter(is_free).take(120);
    let mut scene = of_loose_grains("vibrated", places);
    let mut grain = Grain::at_rest(DIAMETER * large, DIAMETER * LARGE);
    grain.tone = 40;
    scene.grains.push(grain);
    scene.boundaries = vec![open_box(HALF_WIDTH, BOX_HEIGHT)];
    let amplitude = ACCELERATION * GRAVITY / (TAU * FREQUENCY_HZ).powi(2) * DVec2::Y;
    let course = MotionCourse::Sine { amplitude, frequency_hz: FREQUENCY_HZ, phase: 0.0 };
    scene.motions = vec![moved(0, course)];
    scene.duration_secs = 5.0;
    scene.view = view(DVec2::new(-HALF_WIDTH - 1.0, -2.0), DVec2::new(HALF_WIDTH + 1.0, 22.0));
    scene
}
