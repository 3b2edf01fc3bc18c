//! Tests of contact detection and of the methods that solve for the impulses.

mod converged;
mod detection;
mod methods;
mod solver_properties;
