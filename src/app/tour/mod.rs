//! The tour: stations that each show one thing, with worlds side by side and a sentence on what to watch.

mod progress;
mod station;
mod stations;
mod visits;

pub use self::progress::Tour;
pub use self::station::Station;
pub use self::stations::STATIONS;
