//! Measures the upper surface of a heap of discs, and its roughness.

use super::fit::line_through;
use crate::scene::stability::DIAMETER;
use crate::sim::GrainState;
use crate::statistics::mean;

/// Horizontal distance between neighbouring points at which the height of the surface is measured, in diameters.
const SPACING: f64 = 0.5;

/// Returns the heights of the upper surface of a heap, in diameters, at points half a diameter apart, from left to
/// right. The points extend from x = 0 to both sides, as far as there are discs below them.
pub(super) fn profile(grains: &[GrainState]) -> Vec<f64> {
    let above = |x: f64| {
        let arcs = grains.iter().filter_map(|grain| {
            let half = grain.radius * grain.radius - (x - grain.position.x).powi(2);
            (half >= 0.0).then(|| grain.position.y + half.sqrt())
        });
        arcs.reduce(f64::max).map(|height| height / DIAMETER)
    };
    let side = |first: i32, sign: f64| {
        let places = (first..).map(move |place| sign * f64::from(place) * SPACING * DIAMETER);
        places.map_while(above).collect::<Vec<_>>()
    };
    let mut heights = side(1, -1.0);
    heights.reverse();
    heights.extend(side(0, 1.0));
    heights
}

/// Returns the roughness of a surface with these heights, in diameters: the root mean square deviation of the heights
/// from the least-squares line within windows of the width `window` (diameters), averaged over all windows. The
/// roughness is NaN if the surface is shorter than a window. For a self-affine surface it grows as a power of the
/// window's width (J. Schmittbuhl, J.-P. Vilotte, S. Roux, Phys. Rev. E 51, 131, 1995, "variable bandwidth").
pub(super) fn roughness(heights: &[f64], window: f64) -> f64 {
    let count = (window / SPACING).round() as usize + 1;
    let squares: Vec<f64> = heights
        .windows(count)
        .map(|heights| {
            let points = heights.iter().enumerate().map(|(place, y)| (place as f64, *y));
            line_through(&points.collect::<Vec<_>>()).1 / count as f64
        })
        .collect();
    if squares.is_empty() {
        return f64::NAN;
    }
    mean(&squares).mean.sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slope_is_smooth_and_steps_are_as_rough_as_they_are_high() {
        let slope: Vec<f64> = (0..100).map(|place| 3.0 - 0.2 * f64::from(place)).collect();
        assert!(roughness(&slope, 10.0) < 1e-12);
        for height in [0.1, 0.7] {
            let teeth =
                |place: i32| f64::from(place) * 0.3 + height * f64::from(1 - 2 * (place % 2));
            let rough = roughness(&(0..400).map(teeth).collect::<Vec<_>>(), 50.0);
            assert!((rough / height - 1.0).abs() < 1e-3, "{rough} of {height}");
        }
        assert!(roughness(&slope[..5], 10.0).is_nan());
    }

    /// Checks that the roughness of a random walk grows with the square root of the window's width. A random walk is
    /// self-affine with the exponent ½.
    #[test]
    fn a_random_walk_is_rougher_by_the_root_of_the_window() {
        use rand::{RngExt, SeedableRng};
        let mut random = rand_pcg::Pcg64::seed_from_u64(4);
        let mut height = 0.0;
        let walk: Vec<f64> = (0..20_000)
            .map(|_| {
                height += random.random_range(-1.0..=1.0f64);
                height
            })
            .collect();
        let exponent = (roughness(&walk, 80.0) / roughness(&walk, 20.0)).ln() / 4f64.ln();
        assert!((exponent - 0.5).abs() < 0.05, "{exponent}");
    }
}
