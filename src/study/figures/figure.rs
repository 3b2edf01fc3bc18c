//! What a figure consists of.

use super::table::Table;
use super::verdict::Claim;
use crate::study::chart::Sheet;

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
