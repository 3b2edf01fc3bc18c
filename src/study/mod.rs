//! Runs of scenes: one to given times, and the sets that the paper's figures show.

mod paper;
mod run;

pub use paper::{
    FIG4_BONDS, FIG4_TIME_STEPS_SECS, FIG7_TIME_STEPS_SECS, FIG7_TIMES_SECS, PaperRun, paper_runs,
};
pub use run::{Recorded, record};
