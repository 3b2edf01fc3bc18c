//! Export of files on separate threads, so that the window never waits for a file.

use std::collections::VecDeque;
use std::path::{Path, PathBuf};
use std::sync::mpsc::Receiver;
use std::sync::{Arc, Mutex, PoisonError};

use super::IN_BROWSER;
use super::canvas::Canvas;
use super::data_export::DataPanel;
use super::file_names::is_saved_run;
use super::film::FilmFormat;
use super::notice::Notice;
use super::work::{MaySend, Work, outcome_of_ended};
use crate::error::{Error, Result};
use crate::live::Curve;
use crate::output::{Texts, check_writable, write_file};
use crate::render::{Renderer, RendererChoice};
use crate::sim::Observables;

/// All files that are being written in the background, and the link (a line of text that reproduces a run) that is
/// being made.
#[derive(Default)]
pub(crate) struct Exports {
    /// Files to be written, one after another.
    files: VecDeque<Work<PathBuf>>,
    printers: Arc<Mutex<Printers>>,
    pub data: DataPanel,
    pub film: Option<(FilmFormat, Work<String>)>,
    /// The link (a line of text that reproduces a run) that is being made, to be copied to the clipboard. The flag is
    /// true if the user moved, added or removed grains or moved walls with the mouse, which the link cannot express.
    pub link: Option<Work<(String, bool)>>,
}

impl Drop for Exports {
    fn drop(&mut self) {
        self.files.iter_mut().for_each(Work::end);
        self.film.iter_mut().for_each(|(_, work)| work.end());
        self.data.export.iter_mut().for_each(Work::end);
    }
}

/// Message after copying a link that describes the whole run.
const COPIED: &str = if IN_BROWSER {
    "The link is copied: open it in a browser."
} else {
    "The link is copied: paste it into a window, or pass it to slump --open."
};
/// Message after copying a link of a run with edits by the user, which the link does not contain.
const PULLED: &str = "The link is copied. It lacks changes by hand (grains that were pulled by hand, added or \
                      removed, walls that were moved), so it makes another run. A session keeps these changes.";

impl Exports {
    /// True while a picture or another file, a recording (files of grains and contacts) or a film is being written.
    pub(super) fn is_writing(&self) -> bool {
        !self.files.is_empty() || self.data.export.is_some() || self.film.is_some()
    }

    /// Writes a file into a folder on another thread; only one file is written at a time. `job` writes the file from
    /// the copies of runs that the solver's thread sends through the channels `runs`, and returns the path of the file.
    pub(super) fn write<R: Send + 'static>(
        &mut self,
        context: &egui::Context,
        folder: &Path,
        runs: Vec<Receiver<R>>,
        job: impl FnOnce(&Path, &mut Printers, Vec<R>) -> Result<PathBuf> + MaySend + 'static,
    ) {
        let (folder, printers) = (folder.to_owned(), self.printers.clone());
        self.files.push_back(Work::start(context, runs, move |runs, _| {
            let mut printers = printers.lock().unwrap_or_else(PoisonError::into_inner);
            check_writable("folder", &folder)?;
            job(&folder, &mut printers, runs)
        }));
    }

    /// Returns a notice for the status bar if an export has ended since the last call. Copies a finished link (text
    /// that reproduces runs) to the clipboard.
    pub(super) fn follow(&mut self, context: &egui::Context) -> Option<Notice> {
        let mut notice = None;
        if let Some(outcome) = self.files.front().and_then(Work::outcome) {
            self.files.pop_front();
            // The user is likely to open the run that was just saved, so the field for opening contains its path.
            if let Some(path) = outcome.as_ref().ok().filter(|path| is_saved_run(path)) {
                self.data.saved_run = path.display().to_string();
            }
            // The path in the message is absolute, because the user may not know the folder in which the program was
            // started.
            let whole = |path: PathBuf| std::path::absolute(&path).unwrap_or(path);
            notice = Some(outcome.map(|path| format!("Saved {}", whole(path).display())).into());
        }
        if let Some(outcome) = self.film.as_ref().and_then(|(_, work)| work.outcome()) {
            self.film = None;
            notice = Some(outcome.into());
        }
        if let Some(outcome) = outcome_of_ended(&mut self.data.export) {
            notice = Some(outcome.into());
            self.data.told.clone_from(&notice);
        }
        if let Some(outcome) = outcome_of_ended(&mut self.link) {
            notice = Some(match outcome {
                Ok((text, is_pulled)) => {
                    context.copy_text(text);
                    Notice::new(if is_pulled { PULLED } else { COPIED }, is_pulled)
                }
                Err(error) => Err(error).into(),
            });
        }
        notice
    }
}

