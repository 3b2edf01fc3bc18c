//! Which device draws the window, and how large pictures may be.

use crate::error::{Error, Result};

/// What draws the window.
#[derive(
    Clone,
    Copy,
    Debug,
    Default,
    PartialEq,
    Eq,
    serde::Serialize,
    serde::Deserialize,
    clap::ValueEnum,
)]
#[serde(rename_all = "kebab-case")]
pub enum RendererChoice {
    /// Vulkan if there is a driver, else OpenGL.
    #[default]
    Auto,
    /// Vulkan.
    Vulkan,
    /// OpenGL.
    Gl,
    /// The processor alone, which draws pictures and no window.
    Cpu,
}

/// Largest side of a picture, pixels.
const LARGEST_SIDE_PX: u32 = 16_384;

/// Fails unless a picture of this size can be drawn.
pub(crate) fn check_size(width: u32, height: u32) -> Result<()> {
    if (1..=LARGEST_SIDE_PX).contains(&width) && (1..=LARGEST_SIDE_PX).contains(&height) {
        return Ok(());
    }
    let allowed = format!("between 1x1 and {LARGEST_SIDE_PX}x{LARGEST_SIDE_PX} pixels");
    Err(Error::value("size", format!("{width}x{height}"), allowed))
}
