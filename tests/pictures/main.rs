//! Tests of pictures of stored states and of figures that are computed from many simulations, by comparison with stored
//! pictures.

#[path = "../common/program.rs"]
mod program;

mod golden;
mod study_figures;
