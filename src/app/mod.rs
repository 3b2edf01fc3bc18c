//! The window: panels, the scene, plots, and the thread that computes them.
//!
//! `ui` is a function of [`AppState`] alone and knows neither window nor GPU; the private module
//! `window` runs it on a screen. The simulation itself runs on the thread of
//! [`crate::live`].

mod budget;
mod camera;
mod canvas;
mod data_export;
mod ensemble;
mod export;
mod film;
pub mod lessons;
mod opening;
mod painting;
mod panels;
mod plots;
mod preferences;
mod session;
mod setting_control;
mod sharing;
mod state;
pub mod theme;
mod ui;
mod window;
mod work;

pub use canvas::Canvas;
pub use data_export::DataChoices;
pub use ensemble::Ensemble;
pub use panels::{FRONT_SETTINGS, Grabbing, GrainRef, Page};
pub use plots::ChosenPlot;
pub use preferences::Preferences;
pub use state::{AppState, Notice};
pub use ui::ui;
pub use window::SOFTWARE_FRAME_INTERVAL;
pub(crate) use window::{WindowOptions, run};
