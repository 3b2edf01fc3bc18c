//! The panels of the window, one per file. A panel is a function of the user interface and of the context that all
//! panels share. A panel owns the state that it keeps between two frames.

#![deny(dead_code, reason = "a panel that nothing shows would not be missed")]

mod alarms;
mod breaking;
mod compare;
mod data;
mod distributions;
pub(super) mod front;
mod gallery;
mod grabbing;
mod grain;
mod help;
mod layout;
mod lesson_bar;
mod pages;
mod physics;
mod plots;
mod right_answer;
mod run;
mod scene;
mod scene_style;
pub(super) mod see;
mod shown_settings;
mod solver;
mod speed;
mod status;
mod trust;

pub use grabbing::Grabbing;
pub use layout::Panels;
pub use scene::ScenePanel;
pub use shown_settings::FRONT_SETTINGS;
