//! What stands in for a GPU where the program is built without one.

use image::RgbaImage;

use super::Picture;
use super::drivers::Kind;
use crate::error::{Error, Result};

/// A GPU that draws pictures into memory: there is none.
pub(super) enum Offscreen {}

impl Offscreen {
    /// Says that there is none.
    pub(crate) fn open(kind: Kind) -> Result<Self> {
        Err(Error::Renderer(format!(
            "this build draws nothing by {}: build it with the feature gpu, or use --renderer cpu",
            kind.name()
        )))
    }

    pub(crate) fn name(&self) -> &str {
        match *self {}
    }

    pub(crate) fn largest_side(&self) -> u32 {
        match *self {}
    }

    pub(crate) fn draw(&mut self, _: &Picture, _: u32, _: u32) -> Result<RgbaImage> {
        match *self {}
    }
}
