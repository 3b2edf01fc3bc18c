//! Bodies that move by themselves, and gravity that turns: what their surfaces do to grains, that nothing depends on who moves, and that
//! energy, momentum, restart and mirror know of it.

mod balance;
mod belts;
mod biaxial;
mod borders;
mod driven;
mod driven_energy;
mod driven_on_springs;
mod gravity;
mod periodic;
mod periodic_both;
mod periodic_corners;
mod refusals;
mod refused_drives;
mod sheared;
mod sheared_flow;
mod tilt;
mod turning;
mod views;

use glam::DVec2;
use slump::config::{SavedState, scene_to_toml};
use slump::scene::Scene;
use slump::sim::{Simulation, Tally};
use slump::world::{Boundary, Motion, MotionCourse};

/// Boundaries that go this way.
fn goes(boundaries: &[usize], course: MotionCourse) -> Motion {
    Motion { boundaries: boundaries.to_vec(), course: Some(course), ..Motion::default() }
}

/// Boundaries with a belt.
fn belt(boundaries: &[usize], surface_speed: f64) -> Motion {
    Motion { boundaries: boundaries.to_vec(), surface_speed, ..Motion::default() }
}

/// Straight on, without end.
fn straight(velocity: DVec2) -> MotionCourse {
    MotionCourse::Straight { direction: velocity, speed: velocity.length(), travel: None }
}

/// The level y = 0.
fn level() -> Boundary {
    Boundary::HalfSpace { point: DVec2::ZERO, normal: DVec2::Y }
}

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
