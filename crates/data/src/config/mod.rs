//! What a user asks of a run, as options, a scene file, a line of a study, or a saved run.

mod about;
mod command_line;
mod config_file;
mod config_options;
mod config_saved;
mod csv_states;
mod file;
mod origin;
mod refusal;
mod run_config;
mod saved_state;

pub use about::{about, about_run};
pub use command_line::{Provenance, asked_time_secs, joined, words_of, words_up_to};
pub use config_options::parser_of;
pub use csv_states::{parse_discs, write_discs};
pub use file::{read_scene, scene_to_toml};
pub use origin::Origin;
pub use refusal::sentence as refusal_of;
pub use run_config::{Config, Ground};
pub use saved_state::SavedState;
