//! Where methods fail: scenes made to break them, each with a right answer, what was measured on it,
//! and the parameter that drives it into failure. A scene is in `scene::stability`, its measure in
//! the file of the same subject here, and [`CHALLENGES`] lists all.

mod borders;
mod challenge;
mod challenges;
mod contenders;
pub mod maps;
mod measures;
mod picture;
mod table;
mod trial;

pub use borders::contraction_of_column;
pub use challenge::{Challenge, Limits};
pub use challenges::CHALLENGES;
pub(crate) use contenders::CONTENDERS;
pub use contenders::Contender;
pub use maps::{count_of_maps, maps};
pub use picture::picture;
pub use table::{Cell, StabilityTable, Verdict};
pub use trial::Trial;
