//! A table as the bytes of a Parquet file.

use std::sync::Arc;

use parquet::basic::{Compression, ConvertedType, Encoding, LogicalType, Repetition, Type as Kind};
use parquet::data_type::{BoolType, ByteArray, ByteArrayType, DoubleType, Int64Type};
use parquet::errors::Result;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::{EnabledStatistics, WriterProperties, WriterPropertiesBuilder};
use parquet::file::writer::{SerializedColumnWriter, SerializedFileWriter};
use parquet::schema::types::{ColumnPath, Type};

use crate::data::format::About;
use crate::data::table::{Column, Table, Values};

/// Key of the metadata that tells units and meanings of the columns, as JSON.
const COLUMNS: &str = "columns";
/// A column with fewer changes from row to row than this part of its rows is written as a list of what it
/// has and places in it, which then take nearly nothing.
const FEW_CHANGES: usize = 8;

/// Writes tables of the same columns.
pub(super) struct Encoder {
    schema: Arc<Type>,
    metadata: Vec<KeyValue>,
}

impl Encoder {
    /// For tables with the columns of `table`.
    ///
    /// # Errors
    /// Where a name is none in Parquet.
    pub(super) fn new(about: &About, table: &Table) -> Result<Self> {
        let fields = table.columns.iter().map(|column| field(column).map(Arc::new));
        let fields = fields.collect::<Result<_>>()?;
        let schema = Type::group_type_builder(table.name).with_fields(fields).build()?;
        let columns = table.columns.iter().map(|Column { name, unit, about, .. }| {
            ((*name).to_owned(), serde_json::json!({ "unit": unit, "about": about }))
        });
        let columns = serde_json::Value::Object(columns.collect()).to_string();
        let facts = about.facts.iter().cloned().chain([(COLUMNS.to_owned(), columns)]);
        let metadata = facts.map(|(name, said)| KeyValue::new(name, said)).collect();
        Ok(Self { schema: Arc::new(schema), metadata })
    }

    /// The bytes of a file.
    ///
    /// # Errors
    /// What the writer says.
    pub(super) fn encode(&self, table: &Table) -> Result<Vec<u8>> {
        let properties = WriterProperties::builder()
            .set_created_by(concat!("slump ", env!("CARGO_PKG_VERSION")).to_owned())
            .set_key_value_metadata(Some(self.metadata.clone()))
            .set_compression(Compression::SNAPPY)
            .set_dictionary_enabled(false)
            .set_statistics_enabled(EnabledStatistics::Chunk)
            // A file is one group of rows, read as a whole.
            .set_offset_index_disabled(true);
        let properties = table.columns.iter().fold(properties, packed);
        let mut bytes = Vec::with_capacity(table.size() + self.size_of_metadata());
        let schema = Arc::clone(&self.schema);
        let mut file = SerializedFileWriter::new(&mut bytes, schema, Arc::new(properties.build()))?;
        let mut rows = file.next_row_group()?;
        for column in &table.columns {
            // There are as many as in the schema, which was made of the same columns.
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

fn field(column: &Column) -> Result<Type> {
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

/// Says how a column is packed.
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
        // The first and the last word by the alphabet tell readers nothing, and comparing all words took
        // a sixth of the time that a frame takes.
        Values::Words { .. } => {
            let without = EnabledStatistics::None;
            return properties
                .set_column_statistics_enabled(path.clone(), without)
                .set_column_dictionary_enabled(path, true);
        }
    };
    properties.set_column_dictionary_enabled(path, few_changes)
}

fn write(writer: &mut SerializedColumnWriter<'_>, values: &Values) -> Result<()> {
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

/// Which rows have a value.
fn levels<T>(values: &[Option<T>]) -> Vec<i16> {
    values.iter().map(|value| i16::from(value.is_some())).collect()
}
