//! What can go wrong, each as one sentence that names the field, the value and what is allowed.

use std::path::{Path, PathBuf};

/// The error of every fallible operation of this crate. Its `Display` is one sentence for a person.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// A value outside its range.
    #[error("{field} is {value}, but must be {allowed}")]
    Value {
        /// The field, as the user writes it.
        field: String,
        /// The value found.
        value: String,
        /// What is allowed.
        allowed: String,
    },
    /// A file that could not be read or written.
    #[error("{path}: {reason}")]
    File {
        /// The file or folder.
        path: PathBuf,
        /// What the system or the parser said, with the line where there is one.
        reason: String,
    },
    /// No renderer of the kind that was asked for.
    #[error("{0}")]
    Renderer(String),
    /// A simulation whose state is no longer finite.
    #[error(
        "the state is no longer finite at step {step} (t = {time_secs} s) with Bond {bond}, \
         time step {time_step_secs} s, restitution {restitution}, friction {friction}; \
         a smaller time step is the change most likely to help"
    )]
    NonFinite {
        /// The step after which it was seen.
        step: u64,
        /// The simulated time of that step.
        time_secs: f64,
        /// Bond number in force.
        bond: f64,
        /// Time step in force.
        time_step_secs: f64,
        /// Restitution in force.
        restitution: f64,
        /// Friction in force.
        friction: f64,
    },
}

/// Shorthand for results of this crate.
pub type Result<T> = std::result::Result<T, Error>;

impl Error {
    /// An error about the value of a field.
    pub(crate) fn value(
        field: impl Into<String>,
        value: impl std::fmt::Display,
        allowed: impl Into<String>,
    ) -> Self {
        Self::Value { field: field.into(), value: value.to_string(), allowed: allowed.into() }
    }

    /// An error about a file or folder.
    pub(crate) fn file(path: impl AsRef<Path>, reason: impl std::fmt::Display) -> Self {
        // Parsers end their messages with a line break; a sentence has none.
        let reason = reason.to_string().trim_end().to_owned();
        Self::File { path: path.as_ref().to_owned(), reason }
    }
}
