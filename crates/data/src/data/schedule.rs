//! When frames are recorded.

use crate::scene::DataSettings;
use crate::sim::Simulation;

/// Simulated time between two frames where nothing is said, s: that of pictures.
const DEFAULT_EVERY_SECS: f64 = 0.04;

/// The simulated times of frames.
#[derive(Clone, Debug, PartialEq)]
pub enum Times {
    /// From 0 on, with so many seconds from one to the next.
    Every(f64),
    /// At these times, s, rising.
    At(Vec<f64>),
}

impl Times {
    /// Those of the frames, where nothing but a rate is asked for.
    pub fn of(settings: &DataSettings) -> Self {
        Self::Every(settings.every_secs.unwrap_or(DEFAULT_EVERY_SECS))
    }
}

/// The steps of frames.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Schedule {
    times: Times,
    /// Number of the next time.
    next: usize,
}

impl Schedule {
    /// Frames at the steps nearest to some times.
    pub(super) fn new(times: Times) -> Self {
        Self { times, next: 0 }
    }

    /// Whether a frame is to be made of the present state. Steps are to be asked for in turn.
    pub(super) fn is_due(&mut self, simulation: &Simulation) -> bool {
        let latest_secs = simulation.time_secs() + 0.5 * simulation.parameters().time_step_secs;
        let step = simulation.observables().step;
        self.is_due_at(step, latest_secs, |secs| simulation.step_at(secs))
    }

    /// Whether one is due after a step that stands for all times up to `latest_secs`.
    fn is_due_at(&mut self, step: u64, latest_secs: f64, step_at: impl Fn(f64) -> u64) -> bool {
        let mut due = false;
        while self.next_secs().is_some_and(|secs| step_at(secs) <= step) {
            due = true;
            let before = self.next;
            self.next = match self.times {
                // Not one by one: there may be many in one step.
                Times::Every(secs) => {
                    before.saturating_add(1).max((latest_secs / secs).floor() as usize)
                }
                Times::At(_) => before + 1,
            };
            // More than can be counted: one is due in each step.
            if self.next == before {
                break;
            }
        }
        due
    }

    fn next_secs(&self) -> Option<f64> {
        match &self.times {
            Times::Every(secs) => Some(self.next as f64 * secs),
            Times::At(times) => times.get(self.next).copied(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn due(times: Times, time_step_secs: f64, until: u64) -> Vec<u64> {
        let mut schedule = Schedule::new(times);
        let step_at = |secs: f64| (secs / time_step_secs).round() as u64;
        let latest_secs = |step: u64| (step as f64 + 0.5) * time_step_secs;
        let is_due = |&step: &u64| schedule.is_due_at(step, latest_secs(step), step_at);
        (0..=until).filter(is_due).collect()
    }

    #[test]
    fn a_frame_is_made_at_the_step_nearest_to_its_time() {
        assert_eq!(due(Times::Every(0.01), 1e-3, 35), [0, 10, 20, 30]);
        assert_eq!(due(Times::Every(0.0025), 1e-3, 10), [0, 3, 5, 8, 10]);
        assert_eq!(due(Times::At(vec![0.0, 0.0, 0.0121, 0.5]), 1e-3, 35), [0, 12]);
        assert!(due(Times::At(vec![]), 1e-3, 35).is_empty());
    }

    #[test]
    fn where_several_times_fall_on_a_step_one_frame_is_made() {
        assert_eq!(due(Times::Every(1e-300), 1e-3, 5), [0, 1, 2, 3, 4, 5]);
        assert_eq!(due(Times::Every(1e-4), 1e-3, 5), [0, 1, 2, 3, 4, 5]);
        assert_eq!(due(Times::Every(7e-4), 1e-3, 7), [0, 1, 2, 3, 4, 5, 6, 7]);
        assert_eq!(due(Times::Every(1e300), 1e-3, 7), [0]);
    }
}
