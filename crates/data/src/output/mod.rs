//! What all long work shares: files that are whole or not there, words on streams that may be closed,
//! signals that ask for an end, and how far it has come.

pub mod counted;
mod draft;
mod files;
mod growing;
mod lines;
mod lock;

mod progress;
mod seal;
mod signals;
mod target;
mod texts;

pub use counted::counted;
pub use draft::{Draft, name_of_whole};
pub use files::{check_file, check_writable, remove_folder_if_there, remove_if_there, write_file};
pub use growing::{GrowingFile, end_of_last};
pub use lines::{lost_stdout, note_line, note_printed, print_line, print_text};
pub use lock::{FolderLock, Locked};
pub use progress::{Progress, warn_of_steps};
pub use seal::Seal;
pub use signals::{Signal, caught_signal, heed_signals};
pub use target::folder_of;
pub use texts::Texts;
