//! The physics of Slump: Contact Dynamics of cohesive grains.
//!
//! The source is A. Abramian & L. Staron, *Time Steps v.s. Cohesion in Non-Smooth Contact Dynamics
//! Algorithm* (2020, hal-02570097), "the paper" throughout. A pile and how far it slumps:
//!
//! ```
//! let mut scene = slump_core::scene::built_in("pile")?;
//! scene.parameters.bond = 20.0;
//! let mut simulation = scene.simulation()?;
//! simulation.take_steps(5)?;
//! println!("slump {:.3}", simulation.observables().slump);
//! # Ok::<(), slump_core::error::Error>(())
//! ```
//!
//! Programs start from a [`scene`] and step its [`sim::Simulation`]. To add a stepper, a contact law or a solver,
//! implement [`sim::Advance`]. To see a single contact problem, pass a [`sim::ProblemVisitor`] to
//! [`next_problem`](sim::Simulation::next_problem); [`solver::solve`] solves it. Modules depend downward only:
//! [`setting`] ← [`world`] ← [`contact`] ← [`solver`] ← [`sim`] ← [`scene`].

#![warn(missing_docs, unreachable_pub)]
#![cfg_attr(not(test), warn(clippy::print_stdout, clippy::print_stderr))]
#![cfg_attr(
    test,
    allow(clippy::disallowed_methods, reason = "what a test expects may differ in its last bits")
)]

pub mod contact;
pub mod error;
pub mod number;
pub mod scene;
pub mod setting;
pub mod sim;
pub mod solver;
pub mod threads;
pub mod world;
