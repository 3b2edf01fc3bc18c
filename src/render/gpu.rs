//! A GPU that draws pictures into memory by Vulkan or OpenGL.
//!
//! Vulkan and OpenGL are requested separately, so that an error can name the missing driver. Software drivers (Mesa's
//! llvmpipe) count as GPUs, because they draw the same pictures.

use std::sync::{Arc, Mutex};

use image::RgbaImage;

use super::painter::{Painter, PictureArea};
use super::renderer_choice::GpuKind;
use super::{Colour, Picture};
use crate::error::{Error, Result, check};

pub(crate) struct Gpu {
    pub device: wgpu::Device,
    pub queue: wgpu::Queue,
    /// Kind of the driver (Vulkan or OpenGL) and name of the device.
    pub name: String,
    /// Message of the first failure that the graphics driver reported by a callback; [`Self::check`] returns it.
    failure: Arc<Mutex<Option<String>>>,
}

impl Gpu {
    /// Opens a GPU with a Vulkan driver, or with an OpenGL driver if Vulkan fails.
    #[cfg(feature = "panels")]
    pub(crate) fn any() -> Result<Self> {
        Self::open(GpuKind::Vulkan).or_else(|_| Self::open(GpuKind::Gl))
    }

    /// Opens the fastest device that has a driver of this kind (Vulkan or OpenGL).
    pub(super) fn open(kind: GpuKind) -> Result<Self> {
        let backends = match kind {
            GpuKind::Vulkan => wgpu::Backends::VULKAN,
            GpuKind::Gl => wgpu::Backends::GL,
        };
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor {
            backends,
            // With other flags, debug builds would load validation layers, which write to stderr.
            flags: wgpu::InstanceFlags::empty(),
            ..wgpu::InstanceDescriptor::new_without_display_handle()
        });
        let options = wgpu::RequestAdapterOptions {
            power_preference: wgpu::PowerPreference::HighPerformance,
            ..wgpu::RequestAdapterOptions::default()
        };
        let adapter =
            pollster::block_on(instance.request_adapter(&options)).map_err(|_| missing(kind))?;
        let name = format!("{}: {}", kind.name(), adapter.get_info().name);
        let (device, queue) = open_device(&adapter)
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

    /// Returns an error if any operation on the device has failed since the last call of this function.
    pub(crate) fn check(&self) -> Result<()> {
        let Some(message) = self.failure.lock().ok().and_then(|mut first| first.take()) else {
            return Ok(());
        };
        // Messages of wgpu have several lines; an error of this program is one sentence.
        let message = message.split_whitespace().collect::<Vec<_>>().join(" ");
        Err(Error::Renderer(format!("{} failed: {message}", self.name)))
    }
}

/// Opens a device of a driver. Textures and buffers may be as large as the driver allows; all other limits are those
/// that every driver has.
pub(crate) fn open_device(
    adapter: &wgpu::Adapter,
) -> std::result::Result<(wgpu::Device, wgpu::Queue), wgpu::RequestDeviceError> {
    let available = adapter.limits();
    pollster::block_on(adapter.request_device(&wgpu::DeviceDescriptor {
        label: Some("slump"),
        required_limits: wgpu::Limits {
            max_buffer_size: available.max_buffer_size,
            ..wgpu::Limits::downlevel_webgl2_defaults().using_resolution(available)
        },
        ..wgpu::DeviceDescriptor::default()
    }))
}

/// Begins to draw into a render target, which is first filled with one colour.
pub(crate) fn begin_pass<'a>(
    encoder: &'a mut wgpu::CommandEncoder,
    view: &wgpu::TextureView,
    colour: wgpu::Color,
) -> wgpu::RenderPass<'a> {
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations {
                load: wgpu::LoadOp::Clear(colour),
                store: wgpu::StoreOp::Store,
            },
        })],
        ..wgpu::RenderPassDescriptor::default()
    })
}

