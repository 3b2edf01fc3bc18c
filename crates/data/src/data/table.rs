//! Tables of named columns, whatever writes them.

/// A table: columns of one length.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// Its name, a part of names of files: `grains`.
    pub name: &'static str,
    /// Its columns, in the order in which files have them.
    pub columns: Vec<Column>,
}

/// One column.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    /// As files call it.
    pub name: &'static str,
    /// Its unit, `1` for what has none, empty for what is no quantity.
    pub unit: &'static str,
    /// What it is, in a few words.
    pub about: &'static str,
    /// A value a row.
    pub values: Values,
}

/// The values of a column.
#[derive(Clone, Debug, PartialEq)]
pub enum Values {
    /// Numbers.
    Numbers(Vec<f64>),
    /// Numbers that some rows do not have.
    SomeNumbers(Vec<Option<f64>>),
    /// Whole numbers: identities and counts.
    Counts(Vec<u64>),
    /// True, false, or neither where a law knows no such thing.
    Flags(Vec<Option<bool>>),
    /// Words of a short list.
    Words {
        /// The list.
        words: Vec<String>,
        /// Of each row, its word's place in the list.
        codes: Vec<u32>,
    },
}

impl Values {
    /// Number of rows.
    pub fn len(&self) -> usize {
        match self {
            Self::Numbers(values) => values.len(),
            Self::SomeNumbers(values) => values.len(),
            Self::Counts(values) => values.len(),
            Self::Flags(values) => values.len(),
            Self::Words { codes, .. } => codes.len(),
        }
    }

    /// Whether there is no row.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// The place of a word in a list, at whose end it is put where it is not there.
pub(super) fn place_of(words: &mut Vec<String>, word: &str) -> u32 {
    let known = words.iter().position(|known| known == word);
    known.unwrap_or_else(|| {
        words.push(word.to_owned());
        words.len() - 1
    }) as u32
}

/// Name of the column that every table has, and by which rows rise.
pub(super) const STEP: &str = "step";

impl Table {
    /// Number of rows.
    pub fn len(&self) -> usize {
        self.columns.first().map_or(0, |column| column.values.len())
    }

    /// Whether there is no row.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The column of that name.
    pub fn column(&self, name: &str) -> Option<&Column> {
        self.columns.iter().find(|column| column.name == name)
    }
}

/// How a column is made of rows of a kind.
pub(super) struct Declared<Row> {
    pub name: &'static str,
    pub unit: &'static str,
    pub about: &'static str,
    pub value: Value<Row>,
}

/// What a row has in a column.
pub(super) enum Value<Row> {
    Number(fn(&Row) -> f64),
    SomeNumber(fn(&Row) -> Option<f64>),
    Count(fn(&Row) -> u64),
    Flag(fn(&Row) -> Option<bool>),
    /// A word of a list that is known.
    Word(&'static [&'static str], fn(&Row) -> u32),
    /// A word of the list that goes with the rows.
    Name(fn(&Row) -> u32),
}

impl<Row> Declared<Row> {
    /// The column by which rows rise.
    pub(super) const fn step(of: fn(&Row) -> u64) -> Self {
        let about = "steps since the start";
        Self { name: STEP, unit: "", about, value: Value::Count(of) }
    }

    /// A column of any values.
    pub(super) const fn new(
        name: &'static str,
        unit: &'static str,
        about: &'static str,
        value: Value<Row>,
    ) -> Self {
        Self { name, unit, about, value }
    }

    /// A column of numbers.
    pub(super) const fn number(
        name: &'static str,
        unit: &'static str,
        about: &'static str,
        of: fn(&Row) -> f64,
    ) -> Self {
        Self::new(name, unit, about, Value::Number(of))
    }

    /// A column of counts.
    pub(super) const fn count(
        name: &'static str,
        about: &'static str,
        of: fn(&Row) -> u64,
    ) -> Self {
        Self::new(name, "", about, Value::Count(of))
    }

    /// The time of the step.
    pub(super) const fn time(of: fn(&Row) -> f64) -> Self {
        Self { name: "time", unit: "s", about: "simulated time", value: Value::Number(of) }
    }
}

/// The table of some rows, with the list of names that they refer to.
pub(super) fn table<Row>(
    name: &'static str,
    declared: &[Declared<Row>],
    rows: &[Row],
    names: &[String],
) -> Table {
    let values = |value: &Value<Row>| match value {
        Value::Number(of) => Values::Numbers(rows.iter().map(of).collect()),
        Value::SomeNumber(of) => Values::SomeNumbers(rows.iter().map(of).collect()),
        Value::Count(of) => Values::Counts(rows.iter().map(of).collect()),
        Value::Flag(of) => Values::Flags(rows.iter().map(of).collect()),
        Value::Word(words, of) => Values::Words {
            words: words.iter().map(|&word| word.to_owned()).collect(),
            codes: rows.iter().map(of).collect(),
        },
        Value::Name(of) => {
            Values::Words { words: names.to_owned(), codes: rows.iter().map(of).collect() }
        }
    };
    let column = |Declared { name, unit, about, value }: &Declared<Row>| Column {
        name,
        unit,
        about,
        values: values(value),
    };
    Table { name, columns: declared.iter().map(column).collect() }
}
