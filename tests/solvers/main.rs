//! Who touches, and methods that solve for the impulses.

#[path = "../common/mod.rs"]
mod common;

mod colours;
mod contact_system;
mod detection;
mod islands;
mod methods;
mod solver_properties;
