//! What a challenge is.

use super::trial::Trial;
use crate::error::{Error, Result};

/// From which error on a method no longer holds, and from which on it fails.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// Up to this error it holds.
    pub(crate) holds: f64,
    /// Above this error it fails; between the two it degrades.
    pub(crate) fails: f64,
}

/// A scene made to break methods, and what is measured on it.
#[derive(Clone, Copy, Debug)]
pub struct Challenge {
    /// Its name on the command line and in the table.
    pub name: &'static str,
    /// What drives it into failure, with its unit.
    pub(crate) driver: &'static str,
    /// The values of the driver that a quick pass tries, from harmless to harmful.
    pub quick: &'static [f64],
    /// Further values of a full pass, more harmful still.
    pub(crate) further: &'static [f64],
    /// What the error is, with its unit.
    pub measure: &'static str,
    /// What counts as holding and as failing.
    pub(crate) limits: Limits,
    /// How it is measured.
    pub(super) error: fn(&Trial) -> Result<f64>,
}

impl Challenge {
    /// The error of a trial; infinite where the state is no longer finite.
    ///
    /// # Errors
    /// Where the scene is not sound.
    pub(crate) fn error(&self, trial: &Trial) -> Result<f64> {
        match (self.error)(trial) {
            Ok(error) if error.is_nan() => Ok(f64::INFINITY),
            Err(Error::NonFinite { .. }) => Ok(f64::INFINITY),
            outcome => outcome,
        }
    }
}
