//! Pictures of stored states and of studies, against those that are kept.

mod golden;
mod study_figures;
