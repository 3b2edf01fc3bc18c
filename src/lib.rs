//! Slump: a laboratory for Contact Dynamics of cohesive grains.
//!
//! The source is A. Abramian & L. Staron, *Time Steps v.s. Cohesion in Non-Smooth Contact Dynamics
//! Algorithm* (2020, hal-02570097), "the paper" throughout. Modules depend downward only: [`world`] ←
//! [`contact`] ← [`solver`] ← [`sim`] ← [`scene`] ← [`study`], [`interchange`]; [`render`] sees `world` and the
//! snapshots of `sim`; [`headless`] sees all. The physics knows no screen.

pub mod app;
pub mod contact;
pub mod error;
pub mod headless;
pub mod interchange;
pub mod output;
pub mod render;
pub mod scene;
pub mod sim;
pub mod solver;
pub mod study;
pub mod world;
