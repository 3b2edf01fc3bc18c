//! Tests of the program `slump` from outside: options, error messages, files, studies, and runs that are stopped, saved
//! and resumed.

#[path = "../common/mod.rs"]
mod common;
#[path = "../common/probed.rs"]
mod probed;
#[path = "../common/program.rs"]
mod program;

mod calibration;
mod command_line;
mod documents;
mod error_budget;
mod foreign_files;
mod house;
mod import_arrows;
mod limits;
mod machine_limits;
mod output_places;
mod restart;
mod scene_errors;
mod sizes;
mod stopped_runs;
mod study_sweep;
mod video;
