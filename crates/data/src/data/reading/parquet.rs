//! Discs out of Parquet, whoever wrote it.

use std::fs::File;
use std::path::{Path, PathBuf};

use parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use parquet::data_type::DataType;
use parquet::errors::{ParquetError, Result as ParquetResult};
use parquet::file::reader::{FileReader, SerializedFileReader};

use super::{DiscRow, NUMBERS, RecordedGrains, check_names, discs_of_rows, no_such_step};
use crate::error::{Error, Result};

/// What a file must be, for messages.
const FORM: &str = "a Parquet file whose columns are flat, not compressed or by snappy";
/// Rows of the largest file that is read; more are a file that is damaged, or of another trade.
const MOST_ROWS: i64 = 1 << 28;
/// Rows that are decoded at once.
const ROWS_AT_ONCE: usize = 1 << 16;
/// Rows of a file that a place can tell apart.
const ROWS_OF_PLACES: u64 = 1 << 32;

/// Reads the moment of a step, or the last one, from the parts of a table, in their order.
pub(super) fn read_parts(
    path: &Path,
    parts: &[(u64, PathBuf)],
    step: Option<u64>,
) -> Result<RecordedGrains> {
    let (mut known, mut rows, mut wanted) = (Vec::new(), Vec::new(), step);
    // The last moment is in the last part, and one that is asked for most often near it.
    for (index, (_, part)) in parts.iter().enumerate().rev() {
        let table = ParquetFile::open(part)?;
        check_names(part, &table.names())?;
        let steps = table.whole("step")?;
        wanted = wanted.or(steps.as_ref().and_then(|steps| steps.iter().copied().max()));
        let is_wanted = |row: &usize| match (&steps, wanted) {
            (Some(steps), Some(wanted)) => steps[*row] == wanted,
            // A file without steps has one moment.
            (None, _) => step.is_none(),
            (Some(_), None) => false,
        };
        let chosen: Vec<usize> = (0..table.rows).filter(is_wanted).collect();
        if chosen.is_empty() && !rows.is_empty() {
            break;
        }
        if !chosen.is_empty() {
            rows.splice(0..0, table.disc_rows(index as u64 * ROWS_OF_PLACES, &chosen)?);
        }
        known.extend(steps.into_iter().flatten());
        known.sort_unstable();
        known.dedup();
    }
    match step {
        Some(step) if rows.is_empty() => Err(no_such_step(path, step, &known)),
        _ => discs_of_rows(path, rows, |place| {
            let part = parts.get((place / ROWS_OF_PLACES) as usize).map_or(path, |(_, part)| part);
            (part.to_owned(), format!("row {}", place % ROWS_OF_PLACES + 1))
        }),
    }
}

/// What a row has in a column.
#[derive(Clone, Debug)]
enum Cell {
    None,
    Number(f64),
    Whole(i64),
    Word(String),
    Flag,
}

struct ParquetFile {
    path: PathBuf,
    rows: usize,
    reader: SerializedFileReader<File>,
}

impl ParquetFile {
    fn open(path: &Path) -> Result<Self> {
        let file = File::open(path).map_err(|error| Error::unread(path, error, FORM))?;
        let reader = SerializedFileReader::new(file)
            .map_err(|error| Error::unread(path, said(&error), FORM))?;
        let rows = reader.metadata().file_metadata().num_rows();
        if !(0..=MOST_ROWS).contains(&rows) {
            let reason = format!("has {rows} rows, but must have no more than {MOST_ROWS}");
            return Err(Error::file(path, reason));
        }
        Ok(Self { path: path.to_owned(), rows: rows as usize, reader })
    }

    fn names(&self) -> Vec<String> {
        let columns = self.reader.metadata().file_metadata().schema_descr().columns();
        columns.iter().map(|column| column.path().string()).collect()
    }

    /// The column of that name, a cell a row.
    fn column(&self, name: &str) -> Result<Option<Vec<Cell>>> {
        let Some(index) = self.names().iter().position(|there| there == name) else {
            return Ok(None);
        };
        let refuse = |error: ParquetError| {
            Error::unread(&self.path, format!("column {name}: {}", said(&error)), FORM)
        };
        let mut cells = Vec::new();
        for group in 0..self.reader.num_row_groups() {
            let rows = self.reader.get_row_group(group).map_err(refuse)?;
            let count = rows.metadata().num_rows().clamp(0, MOST_ROWS) as usize;
            let reader = rows.get_column_reader(index).map_err(refuse)?;
            decode(reader, count, &mut cells).map_err(refuse)?;
        }
        let (there, rows) = (cells.len(), self.rows);
        if there != rows {
            let reason = format!("column {name} has {there} rows, but must have {rows}");
            return Err(Error::file(&self.path, reason));
        }
        Ok(Some(cells))
    }

