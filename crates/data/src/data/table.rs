//! Defines tables of named columns, independent of file formats.

#[cfg(feature = "data")]
use crate::column_spec::STEP;
use crate::column_spec::{CellValue, ColumnSpec};

/// A table: columns with the same number of rows.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// Name of the table, which is a part of file names, such as `grains`.
    pub name: &'static str,
    /// Columns, in their order in files.
    pub columns: Vec<Column>,
}

/// One column of a table.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    /// Name of the column in files.
    pub name: &'static str,
    /// Unit; `1` for a dimensionless quantity, empty if the column is not a physical quantity (an id, for example).
    pub unit: &'static str,
    /// Description of the column, in a few words.
    pub about: &'static str,
    /// Values of the column, one per row.
    pub values: Values,
}

/// The values of a column.
#[derive(Clone, Debug, PartialEq)]
pub enum Values {
    /// Numbers.
    Numbers(Vec<f64>),
    /// Numbers; `None` for rows in which the number is missing.
    SomeNumbers(Vec<Option<f64>>),
    /// Whole numbers ≥ 0: ids and counts.
    Counts(Vec<u64>),
    /// True or false; `None` if the contact law does not define the property (a law without bonds, for example).
    Flags(Vec<Option<bool>>),
    /// Words from a short list, which belongs to the column.
    Words {
        /// List of the words that may occur in the column.
        words: Vec<String>,
        /// The index of each row's word in `words`.
        codes: Vec<u32>,
    },
}

/// Runs the same code on the list of values of a column, for every variant of [`Values`].
macro_rules! each_kind {
    ($values:expr, $list:ident => $work:expr) => {
        match $values {
            Values::Numbers($list) => $work,
            Values::SomeNumbers($list) => $work,
            Values::Counts($list) => $work,
            Values::Flags($list) => $work,
            Values::Words { codes: $list, .. } => $work,
        }
    };
}

impl Values {
    /// Returns the number of rows.
    pub fn len(&self) -> usize {
        each_kind!(self, list => list.len())
    }

    /// True if the column has no rows.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Returns the number in a row; NaN if the number is missing or the column has no numbers.
    pub(super) fn number(&self, row: usize) -> f64 {
        match self {
            Self::Numbers(numbers) => numbers[row],
            Self::SomeNumbers(numbers) => numbers[row].unwrap_or(f64::NAN),
            Self::Counts(counts) => counts[row] as f64,
            Self::Flags(_) | Self::Words { .. } => f64::NAN,
        }
    }

    /// Returns the word in a row; `None` if the column has no words.
    pub(super) fn word(&self, row: usize) -> Option<&str> {
        let Self::Words { words, codes } = self else { return None };
        words.get(codes[row] as usize).map(String::as_str)
    }

    /// Adds missing values at the end of a column until it has `rows` rows, and returns the result. Counts become
    /// numbers, because a number can be missing but a count cannot. Columns of words, and columns whose numbers cannot
    /// be missing, are returned unchanged.
    pub(super) fn padded(self, rows: usize) -> Self {
        match self {
            Self::SomeNumbers(mut numbers) => {
                numbers.resize(rows, None);
                Self::SomeNumbers(numbers)
            }
            Self::Counts(counts) => {
                let numbers = counts.into_iter().map(|count| Some(count as f64)).collect();
                Self::SomeNumbers(numbers).padded(rows)
            }
            Self::Flags(mut flags) => {
                flags.resize(rows, None);
                Self::Flags(flags)
            }
            others => others,
        }
    }

    #[cfg(feature = "data")]
    fn append(&mut self, others: &Self) {
        match (self, others) {
            (Self::Numbers(values), Self::Numbers(others)) => values.extend(others),
            (Self::SomeNumbers(values), Self::SomeNumbers(others)) => values.extend(others),
            (Self::Counts(values), Self::Counts(others)) => values.extend(others),
            (Self::Flags(values), Self::Flags(others)) => values.extend(others),
            (Self::Words { words, codes }, Self::Words { words: other_words, codes: others }) => {
                let places: Vec<u32> =
                    other_words.iter().map(|word| place_of(words, word)).collect();
                codes.extend(others.iter().map(|&code| places[code as usize]));
            }
            _ => unreachable!("a table's columns keep their kinds"),
        }
    }
}

/// Returns the index of a word in a list. If the list does not have the word, adds the word at the end.
pub(super) fn place_of(words: &mut Vec<String>, word: &str) -> u32 {
    let known = words.iter().position(|known| known == word);
    known.unwrap_or_else(|| {
        words.push(word.to_owned());
        words.len() - 1
    }) as u32
}

