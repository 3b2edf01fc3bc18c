//! Tables whose rows become more, and fewer again.

use crate::data::table::{STEP, Table, Values, place_of};

impl Values {
    /// Adds the rows of a column of the same kind.
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
            (
                Self::Numbers(_)
                | Self::SomeNumbers(_)
                | Self::Counts(_)
                | Self::Flags(_)
                | Self::Words { .. },
                _,
            ) => unreachable!("a table's columns keep their kinds"),
        }
    }

    fn truncate(&mut self, rows: usize) {
        match self {
            Self::Numbers(values) => values.truncate(rows),
            Self::SomeNumbers(values) => values.truncate(rows),
            Self::Counts(values) => values.truncate(rows),
            Self::Flags(values) => values.truncate(rows),
            Self::Words { codes, .. } => codes.truncate(rows),
        }
    }

    /// Bytes that a row takes where nothing is compressed.
    fn width(&self) -> usize {
        match self {
            Self::Numbers(_) | Self::SomeNumbers(_) | Self::Counts(_) => 8,
            Self::Flags(_) | Self::Words { .. } => 1,
        }
    }
}

impl Table {
    /// Adds the rows of a table of the same columns.
    pub(super) fn append(&mut self, other: &Self) {
        for (column, other) in self.columns.iter_mut().zip(&other.columns) {
            column.values.append(&other.values);
        }
    }

    /// The steps of the rows.
    pub(super) fn steps(&self) -> &[u64] {
        match self.column(STEP).map(|column| &column.values) {
            Some(Values::Counts(steps)) => steps,
            _ => &[],
        }
    }

    /// Drops the rows after a step, or all.
    pub(super) fn keep_until(&mut self, step: Option<u64>) {
        let rows = self.steps().partition_point(|&there| Some(there) <= step);
        for column in &mut self.columns {
            column.values.truncate(rows);
        }
    }

    /// Drops all rows.
    pub(super) fn clear(&mut self) {
        for column in &mut self.columns {
            column.values.truncate(0);
        }
    }

    /// Bytes that it takes where nothing is compressed, about.
    pub(super) fn size(&self) -> usize {
        self.len() * self.columns.iter().map(|column| column.values.width()).sum::<usize>()
    }
}
