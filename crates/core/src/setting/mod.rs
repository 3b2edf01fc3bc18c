//! Settings, each declared once: its name, its default, what it may be, and how it is explained.
//!
//! `settings!` makes of a list of declarations the plain structure that the physics reads, the structure
//! of changes that command line, scene and study files fill in ([`Group::Changes`]), the check of the ranges,
//! and a table ([`About`]) from which options, controls and messages are made. `words!` does so for a
//! setting that is one of a few words.

mod about;
mod declare;
mod value;

pub(crate) use about::Declared;
pub use about::{About, Control, Needs};
pub use declare::{Changes, Group};
pub(crate) use declare::{settings, words};
pub use value::{Kind, Settable, Value, Word};
