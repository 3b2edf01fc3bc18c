//! Columns of what is measured of a moment, as `granular` declares them.

use crate::data::table::{Column, Declared, Table, Value, Values, place_of, table};
use crate::granular::{self, GrainMeasures, Histogram, PileMeasures};
use crate::sim::Observables;

/// The columns of grains' measures. `None` is a disc that is no grain.
pub(super) fn of_grains(rows: &[Option<GrainMeasures>]) -> Vec<Column> {
    let column = |declared: &granular::Column<GrainMeasures>| {
        let values = match declared.value {
            granular::Value::Number(of) => {
                Values::SomeNumbers(rows.iter().map(|row| there(of(row.as_ref()?))).collect())
            }
            // A number, so that there may be none.
            granular::Value::Count(of) => {
                Values::SomeNumbers(rows.iter().map(|row| Some(of(row.as_ref()?) as f64)).collect())
            }
            granular::Value::Flag(of) => {
                Values::Flags(rows.iter().map(|row| row.as_ref().map(of)).collect())
            }
        };
        let granular::Column { name, unit, about, .. } = *declared;
        Column { name, unit, about, values }
    };
    GrainMeasures::COLUMNS.iter().map(column).collect()
}

/// A number that exists.
fn there(number: f64) -> Option<f64> {
    (!number.is_nan()).then_some(number)
}

/// What is measured of a whole pile at a step: a row, or none.
pub(in crate::data) fn measures(row: Option<(&Observables, &PileMeasures)>) -> Table {
    let now: Vec<Observables> = row.iter().map(|(observables, _)| **observables).collect();
    let of_step =
        [Declared::step(|now: &Observables| now.step), Declared::time(|now| now.time_secs)];
    let mut measures = table("measures", &of_step, &now, &[]);
    let pile = || row.iter().map(|(_, pile)| *pile);
    measures.columns.extend(PileMeasures::COLUMNS.iter().map(|declared| {
        let values = match declared.value {
            granular::Value::Number(of) => {
                Values::SomeNumbers(pile().map(|pile| there(of(pile))).collect())
            }
            granular::Value::Count(of) => Values::Counts(pile().map(of).collect()),
            granular::Value::Flag(of) => Values::Flags(pile().map(|pile| Some(of(pile))).collect()),
        };
        let granular::Column { name, unit, about, .. } = *declared;
        Column { name, unit, about, values }
    }));
    measures
}

struct Bin {
    step: u64,
    time_secs: f64,
    quantity: u32,
    unit: u32,
    from: f64,
    to: f64,
    count: u64,
}

const BINS: &[Declared<Bin>] = &[
    Declared::step(|bin| bin.step),
    Declared::time(|bin| bin.time_secs),
    Declared::new("quantity", "", "what is counted", Value::Name(|bin| bin.quantity)),
    Declared::new("unit", "", "unit of from and to", Value::Name(|bin| bin.unit)),
    Declared::number("from", "", "where the bin begins, which belongs to it", |bin| bin.from),
    Declared::number("to", "", "where it ends", |bin| bin.to),
    Declared::count("count", "how many are in it", |bin| bin.count),
];

/// A row a bin of each histogram.
pub(in crate::data) fn histograms(now: &Observables, histograms: &[Histogram]) -> Table {
    let mut words: Vec<String> = Vec::new();
    let (step, time_secs) = (now.step, now.time_secs);
    let mut bins = Vec::new();
    for Histogram { quantity, unit, edges, counts } in histograms {
        let (quantity, unit) = (place_of(&mut words, quantity), place_of(&mut words, unit));
        bins.extend(edges.windows(2).zip(counts).map(|(ends, &count)| {
            let [from, to] = [ends[0], ends[1]];
            Bin { step, time_secs, quantity, unit, from, to, count }
        }));
    }
    table("histograms", BINS, &bins, &words)
}
