//! Cases of an experiment, and lines of a journal.

use serde::{Deserialize, Serialize};

/// One run of an experiment, before it is computed.
pub(crate) struct Case<C> {
    /// Unique among all cases of its journal.
    pub key: String,
    /// Expected duration, in any unit, for the order of work and for progress.
    pub cost: f64,
    pub setup: C,
}

/// A line of a journal: a case and the fields of its result.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct FinishedCase<T> {
    pub key: String,
    pub wall_secs: f64,
    /// A structure without a field `key` or `wall_secs`.
    #[serde(flatten)]
    pub result: T,
}
