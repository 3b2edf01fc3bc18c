//! Input and output of Slump's runs: requests for runs, measures of grains and piles, recordings in files that other
//! programs can read, and problem files.

#![cfg_attr(
    target_arch = "wasm32",
    allow(dead_code, unused_imports, reason = "a page has no files")
)]
#![warn(missing_docs, unreachable_pub)]
// These macros panic if a stream is closed or full; `output` has functions that do not.
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
