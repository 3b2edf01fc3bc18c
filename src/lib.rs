//! Slump: a laboratory for Contact Dynamics of cohesive grains.
//!
//! The source is A. Abramian & L. Staron, *Time Steps v.s. Cohesion in Non-Smooth Contact Dynamics
//! Algorithm* (2020, hal-02570097), "the paper" throughout. Modules depend downward only: [`world`] ←
//! [`contact`] ← [`solver`] ← [`sim`] ← [`scene`] ← [`render`], [`interchange`] ← [`study`] ← [`headless`] ← the
//! window (`app`, feature `window`) ← [`cli`]; `tests/house` checks it. The physics knows no screen.
//! Without the feature `gpu` pictures are drawn by the processor alone.

#![warn(missing_docs, unreachable_pub)]

pub mod contact;
pub mod error;
mod headless;
pub mod interchange;
mod output;
pub mod render;
pub mod scene;
pub mod setting;
pub mod sim;
pub mod solver;
pub mod world;

// The program: public for `main.rs`, tests and benches of this package, and for nobody else.
#[cfg(feature = "window")]
#[doc(hidden)]
pub mod app;
#[doc(hidden)]
pub mod cli;
#[doc(hidden)]
pub mod study;
