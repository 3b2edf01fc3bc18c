//! Tests of bodies with prescribed motions, and of gravity that turns: effect of moving surfaces on grains,
//! independence of the frame of reference, balance of energy and momentum, restart, and mirror images.

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

/// Saves a run to bytes and reads it again.
fn saved_and_read(scene: &Scene, run: &Simulation) -> SavedState {
    let state = SavedState::new(scene.clone(), run.clone(), Tally::default());
    let bytes = state.to_bytes().expect("bytes");
    SavedState::from_bytes(&bytes, "a.slump").expect("a state")
}

/// Writes the scene in Slump's own file format, reads it again, checks that it is equal, and returns it.
fn through_a_file(scene: &Scene) -> Scene {
    let text = scene_to_toml(scene).expect("TOML");
    let read: Scene = toml::from_str(&text).expect("a scene");
    assert_eq!(read, *scene, "{text}");
    read
}
