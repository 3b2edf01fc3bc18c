//! The renderer, which draws a picture by Vulkan, by OpenGL or on the processor.

use image::RgbaImage;

#[cfg(feature = "gpu")]
use super::gpu::Offscreen;
use super::renderer_choice::{GpuKind, RendererChoice};
use super::{Picture, primitives};
use crate::error::{Result, check};

/// Prevents Mesa's Vulkan driver from writing to stderr on systems without a desktop. A layer of the driver connects to
/// a Wayland display, and the library for this connection writes a message if `XDG_RUNTIME_DIR` is not set. With a
/// desktop this function does nothing.
///
/// # Safety
/// Changes the environment, so it must run before the program starts its second thread.
pub unsafe fn quieten_drivers() {
    if std::env::var_os("XDG_RUNTIME_DIR").is_none() {
        // SAFETY: the caller guarantees that no other thread reads the environment.
        unsafe { std::env::set_var("NODEVICE_SELECT", "1") };
    }
}

/// Largest width and height of a picture that the processor draws, pixels. Most GPUs have the same limit, so a size
/// that works with one renderer also works with another.
const CPU_LARGEST_SIDE_PX: u32 = 16_384;

/// A renderer, which draws pictures into memory. Keep it for all pictures, because creating a renderer takes longer
/// than drawing a picture.
pub struct Renderer {
    backend: Backend,
}

enum Backend {
    // Boxed because the other variant contains no data.
    #[cfg(feature = "gpu")]
    Gpu(Box<Offscreen>),
    Cpu,
}

impl Backend {
    #[cfg(feature = "gpu")]
    fn open(kind: GpuKind) -> Result<Self> {
        Ok(Self::Gpu(Box::new(Offscreen::open(kind)?)))
    }

    #[cfg(not(feature = "gpu"))]
    fn open(kind: GpuKind) -> Result<Self> {
        Err(crate::error::Error::Renderer(format!(
            "this build draws nothing by {}: build it with the feature gpu, or use --renderer cpu",
            kind.name()
        )))
    }
}

impl Renderer {
    /// Opens the chosen renderer.
    ///
    /// # Errors
    /// Names the missing driver and the package that contains it. `Auto` and `Cpu` cannot fail.
    pub fn new(choice: RendererChoice) -> Result<Self> {
        let backend = match choice {
            RendererChoice::Vulkan => Backend::open(GpuKind::Vulkan)?,
            RendererChoice::Gl => Backend::open(GpuKind::Gl)?,
            RendererChoice::Cpu => Backend::Cpu,
            // The browser version must not wait for a graphics device.
            RendererChoice::Auto if cfg!(target_arch = "wasm32") => Backend::Cpu,
            RendererChoice::Auto => Backend::open(GpuKind::Vulkan)
                .or_else(|_| Backend::open(GpuKind::Gl))
                .unwrap_or(Backend::Cpu),
        };
        Ok(Self { backend })
    }

    /// Name of the renderer, such as "vulkan: llvmpipe (LLVM 15.0.6, 256 bits)" or "cpu".
    pub fn name(&self) -> &str {
        match &self.backend {
            #[cfg(feature = "gpu")]
            Backend::Gpu(offscreen) => offscreen.name(),
            Backend::Cpu => "cpu",
        }
    }

    /// Largest width and height of a picture that this renderer can draw, pixels.
    pub(crate) fn largest_side(&self) -> u32 {
        match &self.backend {
            #[cfg(feature = "gpu")]
            Backend::Gpu(offscreen) => offscreen.largest_side(),
            Backend::Cpu => CPU_LARGEST_SIDE_PX,
        }
    }

    /// Draws a picture of `width` × `height` pixels.
    ///
    /// # Errors
    /// If a side of the picture has 0 pixels or is too long for the renderer, the error names `size`. Other errors have
    /// the message of the graphics device.
    pub(crate) fn draw(&mut self, picture: &Picture, width: u32, height: u32) -> Result<RgbaImage> {
        self.check_size(width, height)?;
        match &mut self.backend {
            #[cfg(feature = "gpu")]
            Backend::Gpu(offscreen) => offscreen.draw(picture, width, height),
            Backend::Cpu => Ok(primitives::draw(picture, width, height)),
        }
    }

    /// Checks that a picture of this size can be drawn.
    ///
    /// # Errors
    /// If a side of the picture has 0 pixels or is too long for the renderer. The error names `size`.
    pub(crate) fn check_size(&self, width: u32, height: u32) -> Result<()> {
        let largest = self.largest_side();
        let is_possible = (1..=largest).contains(&width) && (1..=largest).contains(&height);
        let allowed = format!("between 1x1 and {largest}x{largest} pixels on {}", self.name());
        check(is_possible, "size", format!("{width}x{height}"), allowed)
    }
}
