//! The physics of Slump: Contact Dynamics of cohesive grains.
//!
//! The source is A. Abramian & L. Staron, *Time Steps v.s. Cohesion in Non-Smooth Contact Dynamics Algorithm* (2020,
//! hal-02570097), called *the paper* in this documentation. This example computes five steps of a pile and prints how
//! far it has slumped:
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
//! Programs start from a [`scene`] and advance its [`sim::Simulation`] step by step. To add a stepper, a contact law or
//! a solver, implement [`sim::Advance`]. To read the contact problem of one step, pass a [`sim::ProblemVisitor`] to
//! [`next_problem`](sim::Simulation::next_problem). [`solver::solve`] solves such a problem. Of the following modules,
//! each uses only the modules to its left: [`setting`] ← [`world`] ← [`contact`] ← [`solver`] ← [`sim`] ← [`scene`].

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
