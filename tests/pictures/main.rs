//! Pictures of stored states and of studies, against those that are kept.

#[path = "../common/program.rs"]
mod program;

mod golden;
mod study_figures;