    /// A column of whole numbers ≥ 0, where there is one.
    fn whole(&self, name: &str) -> Result<Option<Vec<u64>>> {
        let refuse = |row: usize, value: &str| {
            let place = format!("row {}: {name} is {value}", row + 1);
            Error::file(&self.path, format!("{place}, but must be a whole number ≥ 0"))
        };
        let of = |(row, cell)| match cell {
            Cell::Whole(value) => u64::try_from(value).map_err(|_| refuse(row, &value.to_string())),
            Cell::None => Err(refuse(row, "missing")),
            _ => Err(self.wrong_kind(name, "whole numbers")),
        };
        let cells = self.column(name)?;
        cells.map(|cells| cells.into_iter().enumerate().map(of).collect()).transpose()
    }

    fn disc_rows(&self, first_place: u64, chosen: &[usize]) -> Result<Vec<DiscRow>> {
        let ids = self.whole("id")?;
        let kinds = self.column("kind")?;
        let row = |&row: &usize| {
            let kind = match kinds.as_ref().map(|kinds| &kinds[row]) {
                None | Some(Cell::None) => None,
                Some(Cell::Word(word)) => Some(word.clone()),
                Some(_) => return Err(self.wrong_kind("kind", "words")),
            };
            let id = ids.as_ref().map(|ids| ids[row]);
            Ok(DiscRow { place: first_place + row as u64, id, kind, numbers: Default::default() })
        };
        let mut rows: Vec<DiscRow> = chosen.iter().map(row).collect::<Result<_>>()?;
        for (place, name) in NUMBERS.iter().enumerate() {
            let Some(cells) = self.column(name)? else { continue };
            for (disc, &row) in rows.iter_mut().zip(chosen) {
                disc.numbers[place] = match cells[row] {
                    Cell::Number(number) => number,
                    Cell::Whole(number) => number as f64,
                    Cell::None => f64::NAN,
                    _ => return Err(self.wrong_kind(name, "numbers")),
                };
            }
        }
        Ok(rows)
    }

    fn wrong_kind(&self, name: &str, allowed: &str) -> Error {
        let reason = format!("column {name} holds something else, but must hold {allowed}");
        Error::file(&self.path, reason)
    }
}

/// What the crate says, in fewer words where they only repeat what kind of error it is.
fn said(error: &ParquetError) -> String {
    match error {
        ParquetError::General(said) | ParquetError::NYI(said) | ParquetError::EOF(said) => {
            said.clone()
        }
        other => other.to_string(),
    }
}

/// Appends the cells of so many rows.
fn decode(reader: ColumnReader, rows: usize, cells: &mut Vec<Cell>) -> ParquetResult<()> {
    match reader {
        ColumnReader::BoolColumnReader(reader) => all(reader, rows, cells, |_| Cell::Flag),
        ColumnReader::Int32ColumnReader(reader) => {
            all(reader, rows, cells, |it| Cell::Whole(it.into()))
        }
        ColumnReader::Int64ColumnReader(reader) => all(reader, rows, cells, Cell::Whole),
        ColumnReader::FloatColumnReader(reader) => {
            all(reader, rows, cells, |it| Cell::Number(it.into()))
        }
        ColumnReader::DoubleColumnReader(reader) => all(reader, rows, cells, Cell::Number),
        ColumnReader::ByteArrayColumnReader(reader) => all(reader, rows, cells, |it| {
            Cell::Word(String::from_utf8_lossy(it.data()).into_owned())
        }),
        ColumnReader::Int96ColumnReader(_) | ColumnReader::FixedLenByteArrayColumnReader(_) => {
            Err(ParquetError::General("holds neither numbers nor words".into()))
        }
    }
}

fn all<T: DataType>(
    mut reader: ColumnReaderImpl<T>,
    rows: usize,
    cells: &mut Vec<Cell>,
    of: impl Fn(T::T) -> Cell,
) -> ParquetResult<()> {
    let (mut levels, mut values, end) = (Vec::new(), Vec::new(), cells.len() + rows);
    while cells.len() < end {
        levels.clear();
        values.clear();
        let at_once = ROWS_AT_ONCE.min(end - cells.len());
        let (records, _, _) = reader.read_records(at_once, Some(&mut levels), None, &mut values)?;
        if records == 0 {
            let reason = format!("has {} of {rows} rows", cells.len() + rows - end);
            return Err(ParquetError::General(reason));
        }
        let mut values = values.drain(..).map(&of);
        if levels.is_empty() {
            cells.extend(values);
        } else {
            let value = |&level: &i16| (level > 0).then(|| values.next()).flatten();
            cells.extend(levels.iter().map(value).map(|cell| cell.unwrap_or(Cell::None)));
        }
    }
    Ok(())
}
