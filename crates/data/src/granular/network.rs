//! Builds the network of grains and their contacts, and computes quantities of the network itself: contacts per grain,
//! clusters, and the distribution of normal forces. The network leaves out lost grains (they went through a wall or
//! left the scene) and grains whose position is not finite.

use ena::unify::{InPlaceUnificationTable, UnifyKey};
use glam::DVec2;

use crate::sim::{ContactState, ContactStatus, GrainState, Moment, OtherBody};

/// Smallest contact force that counts as a force, as a fraction of the mean force of all contacts. If the fraction is
/// smaller, residual errors of the solver count as forces. If it is larger, weak contacts do not count.
const BEARS_FROM: f64 = 1e-6;

/// Network of grains and their contacts, without lost grains (which went through a wall or left the scene).
pub(super) struct Network<'a> {
    pub grains: &'a [GrainState],
    /// For each grain, true if it is in the network: it is not lost and its position is finite. No contact of the
    /// network has the index of a grain that is not in the network.
    pub counts: Vec<bool>,
    pub links: Vec<NetworkContact>,
}

/// A contact of a grain in the network with another grain in the network, a wall or a fixed disc. Lengths are in m and
/// forces in N.
pub(super) struct NetworkContact {
    pub grain: usize,
    /// Index of grain j, the second grain of the contact; `None` if grain i touches a wall or a fixed disc.
    pub other: Option<usize>,
    pub normal: DVec2,
    pub gap: f64,
    /// Vector from the contact point to the centre of grain i, m. It includes half of the gap if body j is a grain, and
    /// otherwise the whole gap.
    pub own_branch: DVec2,
    /// Vector from the centre of grain j to the contact point, m; zero if body j is not a grain.
    pub other_branch: DVec2,
    pub force: DVec2,
    pub normal_force: f64,
    pub status: ContactStatus,
    pub bears: bool,
}

impl NetworkContact {
    /// Returns the branch vector ℓ, m. It ends at the centre of grain i. It begins at the centre of grain j, or at the
    /// touched point of a wall or fixed disc.
    pub(super) fn branch(&self) -> DVec2 {
        self.own_branch + self.other_branch
    }

    pub(super) fn ends(&self) -> impl Iterator<Item = usize> {
        [Some(self.grain), self.other].into_iter().flatten()
    }
}

impl<'a> Network<'a> {
    pub(super) fn of(moment: &'a Moment) -> Self {
        let grains = &moment.grains;
        let counts: Vec<bool> =
            grains.iter().map(|grain| !grain.lost && grain.position.is_finite()).collect();
        let counted = |index: u32| counts.get(index as usize).is_some_and(|&counts| counts);
        let both_count = |contact: &&ContactState| {
            let other = match contact.other {
                OtherBody::Grain(index) => counted(index),
                OtherBody::FixedDisc(_) | OtherBody::Boundary(_) => true,
            };
            counted(contact.grain) && other
        };
        let mut links: Vec<NetworkContact> = moment
            .contacts
            .iter()
            .filter(both_count)
            .map(|contact| link(contact, grains[contact.grain as usize].radius))
            .collect();
        let sum: f64 = links.iter().map(|link| link.force.length()).sum();
        let bears_from = BEARS_FROM * sum / links.len() as f64;
        for link in &mut links {
            link.bears = link.force.length() > bears_from;
        }
        Self { grains, counts, links }
    }

    /// Iterates over the grains that are not lost and have finite positions, with their indices.
    pub(super) fn grains(&self) -> impl Iterator<Item = (usize, &'a GrainState)> {
        let counted = self.grains.iter().zip(&self.counts).enumerate();
        counted.filter_map(|(index, (grain, &counts))| counts.then_some((index, grain)))
    }

    pub(super) fn len(&self) -> usize {
        self.grains().count()
    }

    /// Returns the fraction of the contacts in the network for which `is_so` returns true; NaN without contacts.
    pub(super) fn share(&self, is_so: impl Fn(&NetworkContact) -> bool) -> f64 {
        let count = self.links.iter().filter(|&link| is_so(link)).count();
        count as f64 / self.links.len() as f64
    }
}

fn link(contact: &ContactState, radius: f64) -> NetworkContact {
    let of_two_grains = matches!(contact.other, OtherBody::Grain(_));
    let own_gap = if of_two_grains { 0.5 * contact.gap } else { contact.gap };
    let own_branch = (radius + own_gap) * contact.normal;
    let (other, other_branch) = match contact.other {
        OtherBody::Grain(index) => (Some(index as usize), contact.branch - own_branch),
        OtherBody::FixedDisc(_) | OtherBody::Boundary(_) => (None, DVec2::ZERO),
    };
    NetworkContact {
        grain: contact.grain as usize,
        other,
        normal: contact.normal,
        gap: contact.gap,
        own_branch,
        other_branch,
        force: contact.force,
        normal_force: contact.normal_force,
        status: contact.status,
        bears: false,
    }
}

