//! The state of window and run as a JSON file, for tests that drive the window from outside.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::time::{Duration, Instant};

use serde::Serialize;
use winit::window::Window;

use crate::app::state::AppState;
use crate::world::Parameters;

/// Least time between two files.
const INTERVAL: Duration = Duration::from_millis(50);

/// Writes the file, not too often.
pub(super) struct StateFile {
    path: PathBuf,
    written: Option<Instant>,
}

#[derive(Serialize)]
struct ExportedState<'a> {
    scene: Option<&'a str>,
    playing: bool,
    step: u64,
    time_secs: f64,
    slump: f64,
    /// Parameters of the next step, as the solver's thread has them.
    parameters: Option<Parameters>,
    worlds: usize,
    /// Grains of the selected world.
    grains: usize,
    /// Other piles of the selected world that have come to their end.
    #[serde(rename = "other_piles")]
    ensemble: usize,
    /// Threads that compute them.
    other_threads: usize,
    /// The station of the tour, from 1; 0 where it is not being taken.
    station: usize,
    steps_per_sec: f64,
    /// How often a graphics device was opened.
    devices: u32,
    /// Frames that the solver's thread has published.
    frames: u64,
    window: [u32; 2],
    /// Left, top, right and bottom of controls, pixels of the window.
    controls: BTreeMap<&'a str, [f32; 4]>,
}

impl StateFile {
    pub(super) fn new(path: PathBuf) -> Self {
        Self { path, written: None }
    }

    pub(super) fn write(&mut self, state: &AppState, window: &Window, devices: u32) {
        if self.written.is_some_and(|at| at.elapsed() < INTERVAL && state.frame.playing) {
            return;
        }
        self.written = Some(Instant::now());
        let world = state.world();
        let last = world.map(|world| world.snapshot.observables).unwrap_or_default();
        let scale = window.scale_factor() as f32;
        let size = window.inner_size();
        let record = ExportedState {
            scene: state.frame.start.as_ref().map(|start| start.name.as_str()),
            playing: state.frame.playing,
            step: last.step,
            time_secs: last.time_secs,
            slump: last.slump,
            parameters: world.map(|world| world.controls.settings.parameters),
            worlds: state.frame.worlds.len(),
            grains: world.map_or(0, |world| world.snapshot.grains.len()),
            ensemble: state.ensemble.summary(state.selected).map_or(0, |it| it.band.count),
            other_threads: state.ensemble.threads(),
            station: if state.touring { state.preferences.tour.at + 1 } else { 0 },
            steps_per_sec: state.frame.steps_per_sec,
            devices,
            frames: state.frame.number,
            window: [size.width, size.height],
            controls: state
                .controls
                .iter()
                .map(|(name, rect)| {
                    let corners = [rect.left(), rect.top(), rect.right(), rect.bottom()];
                    (name.as_str(), corners.map(|at| at * scale))
                })
                .collect(),
        };
        let Ok(text) = serde_json::to_string_pretty(&record) else { return };
        // Moved into place, so that a reader never sees half a file.
        let fresh = self.path.with_extension("new");
        if std::fs::write(&fresh, text).is_ok() {
            let _ = std::fs::rename(fresh, &self.path);
        }
    }
}
