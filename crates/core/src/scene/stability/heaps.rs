//! Scenes of discs that stay at rest because of their geometry: heaps, an arch and a full box.

use std::f64::consts::{FRAC_PI_4, FRAC_PI_8, SQRT_2};

use glam::DVec2;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use super::{DIAMETER, TOUCH, disc, dry, floor, half_space, view};
use crate::scene::{Scene, rough_base};
use crate::world::{Disc, direction};

/// Initial position of the falling disc of the scene [`heap_far_away`] relative to the highest disc of its heap, in
/// diameters along x and y.
const FALLING: [f64; 2] = [0.3, 1.5];

/// Returns the scene of a triangular heap on a base of fixed discs, with slopes of 60°. It has `rows` rows, and its
/// lowest row has `rows` discs. Each disc is in the notch between two discs below it, and the load on a disc at the
/// edge passes straight on to the disc below. So the heap stays at rest even without friction.
pub fn heap(rows: usize) -> Scene {
    let height = 0.75f64.sqrt() * (1.0 - 3.0 * TOUCH);
    let mut grains = Vec::new();
    for row in 0..rows {
        let count = rows - row;
        let left = -0.5 * (count as f64 - 1.0);
        // The discs of the lowest row are between discs of the base.
        let shift = if rows.is_multiple_of(2) { 0.0 } else { 0.5 };
        for column in 0..count {
            let x = (left + column as f64 + shift) * (1.0 - TOUCH);
            grains.push(disc(x, (row as f64 + 1.0) * height));
        }
    }
    let mut scene = dry("repose", grains);
    let width = rows as f64 + 6.0;
    scene.fixed_discs = rough_base(width, DIAMETER);
    for disc in &mut scene.fixed_discs {
        disc.position.x *= 1.0 - TOUCH;
    }
    scene.view = view(DVec2::new(-0.5 * width, -1.0), DVec2::new(0.5 * width, rows as f64 + 1.0));
    scene
}

/// Returns the scene of the largest triangular heap with at most `count` ≥ 1 discs.
pub fn heap_of(count: usize) -> Scene {
    let rows = (1..).take_while(|rows| rows * (rows + 1) / 2 <= count).count();
    Scene { name: "size".into(), ..heap(rows) }
}

/// Returns the scene of [`heap`] with one more disc, which falls onto the slope. All discs are shifted by `distance`
/// diameters along both axes, so that they are far from the origin. There the rounding of coordinates is coarser, but
/// the discs should move as they do at the origin.
pub fn heap_far_away(rows: usize, distance: f64) -> Scene {
    let mut scene = heap(rows);
    scene.name = "far".into();
    scene.grains.push(disc(FALLING[0], rows as f64 * 0.75f64.sqrt() + FALLING[1]));
    let shift = DVec2::splat(distance * DIAMETER);
    scene.grains.iter_mut().for_each(|grain| grain.position += shift);
    scene.fixed_discs.iter_mut().for_each(|disc| disc.position += shift);
    if let Some(view) = &mut scene.view {
        view.min += shift;
        view.max += shift;
    }
    scene
}

/// Steepest inclination of the base at which the heap of [`heap_on_slope`] stays at rest, degrees.
pub const STEEPEST_DEGREES: f64 = 30.0;

/// Returns the scene of [`heap`] on a base that is inclined by `degrees` (degrees). The heap stays at rest up to an
/// inclination of exactly 30°, for every number of rows and every friction coefficient below √3.
///
/// **Up to 30°** every disc can rest on the two discs below it without friction. Let f₁ be the force of the lower
/// disc on the uphill side and f₂ the force of the lower disc on the downhill side. Both act along the lattice, at
/// 60° to the base. With the inclination θ and the weight w of a disc, equilibrium requires (f₁ + f₂) sin 60° = w cos
/// θ and (f₂ − f₁) cos 60° = w sin θ, so that
///
/// > f₁ = w (cos θ/√3 − sin θ) ≥ 0  if tan θ ≤ 1/√3.
///
/// The load on a disc passes straight on to the discs below. So the forces along each line of the lattice add up, and
/// all of them push.
///
/// **Beyond 30°** the line of the weight of the highest disc passes outside its downhill contact, about which the disc
/// turns. As the disc turns, its surface leaves the uphill contact in a direction at 30° to the normal of the uphill
/// contact. So friction could hold the disc only with a coefficient of at least tan 60° = √3. Without friction the
/// whole base would have to pull, Σf₁ < 0, so no equilibrium exists.
///
/// A heap of grains that are poured at random does not have such an exact limit: its angle of repose depends on its
/// history.
pub fn heap_on_slope(rows: usize, degrees: f64) -> Scene {
    let mut scene = heap(rows);
    scene.name = "repose-angle".into();
    let slope = direction(-degrees.to_radians());
    for position in scene.grains.iter_mut().map(|grain| &mut grain.position) {
        *position = slope.rotate(*position);
    }
    for position in scene.fixed_discs.iter_mut().map(|disc| &mut disc.position) {
        *position = slope.rotate(*position);
    }
    let half = 0.5 * rows as f64 + 3.0;
    scene.view = view(DVec2::new(-half, -0.6 * half), DVec2::new(half, rows as f64 + 1.0));
    scene
}

/// Smallest friction coefficient at which the arch of [`arch`] stays at rest.
pub const FRICTION_OF_ARCH: f64 = 3.0 - 2.0 * SQRT_2;

