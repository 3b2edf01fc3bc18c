//! Runs scenes of grains: single runs with snapshots, the sets of runs behind the figures of Abramian & Staron (2020,
//! hal-02570097), sweeps over parameters, error budgets, calibrations, charts of the speed of solvers, stability tests
//! and validation experiments.

#![warn(missing_docs, unreachable_pub)]
// `println!` and `eprintln!` panic if a stream is closed or full. The functions of `output` do not panic.
#![cfg_attr(not(test), warn(clippy::print_stdout, clippy::print_stderr))]

use slump_core::{contact, error, number, scene, setting, sim, solver, world};
use slump_data::{column_spec, config, data, granular, input, output};

mod budget;
mod calibrate;
pub mod chart;
mod figures;
mod fracture_work;
mod harness;
mod paper;
pub mod png;
mod run;
mod speed;
pub mod stability;
mod states;
mod statistics;
mod sweep;
mod validate;

pub use budget::{
    BudgetAnswer, BudgetEffect, BudgetOptions, ErrorBudget, FEW_UNSOLVED, Trust, budget,
    made as made_budget,
};
pub use calibrate::{CalibrateOptions, Region, calibrate};
pub use figures::{figure_names, reproduce};
pub use harness::Shard;
pub use paper::{
    FIG4_BONDS, FIG4_TIME_STEPS_SECS, FIG7_TIME_STEPS_SECS, FIG7_TIMES_SECS, PaperRun, paper_runs,
};
pub use run::{OnItsWay, Recorded, Recorder, go_on, record};
pub use speed::{ChartOptions, ChartPart, chart_speed};
pub use states::settled_pile;
pub use statistics::{Mean, mean};
pub use sweep::{
    PlannedRun, RunResult, RunsTable, SeriesSettings, Status, Study, SweepChart, SweepOptions,
    merge, series_path, sweep, write_means,
};
pub use validate::{ValidateOptions, validate};
