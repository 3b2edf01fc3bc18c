//! Runs of scenes: one to given times, the sets that the paper's figures show, and sweeps over
//! parameters.

mod axis;
pub mod chart;
mod collection;
mod figures;
mod journal;
mod outcome;
mod paper;
mod performance;
mod plan;
mod run;
mod shard;
mod speed;
pub mod stability;
mod states;
mod statistics;
mod sweep;
mod table;

pub use collection::{CollectedStep, CollectionPlan, collect};
pub use figures::{figure_names, reproduce};
pub use outcome::{Outcome, Status, run_to_end};
pub use paper::{
    FIG4_BONDS, FIG4_TIME_STEPS_SECS, FIG7_TIME_STEPS_SECS, FIG7_TIMES_SECS, PaperRun, paper_runs,
};
pub use plan::{PlannedRun, SeriesSettings, Study};
pub use run::{Recorded, record};
pub use shard::Shard;
pub use speed::{ChartOptions, ChartPart, chart_speed, default_peers_folder};
pub use sweep::{SweepOptions, merge, series_path, sweep};
pub use table::RunsTable;
