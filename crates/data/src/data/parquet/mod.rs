//! Writes recordings as Parquet files: one folder per table, whose files are complete at all times.

mod decode;
mod guard;

pub(super) use decode::{Decoded, ParquetFile};

use std::path::{Path, PathBuf};
use std::sync::Arc;

use parquet::basic::{Compression, ConvertedType, Encoding, LogicalType, Repetition, Type as Kind};
use parquet::data_type::{BoolType, ByteArray, ByteArrayType, DoubleType, Int64Type};
use parquet::errors::Result as ParquetResult;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::{EnabledStatistics, WriterProperties, WriterPropertiesBuilder};
use parquet::file::writer::{SerializedColumnWriter, SerializedFileWriter};
use parquet::schema::types::{ColumnPath, Type};

use super::columns::empty_tables_of_frames;
use super::folder_files::{make_folder, numbered_parts, path_of_part, remove};
use super::format::{Format, Frame, RecordingMark, RunFacts, check_count};
use super::table::{Column, Table, Values};
use crate::column_spec::STEP;
use crate::error::{Error, Result};
use crate::output::PendingFile;
use crate::sim::Observables;

/// Size of a Parquet file before compression, bytes, at which the file ends after the current frame and the next file
/// begins. If it is larger, each frame of a small scene costs more, because the last file is rewritten with every
/// frame. If it is smaller, there are more files.
const SIZE_OF_PART: usize = 256 << 10;
/// Key of the entry in a file's metadata that describes the units and meanings of the columns, as JSON.
const COLUMNS_KEY: &str = "columns";
/// Least number of rows per change of value, on average over a column of numbers, with which the column is written as a
/// dictionary (list of its different values) and an index for each row. A column that changes so rarely then takes
/// almost no space.
const FEW_CHANGES: usize = 8;

/// Writer of a recording as Parquet files.
pub(super) struct Parquet {
    of_frames: Vec<GrowingParts>,
    steps: GrowingParts,
}

impl Parquet {
    /// Starts a recording in a folder, or opens the recording that is already in it.
    pub(super) fn start(folder: &Path, facts: &RunFacts) -> Result<Self> {
        let start = |table| GrowingParts::start(folder, facts, table);
        let of_frames = empty_tables_of_frames().into_iter().map(start).collect::<Result<_>>()?;
        Ok(Self { of_frames, steps: start(Table::of_steps(&[]))? })
    }
}

impl Format for Parquet {
    fn add(&mut self, frame: &Frame) -> Result<()> {
        let mut tables = self.of_frames.iter_mut().zip(frame.tables());
        tables.try_for_each(|(parts, table)| parts.add(table))
    }

    fn add_steps(&mut self, rows: &[Observables]) -> Result<()> {
        self.steps.add(&Table::of_steps(rows))
    }

    fn flush(&mut self) -> Result<()> {
        let mut tables = self.of_frames.iter_mut().chain([&mut self.steps]);
        tables.try_for_each(GrowingParts::flush)
    }

    fn check(&self, step: u64, last_frame: Option<u64>, mark: &RecordingMark) -> Result<()> {
        let mut of_frames = self.of_frames.iter().zip(mark.rows);
        of_frames.try_for_each(|(parts, rows)| parts.check(last_frame, rows))?;
        self.steps.check(Some(step), mark.steps)
    }

    fn roll_back(&mut self, step: u64, last_frame: Option<u64>) -> Result<()> {
        self.of_frames.iter_mut().try_for_each(|parts| parts.roll_back(last_frame))?;
        self.steps.roll_back(Some(step))
    }
}

/// A table that is split into several files, its parts. The last part is rewritten with each frame until it is large
/// enough, so that readers always find complete files.
struct GrowingParts {
    folder: PathBuf,
    encoder: Encoder,
    /// Number of the last part, the file to which rows are still added.
    number: u64,
    /// Rows of the last part, the file to which rows are still added.
    rows: Table,
    /// True if the last part has rows that are not yet in its file.
    has_news: bool,
    /// True if the file of the last part exists. A table has a file even without rows, so that readers find its
    /// columns.
    has_file: bool,
}

impl GrowingParts {
    /// Starts a table without files. `rows` is an empty table that defines the columns.
    fn start(folder: &Path, facts: &RunFacts, rows: Table) -> Result<Self> {
        let folder = folder.join(rows.name);
        make_folder(&folder)?;
        let encoder = Encoder::new(facts, &rows).map_err(|error| Error::file(&folder, error))?;
        Ok(Self { folder, encoder, number: 0, rows, has_news: false, has_file: false })
    }

