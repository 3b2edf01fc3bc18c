//! Messages between a window and a solver in another process, encoded as bytes.

use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::error::{Error, Result};

/// Encodes a message, or a source of initial states, in binary form (MessagePack).
///
/// # Errors
/// If the binary form cannot express the data.
pub fn to_bytes(message: &impl Serialize) -> Result<Vec<u8>> {
    rmp_serde::to_vec_named(message)
        .map_err(|error| Error::value("message", error, "one that can be written"))
}

/// Decodes a message that this program encoded.
pub(super) fn from_bytes<T: DeserializeOwned>(bytes: &[u8]) -> Result<T> {
    rmp_serde::from_slice(bytes)
        .map_err(|error| Error::value("message", error, "one of the same program"))
}
