//! The window: panels, the scene, plots, and the thread that computes them.
//!
//! `ui` is a function of [`AppState`] alone and knows neither window nor GPU; the private module
//! `window` runs it on a screen. The simulation itself runs on the thread of
//! [`crate::live`].
//!
//! [`WatchedRun`] is the run that is shown. `panels` draw it: each panel has its own state, and all of them share a
//! `context::PanelContext`. [`AppState`] composes the panels and carries out their requests once they are drawn.

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

/// True in a browser, where there are no files, threads or other programs.
const IN_BROWSER: bool = cfg!(target_arch = "wasm32");

pub use canvas::Canvas;
pub use data_export::DataChoices;
pub use ensemble::Ensemble;
pub use notice::Notice;
pub use opening::Opening;
pub use page::Page;
pub use panels::{FRONT_SETTINGS, Grabbing, Panels, ScenePanel};
pub use plots::ChosenPlot;
pub use predictions::{Prediction, Question};
pub use preferences::Preferences;
pub use state::AppState;
pub use ui::ui;
pub use watched_run::{GrainRef, WatchedRun};
#[cfg(feature = "window")]
pub use window::SOFTWARE_FRAME_INTERVAL;
#[cfg(feature = "window")]
pub(crate) use window::{WindowOptions, run};
