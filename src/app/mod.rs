//! The window: panels, the scene, plots, and background tasks.
//!
//! The function `ui` depends only on [`AppState`], and not on a window or a GPU; the private module `window` shows it
//! on a screen. The simulation runs on the thread of [`crate::live`].
//!
//! [`WatchedRun`] is the displayed run. The modules in `panels` draw it. Each panel has its own state, and all panels
//! share a `context::PanelContext`. [`AppState`] contains the panels and performs their requests after they are drawn.

mod axes;
#[cfg(target_arch = "wasm32")]
pub mod browser;
mod budget;
mod camera;
mod canvas;
mod context;
mod curve_pieces;
mod data_export;
mod dialogs;
mod ensemble;
mod experiment_plot;
mod exports;
mod file_names;
mod film;
mod glossary;
pub mod lessons;
mod link;
mod notice;
mod number_text;
mod opening;
mod page;
mod painting;
mod panels;
mod plots;
mod predictions;
mod preferences;
mod provenance;
mod scene_picture;
mod scene_start;
mod session;
mod setting_control;
mod settling_progress;
mod state;
pub mod theme;
mod time_step_figure;
mod titles;
mod told;
mod ui;
mod user_folder;
mod watched_run;
#[cfg(feature = "window")]
mod window;
mod work;

/// True in a browser, where the program cannot use files, threads or other programs.
const IN_BROWSER: bool = cfg!(target_arch = "wasm32");

pub use canvas::Canvas;
pub use data_export::DataChoices;
pub use ensemble::Ensemble;
pub use notice::Notice;
pub use opening::Opening;
pub use page::Page;
pub use panels::{FRONT_SETTINGS, Grabbing, Panels, ScenePanel};
pub use predictions::{Prediction, Question};
pub use preferences::Preferences;
pub use state::AppState;
pub use ui::ui;
pub use watched_run::{GrainRef, WatchedRun};
#[cfg(feature = "window")]
pub use window::SOFTWARE_FRAME_INTERVAL;
#[cfg(feature = "window")]
pub(crate) use window::{WindowOptions, run};
