//! Slump: a laboratory for Contact Dynamics of cohesive grains.
//!
//! "The paper" is A. Abramian & L. Staron, *Time Steps v.s. Cohesion in Non-Smooth Contact Dynamics Algorithm* (2020,
//! hal-02570097). This program simulates the pile of the paper and prints its slump (drop of the mean height, divided
//! by the first mean height):
//!
//! ```
//! let mut scene = slump::scene::built_in("pile")?;
//! scene.parameters.bond = 20.0;
//! let mut simulation = scene.simulation()?;
//! simulation.take_steps(5)?;
//! println!("slump {:.3}", simulation.observables().slump);
//! # Ok::<(), slump::error::Error>(())
//! ```
//!
//! Programs start from a [`scene`] and step its [`sim::Simulation`]. Your own stepper, contact law or solver method
//! implements [`sim::Advance`]. [`next_problem`](sim::Simulation::next_problem) passes the contact problem of the next
//! step to a [`sim::ProblemVisitor`], and [`solver::solve`] solves such a problem. The programs in `examples/` show
//! how.
//!
//! In this list, `a` ← `b` means that the module `b` uses the module `a`:
//!
//! * `slump-core`: [`setting`] ← [`world`] ← [`contact`] ← [`solver`] ← [`sim`] ← [`scene`]
//! * `slump-data`: [`granular`] ← [`data`] ← [`interchange`], [`config`]
//! * `slump-studies`: `study`
//! * this crate: [`render`] ← the program, which consists of `headless`, the window (`app`, feature `window`) and `cli`
//!
//! The compiler ensures the order of the crates, and a test ensures that imports between modules point one way. The
//! physics does not depend on windows or pictures. Without the feature `gpu` the processor draws all pictures.
//! `python/` contains the Python package.

#![cfg_attr(
    target_arch = "wasm32",
    allow(dead_code, unused_imports, reason = "a page has neither files nor a command line")
)]
#![warn(missing_docs, unreachable_pub)]
// The macros `println!` and `eprintln!` panic if a stream is closed or full. The functions of `output` do not panic.
#![cfg_attr(not(test), warn(clippy::print_stdout, clippy::print_stderr))]

pub use slump_core::{contact, error, scene, setting, sim, solver, world};
pub use slump_data::{config, data, granular, interchange};
#[doc(hidden)]
pub use slump_studies as study;

#[cfg(feature = "panels")]
use slump_core::number;
use slump_core::threads;
use slump_data::output;

/// Version of the program, with the git commit if the commit is known.
const VERSION: &str = env!("SLUMP_VERSION");

/// The doc tests of `docs/python-and-rust.md`.
#[cfg(doctest)]
#[doc = include_str!("../docs/python-and-rust.md")]
struct BookOnRust;

/// The wall clock. `std::time::Instant` does not work in a browser, so the browser version uses another type.
#[cfg(not(target_arch = "wasm32"))]
use std::time::Instant;
/// The wall clock of the browser version.
#[cfg(target_arch = "wasm32")]
use web_time::Instant;

mod film;
mod headless;
pub mod live;
pub mod render;

// The modules of the program. They are public only for `main.rs`, and for the tests and benchmarks of this package.
#[cfg(feature = "panels")]
#[doc(hidden)]
pub mod app;
#[doc(hidden)]
pub mod cli;
