//! A JSON file with the state of the window and of the run, for tests that control the program from outside.

use std::path::PathBuf;
use std::time::{Duration, Instant};

use winit::window::Window;

use super::keeping::replace_file;
use crate::app::state::AppState;
use crate::app::told::told;

/// Least time between two writes of the state to the file while the run plays. With a shorter time, tests see changes
/// sooner, but writing takes more of the window's time.
const INTERVAL: Duration = Duration::from_millis(50);

/// Writer of the file with the state of the window and of the run. It limits the rate of writes.
pub(super) struct StateFile {
    path: PathBuf,
    written: Option<Instant>,
}

impl StateFile {
    pub(super) fn new(path: PathBuf) -> Self {
        Self { path, written: None }
    }

    pub(super) fn write(&mut self, state: &AppState, window: &Window, devices: u32) {
        if self.written.is_some_and(|at| at.elapsed() < INTERVAL && state.run.frame.playing) {
            return;
        }
        self.written = Some(Instant::now());
        let size: [u32; 2] = window.inner_size().into();
        let record = told(state, size, window.scale_factor() as f32, devices);
        replace_file(&self.path, &format!("{record:#}"));
    }
}
