//! Finding a GPU: Vulkan, OpenGL, or neither.
//!
//! Each kind is asked for by itself, so that a missing driver can be named. Software drivers (Mesa's
//! llvmpipe) count as GPUs: they draw the same pictures.

use std::sync::{Arc, Mutex};

use super::drivers::Kind;
use crate::error::{Error, Result};

/// An opened GPU.
pub(crate) struct Gpu {
    pub device: wgpu::Device,
    pub queue: wgpu::Queue,
    /// Kind of driver and name of the device.
    pub name: String,
    /// Message of the first failure that no call reported directly.
    failure: Arc<Mutex<Option<String>>>,
}

impl Gpu {
    /// Opens a GPU of either kind.
    #[cfg(feature = "window")]
    pub(crate) fn any() -> Result<Self> {
        Self::open(Kind::Vulkan).or_else(|_| Self::open(Kind::Gl))
    }

    /// Opens the strongest device of one kind.
    pub(super) fn open(kind: Kind) -> Result<Self> {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor {
            backends: backends(kind),
            // Debug builds would otherwise load validation layers and let them write to stderr.
            flags: wgpu::InstanceFlags::empty(),
            ..wgpu::InstanceDescriptor::new_without_display_handle()
        });
        let options = wgpu::RequestAdapterOptions {
            power_preference: wgpu::PowerPreference::HighPerformance,
            ..wgpu::RequestAdapterOptions::default()
        };
        let adapter =
            pollster::block_on(instance.request_adapter(&options)).map_err(|_| missing(kind))?;
        let available = adapter.limits();
        let limits = wgpu::Limits {
            max_buffer_size: available.max_buffer_size,
            ..wgpu::Limits::downlevel_webgl2_defaults().using_resolution(available)
        };
        let name = format!("{}: {}", kind.name(), adapter.get_info().name);
        let request = adapter.request_device(&wgpu::DeviceDescriptor {
            label: Some("slump"),
            required_limits: limits,
            ..wgpu::DeviceDescriptor::default()
        });
        let (device, queue) = pollster::block_on(request)
            .map_err(|error| Error::Renderer(format!("{name} does not open: {error}")))?;

        let failure = Arc::new(Mutex::new(None));
        let seen = Arc::clone(&failure);
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
            if let Ok(mut first) = seen.lock() {
                first.get_or_insert_with(|| error.to_string());
            }
        }));
        Ok(Self { device, queue, name, failure })
    }

    /// Fails if anything went wrong on the device since the last call.
    pub(crate) fn check(&self) -> Result<()> {
        let message = self.failure.lock().ok().and_then(|mut first| first.take());
        match message {
            Some(message) => {
                // Messages of wgpu run over several lines; an error is one sentence.
                let message = message.split_whitespace().collect::<Vec<_>>().join(" ");
                Err(Error::Renderer(format!("{} failed: {message}", self.name)))
            }
            None => Ok(()),
        }
    }
}

fn backends(kind: Kind) -> wgpu::Backends {
    match kind {
        Kind::Vulkan => wgpu::Backends::VULKAN,
        Kind::Gl => wgpu::Backends::GL,
    }
}

/// What is missing and what brings it, as one sentence.
fn missing(kind: Kind) -> Error {
    let (driver, packages) = match kind {
        Kind::Vulkan => ("Vulkan", "mesa-vulkan-drivers and libvulkan1"),
        Kind::Gl => ("OpenGL (EGL)", "libegl1 and libgl1-mesa-dri"),
    };
    Error::Renderer(format!(
        "no {driver} driver was found: install the Debian packages {packages}, or use \
         --renderer cpu, which needs no driver"
    ))
}
