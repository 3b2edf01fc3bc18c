//! Charts as plain data: what is on them, independent of how they are drawn. The same data makes the
//! PNG, the SVG and the CSV, so that the CSV holds every point.

mod csv;
mod draw;
mod layout;
mod places;
mod scale;
mod sheet;

pub use draw::{png, svg};
pub use scale::Scale;
pub use sheet::{Axis, Cell, Chart, Corner, Layer, Look, PALETTE, Point, Rgb, Sheet};
pub(crate) use sheet::{INK, points};
