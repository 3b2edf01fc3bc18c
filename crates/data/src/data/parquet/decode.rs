//! Reads columns of Parquet files, including files of other programs.

use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

use parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use parquet::data_type::{ByteArray, DataType};
use parquet::errors::{ParquetError, Result as ParquetResult};
use parquet::file::metadata::ColumnChunkMetaData;
use parquet::file::reader::{FileReader, SerializedFileReader};

use super::guard::{caught, check_footer, check_pages};
use crate::data::table::{Table, Values};
use crate::error::{Error, Result};
use crate::input::open;

/// Description of a valid Parquet file, for error messages.
const FORM: &str = "a Parquet file whose columns are flat, not compressed or by snappy";
/// Largest number of rows that a file may have: about 268 million, for which the eight numbers of each disc need 16 GiB
/// of memory. A file with more rows is damaged or does not contain discs.
const MOST_ROWS: i64 = 1 << 28;
/// Length of the last section of a Parquet file, bytes: the length of the footer (four bytes) and the mark `PAR1`.
const MARK: u64 = 8;
/// Number of bytes that are read of each word in a column of words; further bytes are ignored. All words for kinds of
/// discs are shorter.
const MOST_OF_WORD: usize = 64;
/// Largest number of rows of a column that are decoded in one call of the decoder. More rows need fewer calls, but a
/// larger buffer.
const ROWS_AT_ONCE: usize = 1 << 16;

/// An open Parquet file.
pub(in crate::data) struct ParquetFile {
    pub path: PathBuf,
    file: File,
    reader: SerializedFileReader<File>,
}

/// Values of a decoded column.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::data) enum Decoded {
    /// Floating-point numbers; `None` for missing values.
    Numbers(Vec<Option<f64>>),
    Whole(Vec<Option<i64>>),
    Flags(Vec<Option<bool>>),
    Words(Vec<Option<String>>),
}

impl ParquetFile {
    /// Opens a Parquet file and checks its footer.
    pub(in crate::data) fn open(path: &Path) -> Result<Self> {
        let file = open(path, FORM)?;
        let refuse = |said: String| Error::unread(path, said, FORM);
        check_whole(&file).map_err(refuse)?;
        let copy = file.try_clone().map_err(|error| refuse(error.to_string()))?;
        let reader = caught(|| SerializedFileReader::new(copy)).map_err(refuse)?;
        let reader = reader.map_err(|error| refuse(said(&error)))?;
        let rows = reader.metadata().file_metadata().num_rows();
        if !(0..=MOST_ROWS).contains(&rows) {
            let reason = format!("has {rows} rows, but must have no more than {MOST_ROWS}");
            return Err(Error::file(path, reason));
        }
        Ok(Self { path: path.to_owned(), file, reader })
    }

    /// Returns the number of rows in the file.
    pub(in crate::data) fn rows(&self) -> usize {
        // The number of rows was checked when the file was opened.
        self.reader.metadata().file_metadata().num_rows() as usize
    }

    /// Returns the names of the columns in the file.
    pub(in crate::data) fn names(&self) -> Vec<String> {
        let columns = self.reader.metadata().file_metadata().schema_descr().columns();
        columns.iter().map(|column| column.path().string()).collect()
    }

