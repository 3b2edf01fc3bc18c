//! What tables say of a number beside its value.

/// A number of a kind of row.
#[derive(Clone, Copy, Debug)]
pub struct Column<Row: 'static> {
    /// Its name in tables.
    pub name: &'static str,
    /// Its unit; 1 where it has none.
    pub unit: &'static str,
    /// What it is, in a sentence or two.
    pub about: &'static str,
    /// Its value.
    pub value: Value<Row>,
}

/// How the value of a column is had from a row.
#[derive(Clone, Copy, Debug)]
pub enum Value<Row: 'static> {
    /// A number; NaN where there is none.
    Number(fn(&Row) -> f64),
    /// A count.
    Count(fn(&Row) -> u64),
    /// Whether something is so.
    Flag(fn(&Row) -> bool),
}

impl<Row> Value<Row> {
    /// The value as a number: what is so is 1, what is not is 0.
    pub fn number(&self, row: &Row) -> f64 {
        match self {
            Self::Number(of) => of(row),
            Self::Count(of) => of(row) as f64,
            Self::Flag(of) => f64::from(of(row)),
        }
    }
}

/// Declares a kind of row once: a structure, and a [`Column`] for each field, whose unit follows its type.
macro_rules! columns {
    (@value f64 $field:ident) => {
        $crate::granular::Value::Number(|row| row.$field)
    };
    (@value u32 $field:ident) => {
        $crate::granular::Value::Count(|row| u64::from(row.$field))
    };
    (@value bool $field:ident) => {
        $crate::granular::Value::Flag(|row| row.$field)
    };
    (
        $(#[$meta:meta])* $vis:vis struct $Name:ident {
            $($(#[doc = $about:literal])+ $field:ident: $type:ident, $unit:literal;)*
        }
    ) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
        $vis struct $Name {
            $(
                $(#[doc = $about])+
                #[doc = concat!("\n\nUnit: ", $unit, ".")]
                pub $field: $type,
            )*
        }

        impl $Name {
            /// The fields, in the order of the declaration.
            pub const COLUMNS: &'static [$crate::granular::Column<Self>] = &[$(
                $crate::granular::Column {
                    name: stringify!($field),
                    unit: $unit,
                    about: concat!($($about),+).trim_ascii(),
                    value: columns!(@value $type $field),
                },
            )*];
        }
    };
}

pub(super) use columns;
