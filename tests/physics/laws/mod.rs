//! Tests of the contact laws on few bodies and small piles, mostly against exact motion.

mod cohesion;
mod conservation;
mod cradle;
mod floors;
mod impacts;
mod lmgc90;
mod lost_grains;
mod materials;
mod moments;
mod pyramid;
mod rolling;
mod slopes;
mod touch_tolerance;
mod turning_pairs;
mod two_bodies;