impl Column {
    /// Returns name, unit and meaning of the column in one line, such as `gap [m]: distance of the surfaces`, for
    /// formats that have no separate fields for unit and meaning. `name` is the column's name in the file.
    pub(super) fn described(&self, name: &str) -> String {
        let Self { unit, about, .. } = self;
        let unit = if unit.is_empty() { String::new() } else { format!(" [{unit}]") };
        format!("{name}{unit}: {about}")
    }

    /// Returns name, unit and meaning of the column in one line. If the column has words, the line also lists the
    /// number of each word, for formats that write words as numbers. The first word has the number `first_code`.
    pub(super) fn described_with_codes(&self, name: &str, first_code: u32) -> String {
        let codes = match &self.values {
            Values::Words { words, .. } => {
                let codes = words.iter().zip(first_code..);
                let codes: Vec<_> = codes.map(|(word, code)| format!("{code} {word}")).collect();
                format!(" ({})", codes.join(", "))
            }
            Values::Flags(_) => " (1 yes, 0 no, -1 neither)".to_owned(),
            _ => String::new(),
        };
        self.described(name) + &codes
    }
}

impl Table {
    /// Makes a table from rows, with the columns `specs`. The columns of type [`CellValue::Name`] state an index for
    /// each row; `names` is the list of words to which these indices refer.
    pub(super) fn new<Row>(
        name: &'static str,
        specs: &[ColumnSpec<Row>],
        rows: &[Row],
        names: &[String],
    ) -> Self {
        let values = |value: &CellValue<Row>| match value {
            CellValue::Number(of) => Values::Numbers(rows.iter().map(of).collect()),
            CellValue::SomeNumber(of) => Values::SomeNumbers(rows.iter().map(of).collect()),
            CellValue::Count(of) => Values::Counts(rows.iter().map(of).collect()),
            CellValue::Flag(of) => Values::Flags(rows.iter().map(of).collect()),
            CellValue::Word(words, of) => Values::Words {
                words: words.iter().map(|&word| word.to_owned()).collect(),
                codes: rows.iter().map(of).collect(),
            },
            CellValue::Name(of) => {
                Values::Words { words: names.to_owned(), codes: rows.iter().map(of).collect() }
            }
        };
        let columns = specs.iter().map(|ColumnSpec { name, unit, about, value }| Column {
            name,
            unit,
            about,
            values: values(value),
        });
        Self { name, columns: columns.collect() }
    }

    /// Returns this table with the columns of the table `more` added. If `more` has fewer rows, its columns are
    /// extended with missing values.
    pub(super) fn beside(mut self, more: Self) -> Self {
        let rows = self.len();
        self.columns.extend(more.columns.into_iter().map(|mut column| {
            column.values = column.values.padded(rows);
            column
        }));
        self
    }

    /// Returns the number of rows.
    pub fn len(&self) -> usize {
        self.columns.first().map_or(0, |column| column.values.len())
    }

    /// True if the table has no rows.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Returns the column with the given name; `None` if there is no such column.
    pub fn column(&self, name: &str) -> Option<&Column> {
        self.columns.iter().find(|column| column.name == name)
    }
}

/// Methods for tables to which rows are added and from which rows are removed.
#[cfg(feature = "data")]
impl Table {
    /// Adds the rows of a table with the same columns.
    pub(super) fn append(&mut self, other: &Self) {
        for (column, other) in self.columns.iter_mut().zip(&other.columns) {
            column.values.append(&other.values);
        }
    }

    /// Returns the number of the step of each row.
    pub(super) fn steps(&self) -> &[u64] {
        match self.column(STEP).map(|column| &column.values) {
            Some(Values::Counts(steps)) => steps,
            _ => &[],
        }
    }

    /// Removes the rows of all steps after `step`, or all rows if `step` is `None`.
    pub(super) fn keep_until(&mut self, step: Option<u64>) {
        let rows = self.steps().partition_point(|&there| Some(there) <= step);
        self.truncate(rows);
    }

    /// Removes all rows except the first `rows`.
    pub(super) fn truncate(&mut self, rows: usize) {
        for column in &mut self.columns {
            each_kind!(&mut column.values, list => list.truncate(rows));
        }
    }

    /// Returns the approximate size of the table in a file without compression, bytes.
    pub(super) fn size(&self) -> usize {
        let width = |column: &Column| match column.values {
            Values::Numbers(_) | Values::SomeNumbers(_) | Values::Counts(_) => 8,
            Values::Flags(_) | Values::Words { .. } => 1,
        };
        self.len() * self.columns.iter().map(width).sum::<usize>()
    }
}
