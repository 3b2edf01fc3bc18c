//! Contacts of a grain, and the grains that carry nothing on.
//!
//! A rattler has fewer than two contacts that bear a force. What leans on rattlers alone is not held either, so they
//! are taken away with their contacts until none is left: what remains is the 2-core of the network of forces, in which
//! a body that no grain moves holds like any other. Under gravity this takes dead ends too, such as a single column.

use super::network::Network;

/// Contacts of a grain that hold it, at least.
const HELD_BY: u32 = 2;

pub(super) struct Coordination {
    /// Contacts of each grain; of one that does not count, none.
    pub of_grains: Vec<u32>,
    /// Whether a grain is a rattler.
    pub rattlers: Vec<bool>,
    /// Contacts of a grain, the mean.
    pub mean: f64,
    /// The same without rattlers, of contacts that bear a force.
    pub mean_without_rattlers: f64,
}

impl Coordination {
    pub(super) fn of(network: &Network) -> Self {
        let mut of_grains = vec![0; network.grains.len()];
        for link in &network.links {
            for end in link.ends() {
                of_grains[end] += 1;
            }
        }
        let (rattlers, held) = rattlers(network);
        let mean_of = |contacts: &[u32], grains: usize| {
            contacts.iter().map(|&count| f64::from(count)).sum::<f64>() / grains as f64
        };
        let left = network.len() - rattlers.iter().filter(|&&rattler| rattler).count();
        Self {
            mean: mean_of(&of_grains, network.len()),
            mean_without_rattlers: mean_of(&held, left),
            of_grains,
            rattlers,
        }
    }
}

/// Which grains are rattlers, and the contacts that are left to each of the others.
fn rattlers(network: &Network) -> (Vec<bool>, Vec<u32>) {
    let mut left = vec![0; network.grains.len()];
    let mut neighbours = vec![Vec::new(); network.grains.len()];
    for link in network.links.iter().filter(|link| link.bears) {
        for end in link.ends() {
            left[end] += 1;
        }
        if let Some(other) = link.other {
            neighbours[link.grain].push(other);
            neighbours[other].push(link.grain);
        }
    }
    let mut rattlers = vec![false; network.grains.len()];
    let mut loose: Vec<usize> =
        network.grains().map(|(index, _)| index).filter(|&index| left[index] < HELD_BY).collect();
    while let Some(index) = loose.pop() {
        if std::mem::replace(&mut rattlers[index], true) {
            continue;
        }
        left[index] = 0;
        for &neighbour in &neighbours[index] {
            if !rattlers[neighbour] {
                left[neighbour] -= 1;
                if left[neighbour] < HELD_BY {
                    loose.push(neighbour);
                }
            }
        }
    }
    (rattlers, left)
}
