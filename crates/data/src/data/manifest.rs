//! `data.json`: what a recording is made of.

use std::path::Path;

use serde_json::{Map, Value, json};

use super::columns::empty_tables;
use super::format::About;
use super::table::{Column, Values};
use crate::error::{Error, Result};
use crate::output::write_file;
use crate::scene::FormatName;

/// Its name.
pub(super) const FILE: &str = "data.json";

/// Writes it.
///
/// # Errors
/// Names the file and what the system says.
pub(super) fn write(folder: &Path, formats: &[FormatName], about: &About) -> Result<()> {
    let path = folder.join(FILE);
    let facts = about.facts.iter().map(|(name, said)| (name.clone(), Value::from(said.as_str())));
    let (of_frames, steps) = empty_tables();
    let tables = of_frames.iter().chain([&steps]).map(|table| {
        let columns: Vec<Value> = table.columns.iter().map(column).collect();
        (table.name.to_owned(), Value::from(columns))
    });
    let manifest = json!({
        "program": "slump",
        "version": env!("CARGO_PKG_VERSION"),
        "formats": formats,
        "about": facts.collect::<Map<_, _>>(),
        "tables": Map::from_iter(tables),
    });
    let mut text =
        serde_json::to_string_pretty(&manifest).map_err(|error| Error::file(&path, error))?;
    text.push('\n');
    write_file(&path, text.as_bytes())
}

/// Refuses to go on with a recording in other formats.
///
/// # Errors
/// Names the formats that it has.
pub(super) fn check(folder: &Path, formats: &[FormatName]) -> Result<()> {
    let path = folder.join(FILE);
    // Without one there is no recording yet.
    let Ok(text) = std::fs::read(&path) else { return Ok(()) };
    let manifest: Value = serde_json::from_slice(&text)
        .map_err(|error| Error::unread(&path, error, "the manifest of a recording"))?;
    if manifest["formats"] == json!(formats) {
        return Ok(());
    }
    let names: Vec<_> = formats.iter().map(|format| format.name()).collect();
    let allowed = format!("as {} has it: {}", path.display(), manifest["formats"]);
    Err(Error::value("data-format", names.join(","), allowed))
}

fn column(column: &Column) -> Value {
    let Column { name, unit, about, values } = column;
    let values = match values {
        Values::Numbers(_) | Values::SomeNumbers(_) => "number",
        Values::Counts(_) => "count",
        Values::Flags(_) => "flag",
        Values::Words { .. } => "word",
    };
    json!({ "name": name, "unit": unit, "about": about, "values": values })
}
