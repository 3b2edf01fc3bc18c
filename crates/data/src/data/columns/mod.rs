//! The tables of a recording: which columns they have, and what these hold.

mod contacts;
mod frames;
mod grains;
mod measured;
mod steps;

pub(super) use contacts::contacts;
use contacts::empty_contacts;
pub(super) use frames::{FrameRow, frames};
pub(super) use grains::{FIXED, GRAIN, KINDS, LOST, empty_grains, grains};
pub(super) use measured::{histograms, measures};
pub use steps::Observed;
pub(super) use steps::steps;

use super::table::Table;
use crate::sim::Observables;

/// The tables that formats write, without a row: those of frames, and that of steps.
pub(super) fn empty_tables() -> ([Table; 4], Table) {
    let histograms = histograms(&Observables::default(), &[]);
    ([empty_grains(), empty_contacts(), measures(None), histograms], steps(&[]))
}
