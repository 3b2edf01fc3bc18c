//! Sets of grains that contacts join. Bodies that no grain moves join none: what lies on one floor is not one cluster.

use ena::unify::{InPlaceUnificationTable, UnifyKey};

use super::network::Network;

pub(super) struct Clusters {
    pub count: u32,
    /// Grains of the largest.
    pub largest: u32,
}

/// A grain in the table of sets.
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

impl Clusters {
    pub(super) fn of(network: &Network) -> Self {
        let mut sets = InPlaceUnificationTable::<Member>::new();
        for _ in network.grains {
            sets.new_key(());
        }
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
