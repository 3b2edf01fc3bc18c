//! Which steps are accepted, and when a solve is given up.

/// A step is accepted if its residual is below [`ENOUGH`] times the largest of this many before:
/// the residual may rise for a few steps on the way down. With 1, steps are refused that lead on;
/// with 15, many are taken that lead nowhere.
const MEMORY: usize = 6;
/// See [`MEMORY`].
const ENOUGH: f64 = 0.99;

/// How the residual has come down.
pub(super) struct Descent {
    /// Residuals of the last accepted steps.
    history: [f64; MEMORY],
    accepted: usize,
    best: f64,
    /// The last best residual that was half of the milestone before: creeping down does not count as
    /// progress.
    milestone: f64,
    /// Steps since then.
    pub since_milestone: u32,
}

impl Descent {
    /// From a residual.
    pub(super) fn new(residual: f64) -> Self {
        let mut history = [0.0; MEMORY];
        history[0] = residual;
        Self { history, accepted: 0, best: residual, milestone: residual, since_milestone: 0 }
    }

    /// The residual that a step has to be below.
    pub(super) fn bound(&self) -> f64 {
        ENOUGH * self.history.iter().copied().fold(0.0, f64::max)
    }

    /// Accepts a state of that residual; whether it is the best.
    pub(super) fn accept(&mut self, residual: f64) -> bool {
        self.accepted += 1;
        self.history[self.accepted % MEMORY] = residual;
        let is_best = residual < self.best;
        if is_best {
            self.best = residual;
        }
        if self.best < 0.5 * self.milestone {
            self.milestone = self.best;
            self.since_milestone = 0;
        }
        is_best
    }
}
