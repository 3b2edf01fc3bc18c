//! Notices: sentences that the status bar shows for a few seconds.

use egui::{Color32, Ui};

use super::theme;
use crate::Instant;
use crate::error::Result;

/// Time for which a notice is shown, s.
const NOTICE_SECS: f32 = 8.0;

/// A sentence that the status bar shows for a few seconds.
#[derive(Clone, Debug)]
pub struct Notice {
    /// The displayed sentence.
    pub text: String,
    failure: bool,
    since: Instant,
}

impl Notice {
    /// Returns a notice that is shown from now on. `failure` is true for an error message.
    pub(super) fn new(text: impl Into<String>, failure: bool) -> Self {
        Self { text: text.into(), failure, since: Instant::now() }
    }

    /// Remaining time for which the notice is shown, s; `None` if this time is over.
    pub(super) fn left_secs(&self) -> Option<f32> {
        let left_secs = NOTICE_SECS - self.since.elapsed().as_secs_f32();
        (left_secs > 0.0).then_some(left_secs)
    }

    /// Colour of the text, which differs for failures and successes.
    pub(super) fn colour(&self, ui: &Ui) -> Color32 {
        let dark = ui.visuals().dark_mode;
        if self.failure { theme::warning(dark) } else { theme::good(dark) }
    }
}

impl From<Result<String>> for Notice {
    /// Converts the result of an action to a notice: the text of the success, or the error message.
    fn from(outcome: Result<String>) -> Self {
        let failure = outcome.is_err();
        Self::new(outcome.unwrap_or_else(|error| error.to_string()), failure)
    }
}
