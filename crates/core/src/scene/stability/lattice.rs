//! A box full of discs in a lattice of triangles: a disc inside touches six others, so that there are three
//! contacts for each disc where its freedoms ask for one and a half. Each disc is off its place by a
//! little, which turns every normal by as much.
//!
//! It is at rest. In the regular lattice the contacts side by side may bear nothing: what is above a disc rests
//! on two contacts below it, or on one and a wall, and all of these push, inside their cones. They have four
//! impulses a disc for its three balances, so that a small turn of the normals asks for a small change of the
//! impulses, and not for motion.
//!
//! The overlap of neighbours is three times the displacement, so that none opens.

use glam::DVec2;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use super::{DIAMETER, TOUCH, disc, dry, floor};
use crate::scene::Scene;
use crate::world::Boundary;

/// Overlap of neighbours in the regular lattice, in displacements: what two of them can open, and half of
/// that again.
const SPARE: f64 = 3.0;

/// Rows of `columns` discs and of one less in turn, each disc displaced by up to `perturbation` diameters
/// along each axis.
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
    let wall = |across: f64, normal: DVec2| Boundary::HalfSpace {
        point: DIAMETER * DVec2::new(across, 0.0),
        normal,
    };
    let right = (columns as f64 - 0.5) * spacing;
    scene.boundaries = vec![floor(), wall(-0.5 * spacing, DVec2::X), wall(right, -DVec2::X)];
    scene
}
