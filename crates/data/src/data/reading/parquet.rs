//! Reads discs from Parquet files.

use std::path::{Path, PathBuf};

use super::rows::{
    DiscRow, LEFT_OUT, NUMBERS, RecordedGrains, check_names, discs_of_rows, no_such_step,
};
use crate::data::parquet::{Decoded, ParquetFile};
use crate::error::{Error, Result};

/// Multiplier that gives the rows of all files of a table different numbers: row k of file n has the number n times
/// this multiplier plus k (n and k count from 0). No file has as many rows as this multiplier.
const MOST_ROWS: u64 = 1 << 32;

/// Reads the discs of step number `step`, or of the last step if `step` is `None`, from the Parquet files of a table,
/// which are in ascending order.
pub(super) fn read_parts(
    path: &Path,
    parts: &[(u64, PathBuf)],
    step: Option<u64>,
) -> Result<RecordedGrains> {
    let (mut known, mut rows, mut wanted) = (Vec::new(), Vec::new(), step);
    // The search begins with the last file, because the last frame is in that file and a requested frame is usually
    // near it.
    for (index, (_, part)) in parts.iter().enumerate().rev() {
        let table = ParquetFile::open(part)?;
        check_names(part, &table.names())?;
        let steps = table.whole("step")?;
        wanted = wanted.or(steps.as_ref().and_then(|steps| steps.iter().copied().max()));
        let is_wanted = |row: &usize| match (&steps, wanted) {
            (Some(steps), Some(wanted)) => steps[*row] == wanted,
            // A file without the column `step` has a single frame.
            (None, _) => step.is_none(),
            (Some(_), None) => false,
        };
        let chosen: Vec<usize> = (0..table.rows()).filter(is_wanted).collect();
        if chosen.is_empty() && !rows.is_empty() {
            break;
        }
        if !chosen.is_empty() {
            rows.splice(0..0, table.disc_rows(index as u64 * MOST_ROWS, &chosen)?);
        }
        known.extend(steps.into_iter().flatten());
        known.sort_unstable();
        known.dedup();
    }
    match step {
        Some(step) if rows.is_empty() => Err(no_such_step(path, step, &known)),
        _ => discs_of_rows(path, rows, |place| {
            let part = parts.get((place / MOST_ROWS) as usize).map_or(path, |(_, part)| part);
            (part.to_owned(), format!("row {}", place % MOST_ROWS + 1))
        }),
    }
}

impl ParquetFile {
    /// Reads a column of whole numbers ≥ 0; `None` if the file has no such column.
    fn whole(&self, name: &str) -> Result<Option<Vec<u64>>> {
        let allowed = "a whole number ≥ 0";
        let of = |(row, value): (usize, Option<i64>)| {
            u64::try_from(value.unwrap_or(-1)).map_err(|_| self.refuse(row, name, value, allowed))
        };
        match self.column(name)? {
            None => Ok(None),
            Some(Decoded::Whole(values)) => {
                values.into_iter().enumerate().map(of).collect::<Result<_>>().map(Some)
            }
            Some(_) => Err(self.wrong_kind(name, "whole numbers")),
        }
    }

    fn disc_rows(&self, first_place: u64, chosen: &[usize]) -> Result<Vec<DiscRow>> {
        let ids = self.whole("id")?;
        let words = |name: &str| match self.column(name)? {
            None => Ok(None),
            Some(Decoded::Words(words)) => Ok(Some(words)),
            Some(_) => Err(self.wrong_kind(name, "words")),
        };
        let (kinds, materials) = (words("kind")?, words("material")?);
        let word = |words: &Option<Vec<Option<String>>>, row: usize| words.as_ref()?[row].clone();
        let row = |&row: &usize| DiscRow {
            place: first_place + row as u64,
            id: ids.as_ref().map(|ids| ids[row]),
            kind: word(&kinds, row),
            material: word(&materials, row).filter(|name| !name.is_empty()),
            numbers: LEFT_OUT,
        };
        let mut rows: Vec<DiscRow> = chosen.iter().map(row).collect();
        for (place, name) in NUMBERS.iter().enumerate() {
            let none = f64::NAN;
            let values: Vec<f64> = match self.column(name)? {
                None => continue,
                Some(Decoded::Numbers(values)) => {
                    values.into_iter().map(|value| value.unwrap_or(none)).collect()
                }
                Some(Decoded::Whole(values)) => {
                    values.into_iter().map(|value| value.map_or(none, |it| it as f64)).collect()
                }
                Some(_) => return Err(self.wrong_kind(name, "numbers")),
            };
            for (disc, &row) in rows.iter_mut().zip(chosen) {
                disc.numbers[place] = values[row];
            }
        }
        Ok(rows)
    }

    fn refuse(&self, row: usize, name: &str, value: Option<i64>, allowed: &str) -> Error {
        let value = value.map_or("missing".to_owned(), |value| value.to_string());
        Error::file(
            &self.path,
            format!("row {}: {name} is {value}, but must be {allowed}", row + 1),
        )
    }

    fn wrong_kind(&self, name: &str, allowed: &str) -> Error {
        Error::file(
            &self.path,
            format!("column {name} holds something else, but must hold {allowed}"),
        )
    }
}
