//! Fits the mean flow (velocity as a linear function of position) around each grain, and computes the kinetic energy of
//! the grains relative to this flow.

use glam::{DMat3, DVec2, DVec3};

use super::network::Network;
use crate::contact::Grid;
use crate::sim::{GrainState, Surroundings};

/// Radius of the neighbourhood of a grain in which the mean flow is fitted, in mean diameters. If it is larger, a
/// curved flow counts as fluctuation. If it is smaller, too few grains contribute.
const REACH_IN_DIAMETERS: f64 = 3.0;
/// Least number of grains for a fit of the mean flow. A linear flow has three parameters per velocity component, so
/// fewer grains determine the flow badly.
const LEAST: f64 = 7.0;

/// Computes the kinetic energy of the velocity fluctuations, ½ Σ m |v − v̄|², J, with the mass m and velocity v of each
/// grain and the mean flow v̄ around it.
///
/// The mean flow v̄ is linear in position, so a uniform shear does not count as fluctuation. It is fitted by least
/// squares to the velocities of the grains in the neighbourhood, all with the same weight. For n uncorrelated
/// velocities the fit removes 3/n of their variance. The factor n/(n − 3) restores it.
pub(super) fn peculiar_energy(network: &Network, surroundings: &Surroundings) -> f64 {
    let reach = REACH_IN_DIAMETERS * surroundings.mean_diameter;
    let mass: f64 = network.grains().map(|(_, grain)| grain.mass).sum();
    let momentum: DVec2 = network.grains().map(|(_, grain)| grain.mass * grain.velocity).sum();
    let of_all = momentum / mass;
    let all = with_images(network, surroundings, reach);
    let places: Vec<DVec2> = all.iter().map(|(place, _)| *place).collect();
    let mut grid = Grid::default();
    grid.rebuild::<2>(&places, reach);
    let mut sums = vec![FlowSums::of_one(); network.len()];
    grid.pairs::<2>(|one, other| {
        let (one, other) = (one as usize, other as usize);
        let offset = (all[other].0 - all[one].0) / reach;
        if offset.length_squared() < 1.0 {
            let velocity = all[other].1 - all[one].1;
            for (of, sign) in [(one, 1.0), (other, -1.0)] {
                if let Some(sums) = sums.get_mut(of) {
                    sums.add(sign * offset, sign * velocity);
                }
            }
        }
    });
    let of_grain =
        |((_, grain), FlowSums { matrix, velocities }): ((usize, &GrainState), FlowSums)| {
            let count = matrix.x_axis.x;
            // Grains in a straight line do not determine how the flow changes across that line.
            let fitted = count >= LEAST && matrix.determinant() > 1e-6 * count.powi(3);
            let (peculiar, part) = if fitted {
                let inverse = matrix.inverse();
                // The mean flow at the grain minus the grain's own velocity.
                let mean = velocities.map(|sum| (inverse * sum).x);
                (DVec2::from(mean), count / (count - 3.0))
            } else {
                (grain.velocity - of_all, 1.0)
            };
            0.5 * grain.mass * part * peculiar.length_squared()
        };
    network.grains().zip(sums).map(of_grain).sum()
}

/// Sums over the neighbourhood of a grain, for the least-squares fit of a linear flow.
#[derive(Clone, Copy)]
struct FlowSums {
    /// Matrix of the normal equations of the fit: Σ (1, x, y) ⊗ (1, x, y) over the grains of the neighbourhood. The
    /// positions (x, y) are relative to the central grain and in units of the neighbourhood's radius.
    matrix: DMat3,
    /// Right-hand sides of the normal equations of the fit, one for each velocity component v relative to the central
    /// grain: Σ (1, x, y) v over the grains of the neighbourhood, m/s. The positions (x, y) are relative to the central
    /// grain and in units of the neighbourhood's radius.
    velocities: [DVec3; 2],
}

impl FlowSums {
    /// Creates the sums for the least-squares fit around a grain. They contain only this grain, which is the centre of
    /// the neighbourhood.
    fn of_one() -> Self {
        let mut sums = Self { matrix: DMat3::ZERO, velocities: [DVec3::ZERO; 2] };
        sums.add(DVec2::ZERO, DVec2::ZERO);
        sums
    }

    #[inline(always)]
    fn add(&mut self, offset: DVec2, velocity: DVec2) {
        let row = DVec3::new(1.0, offset.x, offset.y);
        self.matrix += DMat3::from_cols(row, offset.x * row, offset.y * row);
        let [along_x, along_y] = &mut self.velocities;
        *along_x += velocity.x * row;
        *along_y += velocity.y * row;
    }
}

/// Returns the positions (m) and velocities (m/s) of the grains, followed by those of their periodic images that are at
/// most `reach` (m) outside the periodic cell.
fn with_images(network: &Network, surroundings: &Surroundings, reach: f64) -> Vec<(DVec2, DVec2)> {
    let grains = || network.grains().map(|(_, grain)| (grain.position, grain.velocity));
    let Some(cell) = surroundings.periodic else { return grains().collect() };
    let [low, high] = cell.borders_or([DVec2::NEG_INFINITY, DVec2::INFINITY]);
    let is_near = |place: DVec2| place.cmpge(low - reach).all() && place.cmple(high + reach).all();
    let images = grains().flat_map(|(place, velocity)| {
        let others = cell.around().filter(|by| *by != DVec2::ZERO);
        others.map(move |by| (place + by, velocity + cell.shear_rate * by.y * DVec2::X))
    });
    grains().chain(images.filter(|&(place, _)| is_near(place))).collect()
}
