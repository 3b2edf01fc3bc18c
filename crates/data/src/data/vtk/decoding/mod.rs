//! `.vtp` files, ours or those that ParaView and PyVista save, as arrays of numbers.

mod arrays;
mod xml;

pub(in crate::data) use arrays::{values, words};
pub(in crate::data) use xml::{DataArray, Document, Piece};

/// A value, or what is amiss.
pub(in crate::data) type Said<T> = Result<T, String>;
