//! Which bodies touch, and what a contact may transmit.

mod approach;
mod broad_phase;
mod candidates;
mod contact_list;
mod corners;
mod features;
mod grid;
mod joined;
mod lanes;
pub(crate) mod law;
mod look_ahead;
mod meeting;
mod numbering;
pub mod range;
mod separate;
mod too_close;
mod tree;

pub use broad_phase::BroadPhase;
pub use candidates::{Candidates, Reach};
pub use contact_list::{Contact, ContactList, ContactMemory, Impulse};
pub(crate) use features::Feature;
#[doc(hidden)]
pub use grid::Grid;
pub use joined::{JoinedGrains, most_contacts_joined};
pub use lanes::Lanes;
pub use law::ContactLaw;
#[cfg(test)]
pub(crate) use lanes::levels;
pub(crate) use look_ahead::LookAhead;
pub(crate) use meeting::Course;
pub use numbering::{Numbering, Other};
pub(crate) use too_close::check_distances;
