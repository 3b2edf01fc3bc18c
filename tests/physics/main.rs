//! The physics: exact truths, what holds of any scene, methods and steppers against each other, where they break.

#[path = "../common/mod.rs"]
mod common;
#[path = "../common/program.rs"]
mod program;

mod allocation;
mod deposition;
mod friction_models;
mod granular;
mod hand;
mod laws;
mod motions;
mod repeatability;
mod rooms;
mod solvers;
mod stability;
mod steppers;
