//! Detection of contacts, and the laws for the impulses that contacts transmit.

mod approach;
mod broad_phase;
mod candidates;
mod contact_list;
mod features;
mod images;
mod lanes;
pub(crate) mod law;
mod numbering;
mod pair;
mod pair_laws;
pub mod range;
mod seam_search;
mod seams;
mod too_close;
mod transmitted;

pub(crate) use approach::{InTouch, LookAhead, RelativeMotion};
pub use broad_phase::BroadPhase;
#[doc(hidden)]
pub use broad_phase::Grid;
pub use candidates::{Candidates, Reach};
pub use contact_list::ContactList;
pub(crate) use contact_list::ContactParts;
pub(crate) use features::Feature;
pub(crate) use lanes::Lanes;
#[cfg(test)]
pub(crate) use lanes::levels;
pub use law::ContactLaw;
pub use numbering::{Numbering, Other};
pub use pair::{Contact, ContactMemory, Impulse};
pub(crate) use pair_laws::PairLaws;
pub use pair_laws::RowNumbers;
pub(crate) use too_close::check_distances;
pub(crate) use transmitted::Transmitted;
