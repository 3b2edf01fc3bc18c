//! Declarations of table columns, one list for each kind of row. Everything that shows or writes a column uses them.

/// The declaration of a column.
#[derive(Clone, Copy, Debug)]
pub struct ColumnSpec<Row: 'static> {
    /// Name of the column in tables.
    pub name: &'static str,
    /// Unit; `1` for a dimensionless quantity, empty if the column is not a quantity.
    pub unit: &'static str,
    /// Description, in a few words or sentences.
    pub about: &'static str,
    /// Function that gives the value of a row.
    pub value: CellValue<Row>,
}

/// Kind of a column's value, with the function that takes it from a row.
#[derive(Clone, Copy, Debug)]
pub enum CellValue<Row: 'static> {
    /// A number.
    Number(fn(&Row) -> f64),
    /// A number that some rows do not have.
    SomeNumber(fn(&Row) -> Option<f64>),
    /// A whole number.
    Count(fn(&Row) -> u64),
    /// True or false; `None` if the contact law does not define it.
    Flag(fn(&Row) -> Option<bool>),
    /// A word from a fixed list, by its index.
    Word(&'static [&'static str], fn(&Row) -> u32),
    /// A word from the table's own list of names, by its index.
    Name(fn(&Row) -> u32),
}

impl<Row> CellValue<Row> {
    /// The value as a number, if the row has one; true is 1 and false is 0.
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

/// Name of the column `step`, which every table has and by which its rows are sorted.
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
