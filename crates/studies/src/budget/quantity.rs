//! Defines the quantities of an error budget, and evaluates them during a run. A quantity is a column of the tables
//! `steps` or `measures`, or a property of the shape of a heap. Its value is the last value in an interval of simulated
//! time, or the mean, minimum, maximum or total over the interval.

use crate::column_spec::{CellValue, ColumnSpec};
use crate::data::STEP_COLUMNS;
use crate::error::{Error, Result};
use crate::granular::{HeapShape, PileMeasures};
use crate::sim::{Observables, Simulation};

/// Approximate number of times at which columns of the table `measures` are evaluated in the examined interval of
/// simulated time. The number is small, because one evaluation takes as long as several steps.
const MOMENTS: u64 = 100;

/// A function that returns a statistic, such as the mean, of a column's values in the examined interval of simulated
/// time.
type Statistic = fn(&Found) -> f64;

const STATISTICS: [(&str, Statistic); 4] = [
    ("mean", |found| found.sum / found.count as f64),
    // Comparisons with NaN are false, so the stored minimum and maximum can miss a NaN. The sum cannot.
    ("min", |found| if found.sum.is_nan() { f64::NAN } else { found.least }),
    ("max", |found| if found.sum.is_nan() { f64::NAN } else { found.most }),
    ("total", |found| found.sum),
];

#[derive(Clone, Copy)]
enum RecordedColumn {
    Steps(&'static ColumnSpec<Observables>),
    Measures(&'static ColumnSpec<PileMeasures>),
    Shape(&'static ColumnSpec<HeapShape>),
}

/// A quantity of an error budget: a numeric result of a run.
#[derive(Clone)]
pub(crate) struct BudgetQuantity {
    /// Name of the quantity as the user wrote it.
    pub name: String,
    /// Unit of the quantity; empty for a dimensionless quantity.
    pub unit: &'static str,
    /// Statistic (such as the mean) of the values in the examined interval of simulated time; `None` for the last value
    /// in the interval.
    statistic: Option<Statistic>,
    column: RecordedColumn,
}

impl std::str::FromStr for BudgetQuantity {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let of = text.split_once('(').and_then(|(statistic, rest)| {
            let known = STATISTICS.iter().find(|(name, _)| *name == statistic.trim())?;
            Some((Some(known.1), rest.strip_suffix(')')?.trim()))
        });
        let (statistic, column) = of.unwrap_or((None, text));
        let (column, unit) = column_of(column).ok_or_else(|| {
            let names = names().collect::<Vec<_>>().join(", ");
            let allowed = format!(
                "mean(x), min(x), max(x), total(x), or x itself for its last value, where x is \
                one of {names}"
            );
            Error::value("quantity", text, allowed)
        })?;
        let unit = if unit == "1" { "" } else { unit };
        Ok(Self { name: text.to_owned(), unit, statistic, column })
    }
}

/// True if a column contains results that are numbers. The columns `step`, `time` and `time_step` do not count as
/// results.
fn is_number<Row>(column: &ColumnSpec<Row>) -> bool {
    !matches!(column.name, "step" | "time" | "time_step")
        && !matches!(column.value, CellValue::Word(..) | CellValue::Name(_))
}

fn names() -> impl Iterator<Item = &'static str> {
    let of_steps = STEP_COLUMNS.iter().filter(|column| is_number(column)).map(|column| column.name);
    let is_new = |name: &&str| STEP_COLUMNS.iter().all(|column| column.name != *name);
    of_steps.chain(measures_of_moment().filter(is_new))
}

/// Returns the names of those quantities of an error budget that can be computed from the grains and contact forces at
/// a single simulated time.
pub(crate) fn measures_of_moment() -> impl Iterator<Item = &'static str> {
    let measures = PileMeasures::COLUMNS.iter().map(|column| column.name);
    measures.chain(HeapShape::COLUMNS.iter().map(|column| column.name))
}

fn column_of(name: &str) -> Option<(RecordedColumn, &'static str)> {
    let of_steps = STEP_COLUMNS.iter().find(|column| column.name == name && is_number(column));
    if let Some(column) = of_steps {
        return Some((RecordedColumn::Steps(column), column.unit));
    }
    if let Some(column) = HeapShape::COLUMNS.iter().find(|column| column.name == name) {
        return Some((RecordedColumn::Shape(column), column.unit));
    }
    let column = PileMeasures::COLUMNS.iter().find(|column| column.name == name)?;
    Some((RecordedColumn::Measures(column), column.unit))
}

/// The interval of simulated time in which results of a run are examined, s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Window {
    pub from_secs: f64,
    pub to_secs: f64,
}

/// Evaluates the quantities of an error budget during a run.
pub(super) struct QuantityWatch<'a> {
    quantities: &'a [BudgetQuantity],
    first: u64,
    last: u64,
    stride: u64,
    found: Vec<Found>,
}

#[derive(Clone, Copy)]
struct Found {
    sum: f64,
    count: u64,
    least: f64,
    most: f64,
    latest: f64,
}

