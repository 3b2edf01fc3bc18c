//! Heaps, an arch and a full box, which stand by the way in which their discs lie.

use std::f64::consts::{FRAC_PI_4, FRAC_PI_8, SQRT_2};

use glam::DVec2;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use super::{DIAMETER, TOUCH, disc, dry, floor, half_space, view};
use crate::scene::{Scene, rough_base};
use crate::world::{Disc, direction};

/// Where the falling disc starts, from the place of the highest, in diameters.
const FALLING: [f64; 2] = [0.3, 1.5];

/// A heap of `rows` rows, the lowest of `rows` discs.
/// A heap with slopes of 60° over a rough base: each disc lies in the notch of two below it, and
/// what presses on an edge disc from above passes straight on to the one below, so the heap stands
/// even without friction.
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

/// The largest heap of at most `count` discs, for `count` ≥ 1.
pub fn heap_of(count: usize) -> Scene {
    let rows = (1..).take_while(|rows| rows * (rows + 1) / 2 <= count).count();
    Scene { name: "size".into(), ..heap(rows) }
}

/// The same heap with one disc more that falls on its slope, `distance` diameters from the origin along both axes.
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

/// The steepest slope on which the heap stands, degrees.
pub const STEEPEST_DEGREES: f64 = 30.0;

/// The heap of [`heap`] on a slope. It stands up to an inclination of exactly 30°, whatever its size and
/// for every friction below √3.
///
/// Up to 30° every disc can rest on the two below it without friction. Their forces f₁ (up the slope of
/// it) and f₂ (down the slope) run along the lattice, at 60° to the base. With θ the inclination and w a
/// disc's weight, they ask for (f₁ + f₂) sin 60° = w cos θ and (f₂ − f₁) cos 60° = w sin θ, so that
///
/// > f₁ = w (cos θ/√3 − sin θ) ≥ 0  where tan θ ≤ 1/√3;
///
/// what a disc gets from above passes straight on to the one below, and the sums along each line of
/// the lattice push as well.
///
/// Beyond 30° the weight of the highest disc passes below its lower contact, about which it turns: its
/// upper contact opens at 30° to that contact's normal, which only friction of at least tan 60° = √3
/// could hold. Without friction the whole base would have to pull, Σf₁ < 0, so that nothing holds.
///
/// A heap of grains poured at random has no such value: its angle of repose is a matter of its past.
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

/// The least friction that holds the arch.
pub const FRICTION_OF_ARCH: f64 = 3.0 - 2.0 * SQRT_2;

/// Depth of the ground that a fallen arch lies on, below the fixed discs' centres, in diameters.
const GROUND: f64 = 0.5;

/// Three discs as a semicircular arch between two fixed ones: the centres of all five lie on half a
/// circle, an eighth of a turn apart.
///
/// A contact whose normal, from the lower disc to the higher, rises at the angle φ carries N along it
/// and T across it, so the force up the arch is H = N cos φ − T sin φ, V = N sin φ + T cos φ. With w the
/// weight of a disc, half the keystone hangs on each crown contact (V = w/2, φ = β), and the spring
/// contact below carries a disc more (V = 3w/2, φ = α) at the same thrust H, so that
///
/// > T_β = (w/2) cos β − H sin β,  T_α = (3w/2) cos α − H sin α.
///
/// No torque on the disc between them asks for T_α = −T_β, which gives
///
/// > H = (w/2) (cos β + 3 cos α)/(sin α + sin β),
/// > T_β = (w/2) (sin α cos β − 3 cos α sin β)/(sin α + sin β).
///
/// T vanishes where tan α = 3 tan β, on the funicular. On the semicircle β = 22.5° and α = 67.5°; with
/// c = cos β = sin α and s = sin β = cos α, 4cs = √2 and c² − 3s² = √2 − 1, the crown contacts have
///
/// > T/N = (c² − 3s²)/(1 + 4cs) = (√2 − 1)/(√2 + 1) = 3 − 2√2.
///
/// The spring contacts need (√2 − 1)/(3 + √2), about half of it. Below μ = 3 − 2√2 the keystone slips
/// through.
///
/// The balance is one of discs that can roll, and so unstable at any friction: left alone, rounding and
/// what the solver leaves grow until the arch rolls aside, after about 0.7 s. What is measured is over
/// long before.
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

/// Overlap of neighbours in the regular lattice, in displacements: what two of them can open, and half of
/// that again.
const SPARE: f64 = 3.0;

/// Rows of `columns` discs and of one less in turn, each disc displaced by up to `perturbation` diameters
/// along each axis.
///
/// A box full of discs in a lattice of triangles: a disc inside touches six others, so that there are three
/// contacts for each disc where its freedoms ask for one and a half. Each disc is off its place by a
/// little, which turns every normal by as much.
///
/// It is at rest. In the regular lattice the contacts side by side may bear nothing: what is above a disc rests
/// on two contacts below it, or on one and a wall, and all of these push, inside their cones. They have four
/// impulses a disc for its three balances, so that a small turn of the normals asks for a small change of the
/// impulses, and not for motion.
///
/// The overlap of neighbours is three times the displacement, so that none opens.
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
