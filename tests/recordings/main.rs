//! Recordings and problem files: what is in them, what stays of them, and what is read back.

#[path = "../common/columnar.rs"]
mod columnar;
#[path = "../common/mod.rs"]
mod common;
#[path = "../common/program.rs"]
mod program;

mod data;
mod formats;
mod problem_files;
