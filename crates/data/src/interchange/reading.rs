//! Reading a problem file, whichever of its formats it has, and checking it.

use std::path::Path;

use super::{ProblemFile, siconos};
use crate::error::{Error, Result};

/// What a problem file must be, for messages.
const FORM: &str = "the JSON of a contact problem, or Siconos' text of a plane one";

impl ProblemFile {
    /// Reads a problem file, or a text file of Siconos', and checks it.
    ///
    /// # Errors
    /// In one sentence that names the file and what is wrong in it.
    pub fn read(path: &Path) -> Result<Self> {
        let bytes = std::fs::read(path).map_err(|error| Error::unread(path, error, FORM))?;
        let text = String::from_utf8(bytes).map_err(|error| Error::unread(path, error, FORM))?;
        Self::parse(&text).map_err(|error| Error::file(path, error))
    }

    /// Reads the text of a problem file, or of one of Siconos', and checks it.
    ///
    /// # Errors
    /// In one sentence that names what is wrong.
    pub fn parse(text: &str) -> Result<Self> {
        let file: Self = if text.trim_start().starts_with('{') {
            serde_json::from_str(text).map_err(|error| {
                Error::value(
                    "the problem",
                    format!("not readable ({error})"),
                    "the JSON of a contact problem",
                )
            })?
        } else {
            siconos::parse(text)?
        };
        file.delassus()?;
        if let Some(bodies) = &file.bodies {
            bodies.check(&file)?;
        }
        Ok(file)
    }
}
