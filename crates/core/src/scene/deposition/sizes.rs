//! The sizes of the grains of new piles.

use rand::RngExt;
use rand_pcg::Pcg64;

use crate::scene::pile::DIAMETER;

/// Diameters are uniform in d·[1 − SPREAD, 1 + SPREAD].
const SPREAD: f64 = 0.2;
/// Radius of the largest disc, m.
pub(super) const LARGEST_RADIUS: f64 = 0.5 * DIAMETER * (1.0 + SPREAD);

/// The radius of the next disc, m.
pub(super) fn random_radius(random: &mut Pcg64) -> f64 {
    0.5 * DIAMETER * random.random_range(1.0 - SPREAD..=1.0 + SPREAD)
}
