//! Defines how a column of a table is declared: by name, unit, description, and a function that reads the value from a
//! row. Each type of row has one list of such declarations. All code that shows or writes a table with rows of this
//! type uses this list.

/// Declaration of one column of a table with rows of the type `Row`.
#[derive(Clone, Copy, Debug)]
pub struct ColumnSpec<Row: 'static> {
    /// Name of the column in tables.
    pub name: &'static str,
    /// Unit; `1` for a dimensionless quantity, empty if the column is not a physical quantity (an id, for example).
    pub unit: &'static str,
    /// Description of the column, in a few words or sentences.
    pub about: &'static str,
    /// Type of the column's values (number, count, flag or word), with the function that reads the value from a row.
    pub value: CellValue<Row>,
}

/// Type of a column's values (number, count, flag or word), with the function that reads the value from a row.
#[derive(Clone, Copy, Debug)]
pub enum CellValue<Row: 'static> {
    /// A number.
    Number(fn(&Row) -> f64),
    /// A number that is missing (`None`) in some rows.
    SomeNumber(fn(&Row) -> Option<f64>),
    /// A whole number ≥ 0.
    Count(fn(&Row) -> u64),
    /// True or false; `None` if the contact law does not define the property (a law without bonds, for example).
    Flag(fn(&Row) -> Option<bool>),
    /// A word from a fixed list. The function returns the index of the word in the list.
    Word(&'static [&'static str], fn(&Row) -> u32),
    /// A name from a list that is made together with the table, such as the materials of the scene. The function
    /// returns the index of the name in that list.
    Name(fn(&Row) -> u32),
}

impl<Row> CellValue<Row> {
    /// Returns the column's value in a row as a number (true is 1 and false is 0); `None` if the value is missing, a
    /// word or a name.
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

/// Name of the column with the number of the step since the start of the run. Every table of a recording has this
/// column, and the rows of a table are sorted by it.
pub(crate) const STEP: &str = "step";

/// Makes the list of the columns of a table: name, unit, type of the values with the value in a row, and description of
/// each column. `step and time of` puts the columns with step and time of a row first.
macro_rules! table_columns {
    (step and time of $row:ident; $($columns:tt)*) => {
        table_columns! { $row;
            $crate::column_spec::STEP, "", Count($row.step), "steps since the start";
            "time", "s", Number($row.time_secs), "simulated time";
            $($columns)*
        }
    };
    ($row:ident; $($name:expr, $unit:literal, $kind:ident($($value:expr),+), $about:expr;)*) => {
        &[$($crate::column_spec::ColumnSpec {
            name: $name,
            unit: $unit,
            about: $about,
            value: table_columns!(@$kind $row, $($value),+),
        }),*]
    };
    (@$kind:ident $row:ident, $value:expr) => {
        $crate::column_spec::CellValue::$kind(|$row| $value)
    };
    (@$kind:ident $row:ident, $words:expr, $value:expr) => {
        $crate::column_spec::CellValue::$kind($words, |$row| $value)
    };
}

pub(crate) use table_columns;
