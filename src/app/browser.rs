//! Functions of the browser version that replace the window, the files and the threads of the desktop version.

use std::path::PathBuf;

use egui::Context;
use egui_wgpu::CallbackResources;

use super::file_names::refused_file;
use super::link::{RunLink, set_link_start};
use super::opening::{Opening, opening_of};
use super::painting::TargetFormat;
use super::preferences::{Preferences, StoredWindow};
use super::state::AppState;
use super::{theme, told};
use crate::error::Result;
use crate::live::{Live, LiveOptions, Post, RemoteEngine, StartSource};
use crate::output::give_file;
pub use crate::output::written_files;

/// Returns the engine that computes runs in a web worker. The engine sends its messages to `post`. While the engine
/// makes an initial state, it calls `gives_up` to ask whether the user cancelled the loading.
pub fn engine(post: Post, gives_up: fn() -> bool) -> RemoteEngine<Opening> {
    RemoteEngine::new(post, LiveOptions { gives_up: Box::new(gives_up), ..LiveOptions::default() })
}

/// Stores `format`, the texture format of the picture into which egui draws, in `resources`. Slump's paint callbacks,
/// which egui calls to draw shapes with Slump's own GPU commands, read it there.
pub fn prepare(resources: &mut CallbackResources, format: wgpu::TextureFormat) {
    resources.insert(TargetFormat(format));
}

/// Opens the browser version with the preferences `stored` at the last visit. It shows the run or lesson that the
/// page's `address` describes. If the address describes neither, it shows the lesson at which the user left the lessons
/// open, or the last scene if the lessons were closed.
pub fn begin(live: Live, stored: &str, address: &str, context: &Context) -> AppState {
    let stored: StoredWindow = ron::from_str(stored).unwrap_or_default();
    context.memory_mut(|memory| *memory = stored.layout);
    // The browser itself enlarges the page by these keys. Otherwise the page would become larger twice.
    context.options_mut(|options| options.zoom_with_keyboard = false);
    theme::install(context);
    let (start, query) = address.split_once('?').unwrap_or((address, ""));
    set_link_start(format!("{start}?"));
    let lesson = query.strip_prefix("lesson=").and_then(|number| number.parse::<usize>().ok());
    let mut state = AppState::idle(live, stored.preferences);
    match RunLink::read(address).and_then(|link| link.check()) {
        _ if lesson.is_some() => state.visit(lesson.unwrap_or(1).saturating_sub(1)),
        Ok(()) => state.open(Opening::Link(address.to_owned())),
        Err(refusal) => {
            if !query.is_empty() {
                state.warn(refusal.to_string());
            }
            match state.preferences.lesson.on {
                true => state.visit(state.preferences.lesson.at),
                false => state.load(state.preferences.scene.clone()),
            }
        }
    }
    state
}

/// Returns the preferences and the layout as a text, which the browser stores until the next visit.
pub fn stored(preferences: &Preferences, context: &Context) -> String {
    ron::to_string(&StoredWindow::of(preferences, context)).unwrap_or_default()
}

/// Opens a file that the user dropped on the page.
pub fn open_file(state: &mut AppState, path: PathBuf, bytes: Vec<u8>) {
    let Some(opening) = opening_of(&path) else { return state.warn(refused_file(&path)) };
    give_file(path.clone(), bytes.clone());
    state.open(Opening::With { path, bytes, opening: Box::new(opening) });
}

/// Computes the first of the simulations that a link (text that reproduces runs) describes, up to its last step.
/// Returns the hash of its final state, for tests.
///
/// # Errors
/// Names the invalid part of the link.
pub fn state_of(link: &str) -> Result<String> {
    let start = Box::new(Opening::Link(link.to_owned())).make(&mut |_| true)?;
    let world = start.history.as_ref().and_then(|history| history.worlds().first());
    Ok(world.map_or(&start.simulation, |world| &world.simulation).snapshot().state_hash())
}

/// Returns the state of the page and its run as JSON, for tests.
pub fn told(state: &AppState, size: [u32; 2], scale: f32) -> String {
    told::told(state, size, scale, 1).to_string()
}
