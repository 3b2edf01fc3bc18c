//! Scenes: the bodies, physics, parameters and solver settings with which a simulation starts. [`SCENES`] lists the
//! built-in scenes.

#[cfg(test)]
mod certificates;
mod deposition;
mod description;
pub mod experiments;
#[cfg(test)]
mod law_errors;
mod new_pile;
mod paper;
mod preset;
mod registry;
mod sizes;
pub mod stability;
mod tones;

pub use deposition::{
    Deposit, Rest, Settled, Settling, Support, deposit, drop_and_roll, dropped, settle, start_of,
    walls,
};
pub use description::{DataSettings, FormatName, GrainSource, Scene, View};
pub use new_pile::{Deposition, NewPile};
pub use paper::{collision, cradle, cradle_from, paper_pile, pile_of, put_on_base, rough_base};
pub use preset::Preset;
pub use registry::{SCENES, SceneGroup, SceneInfo, built_in};
pub use sizes::Sizes;
