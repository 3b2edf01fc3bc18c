//! Pictures of stored states and of studies, against stored pictures.

#[path = "../common/program.rs"]
mod program;

mod golden;
mod study_figures;
