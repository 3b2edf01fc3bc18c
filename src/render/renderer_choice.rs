//! The renderers that a user can choose, and the kinds of GPU drivers.

/// The renderer that the user chooses.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum RendererChoice {
    /// Vulkan if there is a driver, else OpenGL, else the processor.
    #[default]
    Auto,
    /// Vulkan.
    Vulkan,
    /// OpenGL, without a window through EGL.
    Gl,
    /// Only the processor.
    Cpu,
}

/// The kinds of GPU drivers that a renderer can use.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum GpuKind {
    Vulkan,
    Gl,
}

impl GpuKind {
    /// Name of the driver on the command line.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Vulkan => "vulkan",
            Self::Gl => "gl",
        }
    }
}
