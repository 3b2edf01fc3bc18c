//! The window: panels, the scene, plots, and the thread that computes them.
//!
//! `ui` is a function of [`AppState`] alone and knows neither window nor GPU; the private module
//! `window` runs it on a screen. The simulation itself runs on the thread of
//! [`crate::live`].

mod camera;
mod canvas;
mod chosen_plot;
mod command_line;
mod data_choices;
mod data_desk;
mod data_export;
mod drop;
mod effort;
mod export;
mod fill;
mod film_export;
mod film_file;
mod graphics;
mod held;
mod hint;
mod keys;
mod link;
mod loader;
mod making;
mod method_box;
mod notice;
mod number;
mod options;
mod other_piles;
mod panels;
mod playing;
mod plot_picture;
mod plots;
mod preferences;
mod saved_files;
mod scene_callback;
mod scene_legend;
mod session;
mod setting_control;
mod sharing;
mod spread;
mod state;
mod step_race;
mod storage;
mod taken;
pub mod theme;
pub mod tour;
mod ui;
mod validation;
mod window;
mod work;
mod world_curve;

pub use canvas::Canvas;
pub use chosen_plot::ChosenPlot;
pub use data_choices::DataChoices;
pub use held::GrainRef;
pub use notice::Notice;
pub(crate) use options::WindowOptions;
pub use other_piles::OtherPiles;
pub use preferences::Preferences;
pub use state::AppState;
pub use ui::ui;
pub use window::SOFTWARE_FRAME_INTERVAL;
pub(crate) use window::run;
