//! Runs that are saved and gone on with: bit for bit what they would have been.

mod files;
mod program;
mod restarts;
mod runs;
mod states;

use slump::config::SavedState;
use slump::scene::Scene;
use slump::sim::{Simulation, Tally};

/// A state in bytes: all that it is, so that equal bytes are one state.
fn bytes_of(scene: &Scene, simulation: &Simulation) -> Vec<u8> {
    let state = SavedState::new(scene.clone(), simulation.clone(), Tally::default());
    state.to_bytes().expect("bytes")
}

/// What a state is read back as.
fn read(bytes: &[u8]) -> SavedState {
    SavedState::from_bytes(bytes, "state.slump").expect("a sound state")
}
