//! Scenes of grains that only cohesion keeps from falling: a hanging chain, a cantilever and a bridge.

use glam::DVec2;

use crate::scene::Scene;
use crate::scene::stability::{DIAMETER, disc, dry, view};
use crate::world::{Disc, Grain};

/// Initial overlap of neighbouring discs of the hanging chain, in diameters, about as in a pile at rest. Steppers with
/// springs need some overlap to find the equilibrium.
const OVERLAP: f64 = 1e-3;

/// Returns the scene of a chain of n ≥ 2 equal discs of mass m that hang from a fixed disc under gravity g. The
/// cohesion force C₀ of a contact is the Bond number times the weight of the effective mass, which is m at a fixed disc
/// and m/2 between two discs. The contact with the fixed disc has C₀ = Bond·m·g and carries n·m·g. The next contact has
/// C₀ = Bond·(m/2)·g and carries (n − 1)·m·g. So the chain does not break if the Bond number is above max(n, 2(n − 1)),
/// at every time step.
pub fn hanging_chain(count: usize, bond: f64) -> Scene {
    let place = |k: usize| -(k as f64) * (1.0 - OVERLAP);
    let mut scene = dry("chain", (1..=count).map(|k| disc(0.0, place(k))).collect());
    scene.parameters.bond = bond;
    scene.fixed_discs = vec![Disc { position: DVec2::ZERO, radius: 0.5 * DIAMETER }];
    let length = count as f64 + 1.5;
    scene.view = view(DVec2::new(-0.5 * length, -1.3 * length), DVec2::new(0.5 * length, 1.0));
    scene
}

/// Returns the Bond number below which a hanging chain of `count` discs breaks.
pub fn breaking_bond(count: usize) -> f64 {
    (count as f64).max(2.0 * (count as f64 - 1.0))
}

/// Distance between the centres of neighbouring discs of the cantilever and the bridge, in diameters. The discs
/// overlap about as in a pile at rest.
const SPACING: f64 = 1.0 - 1e-4;
/// Bond number of the cantilever and the bridge: cohesion force divided by the weight of the effective mass. With this
/// value a cantilever of 4 discs per row does not tear, and a cantilever of 8 discs per row must tear.
const BOND: f64 = 100.0;

fn lower(k: i32) -> Grain {
    disc(SPACING * f64::from(k), 0.0)
}

fn upper(k: i32) -> Grain {
    disc(SPACING * (f64::from(k) + 0.5), SPACING * 0.75f64.sqrt())
}

/// Returns the scene of two rows of grains in a triangular lattice, with fixed discs on one or both sides. Either the
/// upper or the lower row is under tension, so without cohesion both rows fall at once.
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

/// Returns the scene of a cantilever: two rows of L discs each, next to two fixed discs on one side, which act as a
/// wall. Each disc has the mass m and the diameter d, and g is gravity.
///
/// **Estimate.** The cantilever weighs 2L·m·g, and its weight acts L/2 diameters from the wall on average. So this
/// weight exerts a moment of L²·m·g·d at the wall. The rows, whose distance is 0.87 d, balance it by a pull in the
/// upper row and an equal push in the lower row of L²·m·g/0.87. At Bond 100 a contact of two discs carries up to 50
/// m·g. A cantilever with L = 4 needs 18 m·g and is far from tearing. With L = 8 it needs 74 m·g and must tear.
///
/// **Exact limit.** Without friction the cantilever is a truss of 4L bars (contacts) between 2L joints (discs), so it
/// is statically determinate. Cut a bar of the upper row, with n discs of each row beyond the cut, and take moments
/// about the disc of the lower row next to the cut. The lever arms are 1 + 2 + … + (n − 1) diameters in the lower row,
/// and half a diameter more for each disc in the upper row. So the tension of the bar is (n² − n/2) m·g/(√3/2) = (2n²
/// − n) m·g/√3. A diagonal bar that carries the 2n discs beyond it has the tension 4n·m·g/√3. At the wall n is L and
/// the cohesion force is C₀ = Bond·m·g. At the next cut n is L − 1 and C₀ = Bond·(m/2)·g. All other bars have less
/// tension. So at every time step the cantilever does not tear if the Bond number is above
///
/// > Bond = max(2L² − L, 4L, 2(2(L−1)² − (L−1)), 8(L−1))/√3,
///
/// which is 10√3 for L = 4. Friction helps: with a friction coefficient of 0.5 the measured limit is 5 % lower.
pub fn cantilever(length: i32) -> Scene {
    let grains = (0..length).flat_map(|k| [lower(k), upper(k)]).collect();
    truss("cantilever", grains, vec![lower(-1), upper(-1)])
}

/// Returns the Bond number below which a cantilever of two rows of `length` ≥ 2 discs tears without friction.
pub fn breaking_bond_of_cantilever(length: i32) -> f64 {
    let times_root_3 = |n: f64| (2.0 * n * n - n).max(4.0 * n);
    let n = f64::from(length);
    times_root_3(n).max(2.0 * times_root_3(n - 1.0)) / 3f64.sqrt()
}

/// Returns the scene of a bridge: two rows of grains between two fixed discs on each side. The lower row has `length`
/// grains.
pub fn bridge(length: i32) -> Scene {
    let mut grains: Vec<_> = (0..length).map(lower).collect();
    grains.extend((0..length - 1).map(upper));
    truss("bridge", grains, vec![lower(-1), upper(-1), lower(length), upper(length - 1)])
}
