//! Stored snapshots: past states of a run in the form that the window draws. With stored snapshots, past times can be
//! shown without computing.

use std::sync::Arc;

use crate::sim::{Simulation, Snapshot, Tally};
use crate::world::Gravity;

/// Memory for the stored snapshots of all simulations together, bytes. If it is full, every second snapshot is dropped.
/// It is enough for about 2,000 snapshots of 138 grains, or 30 snapshots of 10,000 grains.
pub(super) const STORED_BYTES: usize = 64 << 20;

/// The state after one step, in the form that the window draws.
#[derive(Clone, Debug)]
pub(super) struct StoredMoment {
    pub snapshot: Arc<Snapshot>,
    pub gravity: Gravity,
    /// Sums over all steps up to this state, such as the number of unsolved steps.
    pub tally: Tally,
}

impl StoredMoment {
    fn step(&self) -> u64 {
        self.snapshot.observables.step
    }

    fn bytes(&self) -> usize {
        let Snapshot { grains, contacts, .. } = &*self.snapshot;
        size_of_val(&grains[..]) + size_of_val(&contacts[..])
    }
}

/// The stored snapshots (past states kept for display) of one simulation, in order of time.
#[derive(Clone, Debug)]
pub(super) struct StoredMoments {
    moments: Vec<StoredMoment>,
    /// Only the states after steps whose number is a multiple of `stride` are stored.
    stride: u64,
    bytes: usize,
    most_bytes: usize,
}

impl Default for StoredMoments {
    fn default() -> Self {
        Self { moments: Vec::new(), stride: 1, bytes: 0, most_bytes: STORED_BYTES }
    }
}

impl StoredMoments {
    /// Stores a snapshot after the simulation's last step. If `is_recorded` is true, this step repeats a recorded step,
    /// and snapshots of later steps remain valid. Otherwise they are removed.
    pub(super) fn store(&mut self, simulation: &Simulation, tally: &Tally, is_recorded: bool) {
        let now = simulation.observables().step;
        let earlier = self.moments.partition_point(|moment| moment.step() < now);
        if !is_recorded {
            self.bytes -= self.moments[earlier..].iter().map(StoredMoment::bytes).sum::<usize>();
            self.moments.truncate(earlier);
        }
        if earlier < self.moments.len() || !now.is_multiple_of(self.stride) {
            return;
        }
        let snapshot = Arc::new(simulation.snapshot());
        let moment = StoredMoment { snapshot, gravity: simulation.world().gravity, tally: *tally };
        self.bytes += moment.bytes();
        self.moments.push(moment);
        self.thin();
    }

    /// Limits the memory of the stored snapshots (past states kept for display) to `most_bytes` bytes.
    pub(super) fn keep_within(&mut self, most_bytes: usize) {
        self.most_bytes = most_bytes;
        self.thin();
    }

    fn thin(&mut self) {
        while self.bytes > self.most_bytes && self.moments.len() > 1 {
            self.stride *= 2;
            let stride = self.stride;
            self.retain(|step| step.is_multiple_of(stride));
        }
    }

    /// Removes the stored snapshots (past states kept for display) of step number `first` and of later steps, because
    /// these states have changed.
    pub(super) fn forget_from(&mut self, first: u64) {
        self.retain(|step| step < first);
    }

    fn retain(&mut self, stays: impl Fn(u64) -> bool) {
        self.moments.retain(|moment| stays(moment.step()));
        self.bytes = self.moments.iter().map(StoredMoment::bytes).sum();
    }

    /// The last stored snapshot (past state kept for display) at or before a simulated time, s.
    pub(super) fn at(&self, secs: f64) -> Option<&StoredMoment> {
        let is_there = |moment: &StoredMoment| moment.snapshot.observables.time_secs <= secs;
        self.moments.get(self.moments.partition_point(is_there).checked_sub(1)?)
    }

    /// True if the snapshots that follow step number `from` are stored.
    pub(super) fn go_on_from(&self, from: u64) -> bool {
        let next = self.moments.partition_point(|moment| moment.step() <= from);
        self.moments.get(next).is_some_and(|next| next.step() <= from + 2 * self.stride)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::built_in;

    #[test]
    fn moments_are_thinned_to_the_room_that_there_is_and_stay_in_order() {
        let mut simulation = built_in("pile").unwrap().simulation().unwrap();
        let mut stored = StoredMoments::default();
        for _ in 0..40 {
            simulation.step().unwrap();
            stored.store(&simulation, &Tally::default(), false);
        }
        let (all, bytes) = (stored.moments.len(), stored.bytes);
        assert_eq!(all, 40);
        stored.keep_within(bytes / 3);
        let steps: Vec<u64> = stored.moments.iter().map(StoredMoment::step).collect();
        assert!(stored.bytes <= bytes / 3 && steps.len() >= 8, "{steps:?}");
        let stride = stored.stride;
        assert!(
            stride > 1 && steps.windows(2).all(|pair| pair[1] - pair[0] == stride),
            "{steps:?}"
        );
        // Moments stored after the thinning do not get more memory either.
        for _ in 0..40 {
            simulation.step().unwrap();
            stored.store(&simulation, &Tally::default(), false);
        }
        assert!(stored.bytes <= bytes / 3 && stored.moments.len() > 1);
    }
}
