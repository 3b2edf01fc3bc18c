//! Moments of a run that are kept as they were shown.

use std::sync::Arc;

use crate::sim::{Simulation, Snapshot, Tally};
use crate::world::Gravity;

/// Memory for the stored moments of one world. Where it runs out, every second one goes: some 2,000 of 138 grains find
/// room, and 30 of 10,000.
const BYTES: usize = 64 << 20;

/// A moment as it was shown.
#[derive(Clone, Debug)]
pub(super) struct Stored {
    pub snapshot: Arc<Snapshot>,
    pub gravity: Gravity,
    /// Sums over the steps up to it.
    pub tally: Tally,
}

/// The stored moments of a world, in the order of time.
#[derive(Clone, Debug)]
pub(super) struct Film {
    moments: Vec<Stored>,
    /// Only steps whose number is a multiple of this are kept.
    stride: u64,
    bytes: usize,
}

impl Default for Film {
    fn default() -> Self {
        Self { moments: Vec::new(), stride: 1, bytes: 0 }
    }
}

fn step(moment: &Stored) -> u64 {
    moment.snapshot.observables.step
}

fn bytes(moment: &Stored) -> usize {
    let Snapshot { grains, contacts, .. } = &*moment.snapshot;
    size_of_val(&grains[..]) + size_of_val(&contacts[..])
}

impl Film {
    /// Stores a moment that a step has just led to. What was stored after it is forgotten, unless it is one that is
    /// `recorded` already.
    pub(super) fn store(&mut self, simulation: &Simulation, tally: &Tally, recorded: bool) {
        let now = simulation.observables().step;
        let stored = self.moments.partition_point(|moment| step(moment) < now);
        if !recorded {
            self.bytes -= self.moments[stored..].iter().map(bytes).sum::<usize>();
            self.moments.truncate(stored);
        }
        if stored < self.moments.len() || !now.is_multiple_of(self.stride) {
            return;
        }
        let snapshot = Arc::new(simulation.snapshot());
        let moment = Stored { snapshot, gravity: simulation.world().gravity, tally: *tally };
        self.bytes += bytes(&moment);
        self.moments.push(moment);
        while self.bytes > BYTES && self.moments.len() > 1 {
            self.stride *= 2;
            let stride = self.stride;
            self.moments.retain(|moment| step(moment).is_multiple_of(stride));
            self.bytes = self.moments.iter().map(bytes).sum();
        }
    }

    /// Forgets what is stored of later steps, and of this one, which no longer looks as it did.
    pub(super) fn forget_after(&mut self, last: u64) {
        self.moments.retain(|moment| step(moment) < last);
        self.bytes = self.moments.iter().map(bytes).sum();
    }

    /// The last moment that is no later than a simulated time, s.
    pub(super) fn at(&self, secs: f64) -> Option<&Stored> {
        let later = |moment: &Stored| moment.snapshot.observables.time_secs <= secs;
        let count = self.moments.partition_point(later);
        self.moments.get(count.checked_sub(1)?)
    }

    /// Whether the moments after a step are stored.
    pub(super) fn goes_on_from(&self, from: u64) -> bool {
        let next = self.moments.get(self.moments.partition_point(|moment| step(moment) <= from));
        next.is_some_and(|next| step(next) <= from + 2 * self.stride)
    }
}
