//! One step's contact problem as a file, and a problem from elsewhere solved here.
//!
//! A problem file is JSON: `nc` contacts; `W` as `row`, `col`, `val` (2 nc × 2 nc, 1/kg, rows and
//! columns in the order N0, T0, N1, T1, …); `q` (2 nc, m/s), the relative velocities without contact
//! impulses, restitution's term included; `mu`, a number or a list; and, where there is cohesion,
//! `c0`, the cohesion impulse C₀Δt of each contact (N·s), and `cone`, `"shifted"` or `"compressive"`.
//! A solution is u = W r + q with r = (P_n, P_t) in N·s; `start` may give impulses to start from.
//! Problems of our own have their `bodies` beside W ([`BodyForm`]). Siconos' text files of plane
//! problems are read as well (`siconos`).
//!
//! This stands beside `study`, above the scenes: a problem is taken from a simulation.

mod bodies;
mod body_form;
mod dump;
mod problem_file;
mod reading;
mod siconos;
mod solution;

pub use body_form::BodyForm;
pub use dump::{problem_file_at, problem_file_of};
pub use problem_file::{Friction, ProblemFile};
pub use solution::{Solution, solve_file};