    /// Adds rows, all to the last part (file) of the table. Begins a new part if the last part has become large enough.
    fn add(&mut self, rows: &Table) -> Result<()> {
        self.rows.append(rows);
        self.has_news |= !rows.is_empty();
        if self.rows.size() < SIZE_OF_PART { Ok(()) } else { self.end_part() }
    }

    fn end_part(&mut self) -> Result<()> {
        self.flush()?;
        self.number += 1;
        self.rows.truncate(0);
        Ok(())
    }

    /// Writes the file of the last part if it has rows that are not yet in the file, or if the file does not exist yet.
    ///
    /// # Errors
    /// The error names the file and gives the system's message. The old file remains.
    fn flush(&mut self) -> Result<()> {
        if !self.has_news && self.has_file {
            return Ok(());
        }
        let path = path_of_part(&self.folder, self.number);
        let bytes = self.encoder.encode(&self.rows).map_err(|error| Error::file(&path, error))?;
        let mut file = PendingFile::start(&path)?;
        file.write(&bytes)?;
        // The run does not wait until the disk has the data.
        file.finish(false)?;
        (self.has_news, self.has_file) = (false, true);
        Ok(())
    }

    /// Checks that the files of the table have exactly `marked` rows up to step number `step`.
    fn check(&self, step: Option<u64>, marked: u64) -> Result<()> {
        let mut rows = 0;
        // Rows are sorted by step. As soon as a part has a row up to `step`, all rows of the earlier parts count.
        for (_, path) in numbered_parts(&self.folder)?.into_iter().rev() {
            let part = ParquetFile::open(&path)?;
            let Some(Decoded::Whole(steps)) = (if rows == 0 { part.column(STEP)? } else { None })
            else {
                rows += part.rows() as u64;
                continue;
            };
            let steps = steps.into_iter().filter_map(|there| u64::try_from(there?).ok());
            rows += steps.filter(|&there| Some(there) <= step).count() as u64;
        }
        check_count(&self.folder, "rows", rows, marked)
    }

    /// Removes the rows of all steps after `step`, or all rows if `step` is `None`.
    fn roll_back(&mut self, step: Option<u64>) -> Result<()> {
        self.rows.truncate(0);
        (self.number, self.has_news, self.has_file) = (0, false, false);
        // The loop begins with the last part, so that the remaining parts are complete if the program is killed in
        // between.
        for (number, path) in numbered_parts(&self.folder)?.into_iter().rev() {
            let mut rows = self.rows.clone();
            ParquetFile::open(&path)?.read_into(&mut rows)?;
            if rows.steps().first().is_none_or(|&first| Some(first) > step) {
                remove(&path)?;
                continue;
            }
            let all = rows.len();
            rows.keep_until(step);
            (self.number, self.has_file) = (number, true);
            self.has_news = rows.len() < all;
            self.rows = rows;
            self.flush()?;
            if self.rows.size() >= SIZE_OF_PART {
                self.end_part()?;
            }
            return Ok(());
        }
        Ok(())
    }
}

/// Encoder of Parquet files for tables with the same columns.
struct Encoder {
    schema: Arc<Type>,
    metadata: Vec<KeyValue>,
}

impl Encoder {
    /// Creates an encoder for tables with the columns of `table`.
    fn new(facts: &RunFacts, table: &Table) -> ParquetResult<Self> {
        let fields = table.columns.iter().map(|column| field(column).map(Arc::new));
        let fields = fields.collect::<ParquetResult<_>>()?;
        let schema = Type::group_type_builder(table.name).with_fields(fields).build()?;
        let columns = table.columns.iter().map(|Column { name, unit, about, .. }| {
            ((*name).to_owned(), serde_json::json!({ "unit": unit, "about": about }))
        });
        let columns = serde_json::Value::Object(columns.collect()).to_string();
        let facts = facts.facts.iter().cloned().chain([(COLUMNS_KEY.to_owned(), columns)]);
        let metadata = facts.map(|(name, said)| KeyValue::new(name, said)).collect();
        Ok(Self { schema: Arc::new(schema), metadata })
    }

