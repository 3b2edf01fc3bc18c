//! Runs of scenes: one to given times, the sets that the paper's figures show, and sweeps over
//! parameters.

#![warn(missing_docs, unreachable_pub)]
// They panic where a stream is closed or full: `output` has lines that do not.
#![cfg_attr(not(test), warn(clippy::print_stdout, clippy::print_stderr))]

use slump_core::{contact, error, number, scene, sim, solver, world};
use slump_data::{column_spec, config, data, granular, input, output};

mod budget;
pub mod chart;
mod figures;
mod fracture_work;
mod journal;
mod machine;
mod means;
mod paper;
mod plan;
pub mod png;
mod report;
mod results;
mod run;
mod runner;
mod series;
mod speed;
pub mod stability;
mod states;
mod statistics;
mod sweep;
mod sweep_chart;
mod validate;

pub use budget::{BudgetOptions, ErrorBudget, Trust, budget, made as made_budget};
pub use figures::{figure_names, reproduce};
pub use means::write_means;
pub use paper::{
    FIG4_BONDS, FIG4_TIME_STEPS_SECS, FIG7_TIME_STEPS_SECS, FIG7_TIMES_SECS, PaperRun, paper_runs,
};
pub use plan::{PlannedRun, SeriesSettings, Study};
pub use results::{RunResult, RunsTable, Status};
pub use run::{OnItsWay, Recorded, Recorder, go_on, record};
pub use series::series_path;
pub use speed::{ChartOptions, ChartPart, chart_speed};
pub use states::settled_pile;
pub use statistics::{Mean, mean};
pub use sweep::{Shard, SweepOptions, merge, sweep};
pub use sweep_chart::SweepChart;
pub use validate::{ValidateOptions, validate};
