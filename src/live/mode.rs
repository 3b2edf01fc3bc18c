//! The mode of the solver's thread.

use super::LoadingProgress;

/// The present activity of the thread.
#[derive(Clone, Debug)]
pub(super) enum Mode {
    Paused,
    /// Time passes, and steps are computed when they are due.
    Computing,
    /// Time passes within the record: the stored moments up to this simulated time, s, are shown and nothing is
    /// computed, so that a slow run is shown smoothly. The worlds do not change meanwhile.
    Showing {
        until_secs: f64,
    },
    /// A recorded moment is being computed; then time passes or stops.
    Seeking {
        then_plays: bool,
    },
    /// A step that takes longer than a slice is being completed. Then the further requested steps are taken, and time
    /// stops.
    Stepping {
        more: u64,
    },
    /// A start is being made.
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
