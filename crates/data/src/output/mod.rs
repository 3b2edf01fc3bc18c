//! Provides output functions for work that takes long: files that are written completely or not at all, messages to
//! streams that may be closed, progress bars, and signals that ask the program to end.

mod files;
mod growing;
mod locks;
mod recognised;
mod seal;
mod terminal;

pub use crate::draft::{DraftFile, nameless_file};
#[cfg(target_arch = "wasm32")]
pub use crate::memory::{give_file, given_file, written_files};
pub use files::{
    PendingFile, Texts, check_file, check_new_file, check_writable, final_name, folder_of,
    remove_drafts, remove_if_there, resolved, write_file,
};
pub use growing::{GrowingFile, end_of_last};
pub use locks::{FolderLock, Locked, SharedFolder, in_use, lock_of};
pub use recognised::{check_recognised, is_recognised};
pub use seal::Seal;
pub use terminal::{
    Progress, Signal, caught_signal, counted, heed_signals, ignore_file_size_signal, lost_stdout,
    note_line, note_printed, print_line, print_text, warn_of_steps,
};
