//! A GPU, on Vulkan or OpenGL, and what it draws into memory.
//!
//! Software drivers (Mesa's llvmpipe) count as GPUs: they draw the same pictures.

use std::sync::{Arc, Mutex};

use image::RgbaImage;

use crate::error::{Error, Result};

pub(crate) struct Gpu {
    pub device: wgpu::Device,
    pub queue: wgpu::Queue,
    /// Kind of driver and name of the device.
    pub name: String,
    /// Message of the first failure that no call reported directly.
    failure: Arc<Mutex<Option<String>>>,
}

impl Gpu {
    pub(crate) fn any() -> Result<Self> {
        Self::open(wgpu::Backends::VULKAN).or_else(|_| Self::open(wgpu::Backends::GL))
    }

    /// Opens the strongest device of one kind.
    pub(super) fn open(backends: wgpu::Backends) -> Result<Self> {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor {
            backends,
            // Debug builds would otherwise load validation layers and let them write to stderr.
            flags: wgpu::InstanceFlags::empty(),
            ..wgpu::InstanceDescriptor::new_without_display_handle()
        });
        let options = wgpu::RequestAdapterOptions {
            power_preference: wgpu::PowerPreference::HighPerformance,
            ..wgpu::RequestAdapterOptions::default()
        };
        let adapter = pollster::block_on(instance.request_adapter(&options)).map_err(|_| {
            Error::Renderer(
                "no Vulkan or OpenGL (EGL) driver was found: install the Debian packages \
                 mesa-vulkan-drivers and libvulkan1, or libegl1 and libgl1-mesa-dri"
                    .into(),
            )
        })?;
        let available = adapter.limits();
        let limits = wgpu::Limits {
            max_buffer_size: available.max_buffer_size,
            ..wgpu::Limits::downlevel_webgl2_defaults().using_resolution(available)
        };
        let about = adapter.get_info();
        let name = format!("{}: {}", about.backend.to_str(), about.name);
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
        let Some(message) = self.failure.lock().ok().and_then(|mut first| first.take()) else {
            return Ok(());
        };
        // Messages of wgpu run over several lines; an error is one sentence.
        let message = message.split_whitespace().collect::<Vec<_>>().join(" ");
        Err(Error::Renderer(format!("{} failed: {message}", self.name)))
    }
}

/// Stores the numbers that are blended; an sRGB format would convert them.
pub(crate) const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;

/// What a GPU draws a picture of one size into, in memory. Rows of the readback buffer are padded to the 256 bytes that
/// texture copies ask for.
pub(crate) struct OffscreenTarget {
    pub width: u32,
    pub height: u32,
    padded_row_bytes: u32,
    texture: wgpu::Texture,
    pub view: wgpu::TextureView,
    readback: wgpu::Buffer,
}

impl OffscreenTarget {
    pub(crate) fn new(gpu: &Gpu, width: u32, height: u32) -> Result<Self> {
        let padded_row_bytes = (4 * width).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
        let bytes = u64::from(padded_row_bytes) * u64::from(height);
        let largest = gpu.device.limits().max_buffer_size;
        if bytes > largest {
            return Err(Error::value(
                "size",
                format!("{width}x{height}"),
                format!("at most {largest} bytes as a picture on {}", gpu.name),
            ));
        }
        let size = wgpu::Extent3d { width, height, depth_or_array_layers: 1 };
        let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("picture"),
            size,
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: FORMAT,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        });
        let readback = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("readback"),
            size: bytes,
            usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        gpu.check()?;
        let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
        Ok(Self { width, height, padded_row_bytes, texture, view, readback })
    }

    pub(crate) fn record_copy(&self, encoder: &mut wgpu::CommandEncoder) {
        encoder.copy_texture_to_buffer(
            self.texture.as_image_copy(),
            wgpu::TexelCopyBufferInfo {
                buffer: &self.readback,
                layout: wgpu::TexelCopyBufferLayout {
                    offset: 0,
                    bytes_per_row: Some(self.padded_row_bytes),
                    rows_per_image: None,
                },
            },
            self.texture.size(),
        );
    }

    pub(crate) fn read(&self, gpu: &Gpu) -> Result<RgbaImage> {
        let failed = |what: &dyn std::fmt::Display| {
            Error::Renderer(format!("{} gave no picture back: {what}", gpu.name))
        };
        let (sender, receiver) = std::sync::mpsc::channel();
        self.readback.map_async(wgpu::MapMode::Read, .., move |outcome| {
            // The receiver outlives the poll below, so only a lost device can leave none.
            let _ = sender.send(outcome);
        });
        gpu.device.poll(wgpu::PollType::wait_indefinitely()).map_err(|error| failed(&error))?;
        match receiver.try_recv() {
            Ok(Ok(())) => {}
            Ok(Err(error)) => return Err(failed(&error)),
            Err(error) => return Err(failed(&error)),
        }
        let row_bytes = 4 * self.width as usize;
        let mut image = RgbaImage::new(self.width, self.height);
        {
            let mapped = self.readback.get_mapped_range(..).map_err(|error| failed(&error))?;
            let padded_rows = mapped.chunks_exact(self.padded_row_bytes as usize);
            for (row, padded) in image.chunks_exact_mut(row_bytes).zip(padded_rows) {
                row.copy_from_slice(&padded[..row_bytes]);
            }
        }
        self.readback.unmap();
        Ok(image)
    }
}