    /// Reads the column with the given name; `None` if the file has no such column.
    pub(in crate::data) fn column(&self, name: &str) -> Result<Option<Decoded>> {
        let Some(index) = self.names().iter().position(|there| there == name) else {
            return Ok(None);
        };
        let refuse = |error: ParquetError| {
            Error::unread(&self.path, format!("column {name}: {}", said(&error)), FORM)
        };
        let mut decoded: Option<Decoded> = None;
        for group in 0..self.reader.num_row_groups() {
            let rows = self.reader.get_row_group(group).map_err(refuse)?;
            let count = rows.metadata().num_rows().clamp(0, MOST_ROWS) as usize;
            let column = rows.metadata().column(index);
            let descriptor = column.column_descr();
            let is_flat = descriptor.max_rep_level() == 0 && descriptor.max_def_level() <= 1;
            let checked = if is_flat { self.check_pages(column) } else { Err("is nested".into()) };
            checked.map_err(|said| refuse(ParquetError::General(said)))?;
            let more = caught(|| decode(rows.get_column_reader(index)?, count));
            let more = more.map_err(|said| refuse(ParquetError::General(said)))?.map_err(refuse)?;
            decoded = Some(match decoded {
                None => more,
                Some(first) => first.followed_by(more),
            });
        }
        let decoded = decoded.unwrap_or(Decoded::Numbers(Vec::new()));
        let (there, rows) = (decoded.len(), self.rows());
        if there != rows {
            let reason = format!("column {name} has {there} rows, but must have {rows}");
            return Err(Error::file(&self.path, reason));
        }
        Ok(Some(decoded))
    }

    fn check_pages(&self, column: &ColumnChunkMetaData) -> std::result::Result<(), String> {
        let (start, length) = caught(|| column.byte_range())?;
        let mut bytes = Vec::new();
        let mut file = &self.file;
        file.seek(SeekFrom::Start(start))
            .and_then(|_| file.take(length).read_to_end(&mut bytes))
            .map_err(|error| error.to_string())?;
        check_pages(&bytes)
    }

    /// Reads all rows of the file into `table`, an empty table. The file must have every column of this table.
    pub(in crate::data) fn read_into(&self, table: &mut Table) -> Result<()> {
        for column in &mut table.columns {
            let refuse = || {
                let reason = format!(
                    "has no column {} as this version writes it, but must be a part of a recording \
                     of this version",
                    column.name
                );
                Error::file(&self.path, reason)
            };
            let decoded = self.column(column.name)?.ok_or_else(refuse)?;
            column.values = decoded.into_values(&column.values).ok_or_else(refuse)?;
        }
        Ok(())
    }
}

/// Checks the footer of a Parquet file, which contains its metadata. It is at the end of the file, ahead of its own
/// length and the mark `PAR1`.
fn check_whole(file: &File) -> std::result::Result<(), String> {
    let read = |count: u64| -> std::io::Result<Vec<u8>> {
        let (mut file, mut bytes) = (file, Vec::new());
        file.seek(SeekFrom::Start(file.metadata()?.len().saturating_sub(count)))?;
        file.take(count).read_to_end(&mut bytes)?;
        Ok(bytes)
    };
    let read = |count| read(count).map_err(|error| error.to_string());
    let bytes = file.metadata().map_err(|error| error.to_string())?.len();
    let Some(&[a, b, c, d, ..]) = read(MARK)?.first_chunk::<4>() else {
        return Err("ends before it has begun".into());
    };
    let footer = read(u64::from(u32::from_le_bytes([a, b, c, d])) + MARK)?;
    check_footer(&footer, bytes)
}

/// Returns the message of an error of the crate `parquet`. Messages of the kinds `General`, `NYI` (not implemented) and
/// `EOF` (end of file) are returned without the name of the kind, because they say enough.
fn said(error: &ParquetError) -> String {
    match error {
        ParquetError::General(said) | ParquetError::NYI(said) | ParquetError::EOF(said) => {
            said.clone()
        }
        other => other.to_string(),
    }
}

impl Decoded {
    fn len(&self) -> usize {
        match self {
            Self::Numbers(values) => values.len(),
            Self::Whole(values) => values.len(),
            Self::Flags(values) => values.len(),
            Self::Words(values) => values.len(),
        }
    }

    fn followed_by(self, more: Self) -> Self {
        match (self, more) {
            (Self::Numbers(mut all), Self::Numbers(more)) => {
                all.extend(more);
                Self::Numbers(all)
            }
            (Self::Whole(mut all), Self::Whole(more)) => {
                all.extend(more);
                Self::Whole(all)
            }
            (Self::Flags(mut all), Self::Flags(more)) => {
                all.extend(more);
                Self::Flags(all)
            }
            (Self::Words(mut all), Self::Words(more)) => {
                all.extend(more);
                Self::Words(all)
            }
            // Kinds cannot differ, because all row groups of a file have the same schema.
            (first, _) => first,
        }
    }

