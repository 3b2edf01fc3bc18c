//! Reads and writes configurations of runs. A configuration comes from options of the command line, from a scene file,
//! from a run of a study (a list of runs), or from a saved run.

mod facts;
mod option_words;
mod options;
mod provenance;
mod recorded_scene;
mod run_config;
mod saved_state;
mod scene_file;

pub use facts::{run_facts, scene_facts};
pub use option_words::parser_of;
pub use options::refusal_of;
pub use provenance::{Provenance, asked_time_secs, joined, words_of, words_up_to};
pub use run_config::{BaseScene, Config, SceneSource};
pub use saved_state::SavedState;
pub use scene_file::{parse_discs, read_scene, scene_to_toml, write_discs};
