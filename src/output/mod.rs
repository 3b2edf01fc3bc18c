//! What all long work shares: files that are whole or not there, and how far it has come.

mod files;
mod progress;

pub(crate) use files::{check_writable, write_file, write_png};
pub(crate) use files::{finish_file, start_file};
pub(crate) use progress::Progress;
