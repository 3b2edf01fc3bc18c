//! Which bodies touch, and what a contact may transmit.

mod approach;
mod candidates;
mod contact_list;
mod features;
mod grid;
mod lanes;
pub mod law;
mod numbering;
pub mod range;
mod separate;
mod tree;

pub use candidates::{Candidates, Reach};
pub use contact_list::{Contact, ContactList, ContactMemory, Impulse, LookAhead};
pub use features::Feature;
pub use grid::Grid;
pub use lanes::Lanes;
#[cfg(test)]
pub(crate) use lanes::levels;
pub use numbering::{Numbering, Other};
pub use tree::Tree;
