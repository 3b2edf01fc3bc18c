//! Two rows of grains, a lattice of triangles, held by fixed discs on one side or on both. Its upper
//! or lower row is pulled: without cohesion both fall at once.
//!
//! A cantilever of 2L discs weighs 2L·m·g, L/2 diameters from its root on average, so its rows carry
//! L²·m·g·d over their distance of 0.87 d. A contact holds 50 m·g at Bond 100: L = 4, with 18 m·g, is
//! far from tearing, and L = 8, with 74, must tear.

use glam::DVec2;

use super::{DIAMETER, disc, dry};
use crate::scene::Scene;
use crate::world::{Disc, Grain};

/// Distance of neighbours, in diameters: an overlap like that of a pile that has come to rest.
const SPACING: f64 = 1.0 - 1e-4;
/// Bond number that has to hold them.
const BOND: f64 = 100.0;

fn lower(k: i32) -> Grain {
    disc(SPACING * f64::from(k), 0.0)
}

fn upper(k: i32) -> Grain {
    disc(SPACING * (f64::from(k) + 0.5), SPACING * 0.75f64.sqrt())
}

fn truss(name: &str, grains: Vec<Grain>, fixed: Vec<Grain>) -> Scene {
    let mut scene = dry(name, grains);
    scene.parameters.bond = BOND;
    let fixed = fixed.iter().map(|grain| Disc { position: grain.position, radius: grain.radius });
    scene.fixed_discs = fixed.collect();
    let shift = DIAMETER * DVec2::new(0.0, 4.0);
    scene.grains.iter_mut().for_each(|grain| grain.position += shift);
    scene.fixed_discs.iter_mut().for_each(|disc| disc.position += shift);
    scene
}

/// Two rows of `length` grains that reach out from a wall.
pub fn cantilever(length: i32) -> Scene {
    let grains = (0..length).flat_map(|k| [lower(k), upper(k)]).collect();
    truss("cantilever", grains, vec![lower(-1), upper(-1)])
}

/// Two rows between two walls, the lower one of `length` grains.
pub fn bridge(length: i32) -> Scene {
    let mut grains: Vec<_> = (0..length).map(lower).collect();
    grains.extend((0..length - 1).map(upper));
    truss("bridge", grains, vec![lower(-1), upper(-1), lower(length), upper(length - 1)])
}