impl<'a> QuantityWatch<'a> {
    pub(super) fn new(
        quantities: &'a [BudgetQuantity],
        window: Window,
        simulation: &Simulation,
    ) -> Self {
        let [first, last] = [window.from_secs, window.to_secs].map(|at| simulation.step_at(at));
        let stride = (last.saturating_sub(first) / MOMENTS).max(1);
        let (least, most) = (f64::INFINITY, f64::NEG_INFINITY);
        let none = Found { sum: 0.0, count: 0, least, most, latest: f64::NAN };
        Self { quantities, first, last, stride, found: vec![none; quantities.len()] }
    }

    /// Returns the number of steps from the start of the run to the end of the examined interval of simulated time.
    pub(super) fn steps(&self) -> u64 {
        self.last
    }

    pub(super) fn add(&mut self, simulation: &Simulation) {
        let row = simulation.observables();
        let is_last = row.step == self.last;
        if row.step <= self.first && !is_last {
            return;
        }
        let is_moment = is_last || (row.step - self.first).is_multiple_of(self.stride);
        let mut measured: Option<PileMeasures> = None;
        for (quantity, found) in self.quantities.iter().zip(&mut self.found) {
            if quantity.statistic.is_none() && !is_last {
                continue;
            }
            let value = match quantity.column {
                RecordedColumn::Steps(column) => column.value.number(row),
                _ if !is_moment => continue,
                RecordedColumn::Shape(column) => {
                    column.value.number(&HeapShape::of(&simulation.moment()))
                }
                RecordedColumn::Measures(column) => {
                    let moment = || PileMeasures::of(&simulation.moment());
                    column.value.number(measured.get_or_insert_with(moment))
                }
            };
            let value = value.unwrap_or(f64::NAN);
            found.sum += value;
            found.count += 1;
            // If `value` is NaN, both comparisons are false, and the NaN is stored.
            found.least = if value >= found.least { found.least } else { value };
            found.most = if value <= found.most { found.most } else { value };
            found.latest = value;
        }
    }

    /// Returns the values of all quantities after the run. A value can be NaN or infinite.
    pub(super) fn values(&self) -> Vec<f64> {
        let of = |(quantity, found): (&BudgetQuantity, &Found)| {
            quantity.statistic.map_or(found.latest, |statistic| statistic(found))
        };
        self.quantities.iter().zip(&self.found).map(of).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::built_in;
    use std::ops::ControlFlow;

    fn values(names: &[&str], window: Window) -> (Vec<f64>, Vec<Observables>) {
        let quantities: Vec<BudgetQuantity> =
            names.iter().map(|name| name.parse().expect("a quantity")).collect();
        let mut simulation = built_in("column").unwrap().simulation().unwrap();
        let mut watch = QuantityWatch::new(&quantities, window, &simulation);
        let mut rows = Vec::new();
        let steps = watch.steps();
        let run = simulation.run(steps, |simulation| {
            watch.add(simulation);
            rows.push(*simulation.observables());
            Ok(ControlFlow::Continue(()))
        });
        run.unwrap();
        (watch.values(), rows)
    }

    #[test]
    fn statistics_are_those_of_the_rows_of_the_window() {
        let names = [
            "kinetic_energy",
            "mean(kinetic_energy)",
            "max(kinetic_energy)",
            "total(gravity_work)",
        ];
        let (found, rows) = values(&names, Window { from_secs: 0.01, to_secs: 0.03 });
        let step = rows[0].time_step_secs;
        let inside: Vec<_> = rows.iter().filter(|row| row.time_secs > 0.01 + 0.5 * step).collect();
        assert_eq!(rows.len() as u64, (0.03 / step).round() as u64);
        let energies: Vec<f64> = inside.iter().map(|row| row.kinetic_energy).collect();
        let mean = energies.iter().sum::<f64>() / energies.len() as f64;
        assert_eq!(found[0], *energies.last().unwrap());
        assert!((found[1] / mean - 1.0).abs() < 1e-12, "{found:?}, {mean}");
        assert_eq!(found[2], energies.iter().copied().fold(0.0, f64::max));
        let work: f64 = inside.iter().map(|row| row.gravity_work).sum();
        assert!((found[3] - work).abs() < 1e-12 * work.abs().max(1e-12));
    }

    #[test]
    fn what_has_no_value_somewhere_has_none_and_measures_are_looked_at_to_the_end() {
        let names = ["bond_energy", "max(bond_energy)", "grains", "min(coordination)"];
        let (found, _) = values(&names, Window { from_secs: 0.0, to_secs: 0.02 });
        assert!(found[0].is_nan() && found[1].is_nan(), "{found:?}");
        assert_eq!(found[2], 20.0);
        assert!((0.0..=4.0).contains(&found[3]), "{found:?}");
    }

    #[test]
    fn unknown_quantities_are_refused_with_what_there_is() {
        for text in ["slumpp", "median(slump)", "max(slump", "max(step)", "time", ""] {
            let error = text.parse::<BudgetQuantity>().err().expect(text).to_string();
            assert!(error.starts_with("quantity is") && error.contains("coordination"), "{error}");
        }
    }
}
