//! Slump: a laboratory for Contact Dynamics of cohesive grains.
//!
//! The source is A. Abramian & L. Staron, *Time Steps v.s. Cohesion in Non-Smooth Contact Dynamics
//! Algorithm* (2020, hal-02570097), "the paper" throughout. A pile and how far it slumps:
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
//! Programs start from a [`scene`] and step its [`sim::Simulation`]. A way to step, a contact law or a method
//! of one's own is a [`sim::Advance`]; one problem by itself is shown by
//! [`next_problem`](sim::Simulation::next_problem) to a [`sim::ProblemVisitor`], and solved by
//! [`solver::solve`]. Three such programs are in `examples/`.
//!
//! Each module uses those before it: [`setting`] ← [`world`] ← [`contact`] ← [`solver`] ← [`sim`] ← [`scene`], which are
//! of the crate `slump-core`, ← [`granular`] ← [`data`] ← [`interchange`], [`config`], of `slump-data`, ← `study`, of
//! `slump-studies`, ← [`render`] ← the program, which is `headless`, the window (`app`, feature `window`) and `cli`. The
//! compiler sees to the order of the crates, nothing but care to that within one. The physics knows no screen. Without the
//! feature `gpu` pictures are drawn by the processor alone. The same from Python is a package of its own, in `python/`.

#![cfg_attr(
    target_arch = "wasm32",
    allow(dead_code, unused_imports, reason = "a page has neither files nor a command line")
)]
#![warn(missing_docs, unreachable_pub)]
// They panic where a stream is closed or full: `output` has lines that do not.
#![cfg_attr(not(test), warn(clippy::print_stdout, clippy::print_stderr))]

pub use slump_core::{contact, error, scene, setting, sim, solver, world};
pub use slump_data::{config, data, granular, interchange};
#[doc(hidden)]
pub use slump_studies as study;

use slump_core::threads;
use slump_data::output;

/// The version, with the commit where it is known.
const VERSION: &str = env!("SLUMP_VERSION");

/// The programs of a page of the book.
#[cfg(doctest)]
#[doc = include_str!("../docs/python-and-rust.md")]
struct BookOnRust;

/// A clock that a page has, too.
#[cfg(not(target_arch = "wasm32"))]
use std::time::Instant;
/// A clock that a page has, too.
#[cfg(target_arch = "wasm32")]
use web_time::Instant;

mod film;
mod headless;
pub mod live;
pub mod render;

// The program: public for `main.rs`, tests and benches of this package, and for nobody else.
#[cfg(feature = "panels")]
#[doc(hidden)]
pub mod app;
#[doc(hidden)]
pub mod cli;
