//! New piles: discs put into a box over a rough base and left to come to rest, by rain or quickly.

mod drop_and_roll;
mod new_pile;
mod rain;
mod resting;
mod rolling;
mod settle;
mod sizes;
mod surface;

pub use drop_and_roll::drop_and_roll;
pub use new_pile::{Deposition, NewPile};
pub use resting::walls;
pub use resting::{Settled, Settling};
pub use rolling::{Rest, Support, dropped};
pub use settle::start_of;
pub use settle::{deposit, settle};
pub use surface::Surface;
