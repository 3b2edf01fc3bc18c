//! Tests of recordings and of files with contact problems: their contents, the data that remain after an interruption,
//! and reading them.

#[path = "../common/columnar.rs"]
mod columnar;
#[path = "../common/mod.rs"]
mod common;
#[path = "../common/program.rs"]
mod program;

mod data;
mod formats;
mod problem_files;