/// Depth of the ground below the centres of the two fixed discs of the arch, in diameters. The other discs fall onto
/// it if the arch breaks.
const GROUND: f64 = 0.5;

/// Returns the scene of an arch: three discs between two fixed discs. The centres of all five discs are on a
/// semicircle, an eighth of a turn apart.
///
/// The highest disc is the keystone. Its two contacts are the crown contacts, and the contacts with the fixed discs are
/// the spring contacts. Let the normal of a contact, from the lower to the higher disc, rise at the angle φ to the
/// horizontal: φ = β at a crown contact, and φ = α at a spring contact. The lower disc pushes the higher disc with a
/// force N along the normal and T across it. The horizontal component of this force is the thrust H = N cos φ − T sin
/// φ, and the vertical component is V = N sin φ + T cos φ. With the weight w of a disc, each crown contact carries half
/// of the keystone, V = w/2. Each spring contact carries one disc more, V = 3w/2, at the same thrust H. With T_β at a
/// crown contact and T_α at a spring contact,
///
/// > T_β = (w/2) cos β − H sin β,  T_α = (3w/2) cos α − H sin α.
///
/// No torque acts on the disc between a crown contact and a spring contact if T_α = −T_β, which gives
///
/// > H = (w/2) (cos β + 3 cos α)/(sin α + sin β),
/// > T_β = (w/2) (sin α cos β − 3 cos α sin β)/(sin α + sin β).
///
/// T is zero if tan α = 3 tan β, which is the shape of the funicular curve. On the semicircle β = 22.5° and α =
/// 67.5°. With c = cos β = sin α and s = sin β = cos α, 4cs = √2 and c² − 3s² = √2 − 1, so the crown contacts have
///
/// > T/N = (c² − 3s²)/(1 + 4cs) = (√2 − 1)/(√2 + 1) = 3 − 2√2.
///
/// The spring contacts need T/N = (√2 − 1)/(3 + √2), about half of this value. If the friction coefficient μ is below
/// 3 − 2√2, the keystone slips through.
///
/// This equilibrium is unstable at any friction, because discs can roll. Rounding and solver errors grow until the
/// arch rolls aside after about 0.7 s. The measurement ends long before this time.
pub fn arch() -> Scene {
    let radius = 0.5 * (1.0 - TOUCH) / libm::sin(FRAC_PI_8);
    let place = |eighth: u8| radius * direction(f64::from(eighth) * FRAC_PI_4);
    let stones = [1, 2, 3].map(place).map(|centre| disc(centre.x, centre.y));
    let mut scene = dry("arch", stones.into());
    let abutment = |eighth: u8| Disc { position: DIAMETER * place(eighth), radius: 0.5 * DIAMETER };
    scene.fixed_discs = vec![abutment(0), abutment(4)];
    scene.boundaries = vec![half_space(DVec2::new(0.0, -GROUND), DVec2::Y)];
    scene.view = view(DVec2::new(-3.0, -1.0), DVec2::new(3.0, 2.5));
    scene
}

/// Overlap of neighbouring discs of the scene [`lattice`] before its discs are displaced at random, in units of the
/// largest displacement of a disc along an axis. The displacements can move two neighbours apart by two units, and one
/// more unit is a margin, so that all contacts touch.
const SPARE: f64 = 3.0;

/// Returns the scene of a box full of discs in a triangular lattice. Each disc is displaced at random by up to
/// `perturbation` diameters along each axis. The rows have `columns` and `columns` − 1 discs in turn.
///
/// An inner disc touches six other discs. So there are three contacts per disc, but only one and a half would be
/// needed for the degrees of freedom of a disc. The displacements turn every normal by a small angle.
///
/// The lattice is in equilibrium. In the regular lattice the horizontal contacts may be without force. Then two
/// contacts carry the load on a disc: two contacts with discs below it, or one contact with such a disc and one with a
/// wall. Both contacts push, with forces inside their friction cones. Their impulses have four components, normal and
/// tangential, for the three equations of equilibrium of a disc. So a small rotation of the normals needs only a small
/// change of the impulses, and no motion.
///
/// The overlap of neighbouring discs is three times the displacement, so that no contact opens.
pub fn lattice(columns: usize, rows: usize, perturbation: f64) -> Scene {
    let mut random = Pcg64::seed_from_u64(5);
    let mut displaced = || DVec2::from_array([0; 2].map(|_| random.random_range(-1.0..=1.0)));
    let overlap = (SPARE * perturbation).max(TOUCH);
    let spacing = 1.0 - overlap;
    let mut grains = Vec::new();
    for row in 0..rows {
        let odd = row % 2;
        for column in 0..columns - odd {
            let across = (column as f64 + 0.5 * odd as f64) * spacing;
            let up = 0.5 * spacing + row as f64 * 0.75f64.sqrt() * spacing;
            let place = DVec2::new(across, up) + perturbation * displaced();
            grains.push(disc(place.x, place.y));
        }
    }
    let mut scene = dry("hyperstatic", grains);
    let wall = |across: f64, normal: DVec2| half_space(DVec2::new(across, 0.0), normal);
    let right = (columns as f64 - 0.5) * spacing;
    scene.boundaries = vec![floor(), wall(-0.5 * spacing, DVec2::X), wall(right, -DVec2::X)];
    scene
}
