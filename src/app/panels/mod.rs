//! The panels of the window, one a file. Each is a function of the user interface and the state.

pub mod compare;
pub mod grain;
pub mod help;
pub mod physics;
pub mod plots;
pub mod run;
pub mod scene;
pub mod see;
pub mod solver;
pub mod speed;
pub mod status;
pub mod transport;
