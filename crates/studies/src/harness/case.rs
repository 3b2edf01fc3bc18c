//! Defines a case, which is one run of an experiment, and the line that stores a finished case in a journal, the file
//! of results.

use serde::{Deserialize, Serialize};

/// A case: one run of an experiment, before the run is computed.
pub(crate) struct Case<C> {
    /// Name of the case, unique among all cases of an experiment whose results are in the same file.
    pub key: String,
    /// Expected computing time, in any unit that all cases share. It determines the order in which cases run, and how
    /// far the progress bar moves when the case is finished.
    pub cost: f64,
    pub setup: C,
}

/// A finished case (run of an experiment) as one line of a journal, the file of results: the key of the case, the
/// computing time, s, and the fields of its result.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct FinishedCase<T> {
    pub key: String,
    pub wall_secs: f64,
    /// Result of the case. The type must not have a field named `key` or `wall_secs`, because all fields are written
    /// into the same JSON object.
    #[serde(flatten)]
    pub result: T,
}
