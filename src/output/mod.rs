//! What all long work shares: files that are whole or not there, words on streams that may be closed,
//! signals that ask for an end, and how far it has come.

mod animation;
mod counted;
mod draft;
mod files;
mod growing;
mod lines;
mod lock;
pub(crate) mod number;
mod png;
mod progress;
mod seal;
mod signals;
mod target;
mod texts;
#[cfg(feature = "video")]
mod video;

pub(crate) use animation::Animation;
pub(crate) use counted::counted;
pub(crate) use draft::{Draft, name_of_whole};
pub(crate) use files::{
    check_file, check_writable, remove_folder_if_there, remove_if_there, write_file,
};
pub(crate) use growing::{GrowingFile, end_of_last};
pub(crate) use lines::{lost_stdout, note_line, note_printed, print_line, print_text};
pub(crate) use lock::{FolderLock, Locked};
pub(crate) use png::{png_of_rgb, write_png};
pub(crate) use progress::{Progress, warn_of_steps};
pub(crate) use seal::Seal;
pub(crate) use signals::{Signal, caught_signal, heed_signals};
pub(crate) use texts::Texts;
#[cfg(feature = "video")]
pub(crate) use video::Video;