/// Renderers of exported pictures. Each renderer is opened for the first picture and kept, because opening a graphics
/// device takes longer than drawing.
#[derive(Default)]
pub(crate) struct Printers {
    renderer: Option<Renderer>,
    canvas: Option<Canvas>,
}

impl Printers {
    /// Returns the renderer that draws pictures of scenes.
    pub(super) fn renderer(&mut self) -> Result<&mut Renderer> {
        match &mut self.renderer {
            Some(renderer) => Ok(renderer),
            none => Ok(none.insert(Renderer::new(RendererChoice::Auto)?)),
        }
    }

    /// Returns the canvas on which plots are drawn.
    pub(super) fn canvas(&mut self) -> Result<&mut Canvas> {
        match &mut self.canvas {
            Some(canvas) => Ok(canvas),
            none => Ok(none.insert(Canvas::new()?)),
        }
    }
}

/// Writes the observables (measured quantities of each step) of all simulations as a CSV table, and their description
/// to a second file, because text lines in a CSV file would be read as data.
pub(super) fn write_table(path: &Path, curves: &[Curve], texts: &Texts) -> Result<()> {
    write_file(&path.with_extension("csv.txt"), texts.lines().as_bytes())?;
    write_curves(path, curves)
}

/// Writes a CSV table with one row per recorded step of each simulation. The first column is the number of the
/// simulation.
fn write_curves(path: &Path, curves: &[Curve]) -> Result<()> {
    let has_more = curves.iter().flat_map(Curve::rows).any(Observables::has_further_columns);
    let cells = |row: Observables| if has_more { row.with_further_columns() } else { row };
    let table =
        |rows: &mut dyn Iterator<Item = Observables>| -> std::result::Result<_, csv::Error> {
            let mut table = csv::Writer::from_writer(Vec::new());
            for row in rows {
                table.serialize(cells(row))?;
            }
            let bytes = table.into_inner().map_err(|error| error.into_error())?;
            Ok(String::from_utf8_lossy(&bytes).into_owned())
        };
    let refuse = |error| Error::file(path, error);
    let names = table(&mut std::iter::once(Observables::default())).map_err(refuse)?;
    let mut text = format!("world,{}\n", names.lines().next().unwrap_or_default());
    for (world, curve) in curves.iter().enumerate() {
        for row in table(&mut curve.rows().copied()).map_err(refuse)?.lines().skip(1) {
            text += &format!("{},{row}\n", world + 1);
        }
    }
    write_file(path, text.as_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curves_are_written_with_a_header_and_their_worlds() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("curves.csv");
        let mut curve = Curve::default();
        curve.push(Observables { slump: 0.25, ..Observables::default() });
        write_curves(&path, &[curve.clone(), curve]).unwrap();
        let text = std::fs::read_to_string(&path).unwrap();
        let mut lines = text.lines();
        let header = lines.next().unwrap();
        assert!(header.starts_with("world,step,time,time_step,"), "{header}");
        assert!(
            lines.next().unwrap().starts_with("1,0,") && lines.next().unwrap().starts_with("2,0,")
        );
    }

    #[test]
    #[cfg(unix)]
    fn an_export_has_its_name_only_when_it_is_whole() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("curves.csv");
        std::fs::write(&path, "before").unwrap();
        let mut reader = std::fs::File::open(&path).unwrap();
        write_curves(&path, &[Curve::default()]).unwrap();
        let mut seen = String::new();
        std::io::Read::read_to_string(&mut reader, &mut seen).unwrap();
        assert_eq!(seen, "before", "whoever reads the old file goes on reading it");
        assert!(std::fs::read_to_string(&path).unwrap().starts_with("world,step"));
    }
}
