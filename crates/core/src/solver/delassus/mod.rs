//! Contact problems in the Delassus operator alone.

mod assembly;
mod blocks;
mod local;
mod problem;
mod sweeps;
mod system;

pub use self::assembly::Assembled;
pub use self::blocks::Triplets;
pub use self::problem::DelassusProblem;
pub use self::sweeps::solve_delassus;
