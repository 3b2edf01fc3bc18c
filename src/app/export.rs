//! Writing files on a thread of its own, so that the window never waits for one.

use std::path::{Path, PathBuf};
use std::sync::mpsc::Receiver;
use std::sync::{Arc, PoisonError};

use image::RgbaImage;

use super::canvas::Canvas;
use super::file_names::{STATE_ENDING, free_path, stem};
use super::opening::TakenRun;
use super::state::AppState;
use super::work::{MaySend, Work};
use crate::config::SavedState;
use crate::error::{Error, Result};
use crate::live::Curve;
use crate::output::{Texts, check_writable, write_file};
use crate::render::{Camera, Renderer, RendererChoice, Style, WorldPanel, draw_scene, draw_worlds};
use crate::sim::{Observables, Snapshot};

/// A world of a picture.
pub(crate) struct PicturedWorld {
    pub snapshot: Arc<Snapshot>,
    /// What tells it from the others.
    pub title: String,
    /// What stands below it.
    pub note: String,
}

/// A picture of the worlds, as they are seen side by side.
pub(crate) struct ScenePicture {
    pub worlds: Vec<PicturedWorld>,
    /// How many stand in a row.
    pub columns: usize,
    pub style: Style,
    /// What of one is seen.
    pub camera: Camera,
    pub size: [u32; 2],
    pub texts: Texts,
}

impl ScenePicture {
    /// Draws it.
    pub(super) fn draw(&self, renderer: &mut Renderer) -> Result<RgbaImage> {
        let Self { worlds, columns, style, camera, size, .. } = self;
        if let [PicturedWorld { snapshot, .. }] = &worlds[..] {
            return draw_scene(renderer, snapshot, style, camera, size[0], size[1]);
        }
        let panels = worlds.iter().map(|PicturedWorld { snapshot, title, note }| WorldPanel {
            snapshot,
            title,
            note,
        });
        let panels: Vec<_> = panels.collect();
        draw_worlds(renderer, &panels, style, camera, *columns, *size)
    }
}

/// What pictures are drawn with, opened by the first that needs it: opening a device takes longer than a picture.
#[derive(Default)]
pub(crate) struct Printers {
    renderer: Option<Renderer>,
    canvas: Option<Canvas>,
}

impl Printers {
    /// Draws scenes.
    pub(super) fn renderer(&mut self) -> Result<&mut Renderer> {
        match &mut self.renderer {
            Some(renderer) => Ok(renderer),
            none => Ok(none.insert(Renderer::new(RendererChoice::Auto)?)),
        }
    }

    /// Draws plots.
    pub(super) fn canvas(&mut self) -> Result<&mut Canvas> {
        match &mut self.canvas {
            Some(canvas) => Ok(canvas),
            none => Ok(none.insert(Canvas::new()?)),
        }
    }
}

impl AppState {
    /// Has a file written into the folder of the preferences, after those that are being written. The job says which.
    pub(super) fn export(
        &mut self,
        context: &egui::Context,
        job: impl FnOnce(&Path, &mut Printers) -> Result<PathBuf> + MaySend + 'static,
    ) {
        self.export_run(context, Vec::new(), |folder, printers, _: Vec<()>| job(folder, printers));
    }

    /// The same of what is handed out first.
    pub(super) fn export_run<R: Send + 'static>(
        &mut self,
        context: &egui::Context,
        runs: Vec<Receiver<R>>,
        job: impl FnOnce(&Path, &mut Printers, Vec<R>) -> Result<PathBuf> + MaySend + 'static,
    ) {
        let (folder, printers) = (self.preferences.folder.clone(), self.exports.printers.clone());
        self.exports.files.push_back(Work::start(context, runs, move |runs, _| {
            let mut printers = printers.lock().unwrap_or_else(PoisonError::into_inner);
            check_writable("folder", &folder)?;
            job(&folder, &mut printers, runs)
        }));
    }
}

/// Writes the observables of all worlds as a table, and beside it what they are of: lines of another kind in it would be
/// data to those who read it.
pub(super) fn write_table(path: &Path, curves: &[Curve], texts: &Texts) -> Result<()> {
    write_file(&path.with_extension("csv.txt"), texts.lines().as_bytes())?;
    write_curves(path, curves)
}

/// Writes the moment that a run had when it was handed out: it may go on meanwhile.
pub(super) fn write_state(folder: &Path, run: TakenRun) -> Result<PathBuf> {
    let TakenRun { start, world } = run;
    if world.failure.is_some() {
        return Err(not_finite());
    }
    let settings = [*world.simulation.settings()];
    let stem = stem(&start.scene.name, &settings, world.simulation.time_secs());
    let path = free_path(folder, &stem, STATE_ENDING);
    SavedState::new(start.scene.clone(), world.simulation, world.tally).save(&path)?;
    Ok(path)
}

/// Why a run that has failed is not saved.
pub(super) fn not_finite() -> Error {
    Error::value("state", "no longer finite", "an earlier one: drag the timeline back")
}

/// All rows of all curves, each with the number of its world in front.
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
