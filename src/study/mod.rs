//! Runs of scenes: one to given times, the sets that the paper's figures show, and sweeps over
//! parameters.

mod alarms;
mod axis;
pub mod chart;
mod collection;
mod course;
mod figures;
mod journal;
mod machine;
mod outcome;
mod paper;
mod performance;
mod plan;
mod planned_run;
mod record;
mod run;
mod shard;
mod speed;
pub mod stability;
mod states;
mod statistics;
mod sweep;
mod table;
mod validate;

pub(crate) use course::series_path;
pub(crate) use figures::{figure_names, reproduce};
pub(crate) use outcome::{Outcome, Status};
#[cfg(feature = "window")]
pub(crate) use paper::PILE_SOLVER;
pub(crate) use paper::{
    FIG4_BONDS, FIG4_TIME_STEPS_SECS, FIG7_TIME_STEPS_SECS, FIG7_TIMES_SECS, PaperRun, paper_runs,
};
pub use plan::{SeriesSettings, Study};
pub use planned_run::PlannedRun;
pub use run::{OnItsWay, Recorded, Recorder, go_on, record};
pub(crate) use shard::Shard;
pub(crate) use speed::{ChartOptions, ChartPart, chart_speed, default_peers_folder};
#[cfg(feature = "window")]
pub(crate) use states::settled_pile;
#[cfg(feature = "window")]
pub(crate) use statistics::mean;
pub(crate) use sweep::{SweepOptions, merge, sweep};
pub(crate) use table::RunsTable;
#[cfg(feature = "window")]
pub(crate) use validate::Verdict;
pub(crate) use validate::{ValidateOptions, experiment_names, validate};
