//! A chain of n ≥ 2 equal discs under a fixed one. The contact with the fixed disc has
//! C₀ = Bond·m·g and carries n·m·g; the one below has C₀ = Bond·(m/2)·g and carries (n − 1)·m·g. So
//! the chain holds above Bond = max(n, 2(n − 1)), at every time step.

use super::{DIAMETER, disc, dry};
use crate::scene::{Scene, View};
use crate::world::Disc;
use glam::DVec2;

/// Overlap of neighbours, in diameters, like that of a pile that has come to rest: springs need some
/// to find their balance in.
const OVERLAP: f64 = 1e-3;

/// A chain of `count` discs.
pub fn hanging_chain(count: usize, bond: f64) -> Scene {
    let place = |k: usize| -(k as f64) * (1.0 - OVERLAP);
    let mut scene = dry("chain", (1..=count).map(|k| disc(0.0, place(k))).collect());
    scene.parameters.bond = bond;
    scene.fixed_discs = vec![Disc { position: DVec2::ZERO, radius: 0.5 * DIAMETER }];
    let length = count as f64 + 1.5;
    scene.view = Some(View {
        min: DIAMETER * DVec2::new(-0.5 * length, -1.3 * length),
        max: DIAMETER * DVec2::new(0.5 * length, 1.0),
    });
    scene
}

/// The Bond number below which a chain of `count` discs breaks.
pub fn breaking_bond(count: usize) -> f64 {
    (count as f64).max(2.0 * (count as f64 - 1.0))
}
