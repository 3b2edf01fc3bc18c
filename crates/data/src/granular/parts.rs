//! What several measures are made of, found once.

use super::cells::Cells;
use super::clusters::Clusters;
use super::coordination::Coordination;
use super::forces::Forces;
use super::network::Network;
use crate::sim::Moment;

pub(super) struct Parts<'a> {
    pub network: Network<'a>,
    pub cells: Cells,
    pub coordination: Coordination,
    pub forces: Forces,
    pub clusters: Clusters,
}

impl<'a> Parts<'a> {
    pub(super) fn of(moment: &'a Moment) -> Self {
        let network = Network::of(moment);
        Self {
            cells: Cells::of(&network, &moment.surroundings),
            coordination: Coordination::of(&network),
            forces: Forces::of(&network),
            clusters: Clusters::of(&network),
            network,
        }
    }
}
