//! The mean flow about each grain, and what grains have beside it.

use glam::{DMat3, DVec2, DVec3};

use super::network::Network;
use crate::sim::Surroundings;

/// How far grains tell of the mean flow, in mean diameters. Larger: a flow that bends counts as fluctuation; smaller: too
/// few tell.
const REACH_IN_DIAMETERS: f64 = 3.0;
/// Fewer grains tell too little of a flow, since a linear one has three numbers for each component.
const LEAST: f64 = 7.0;

/// ½ Σ m |v − v̄|², v̄ the local mean flow, J.
///
/// v̄ is linear in place, so that a shear has no part in the rest, and is fitted by least squares to grains of the
/// neighbourhood, all with the same weight. Of n velocities without correlation the fit takes 3/n of their variance away,
/// which n/(n − 3) puts back.
pub(super) fn peculiar_energy(network: &Network, surroundings: &Surroundings) -> f64 {
    let reach = REACH_IN_DIAMETERS * surroundings.mean_diameter;
    let mass: f64 = network.grains().map(|(_, grain)| grain.mass).sum();
    let momentum: DVec2 = network.grains().map(|(_, grain)| grain.mass * grain.velocity).sum();
    let of_all = momentum / mass;
    let mut grains = with_images(network, surroundings, reach);
    grains.sort_by(|one, other| one.0.x.total_cmp(&other.0.x));
    let of_grain = |(_, grain): (usize, &crate::sim::GrainState)| {
        let first = grains.partition_point(|(place, _)| place.x < grain.position.x - reach);
        let near = grains[first..].iter();
        let near = near.take_while(|(place, _)| place.x <= grain.position.x + reach);
        // Σ (1, x, y) ⊗ (1, x, y), and Σ (1, x, y) v for each component.
        let (mut matrix, mut sums) = (DMat3::ZERO, [DVec3::ZERO; 2]);
        for &(place, velocity) in near {
            let offset = (place - grain.position) / reach;
            if offset.length_squared() < 1.0 {
                let row = DVec3::new(1.0, offset.x, offset.y);
                matrix += DMat3::from_cols(row, offset.x * row, offset.y * row);
                let beside = velocity - grain.velocity;
                sums = [sums[0] + beside.x * row, sums[1] + beside.y * row];
            }
        }
        let count = matrix.x_axis.x;
        // Grains in a row tell nothing of a flow across it.
        let fitted = count >= LEAST && matrix.determinant() > 1e-6 * count.powi(3);
        let (peculiar, part) = if fitted {
            let inverse = matrix.inverse();
            // At the grain itself, and less its own velocity.
            let mean = sums.map(|sum| (inverse * sum).x);
            (DVec2::from(mean), count / (count - 3.0))
        } else {
            (grain.velocity - of_all, 1.0)
        };
        0.5 * grain.mass * part * peculiar.length_squared()
    };
    network.grains().map(of_grain).sum()
}

/// Places and velocities of the grains, and of their images within reach of the cell.
fn with_images(network: &Network, surroundings: &Surroundings, reach: f64) -> Vec<(DVec2, DVec2)> {
    let grains = network.grains().map(|(_, grain)| (grain.position, grain.velocity));
    let Some(cell) = surroundings.periodic else { return grains.collect() };
    let [low, high] = cell.borders_or([DVec2::NEG_INFINITY, DVec2::INFINITY]);
    let is_near = |place: DVec2| place.cmpge(low - reach).all() && place.cmple(high + reach).all();
    let images = grains.flat_map(|(place, velocity)| {
        cell.around().map(move |by| (place + by, velocity + cell.shear_rate * by.y * DVec2::X))
    });
    images.filter(|&(place, _)| is_near(place)).collect()
}
