//! The laws of contact on few bodies and small piles, held against exact motion.

mod cohesion;
mod conservation;
mod cradle;
mod floors;
mod impacts;
mod lost_grains;
mod moments;
mod slopes;
mod two_bodies;
