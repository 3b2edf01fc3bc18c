//! The state of window and run as a JSON file, for tests that drive the window from outside.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::time::{Duration, Instant};

use winit::window::Window;

use crate::app::preferences::replace_file;
use crate::app::state::AppState;

/// Least time between two files.
const INTERVAL: Duration = Duration::from_millis(50);

/// Writes the file, not too often.
pub(super) struct StateFile {
    path: PathBuf,
    written: Option<Instant>,
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
        let edges = |rect: &egui::Rect| {
            [rect.left(), rect.top(), rect.right(), rect.bottom()].map(|at| at * scale)
        };
        let controls = state.controls.iter().map(|(name, rect)| (name, edges(rect)));
        let record = serde_json::json!({
            "scene": state.frame.start.as_ref().map(|start| start.name.as_str()),
            "playing": state.frame.playing,
            "step": last.step,
            "time_secs": last.time_secs,
            "slump": last.slump,
            // Of the next step, as the solver's thread has them.
            "parameters": world.map(|world| world.controls.settings.parameters),
            "worlds": state.frame.worlds.len(),
            // Of the selected world.
            "grains": world.map_or(0, |world| world.snapshot.grains.len()),
            // Those of the selected world that have come to their end, and threads that compute them.
            "other_piles": state.ensemble.summary(state.selected).map_or(0, |it| it.band.count),
            "other_threads": state.ensemble.threads(),
            // From 1; 0 where none is being taken.
            "lesson": if state.touring { state.preferences.lesson.at + 1 } else { 0 },
            "steps_per_sec": state.frame.steps_per_sec,
            // How often a graphics device was opened.
            "devices": devices,
            // That the solver's thread has published.
            "frames": state.frame.number,
            "window": [size.width, size.height],
            // Left, top, right and bottom, pixels of the window.
            "controls": controls.collect::<BTreeMap<_, _>>(),
        });
        replace_file(&self.path, &format!("{record:#}"));
    }
}
