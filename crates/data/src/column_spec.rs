//! How the columns of a table are made of rows of a kind: declared once, for whatever shows or writes them.

/// A column as it is declared.
#[derive(Clone, Copy, Debug)]
pub struct ColumnSpec<Row: 'static> {
    /// Its name in tables.
    pub name: &'static str,
    /// Its unit, `1` for what has none, empty for what is no quantity.
    pub unit: &'static str,
    /// What it is, in a few words or sentences.
    pub about: &'static str,
    /// What a row has in it.
    pub value: CellValue<Row>,
}

/// How the value of a column is had from a row.
#[derive(Clone, Copy, Debug)]
pub enum CellValue<Row: 'static> {
    /// A number.
    Number(fn(&Row) -> f64),
    /// A number that some rows do not have.
    SomeNumber(fn(&Row) -> Option<f64>),
    /// A whole number.
    Count(fn(&Row) -> u64),
    /// Whether something is so; neither where a law knows no such thing.
    Flag(fn(&Row) -> Option<bool>),
    /// A word of a list that is known, by its place there.
    Word(&'static [&'static str], fn(&Row) -> u32),
    /// A word of the list that goes with the rows, by its place there.
    Name(fn(&Row) -> u32),
}

impl<Row> CellValue<Row> {
    /// The value as a number, in a row that has one; 1 and 0 stand for what is so and what is not.
    pub fn number(&self, row: &Row) -> Option<f64> {
        match self {
            Self::Number(of) => Some(of(row)),
            Self::SomeNumber(of) => of(row),
            Self::Count(of) => Some(of(row) as f64),
            Self::Flag(of) => of(row).map(|is_so| u8::from(is_so).into()),
            Self::Word(..) | Self::Name(_) => None,
        }
    }
}

/// Name of the column that every table has, and by which rows rise.
pub(crate) const STEP: &str = "step";

/// Columns of each kind of values.
impl<Row> ColumnSpec<Row> {
    pub(crate) const fn new(
        name: &'static str,
        unit: &'static str,
        about: &'static str,
        value: CellValue<Row>,
    ) -> Self {
        Self { name, unit, about, value }
    }

    pub(crate) const fn step(of: fn(&Row) -> u64) -> Self {
        Self::count(STEP, "steps since the start", of)
    }

    pub(crate) const fn time(of: fn(&Row) -> f64) -> Self {
        Self::number("time", "s", "simulated time", of)
    }

    pub(crate) const fn number(
        name: &'static str,
        unit: &'static str,
        about: &'static str,
        of: fn(&Row) -> f64,
    ) -> Self {
        Self::new(name, unit, about, CellValue::Number(of))
    }

    pub(crate) const fn some_number(
        name: &'static str,
        unit: &'static str,
        about: &'static str,
        of: fn(&Row) -> Option<f64>,
    ) -> Self {
        Self::new(name, unit, about, CellValue::SomeNumber(of))
    }

    pub(crate) const fn count(
        name: &'static str,
        about: &'static str,
        of: fn(&Row) -> u64,
    ) -> Self {
        Self::new(name, "", about, CellValue::Count(of))
    }

    pub(crate) const fn flag(
        name: &'static str,
        about: &'static str,
        of: fn(&Row) -> Option<bool>,
    ) -> Self {
        Self::new(name, "", about, CellValue::Flag(of))
    }

    pub(crate) const fn word(
        name: &'static str,
        about: &'static str,
        words: &'static [&'static str],
        of: fn(&Row) -> u32,
    ) -> Self {
        Self::new(name, "", about, CellValue::Word(words, of))
    }

    pub(crate) const fn name(name: &'static str, about: &'static str, of: fn(&Row) -> u32) -> Self {
        Self::new(name, "", about, CellValue::Name(of))
    }
}
