//! Dialogs of the desktop in which the user chooses a file or a folder. They run on a separate thread, so that the
//! simulation continues.

use std::path::{Path, PathBuf};

use super::work::{Work, outcome_of_ended};
use crate::error::Result;

/// The file or folder that the user chose in a dialog.
pub(crate) enum Chosen {
    /// A file that the program opens.
    File(PathBuf),
    /// The new folder for saved files.
    Folder(PathBuf),
}

/// The dialog that the window shows at present, in which the user chooses a file or a folder; empty if there is none.
/// At most one dialog is open.
#[derive(Default)]
pub(crate) struct FileDialog {
    waiting: Option<Work<Option<Chosen>>>,
}

impl FileDialog {
    /// Shows a dialog in which the user chooses a file to be opened or, if `for_file` is false, the folder of saved
    /// files. The dialog begins in `folder`.
    pub(super) fn ask(&mut self, context: &egui::Context, folder: &Path, for_file: bool) {
        if self.waiting.is_some() {
            return;
        }
        let folder = std::path::absolute(folder).unwrap_or_else(|_| folder.to_owned());
        let runs = Vec::<std::sync::mpsc::Receiver<()>>::new();
        self.waiting = Some(Work::start(context, runs, move |_, _| choose(&folder, for_file)));
    }

    /// Returns the choice of the user if a dialog has ended since the last call; `None` also if the user cancelled it.
    pub(super) fn answer(&mut self) -> Option<Result<Chosen>> {
        outcome_of_ended(&mut self.waiting)?.transpose()
    }
}

/// Replaces the dialog for files and folders in the browser version, and always returns `None` (no choice): the user
/// drops files on the page, and saved files are downloads.
#[cfg(target_arch = "wasm32")]
fn choose(_: &Path, _: bool) -> Result<Option<Chosen>> {
    Ok(None)
}

#[cfg(not(target_arch = "wasm32"))]
fn choose(folder: &Path, for_file: bool) -> Result<Option<Chosen>> {
    use super::file_names::{SESSION_ENDING, STATE_ENDING};

    // If a dialog ends within this time, the system has not shown it, because nobody reads and cancels a dialog so
    // quickly.
    const SHORTEST: std::time::Duration = std::time::Duration::from_millis(100);
    let began = crate::Instant::now();
    let dialog = rfd::FileDialog::new().set_directory(folder);
    let chosen = if for_file {
        let dialog = dialog.set_title("Open a scene, discs, a saved run or a session");
        let endings = [STATE_ENDING, SESSION_ENDING, "toml", "csv"];
        dialog.add_filter("Slump", &endings).pick_file().map(Chosen::File)
    } else {
        dialog.set_title("Folder of saved files").pick_folder().map(Chosen::Folder)
    };
    if chosen.is_none() && began.elapsed() < SHORTEST {
        let needed = "shown by xdg-desktop-portal or zenity: install one of them, or type the path";
        return Err(crate::error::Error::value("dialog", "not shown", needed));
    }
    Ok(chosen)
}
