//! All that a live run has come to: to be gone on with at another time, or computed anew from what was done.

use rayon::iter::{IntoParallelRefMutIterator, ParallelIterator};
use serde::{Deserialize, Serialize};

use super::past::Past;
use super::track::Track;
use super::worlds::Worlds;
use super::{LiveOptions, Progress};
use crate::error::{Error, Result};
use crate::sim::{Settings, Simulation, Tally};

/// Keyframes of the worlds in a record that is handed out, and of each run before: what is between them is computed
/// again where it is wanted.
const KEYFRAME_BYTES: usize = 8 << 20;
const PAST_KEYFRAME_BYTES: usize = 1 << 20;
/// Rows of each of their curves at the most; a row is some 500 bytes in a file.
const ROWS: usize = 4096;
const PAST_ROWS: usize = 512;
/// Steps of each world between two words of progress.
const STEPS_AT_ONCE: u64 = 8;

/// What all worlds have come to, with the way there, and the runs before.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Record {
    worlds: Worlds,
    /// The oldest first.
    past: Vec<Worlds>,
}

/// How a world comes about from a start.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// Those of its first step.
    pub settings: Settings,
    /// Each with the number of the step after which it is made, in their order.
    pub changes: Vec<(u64, Settings)>,
    /// How many steps it takes.
    pub steps: u64,
}

impl Record {
    /// That of these worlds, with fewer keyframes than they have. A run before whose state is no longer finite is
    /// left out.
    pub(super) fn of(worlds: &Worlds, past: &Past) -> Self {
        let thinned = |worlds: &Worlds, bytes, rows| {
            let mut worlds = worlds.clone();
            worlds.keep_within(bytes);
            worlds.tracks.iter_mut().for_each(|track| {
                // The hand is not there when the run goes on from here.
                track.simulation.set_pull(None);
                track.curve.thin_to(rows);
            });
            worlds
        };
        let kept = past.runs().filter(|run| !run.has_failed());
        Self {
            worlds: thinned(worlds, KEYFRAME_BYTES, ROWS),
            past: kept.map(|run| thinned(run, PAST_KEYFRAME_BYTES, PAST_ROWS)).collect(),
        }
    }

    /// That of worlds which are computed here, side by side, from a state and the sums over the steps before it. `tell` hears how far it has come, and ends it by
    /// returning false.
    ///
    /// # Errors
    /// Names the first setting that is refused, or says that it was given up.
    pub fn computed(
        from: (&Simulation, Tally),
        plans: &[Plan],
        tell: &mut dyn FnMut(Progress) -> bool,
    ) -> Result<Self> {
        let bytes = LiveOptions::default().recording_bytes / plans.len().max(1);
        let mut ways = Vec::with_capacity(plans.len());
        for plan in plans {
            from.0.clone().change(plan.settings)?;
            ways.push((Track::new(from, &plan.settings, bytes), plan));
        }
        let all = plans.iter().map(|plan| plan.steps).fold(0, u64::saturating_add);
        loop {
            let goes_on = ways.par_iter_mut().map(|(track, plan)| advance(track, plan));
            let goes_on = goes_on.try_reduce(|| false, |one, other| Ok(one || other))?;
            let taken = ways.iter().map(|(track, _)| track.simulation.observables().step);
            let taken: u64 = taken.sum();
            let part = taken as f32 / all.max(1) as f32;
            let text = format!("Computing what the link tells of: {taken} of {all} steps");
            if !goes_on {
                break;
            }
            if !tell(Progress { part, text, preview: None }) {
                return Err(Error::value("link", "given up", "computed to its end"));
            }
        }
        let tracks = ways.into_iter().map(|(track, _)| track).collect();
        Ok(Self { worlds: Worlds { tracks, name: String::new() }, past: Vec::new() })
    }

    /// Whether one that was read holds together.
    pub fn is_sound(&self) -> bool {
        let all = std::iter::once(&self.worlds).chain(&self.past);
        let sound = |track: &Track| track.recording.is_sound();
        all.into_iter().all(|worlds| !worlds.tracks.is_empty() && worlds.tracks.iter().all(sound))
    }

    /// Why one of its worlds cannot go on.
    pub fn failure(&self) -> Option<&str> {
        self.worlds.tracks.iter().find_map(|track| track.failure.as_deref())
    }

    pub(super) fn into_parts(self) -> (Worlds, Vec<Worlds>) {
        (self.worlds, self.past)
    }
}

/// Takes some steps of a plan, with its changes. Whether there are more.
fn advance(track: &mut Track, plan: &Plan) -> Result<bool> {
    for _ in 0..STEPS_AT_ONCE {
        let step = track.simulation.observables().step;
        if let Some((_, settings)) = plan.changes.iter().find(|(after, _)| *after == step) {
            track.simulation.change(*settings)?;
        }
        if step >= plan.steps || !track.step() {
            return Ok(false);
        }
    }
    Ok(true)
}
