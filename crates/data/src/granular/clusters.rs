//! Sets of grains that contacts join, and how large they are.

use super::network::Network;
use crate::contact::JoinedGrains;

pub(super) struct Clusters {
    pub count: u32,
    /// Grains of the largest.
    pub largest: u32,
}

impl Clusters {
    pub(super) fn of(network: &Network) -> Self {
        let mut sets = JoinedGrains::apart(network.grains.len());
        for link in &network.links {
            if let Some(other) = link.other {
                sets.join(link.grain as u32, other as u32);
            }
        }
        let mut sizes = vec![0; network.grains.len()];
        for (index, _) in network.grains() {
            sizes[sets.of(index as u32) as usize] += 1;
        }
        Self {
            count: sizes.iter().filter(|&&size| size > 0).count() as u32,
            largest: sizes.iter().copied().max().unwrap_or(0),
        }
    }
}