    /// Converts decoded values to the variant of `like`, the values of a table's column (numbers, counts, flags or
    /// words). Returns `None` if the variants do not match, or if a value is missing that may not be missing.
    fn into_values(self, like: &Values) -> Option<Values> {
        match (self, like) {
            (Self::Numbers(values), Values::Numbers(_)) => {
                values.into_iter().collect::<Option<_>>().map(Values::Numbers)
            }
            (Self::Numbers(values), Values::SomeNumbers(_)) => Some(Values::SomeNumbers(values)),
            (Self::Whole(values), Values::Counts(_)) => {
                let count = |value: Option<i64>| u64::try_from(value?).ok();
                values.into_iter().map(count).collect::<Option<_>>().map(Values::Counts)
            }
            (Self::Flags(values), Values::Flags(_)) => Some(Values::Flags(values)),
            (Self::Words(values), Values::Words { words, .. }) => {
                let mut words = words.clone();
                let mut code = |word: Option<String>| {
                    let word = word?;
                    let known = words.iter().position(|known| *known == word);
                    Some(known.unwrap_or_else(|| {
                        words.push(word);
                        words.len() - 1
                    }) as u32)
                };
                let codes = values.into_iter().map(&mut code).collect::<Option<_>>()?;
                Some(Values::Words { words, codes })
            }
            _ => None,
        }
    }
}

fn decode(reader: ColumnReader, rows: usize) -> ParquetResult<Decoded> {
    let word = |bytes: ByteArray| {
        let bytes = bytes.data();
        String::from_utf8_lossy(&bytes[..bytes.len().min(MOST_OF_WORD)]).into_owned()
    };
    Ok(match reader {
        ColumnReader::BoolColumnReader(reader) => Decoded::Flags(all(reader, rows, |it| it)?),
        ColumnReader::Int32ColumnReader(reader) => Decoded::Whole(all(reader, rows, i64::from)?),
        ColumnReader::Int64ColumnReader(reader) => Decoded::Whole(all(reader, rows, |it| it)?),
        ColumnReader::FloatColumnReader(reader) => Decoded::Numbers(all(reader, rows, f64::from)?),
        ColumnReader::DoubleColumnReader(reader) => Decoded::Numbers(all(reader, rows, |it| it)?),
        ColumnReader::ByteArrayColumnReader(reader) => Decoded::Words(all(reader, rows, word)?),
        ColumnReader::Int96ColumnReader(_) | ColumnReader::FixedLenByteArrayColumnReader(_) => {
            return Err(ParquetError::General("holds neither numbers nor words".into()));
        }
    })
}

/// Reads the first `rows` values of a column; `None` for missing values.
fn all<T: DataType, Value>(
    mut reader: ColumnReaderImpl<T>,
    rows: usize,
    of: impl Fn(T::T) -> Value,
) -> ParquetResult<Vec<Option<Value>>> {
    let (mut decoded, mut levels, mut values) = (Vec::new(), Vec::new(), Vec::new());
    while decoded.len() < rows {
        levels.clear();
        values.clear();
        let at_once = ROWS_AT_ONCE.min(rows - decoded.len());
        let (records, _, _) = reader.read_records(at_once, Some(&mut levels), None, &mut values)?;
        if records == 0 {
            let reason = format!("has {} of {rows} rows", decoded.len());
            return Err(ParquetError::General(reason));
        }
        let mut values = values.drain(..).map(&of);
        if levels.is_empty() {
            decoded.extend(values.map(Some));
        } else {
            decoded
                .extend(levels.iter().map(|&level| if level > 0 { values.next() } else { None }));
        }
    }
    Ok(decoded)
}
