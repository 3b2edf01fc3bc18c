//! Tests of the physics: exact solutions, properties of all scenes, comparisons of methods and steppers with each
//! other, and their limits.

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