/// Returns an error that names the missing driver and the package that contains this driver.
fn missing(kind: GpuKind) -> Error {
    let (driver, packages) = match kind {
        GpuKind::Vulkan => ("Vulkan", "mesa-vulkan-drivers and libvulkan1"),
        GpuKind::Gl => ("OpenGL (EGL)", "libegl1 and libgl1-mesa-dri"),
    };
    Error::Renderer(format!(
        "no {driver} driver was found: install the Debian packages {packages}, or use \
         --renderer cpu, which needs no driver"
    ))
}

/// Texture format of pictures in memory. It stores the blended colour values unchanged; an sRGB format would convert
/// them.
pub(crate) const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;

/// A GPU that draws pictures into memory. The texture, and the buffer into which its pixels are copied, are kept until
/// the size of the pictures changes. Rows of the buffer are padded to 256 bytes, as texture copies require.
pub(super) struct Offscreen {
    gpu: Gpu,
    painter: Painter,
    target: Option<OffscreenTarget>,
}

/// The texture into which a picture is drawn, and the buffer into which its pixels are copied; both have the size of
/// the picture.
pub(crate) struct OffscreenTarget {
    pub width: u32,
    pub height: u32,
    padded_row_bytes: u32,
    texture: wgpu::Texture,
    pub view: wgpu::TextureView,
    readback: wgpu::Buffer,
}

impl Offscreen {
    /// Opens the fastest device that has a driver of this kind (Vulkan or OpenGL).
    pub(super) fn open(kind: GpuKind) -> Result<Self> {
        let gpu = Gpu::open(kind)?;
        let painter = Painter::new(&gpu.device, FORMAT);
        gpu.check()?;
        Ok(Self { gpu, painter, target: None })
    }

    pub(super) fn name(&self) -> &str {
        &self.gpu.name
    }

    /// Largest width and height of a picture, pixels.
    pub(super) fn largest_side(&self) -> u32 {
        self.gpu.device.limits().max_texture_dimension_2d
    }

    pub(super) fn draw(&mut self, picture: &Picture, width: u32, height: u32) -> Result<RgbaImage> {
        if self.target.as_ref().is_some_and(|old| (old.width, old.height) != (width, height)) {
            self.target = None;
        }
        let gpu = &self.gpu;
        let target = match &mut self.target {
            Some(target) => target,
            empty => empty.insert(OffscreenTarget::new(gpu, width, height)?),
        };
        let area = PictureArea::new(0.0, 0.0, width as f32, height as f32);
        self.painter.prepare(&gpu.device, &gpu.queue, picture, area);

        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let ground = clear_colour(picture.background);
        self.painter.draw(&mut begin_pass(&mut encoder, &target.view, ground));
        target.record_copy(&mut encoder);
        gpu.queue.submit([encoder.finish()]);
        let image = target.read(gpu);
        // A failure on the device explains more than the error of the readback that follows from it.
        gpu.check().and(image)
    }
}

/// Returns the colour with which the texture is cleared. It is rounded to an exact multiple of 1/255, so that all
/// drivers store the same byte.
fn clear_colour(colour: Colour) -> wgpu::Color {
    let [r, g, b, _] = colour.to_rgba8().0.map(|byte| f64::from(byte) / 255.0);
    wgpu::Color { r, g, b, a: 1.0 }
}

impl OffscreenTarget {
    pub(crate) fn new(gpu: &Gpu, width: u32, height: u32) -> Result<Self> {
        let padded_row_bytes = (4 * width).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
        let bytes = u64::from(padded_row_bytes) * u64::from(height);
        let largest = gpu.device.limits().max_buffer_size;
        let allowed = format!("at most {largest} bytes as a picture on {}", gpu.name);
        check(bytes <= largest, "size", format!("{width}x{height}"), allowed)?;
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
            // The receiver lives longer than the poll below, so only a lost device can prevent the message.
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
