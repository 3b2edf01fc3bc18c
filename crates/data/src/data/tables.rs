//! The tables of a recording one by one, for those who want no whole frame.

use super::columns;
use super::table::Table;
use crate::granular::{GrainMeasures, PileMeasures, histograms};
use crate::sim::{Moment, Observables};

impl Table {
    /// A row a grain, then a row a fixed disc.
    pub fn of_grains(moment: &Moment) -> Self {
        columns::grains(moment, &GrainMeasures::of_each(moment))
    }

    /// A row a contact.
    pub fn of_contacts(moment: &Moment) -> Self {
        columns::contacts(moment)
    }

    /// One row, of the whole pile.
    pub fn of_measures(moment: &Moment) -> Self {
        columns::measures(Some((&moment.observables, &PileMeasures::of(moment))))
    }

    /// A row a bin of each histogram.
    pub fn of_histograms(moment: &Moment) -> Self {
        columns::histograms(&moment.observables, &histograms(moment))
    }

    /// A row a step.
    pub fn of_steps(rows: &[Observables]) -> Self {
        columns::steps(rows)
    }
}
