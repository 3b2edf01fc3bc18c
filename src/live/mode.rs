//! What the solver's thread is at.

use super::LoadingProgress;

/// What the thread is at.
#[derive(Clone, Debug)]
pub(super) enum Mode {
    Paused,
    /// Time passes: steps are computed as they are due.
    Computing,
    /// Time passes within the record: stored moments are shown up to this simulated time, s, and nothing is computed, so
    /// that a slow run is shown fluently. The worlds stay where they are meanwhile.
    Showing {
        until_secs: f64,
    },
    /// A recorded moment is computed, after which time passes or stands still.
    Seeking {
        then_plays: bool,
    },
    /// A step that takes longer than a slice is brought to its end, and then as many more are taken as were asked for
    /// meanwhile, after which time stands still.
    Stepping {
        more: u64,
    },
    /// A start is made.
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
