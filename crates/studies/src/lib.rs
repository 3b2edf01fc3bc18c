//! Runs of scenes: one to given times, the sets that the paper's figures show, and sweeps over
//! parameters.

#![warn(missing_docs, unreachable_pub)]
// They panic where a stream is closed or full: `output` has lines that do not.
#![cfg_attr(not(test), warn(clippy::print_stdout, clippy::print_stderr))]

use slump_core::{contact, error, number, scene, sim, solver, world};
use slump_data::{config, data, granular, output};

mod alarms;
mod axis;
pub mod chart;
mod course;
mod figures;
mod journal;
mod machine;
mod outcome;
mod paper;
mod plan;
mod planned_run;
pub mod png;
mod record;
mod run;
mod runner;
mod shard;
mod speed;
pub mod stability;
mod states;
mod statistics;
pub mod sweep;
mod table;
pub mod validate;

pub use course::series_path;
pub use figures::{figure_names, reproduce};
pub use outcome::{Outcome, Status};
pub use paper::PILE_SOLVER;
pub use paper::{
    FIG4_BONDS, FIG4_TIME_STEPS_SECS, FIG7_TIME_STEPS_SECS, FIG7_TIMES_SECS, PaperRun, paper_runs,
};
pub use plan::{SeriesSettings, Study};
pub use planned_run::PlannedRun;
pub use run::{OnItsWay, Recorded, Recorder, go_on, record};
pub use shard::Shard;
pub use speed::{ChartOptions, ChartPart, chart_speed};
pub use states::settled_pile;
pub use statistics::{Mean, mean};
pub use sweep::{SweepOptions, merge, sweep};
pub use table::RunsTable;
pub use validate::Agreement as Verdict;
pub use validate::{ValidateOptions, experiment_names, validate};
