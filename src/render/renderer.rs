//! One way to draw a picture, whatever draws it: Vulkan, OpenGL or the processor.

use image::RgbaImage;

use super::Picture;
use super::cpu;
use super::drivers::{Kind, RendererChoice};
#[cfg(not(feature = "gpu"))]
use super::no_gpu::Offscreen;
#[cfg(feature = "gpu")]
use super::offscreen::Offscreen;
use crate::error::{Error, Result};

/// Largest side of a picture drawn by the processor, pixels: what most GPUs allow as well, so that
/// a size that works here works there.
const CPU_LARGEST_SIDE_PX: u32 = 16_384;

/// Draws pictures into memory. Keep it between frames: making one costs more than a frame.
pub struct Renderer {
    engine: Engine,
}

enum Engine {
    // Boxed because the other variant holds nothing.
    Gpu(Box<Offscreen>),
    Cpu,
}

impl Renderer {
    /// Opens the renderer that was asked for.
    ///
    /// # Errors
    /// Says which driver is missing and which package brings it. `Auto` and `Cpu` cannot fail.
    pub fn new(choice: RendererChoice) -> Result<Self> {
        let open = |kind| -> Result<Self> {
            Ok(Self { engine: Engine::Gpu(Box::new(Offscreen::open(kind)?)) })
        };
        let cpu = Self { engine: Engine::Cpu };
        match choice {
            RendererChoice::Vulkan => open(Kind::Vulkan),
            RendererChoice::Gl => open(Kind::Gl),
            RendererChoice::Cpu => Ok(cpu),
            RendererChoice::Auto => {
                Ok(open(Kind::Vulkan).or_else(|_| open(Kind::Gl)).unwrap_or(cpu))
            }
        }
    }

    /// What draws, such as "vulkan: llvmpipe (LLVM 15.0.6, 256 bits)" or "cpu".
    pub fn name(&self) -> &str {
        match &self.engine {
            Engine::Gpu(offscreen) => offscreen.name(),
            Engine::Cpu => "cpu",
        }
    }

    /// Largest width and height that this renderer draws, pixels.
    pub(crate) fn largest_side(&self) -> u32 {
        match &self.engine {
            Engine::Gpu(offscreen) => offscreen.largest_side(),
            Engine::Cpu => CPU_LARGEST_SIDE_PX,
        }
    }

    /// Draws a picture of `width` × `height` pixels.
    ///
    /// # Errors
    /// Names `size` if it is empty or too large; otherwise says what the device reported.
    pub(crate) fn draw(&mut self, picture: &Picture, width: u32, height: u32) -> Result<RgbaImage> {
        self.check_size(width, height)?;
        match &mut self.engine {
            Engine::Gpu(offscreen) => offscreen.draw(picture, width, height),
            Engine::Cpu => Ok(cpu::draw(picture, width, height)),
        }
    }

    /// Fails unless a picture of this size can be drawn.
    ///
    /// # Errors
    /// Names `size`.
    pub(crate) fn check_size(&self, width: u32, height: u32) -> Result<()> {
        let largest = self.largest_side();
        if (1..=largest).contains(&width) && (1..=largest).contains(&height) {
            return Ok(());
        }
        Err(Error::value(
            "size",
            format!("{width}x{height}"),
            format!("between 1x1 and {largest}x{largest} pixels on {}", self.name()),
        ))
    }
}
