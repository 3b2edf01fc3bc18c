//! Which renderer is asked for, and what it needs of the system.

/// Which renderer to use.
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
    /// Vulkan if there is a driver, else OpenGL, else the processor.
    #[default]
    Auto,
    /// Vulkan.
    Vulkan,
    /// OpenGL, without a window through EGL.
    Gl,
    /// The processor alone.
    Cpu,
}

/// Keeps a layer of Mesa's Vulkan from writing to stderr where there is no desktop: it asks for a
/// Wayland display, which complains if `XDG_RUNTIME_DIR` is not set. With a desktop nothing changes.
///
/// # Safety
/// Changes the environment, so it must run before the program starts its second thread.
pub unsafe fn quieten_drivers() {
    if std::env::var_os("XDG_RUNTIME_DIR").is_none() {
        // SAFETY: the caller states that no other thread can be reading the environment.
        unsafe { std::env::set_var("NODEVICE_SELECT", "1") };
    }
}

/// The kinds of GPU that can be asked for.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Vulkan,
    Gl,
}

impl Kind {
    /// Its name on the command line.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Vulkan => "vulkan",
            Self::Gl => "gl",
        }
    }
}
