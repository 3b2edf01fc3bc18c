//! Scenes: what is simulated, with which physics, numbers and solver. One file a built-in scene,
//! listed in [`SCENES`].

mod collision;
mod cradle;
mod data_settings;
mod deposition;
mod description;
pub mod experiments;
mod pile;
mod preset;
mod registry;
pub mod stability;

pub use collision::collision;
pub use cradle::{cradle, cradle_from};
pub use data_settings::{DataSettings, FormatName};
pub use deposition::{
    Deposition, NewPile, Rest, Settled, Settling, Support, Surface, deposit, drop_and_roll,
    dropped, settle,
};
pub use deposition::{start_of, walls};
pub use description::{GrainSource, Scene, View};
pub use pile::{paper_pile, pile_of, put_on_base, rough_base};
pub use preset::Preset;
pub use registry::{SCENES, SceneGroup, SceneInfo, built_in};
