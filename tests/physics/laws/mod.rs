//! The laws of contact on few bodies and small piles, held against exact motion.

mod conservation;
mod coulombs_cone;
mod cradle;
mod hanging_chain;
mod honest_reports;
mod impacts;
mod lost_grains;
mod moments;
mod moving_walls;
mod pile_physics;
mod restitution;
mod rolling_and_sliding;
mod speculative;
mod stalls;
mod two_bodies;
