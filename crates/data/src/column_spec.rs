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
    /// True if something is so; neither where a law knows no such thing.
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

pub(crate) const fn column<Row>(
    name: &'static str,
    unit: &'static str,
    about: &'static str,
    value: CellValue<Row>,
) -> ColumnSpec<Row> {
    ColumnSpec { name, unit, about, value }
}

impl<Row> ColumnSpec<Row> {
    pub(crate) const fn step(of: fn(&Row) -> u64) -> Self {
        column(STEP, "", "steps since the start", CellValue::Count(of))
    }

    pub(crate) const fn time(of: fn(&Row) -> f64) -> Self {
        column("time", "s", "simulated time", CellValue::Number(of))
    }
}
