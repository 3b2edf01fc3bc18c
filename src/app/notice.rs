//! Sentences that the status bar shows for a while.

use egui::{Color32, Ui};

use super::theme;
use crate::Instant;
use crate::error::Result;

/// Time for which a notice is shown, s.
const NOTICE_SECS: f32 = 8.0;

/// A sentence for the status bar.
#[derive(Clone, Debug)]
pub struct Notice {
    /// The sentence.
    pub text: String,
    failure: bool,
    since: Instant,
}

impl Notice {
    /// A notice that appears now.
    pub(super) fn new(text: impl Into<String>, failure: bool) -> Self {
        Self { text: text.into(), failure, since: Instant::now() }
    }

    /// Remaining time, s; `None` when it is over.
    pub(super) fn left_secs(&self) -> Option<f32> {
        let left_secs = NOTICE_SECS - self.since.elapsed().as_secs_f32();
        (left_secs > 0.0).then_some(left_secs)
    }

    /// Colour of the text: that of a failure or of a success.
    pub(super) fn colour(&self, ui: &Ui) -> Color32 {
        let dark = ui.visuals().dark_mode;
        if self.failure { theme::warning(dark) } else { theme::good(dark) }
    }
}

impl From<Result<String>> for Notice {
    /// A notice of a result.
    fn from(outcome: Result<String>) -> Self {
        let failure = outcome.is_err();
        Self::new(outcome.unwrap_or_else(|error| error.to_string()), failure)
    }
}
