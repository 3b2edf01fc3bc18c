//! Stresses by Love and Weber, compression positive, and the fabric of contacts.
//!
//! A body under the forces f_c at the points p_c has the mean stress (1/A) Σ f_c ⊗ p_c where the forces balance. Summed
//! over grains about their centres, each contact gives f ⊗ ℓ: ℓ joins the two centres, or a centre and the point
//! touched of a wall or a fixed disc, so that what the surroundings bear is not counted. With f on grain i and ℓ
//! towards its centre, pushes are positive. Weight and inertia have no part in it: their mean is the stress that
//! balances them. In a plane σ is a force a length.

use glam::DVec2;

use super::network::Network;
use super::tensor::Tensor;

/// Σ f ⊗ ℓ over all contacts, J.
pub(super) fn of_contacts(network: &Network) -> Tensor {
    let mut sum = Tensor::default();
    for link in &network.links {
        sum.add(link.force, link.branch());
    }
    sum
}

/// The part of each grain in the same sum, J.
pub(super) fn of_grains(network: &Network) -> Vec<Tensor> {
    let mut sums = vec![Tensor::default(); network.grains.len()];
    for link in &network.links {
        sums[link.grain].add(link.force, link.own_branch);
        if let Some(other) = link.other {
            sums[other].add(link.force, link.other_branch);
        }
    }
    sums
}

/// ½ Σ m |v − v̄|², v̄ the velocity of the centre of mass, J.
pub(super) fn of_motion(network: &Network) -> f64 {
    let mass: f64 = network.grains().map(|(_, grain)| grain.mass).sum();
    let momentum: DVec2 = network.grains().map(|(_, grain)| grain.mass * grain.velocity).sum();
    let mean = momentum / mass;
    let energies = network
        .grains()
        .map(|(_, grain)| 0.5 * grain.mass * (grain.velocity - mean).length_squared());
    energies.sum()
}

/// Mean of n ⊗ n over all contacts, whether they bear a force or not; NaN without contacts.
pub(super) fn fabric(network: &Network) -> Tensor {
    let mut sum = Tensor::default();
    for link in &network.links {
        sum.add(link.normal, link.normal);
    }
    sum.over(network.links.len() as f64)
}
