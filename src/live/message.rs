//! Messages between a window and a remote engine as bytes.

use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::error::{Error, Result};

/// Writes a message, or a source of starts.
///
/// # Errors
/// If the binary form cannot express the data.
pub fn to_bytes(message: &impl Serialize) -> Result<Vec<u8>> {
    rmp_serde::to_vec_named(message)
        .map_err(|error| Error::value("message", error, "one that can be written"))
}

/// Reads a message that this program wrote.
pub(super) fn from_bytes<T: DeserializeOwned>(bytes: &[u8]) -> Result<T> {
    rmp_serde::from_slice(bytes)
        .map_err(|error| Error::value("message", error, "one of the same program"))
}
