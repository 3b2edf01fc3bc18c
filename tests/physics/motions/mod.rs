//! Bodies that move by themselves, and gravity that turns: what their surfaces do to grains, that nothing depends on who moves, and that
//! energy, momentum, restart and mirror know of it.

mod driven;
mod gravity;
mod images;
mod periodic;
mod refusals;
mod rest_on_walls;
mod sheared;
mod surfaces;
mod views;

use crate::common::*;
use slump::config::{SavedState, scene_to_toml};

/// A run as its file keeps it.
fn saved_and_read(scene: &Scene, run: &Simulation) -> SavedState {
    let state = SavedState::new(scene.clone(), run.clone(), Tally::default());
    let bytes = state.to_bytes().expect("bytes");
    SavedState::from_bytes(&bytes, "a.slump").expect("a state")
}

/// The scene as its own file says it.
fn through_a_file(scene: &Scene) -> Scene {
    let text = scene_to_toml(scene).expect("TOML");
    let read: Scene = toml::from_str(&text).expect("a scene");
    assert_eq!(read, *scene, "{text}");
    read
}
