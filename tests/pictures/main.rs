//! Tests of pictures of stored states and of figures of studies, by comparison with stored pictures.

#[path = "../common/program.rs"]
mod program;

mod golden;
mod study_figures;
