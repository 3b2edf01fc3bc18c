//! Scenes: what is simulated, with which physics, numbers and solver. One file a built-in scene,
//! listed in [`SCENES`]; the same data can be read from a TOML file.

mod about;
mod collision;
mod command_line;
mod config;
mod config_file;
mod config_options;
mod config_saved;
mod cradle;
mod csv_states;
mod deposition;
mod description;
pub(crate) mod experiments;
mod file;
mod origin;
mod pile;
mod preset;
mod registry;
mod saved_state;
pub mod stability;

pub use collision::collision;
#[cfg(feature = "window")]
pub(crate) use command_line::joined;
pub(crate) use command_line::{Provenance, asked_time_secs, words_of, words_up_to};
pub use config::{Config, Ground};
pub(crate) use config_options::parser_of;
pub use cradle::{cradle, cradle_from};
pub use csv_states::{parse_discs, write_discs};
pub(crate) use deposition::walls;
pub use deposition::{
    Deposition, NewPile, Rest, Settled, Settling, Support, Surface, deposit, drop_and_roll,
    dropped, settle,
};
pub use description::{GrainSource, Scene, View};
pub use file::{read_scene, scene_to_toml};
pub use origin::Origin;
pub use pile::{paper_pile, pile_of, rough_base};
pub use preset::Preset;
pub use registry::{SCENES, SceneGroup, SceneInfo, built_in};
pub use saved_state::SavedState;
