//! Choices made before a window opens: the scene or run that it shows first, and its size.

use std::path::{Path, PathBuf};

use winit::dpi::LogicalSize;
use winit::event_loop::ActiveEventLoop;
use winit::monitor::MonitorHandle;
use winit::window::{Window, WindowAttributes};

use crate::app::link::RunLink;
use crate::app::opening::Opening;
use crate::app::preferences::Preferences;
use crate::app::session::open_session;
use crate::app::state::AppState;
use crate::config::{Config, SavedState};
use crate::error::{Error, Result, check};

/// Options of the window. The scene, its physics and its solver are in [`crate::config::Config`].
#[derive(Clone, Debug, Default, PartialEq, clap::Args)]
pub(crate) struct WindowOptions {
    /// Forget the window's layout, theme and last scene
    #[arg(long, help_heading = "Window")]
    pub reset_ui: bool,
    /// Open a session that the window saved: worlds, record and arrangement
    #[arg(long, value_name = "FILE", help_heading = "Window", conflicts_with_all = ["headless", "restart", "open"])]
    pub session: Option<PathBuf>,
    /// Open the line that Copy link gave, slump://run?…
    #[arg(long, value_name = "LINK", help_heading = "Window", conflicts_with_all = ["headless", "restart"])]
    pub open: Option<String>,
    /// Keep writing the state of window and run to this file, as JSON: for tests
    #[arg(long, value_name = "FILE", hide = true)]
    pub export_state: Option<PathBuf>,
}

/// Size of a new window, points.
const SIZE: [f64; 2] = [1280.0, 800.0];
const LEAST_SIZE: [f64; 2] = [640.0, 480.0];

/// Callback that loads the scene or run that a window shows first.
pub(super) type Opener = Box<dyn FnOnce(&mut AppState)>;

/// Chooses the scene or run that a window shows first. A session, link, saved run or scene of the command line has
/// priority; then the lessons, unless the user has left them; then the last scene, or the default scene if the last
/// scene no longer exists.
///
/// # Errors
/// Names the first field of the command line or of the saved run that is outside its range, or the file that cannot be
/// read.
pub(super) fn first(
    asked: &Config,
    restart: Option<&Path>,
    options: &WindowOptions,
    preferences: &Preferences,
) -> Result<Opener> {
    let is_alone = asked.is_empty() || (options.session.is_none() && options.open.is_none());
    let field = if options.session.is_some() { "session" } else { "open" };
    let allowed = "left out if a scene or a setting is given, because it has its own";
    check(is_alone, field, "given", allowed)?;
    if let Some(path) = &options.session {
        let session = open_session(path)?;
        return Ok(Box::new(move |state| state.open(Opening::Session(Box::new(session)))));
    }
    if let Some(text) = &options.open {
        RunLink::read(text)?.check()?;
        let text = text.clone();
        return Ok(Box::new(move |state| state.open(Opening::Link(text))));
    }
    if let Some(path) = restart {
        let mut saved = SavedState::open(path)?;
        asked.change_state(&mut saved)?;
        return Ok(Box::new(move |state| state.load_run(saved)));
    }
    if asked.is_empty() && preferences.lesson.on {
        let at = preferences.lesson.at;
        return Ok(Box::new(move |state| state.visit(at)));
    }
    // A new pile is made on the solver's thread. All other parts of a scene are checked before the window opens.
    let config = if !asked.is_empty() {
        asked.without_settling()?;
        asked.clone()
    } else if preferences.scene.without_settling().is_ok() {
        preferences.scene.clone()
    } else {
        Config::default()
    };
    Ok(Box::new(move |state| state.load(config)))
}

/// Returns the attributes of a new window. The window has the size of the last window (points) if there was one,
/// limited to the size of the screen.
pub(super) fn attributes(
    events: &ActiveEventLoop,
    window_points: Option<[f64; 2]>,
) -> WindowAttributes {
    let [width, height] = window_points.unwrap_or(SIZE);
    let on_screen = |monitor: MonitorHandle| monitor.size().to_logical(monitor.scale_factor());
    let screen: Option<LogicalSize<f64>> = events.primary_monitor().map(on_screen);
    // A driver may report no screen, or a screen without a size.
    let screen = screen.filter(|screen| screen.width > 0.0 && screen.height > 0.0);
    let most = screen.unwrap_or(LogicalSize::new(f64::INFINITY, f64::INFINITY));
    Window::default_attributes()
        .with_title("Slump")
        .with_inner_size(LogicalSize::new(width.min(most.width), height.min(most.height)))
        .with_min_inner_size(LogicalSize::new(LEAST_SIZE[0], LEAST_SIZE[1]))
}

/// Returns the error for a missing display, with its cause and the packages that provide a display.
pub(super) fn no_display(error: &dyn std::fmt::Display) -> Error {
    let message = error.to_string();
    // The messages of winit begin with positions in its own source code, which are removed.
    let reason = message.rsplit(": ").next().unwrap_or(&message).trim_end_matches('.');
    Error::Renderer(format!(
        "no window can be opened ({reason}): start Slump on a desktop, or install the Debian \
         packages libx11-6, libxcursor1, libxi6, libxkbcommon-x11-0 and libx11-xcb1; --headless \
         needs none of them"
    ))
}
