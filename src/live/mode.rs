//! The mode of the solver's thread: paused, playing, seeking, stepping or loading.

use super::LoadingProgress;

/// The present activity of the solver's thread.
#[derive(Clone, Debug)]
pub(super) enum Mode {
    Paused,
    /// Simulated time advances, and steps are computed when they are due.
    Computing,
    /// The stored snapshots (past states kept for display) up to this simulated time, s, are shown at the chosen speed.
    /// Nothing is computed, so that a run that is slow to compute is also shown smoothly. The simulations do not change
    /// in this mode.
    Showing {
        until_secs: f64,
    },
    /// A recorded state is being computed. After that, the run plays if `then_plays` is true; otherwise it pauses.
    Seeking {
        then_plays: bool,
    },
    /// A single step that takes longer than 50 ms is being completed. After that, `more` further steps that the user
    /// asked for are taken, and the run pauses.
    Stepping {
        more: u64,
    },
    /// An initial state is being computed or read, with this progress.
    Loading(LoadingProgress),
}

impl Mode {
    pub(super) fn of_play(plays: bool) -> Self {
        if plays { Self::Computing } else { Self::Paused }
    }

    pub(super) fn plays(&self) -> bool {
        matches!(self, Self::Computing | Self::Showing { .. } | Self::Seeking { then_plays: true })
    }

    pub(super) fn seeks(&self) -> bool {
        matches!(self, Self::Seeking { .. })
    }
}
