//! Who touches, and methods that solve for the impulses.

mod colours;
mod contact_system;
mod detection;
mod islands;
mod methods;
mod solver_properties;
