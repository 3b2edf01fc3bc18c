//! Heaps, an arch and a full box, whose geometry keeps them at rest.

use std::f64::consts::{FRAC_PI_4, FRAC_PI_8, SQRT_2};

use glam::DVec2;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use super::{DIAMETER, TOUCH, disc, dry, floor, half_space, view};
use crate::scene::{Scene, rough_base};
use crate::world::{Disc, direction};

/// Start of the falling disc relative to the highest disc, in diameters.
const FALLING: [f64; 2] = [0.3, 1.5];

/// A heap of `rows` rows over a rough base, the lowest row with `rows` discs, with slopes of 60°. Each disc lies in
/// the notch between two below it, and the load on an edge disc passes straight on to the one below. So the heap
/// stays at rest even without friction.
pub fn heap(rows: usize) -> Scene {
    let height = 0.75f64.sqrt() * (1.0 - 3.0 * TOUCH);
    let mut grains = Vec::new();
    for row in 0..rows {
        let count = rows - row;
        let left = -0.5 * (count as f64 - 1.0);
        // The discs of the lowest row lie between those of the base.
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

/// The largest heap with at most `count` ≥ 1 discs.
pub fn heap_of(count: usize) -> Scene {
    let rows = (1..).take_while(|rows| rows * (rows + 1) / 2 <= count).count();
    Scene { name: "size".into(), ..heap(rows) }
}

/// The same heap, with one more disc that falls on its slope, moved by `distance` diameters from the origin along
/// both axes.
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

/// The steepest slope on which the heap stays at rest, degrees.
pub const STEEPEST_DEGREES: f64 = 30.0;

/// The heap of [`heap`] on a slope. It stays at rest up to an inclination of exactly 30°, whatever its size and for
/// every friction below √3.
///
/// Up to 30° every disc can rest on the two below it without friction. The forces of these, f₁ (the disc up the
/// slope) and f₂ (the disc down the slope), act along the lattice, at 60° to the base. With θ the inclination and w a
/// disc's weight, balance requires (f₁ + f₂) sin 60° = w cos θ and (f₂ − f₁) cos 60° = w sin θ, so that
///
/// > f₁ = w (cos θ/√3 − sin θ) ≥ 0  if tan θ ≤ 1/√3.
///
/// The load on a disc passes straight on to the discs below, and the sums along each line of the lattice push as
/// well.
///
/// Beyond 30° the weight of the highest disc passes below its lower contact, about which the disc turns: its upper
/// contact opens at 30° to that contact's normal, and only a friction of at least tan 60° = √3 could hold it. Without
/// friction the whole base would have to pull, Σf₁ < 0, so that nothing holds.
///
/// A heap of grains poured at random has no such value: its angle of repose depends on its history.
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

/// The smallest friction that holds the arch.
pub const FRICTION_OF_ARCH: f64 = 3.0 - 2.0 * SQRT_2;

/// Depth of the ground below the fixed discs' centres, in diameters. A fallen arch lies on it.
const GROUND: f64 = 0.5;

/// Three discs as a semicircular arch between two fixed ones: the centres of all five lie on half a
/// circle, an eighth of a turn apart.
///
/// A contact whose normal, from the lower disc to the higher, rises at the angle φ carries N along the normal and T
/// across it. So the force up the arch is H = N cos φ − T sin φ, V = N sin φ + T cos φ. With w the weight of a disc,
/// each crown contact carries half the keystone (V = w/2, φ = β), and the spring contact below carries one disc more
/// (V = 3w/2, φ = α) at the same thrust H, so that
///
/// > T_β = (w/2) cos β − H sin β,  T_α = (3w/2) cos α − H sin α.
///
/// Zero torque on the disc between the two contacts requires T_α = −T_β, which gives
///
/// > H = (w/2) (cos β + 3 cos α)/(sin α + sin β),
/// > T_β = (w/2) (sin α cos β − 3 cos α sin β)/(sin α + sin β).
///
/// T vanishes if tan α = 3 tan β, on the funicular. On the semicircle β = 22.5° and α = 67.5°; with
/// c = cos β = sin α and s = sin β = cos α, 4cs = √2 and c² − 3s² = √2 − 1, the crown contacts have
///
/// > T/N = (c² − 3s²)/(1 + 4cs) = (√2 − 1)/(√2 + 1) = 3 − 2√2.
///
/// The spring contacts need (√2 − 1)/(3 + √2), about half as much. Below μ = 3 − 2√2 the keystone slips through.
///
/// This balance is unstable at any friction, because discs can roll. Rounding and solver errors grow until the arch
/// rolls aside, after about 0.7 s. The measurement ends long before.
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

/// Overlap of neighbours in the regular lattice, in units of the displacement: two neighbours can open by two units,
/// and half as much is added.
const SPARE: f64 = 3.0;

/// A box full of discs in a triangular lattice, each displaced by up to `perturbation` diameters along each axis. The
/// rows have `columns` discs and one disc less in turn.
///
/// An inner disc touches six others, so there are three contacts per disc, while the degrees of freedom of a disc
/// require one and a half. The displacements turn every normal by a small angle.
///
/// The lattice is at rest. In the regular lattice the horizontal contacts may carry no force: the load on a disc
/// rests on two contacts below it, or on one contact and a wall, and all of these push, inside their friction cones.
/// They have four impulses per disc for three balance equations, so a small rotation of the normals needs only a
/// small change of the impulses and no motion.
///
/// The overlap of neighbours is three times the displacement, so that no contact opens.
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
