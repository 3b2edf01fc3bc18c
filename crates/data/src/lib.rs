//! Reads and writes the data of Slump's runs: configurations of runs, recordings in files that other programs can read,
//! and files of contact problems. Also computes measures of grains and piles, such as stress and solid fraction.

#![cfg_attr(
    target_arch = "wasm32",
    allow(dead_code, unused_imports, reason = "a page has no files")
)]
#![warn(missing_docs, unreachable_pub)]
// `print!` and `eprint!` panic if a stream is closed or full. The module `output` has functions that do not panic.
#![cfg_attr(not(test), warn(clippy::print_stdout, clippy::print_stderr))]

use slump_core::{contact, error, number, scene, setting, sim, solver, world};

pub mod column_spec;
pub mod config;
pub mod data;
mod draft;
pub mod granular;
pub mod input;
pub mod interchange;
#[cfg(any(target_arch = "wasm32", test))]
mod memory;
pub mod output;