/// Least number of force-bearing contacts of a grain that transmits forces. A grain with fewer such contacts is a
/// rattler.
const HELD_BY: u32 = 2;

/// Numbers of contacts of the grains, and the rattlers: grains that do not transmit forces.
///
/// A rattler has fewer than two contacts that bear a force. Contacts with rattlers do not support a grain, so rattlers
/// and their contacts are removed repeatedly until no rattler is left. The remaining grains are the 2-core of the force
/// network, in which walls and fixed discs support grains like any other body. Under gravity this also removes dead
/// ends, such as a single column of grains.
pub(super) struct Coordination {
    /// Number of contacts of each grain; 0 for a lost grain, or for a grain without a finite position.
    pub of_grains: Vec<u32>,
    pub rattlers: Vec<bool>,
    /// Mean number of contacts per grain.
    pub mean: f64,
    /// Mean number of force-bearing contacts per grain, without rattlers (grains that transmit no force) and their
    /// contacts.
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

/// Finds the rattlers, grains that transmit no force. Returns for each grain whether it is a rattler, and the number of
/// its force-bearing contacts after all rattlers are removed.
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

/// Index of a grain, as a key of the union-find structure that finds clusters.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Member(u32);

impl UnifyKey for Member {
    type Value = ();

    fn index(&self) -> u32 {
        self.0
    }

    fn from_index(index: u32) -> Self {
        Self(index)
    }

    fn tag() -> &'static str {
        "grain"
    }
}

/// Number of clusters, and size of the largest cluster. A cluster is a set of grains joined by contacts. Walls and
/// fixed discs do not join grains, so two piles on one floor are separate clusters.
pub(super) struct Clusters {
    pub count: u32,
    /// Number of grains in the largest cluster.
    pub largest: u32,
}

impl Clusters {
    pub(super) fn of(network: &Network) -> Self {
        let mut sets = InPlaceUnificationTable::<Member>::new();
        network.grains.iter().for_each(|_| _ = sets.new_key(()));
        for link in &network.links {
            if let Some(other) = link.other {
                sets.union(Member(link.grain as u32), Member(other as u32));
            }
        }
        let mut sizes = vec![0; network.grains.len()];
        for (index, _) in network.grains() {
            sizes[sets.find(Member(index as u32)).0 as usize] += 1;
        }
        Self {
            count: sizes.iter().filter(|&&size| size > 0).count() as u32,
            largest: sizes.iter().copied().max().unwrap_or(0),
        }
    }
}

/// Distribution P(f) of the normal forces N relative to their mean, f = N/⟨|N|⟩, over the contacts that bear a force.
///
/// The mean is taken over |N|, because with cohesion the tensile forces may be as large as the compressive forces.
/// Without cohesion it is the usual mean.
pub(super) struct ForceDistribution {
    /// Mean magnitude ⟨|N|⟩ of the normal forces N, in newtons.
    pub mean: f64,
    /// Relative normal force f = N/⟨|N|⟩ of each contact that bears a force, dimensionless.
    pub over_mean: Vec<f64>,
}

impl ForceDistribution {
    pub(super) fn of(network: &Network) -> Self {
        let bearing = network.links.iter().filter(|link| link.bears);
        let forces: Vec<f64> = bearing.map(|link| link.normal_force).collect();
        let mean = mean(&forces, f64::abs);
        Self { mean, over_mean: forces.iter().map(|force| force / mean).collect() }
    }

    /// Returns the statistical moment ⟨|f|^power⟩ of the relative normal forces f = N/⟨|N|⟩ (normal force N divided by
    /// its mean magnitude); NaN without forces.
    pub(super) fn moment(&self, power: i32) -> f64 {
        mean(&self.over_mean, |force| force.abs().powi(power))
    }

    /// Returns the largest magnitude |f| of the relative normal forces f = N/⟨|N|⟩ (normal force N divided by its mean
    /// magnitude); NaN without forces.
    pub(super) fn largest(&self) -> f64 {
        self.over_mean.iter().map(|force| force.abs()).fold(f64::NAN, f64::max)
    }

    /// Returns the fraction of strong forces, which exceed the mean: |f| > 1 for the relative normal force f. It is NaN
    /// without forces.
    pub(super) fn strong_share(&self) -> f64 {
        mean(&self.over_mean, |force| f64::from(force.abs() > 1.0))
    }
}

fn mean(values: &[f64], of: impl Fn(f64) -> f64) -> f64 {
    values.iter().map(|&value| of(value)).sum::<f64>() / values.len() as f64
}
