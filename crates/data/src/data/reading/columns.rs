//! Discs out of columns that are at hand.

use std::path::Path;

use super::found::{FoundRow, NUMBERS, RecordedGrains, check_names, checked};
use crate::data::columns::empty_grains;
use crate::data::table::Values;
use crate::error::{Error, Result};

/// The discs of columns by those names that recordings give them: numbers, and where they are there the
/// counts `id` and the words `kind`. `what` they are of is for messages.
///
/// ```
/// use slump::data::{Values, grains_of};
///
/// let column = |name: &str, number| (name.to_owned(), Values::Numbers(vec![number]));
/// let columns = [column("x", 0.01), column("y", 0.02), column("radius", 0.0025)];
/// let discs = grains_of("my discs".as_ref(), &columns)?;
/// assert_eq!(discs.grains[0].radius, 0.0025);
/// let refused = grains_of("my discs".as_ref(), &columns[..2]);
/// assert!(refused.is_err_and(|error| error.to_string().starts_with("my discs: the columns are x, y")));
/// # Ok::<(), slump::error::Error>(())
/// ```
///
/// # Errors
/// Where a column is missing, unknown, of another length or of other values, or a row is no disc; the message
/// names it.
pub fn grains_of(what: &Path, columns: &[(String, Values)]) -> Result<RecordedGrains> {
    let names: Vec<String> = columns.iter().map(|(name, _)| name.clone()).collect();
    check_names(what, &names)?;
    let known = empty_grains();
    let refuse = |reason: String| Error::file(what, reason);
    if let Some(unknown) = names.iter().find(|name| known.column(name).is_none()) {
        let known: Vec<_> = known.columns.iter().map(|column| column.name).collect();
        let known = known.join(", ");
        return Err(refuse(format!("a column is {unknown}, but must be one of {known}")));
    }
    let (first, values) = &columns[0];
    let rows = values.len();
    if let Some((name, values)) = columns.iter().find(|(_, values)| values.len() != rows) {
        let found = values.len();
        return Err(refuse(format!(
            "{name} has {found} rows, but must have {rows}, as {first} has"
        )));
    }
    for (name, values) in columns {
        match (name.as_str(), values) {
            ("id", Values::Counts(_)) | ("kind", Values::Words { .. }) => {}
            ("id", _) => return Err(refuse("id has no counts, but must be of them".into())),
            ("kind", _) => return Err(refuse("kind has no words, but must be of them".into())),
            _ => {}
        }
    }
    let column =
        |name: &str| columns.iter().find(|(known, _)| known == name).map(|(_, values)| values);
    let numbers = NUMBERS.map(column);
    let (ids, kinds) = (column("id"), column("kind"));
    let row = |at: usize| FoundRow {
        place: at as u64,
        id: ids.and_then(|ids| ids.count(at)),
        kind: kinds.and_then(|kinds| kinds.word(at)).map(str::to_owned),
        numbers: numbers.map(|numbers| numbers.map_or(0.0, |numbers| numbers.number(at))),
    };
    let place = |row| (what.to_owned(), format!("row {row}"));
    checked(what, (0..rows).map(row).collect(), place)
}

impl Values {
    /// The number of a row; not a number where it has none.
    fn number(&self, row: usize) -> f64 {
        match self {
            Self::Numbers(numbers) => numbers[row],
            Self::SomeNumbers(numbers) => numbers[row].unwrap_or(f64::NAN),
            Self::Counts(counts) => counts[row] as f64,
            Self::Flags(_) | Self::Words { .. } => f64::NAN,
        }
    }

    /// The count of a row, if this is a column of counts.
    fn count(&self, row: usize) -> Option<u64> {
        if let Self::Counts(counts) = self { Some(counts[row]) } else { None }
    }

    /// The word of a row, if this is a column of words.
    fn word(&self, row: usize) -> Option<&str> {
        let Self::Words { words, codes } = self else { return None };
        words.get(codes[row] as usize).map(String::as_str)
    }
}
