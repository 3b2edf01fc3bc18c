//! Reads the files of recordings as tables of cells, without Slump's own readers.

use std::collections::BTreeMap;
use std::fs::File;
use std::path::{Path, PathBuf};

use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::record::Field;

/// A cell of a table, in a form that can be compared bitwise.
#[derive(Clone, Debug, PartialEq)]
pub enum Cell {
    /// Bit pattern of a floating-point number.
    Number(u64),
    Whole(u64),
    Flag(bool),
    Word(String),
    Nothing,
}

impl From<f64> for Cell {
    fn from(number: f64) -> Self {
        Self::Number(number.to_bits())
    }
}

pub type Columns = BTreeMap<String, Vec<Cell>>;

/// Returns the files of which a table in Parquet consists. Hidden files are omitted: killed programs leave them, and
/// readers of whole folders ignore them.
pub fn parts(folder: &Path, table: &str) -> Vec<PathBuf> {
    let Ok(entries) = std::fs::read_dir(folder.join(table)) else { return Vec::new() };
    let mut parts: Vec<_> = entries.map(|entry| entry.expect("an entry").path()).collect();
    parts.retain(|part| part.file_name().is_some_and(|it| it.as_encoded_bytes()[0] != b'.'));
    parts.sort();
    parts
}

/// Reads a table in Parquet from all its files.
pub fn parquet(folder: &Path, table: &str) -> Columns {
    let mut columns = Columns::new();
    for part in parts(folder, table) {
        let file = File::open(&part).expect("a part");
        let reader = SerializedFileReader::new(file).expect("a whole part");
        for row in reader.get_row_iter(None).expect("rows") {
            for (name, field) in row.expect("a row").get_column_iter() {
                let cell = match field {
                    Field::Double(number) => Cell::from(*number),
                    Field::Long(number) => Cell::Whole(u64::try_from(*number).expect("no sign")),
                    Field::Bool(flag) => Cell::Flag(*flag),
                    Field::Str(word) => Cell::Word(word.clone()),
                    Field::Null => Cell::Nothing,
                    other => panic!("{name} is {other}"),
                };
                columns.entry(name.clone()).or_default().push(cell);
            }
        }
    }
    columns
}

/// Returns the metadata of one Parquet file of a table.
pub fn metadata(part: &Path) -> BTreeMap<String, String> {
    let reader = SerializedFileReader::new(File::open(part).expect("a part")).expect("a part");
    let pairs = reader.metadata().file_metadata().key_value_metadata().expect("metadata");
    pairs.iter().map(|pair| (pair.key.clone(), pair.value.clone().unwrap_or_default())).collect()
}

/// Reads a table in CSV. Its columns get the types of the columns with the same names in the table `like`.
pub fn csv(path: &Path, like: &Columns) -> Columns {
    let mut reader =
        csv::ReaderBuilder::new().comment(Some(b'#')).from_path(path).expect("a table");
    let names = reader.headers().expect("a header").clone();
    let mut columns = Columns::new();
    for record in reader.records() {
        for (name, said) in names.iter().zip(&record.expect("a row as wide as the header")) {
            let kind = like[name].iter().find(|cell| **cell != Cell::Nothing);
            let cell = match kind {
                Some(Cell::Word(_)) => Cell::Word(said.to_owned()),
                _ if said.is_empty() => Cell::Nothing,
                Some(Cell::Whole(_)) => Cell::Whole(said.parse().expect("a whole number")),
                Some(Cell::Flag(_)) => Cell::Flag(said.parse().expect("true or false")),
                _ => Cell::from(said.parse::<f64>().expect("a number")),
            };
            columns.entry(name.to_owned()).or_default().push(cell);
        }
    }
    columns
}

/// Returns the step numbers that occur in a table's rows, each once.
pub fn steps(columns: &Columns) -> Vec<u64> {
    let mut steps: Vec<u64> = columns.get("step").into_iter().flatten().map(whole).collect();
    assert!(steps.is_sorted(), "rows rise by their steps");
    steps.dedup();
    steps
}

pub fn whole(cell: &Cell) -> u64 {
    match cell {
        Cell::Whole(number) => *number,
        other => panic!("{other:?} is no whole number"),
    }
}

pub fn number(cell: &Cell) -> f64 {
    match cell {
        Cell::Number(bits) => f64::from_bits(*bits),
        other => panic!("{other:?} is no number"),
    }
}
