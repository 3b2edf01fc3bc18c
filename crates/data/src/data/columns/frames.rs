//! The table of the frames that are there.

use crate::data::table::{Declared, Table, table};

/// A frame that is there in every format.
pub(in crate::data) struct FrameRow {
    pub step: u64,
    pub time_secs: f64,
    pub number: u64,
}

const COLUMNS: &[Declared<FrameRow>] = &[
    Declared::step(|row| row.step),
    Declared::time(|row| row.time_secs),
    Declared::count("number", "frames before this one", |row| row.number),
];

/// A row a frame.
pub(in crate::data) fn frames(rows: &[FrameRow]) -> Table {
    table("frames", COLUMNS, rows, &[])
}
