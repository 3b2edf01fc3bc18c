//! What a figure consists of.

use super::table::Table;
use super::verdict::Claim;
use crate::chart::{Point, Sheet};
use crate::statistics::mean;

/// A finished figure.
pub(super) struct Figure {
    /// Name of its files.
    pub name: &'static str,
    /// What is drawn.
    pub sheet: Sheet,
    /// What it says of the paper's claims.
    pub claims: Vec<Claim>,
    /// The numbers behind them, where the chart shows too few.
    pub table: Option<Table>,
}

/// The mean of some slumps on a chart.
pub(super) fn slump_point(x: f64, slumps: &[f64]) -> Point {
    let told = mean(slumps);
    // Two states tell next to nothing of their spread.
    let interval = (told.count > 2).then_some((told.low.max(0.0), told.high.min(0.7)));
    Point { x, y: told.mean, interval }
}