    /// Returns the bytes of a Parquet file with the rows of `table`.
    fn encode(&self, table: &Table) -> ParquetResult<Vec<u8>> {
        let properties = WriterProperties::builder()
            .set_created_by(concat!("slump ", env!("CARGO_PKG_VERSION")).to_owned())
            .set_key_value_metadata(Some(self.metadata.clone()))
            .set_compression(Compression::SNAPPY)
            .set_dictionary_enabled(false)
            .set_statistics_enabled(EnabledStatistics::Chunk)
            // A file is a single row group, which is always read as a whole, so an offset index is of no use.
            .set_offset_index_disabled(true);
        let properties = table.columns.iter().fold(properties, packed);
        let mut bytes = Vec::with_capacity(table.size() + self.size_of_metadata());
        let schema = Arc::clone(&self.schema);
        let mut file = SerializedFileWriter::new(&mut bytes, schema, Arc::new(properties.build()))?;
        let mut rows = file.next_row_group()?;
        for column in &table.columns {
            // The table has as many columns as the schema, which was made from the table, so the loop never breaks.
            let Some(mut writer) = rows.next_column()? else { break };
            write(&mut writer, &column.values)?;
            writer.close()?;
        }
        rows.close()?;
        file.close()?;
        Ok(bytes)
    }

    fn size_of_metadata(&self) -> usize {
        let length = |it: &KeyValue| it.key.len() + it.value.as_ref().map_or(0, String::len);
        self.metadata.iter().map(length).sum()
    }
}

fn field(column: &Column) -> ParquetResult<Type> {
    let (kind, repetition) = match column.values {
        Values::Numbers(_) => (Kind::DOUBLE, Repetition::REQUIRED),
        Values::SomeNumbers(_) => (Kind::DOUBLE, Repetition::OPTIONAL),
        Values::Counts(_) => (Kind::INT64, Repetition::REQUIRED),
        Values::Flags(_) => (Kind::BOOLEAN, Repetition::OPTIONAL),
        Values::Words { .. } => (Kind::BYTE_ARRAY, Repetition::REQUIRED),
    };
    let field = Type::primitive_type_builder(column.name, kind).with_repetition(repetition);
    let field = match column.values {
        Values::Words { .. } => field
            .with_logical_type(Some(LogicalType::String))
            .with_converted_type(ConvertedType::UTF8),
        _ => field,
    };
    field.build()
}

/// Chooses the encoding of a column and adds it to the properties of a Parquet file.
fn packed(properties: WriterPropertiesBuilder, column: &Column) -> WriterPropertiesBuilder {
    let path = ColumnPath::from(column.name);
    let few_changes = match &column.values {
        Values::Numbers(values) => {
            let changes = values.windows(2).filter(|two| two[0].to_bits() != two[1].to_bits());
            FEW_CHANGES * changes.count() < values.len()
        }
        Values::SomeNumbers(_) | Values::Flags(_) => false,
        Values::Counts(_) => {
            return properties.set_column_encoding(path, Encoding::DELTA_BINARY_PACKED);
        }
        // Columns of words have no statistics: readers have no use for the alphabetically first and last word, and
        // comparing all words took a sixth of the time of a frame.
        Values::Words { .. } => {
            let without = EnabledStatistics::None;
            return properties
                .set_column_statistics_enabled(path.clone(), without)
                .set_column_dictionary_enabled(path, true);
        }
    };
    properties.set_column_dictionary_enabled(path, few_changes)
}

fn write(writer: &mut SerializedColumnWriter<'_>, values: &Values) -> ParquetResult<()> {
    match values {
        Values::Numbers(values) => writer.typed::<DoubleType>().write_batch(values, None, None)?,
        Values::SomeNumbers(values) => {
            let there: Vec<f64> = values.iter().copied().flatten().collect();
            writer.typed::<DoubleType>().write_batch(&there, Some(&levels(values)), None)?
        }
        Values::Counts(values) => {
            let values: Vec<i64> = values.iter().map(|&value| value as i64).collect();
            writer.typed::<Int64Type>().write_batch(&values, None, None)?
        }
        Values::Flags(values) => {
            let there: Vec<bool> = values.iter().copied().flatten().collect();
            writer.typed::<BoolType>().write_batch(&there, Some(&levels(values)), None)?
        }
        Values::Words { words, codes } => {
            let words: Vec<ByteArray> =
                words.iter().map(|word| ByteArray::from(word.as_str())).collect();
            let values: Vec<ByteArray> =
                codes.iter().map(|&code| words[code as usize].clone()).collect();
            writer.typed::<ByteArrayType>().write_batch(&values, None, None)?
        }
    };
    Ok(())
}

/// Returns the definition levels of a column, as Parquet calls them: 1 for a row with a value, 0 for a row without.
fn levels<T>(values: &[Option<T>]) -> Vec<i16> {
    values.iter().map(|value| i16::from(value.is_some())).collect()
}
