//! The surface of the window on a graphics device, and the recovery when the surface or the device is lost.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use wgpu::CurrentSurfaceTexture;
use winit::dpi::PhysicalSize;
use winit::event_loop::ActiveEventLoop;
use winit::window::Window;

use crate::app::canvas::Screen;
use crate::error::{Error, Result};
use crate::render::RendererChoice;
use crate::render::gpu::open_device;

/// Largest side of egui's font textures, pixels, that every graphics driver allows.
const LARGEST_SIDE_NEEDED: u32 = 2048;

/// Result of an attempt to draw a frame in the window.
pub(super) enum Drawn {
    Shown,
    /// The surface of the window has changed, so the frame must be drawn again.
    Again,
    /// The frame was not drawn, because the window is not visible.
    Hidden,
    /// The frame was not drawn, because the graphics device is lost.
    Lost,
}

/// The surface of the window and the graphics device that draws on it.
pub(super) struct WindowSurface {
    // This field is before the window, so that it is dropped first.
    surface: wgpu::Surface<'static>,
    instance: wgpu::Instance,
    window: Arc<Window>,
    configuration: wgpu::SurfaceConfiguration,
    screen: Screen,
    /// True if the graphics device is a software driver, so that the processor draws.
    pub is_software: bool,
    lost: Arc<AtomicBool>,
    /// Textures that the graphics device has not received yet, because their frames were not drawn.
    textures: egui::TexturesDelta,
}

impl WindowSurface {
    /// Opens the requested graphics driver. With `auto`, opens the fastest device that can draw in the window: first by
    /// Vulkan, then by the system's own interface, then by OpenGL.
    pub(super) fn new(
        events: &ActiveEventLoop,
        window: &Arc<Window>,
        renderer: RendererChoice,
    ) -> Result<Self> {
        // Each backend is tried separately, because a driver that exists but cannot draw on this display must not hide
        // another driver. The environment variable `WGPU_BACKEND` overrides the choice. Under Wine, Direct3D 12 opens
        // but draws nothing, so it is tried after Vulkan.
        let (first, others): (_, &[_]) = match renderer {
            RendererChoice::Auto => (
                wgpu::Backends::from_env().unwrap_or(wgpu::Backends::VULKAN),
                &[wgpu::Backends::PRIMARY, wgpu::Backends::GL],
            ),
            RendererChoice::Vulkan => (wgpu::Backends::VULKAN, &[]),
            RendererChoice::Gl => (wgpu::Backends::GL, &[]),
            RendererChoice::Cpu => {
                let allowed = "auto, vulkan or gl for the window (cpu with --headless)";
                return Err(Error::value("renderer", "cpu", allowed));
            }
        };
        let open = |backends| Self::with_backends(events, window, backends);
        others.iter().fold(open(first), |opened, &next| opened.or_else(|_| open(next)))
    }

    fn with_backends(
        events: &ActiveEventLoop,
        window: &Arc<Window>,
        backends: wgpu::Backends,
    ) -> Result<Self> {
        let display = Box::new(events.owned_display_handle());
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor {
            backends,
            flags: wgpu::InstanceFlags::empty(),
            ..wgpu::InstanceDescriptor::new_with_display_handle(display)
        });
        let surface =
            instance.create_surface(Arc::clone(window)).map_err(|error| no_driver(&error))?;
        let options = wgpu::RequestAdapterOptions {
            power_preference: wgpu::PowerPreference::HighPerformance,
            compatible_surface: Some(&surface),
            ..wgpu::RequestAdapterOptions::default()
        };
        let adapter = pollster::block_on(instance.request_adapter(&options))
            .map_err(|error| no_driver(&error))?;
        let (device, queue) = open_device(&adapter).map_err(|error| no_driver(&error))?;
        let lost = Arc::new(AtomicBool::new(false));
        let seen = Arc::clone(&lost);
        device.set_device_lost_callback(move |_, _| seen.store(true, Ordering::Relaxed));
        // An error that no function call returns leaves the picture unchanged; it must not end the program.
        device.on_uncaptured_error(Arc::new(|_| {}));

        let size = window.inner_size();
        let mut configuration = surface
            .get_default_config(&adapter, size.width.max(1), size.height.max(1))
            .ok_or_else(|| no_driver(&"the driver cannot draw on this display"))?;
        configuration.format = plain_format(&surface.get_capabilities(&adapter).formats)
            .unwrap_or(configuration.format);
        configuration.present_mode = wgpu::PresentMode::AutoVsync;
        surface.configure(&device, &configuration);
        let is_software = adapter.get_info().device_type == wgpu::DeviceType::Cpu;
        let screen = Screen::new(&device, &queue, configuration.format);
        Ok(Self {
            surface,
            instance,
            window: Arc::clone(window),
            configuration,
            screen,
            is_software,
            lost,
            textures: egui::TexturesDelta::default(),
        })
    }

    /// Largest side that egui's font textures may have on this graphics device, pixels.
    pub(super) fn largest_side(&self) -> usize {
        self.screen.device.limits().max_texture_dimension_2d.max(LARGEST_SIDE_NEEDED) as usize
    }

    /// Adapts the surface to the window's size, pixels.
    pub(super) fn resize(&mut self, size: PhysicalSize<u32>) {
        let largest = self.screen.device.limits().max_texture_dimension_2d;
        let [width, height] = [size.width, size.height].map(|side| side.clamp(1, largest));
        if (self.configuration.width, self.configuration.height) != (width, height) {
            (self.configuration.width, self.configuration.height) = (width, height);
            self.configure();
        }
    }

    fn configure(&self) {
        self.surface.configure(&self.screen.device, &self.configuration);
    }

    /// Destroys the graphics device, as a fault of the driver would, so that the window must recover.
    pub(super) fn destroy_device(&self) {
        self.screen.device.destroy();
    }

    /// Draws the output of egui in the window.
    pub(super) fn draw(&mut self, context: &egui::Context, output: egui::FullOutput) -> Drawn {
        self.textures.append(output.textures_delta);
        // `poll` runs callbacks of the device, including the callback that reports its loss.
        let polled = self.screen.device.poll(wgpu::PollType::Poll);
        if polled.is_err() || self.lost.load(Ordering::Relaxed) {
            self.textures.clear();
            return Drawn::Lost;
        }
        let (texture, again) = match self.surface.get_current_texture() {
            CurrentSurfaceTexture::Success(texture) => (texture, false),
            CurrentSurfaceTexture::Suboptimal(texture) => (texture, true),
            CurrentSurfaceTexture::Timeout | CurrentSurfaceTexture::Occluded => {
                return Drawn::Hidden;
            }
            CurrentSurfaceTexture::Outdated => {
                self.configure();
                return Drawn::Again;
            }
            CurrentSurfaceTexture::Lost | CurrentSurfaceTexture::Validation => {
                return self.replace_surface();
            }
        };
        let ppp = output.pixels_per_point;
        let primitives = context.tessellate(output.shapes, ppp);
        let view = texture.texture.create_view(&wgpu::TextureViewDescriptor::default());
        let size = [self.configuration.width, self.configuration.height];
        self.screen.draw(&view, size, ppp, &primitives, &mut self.textures, |_| {});
        self.window.pre_present_notify();
        self.screen.queue.present(texture);
        if again {
            self.configure();
        }
        Drawn::Shown
    }

    /// Replaces the lost surface of the window by a new surface on the same graphics device.
    fn replace_surface(&mut self) -> Drawn {
        match self.instance.create_surface(Arc::clone(&self.window)) {
            Ok(surface) => {
                self.surface = surface;
                self.configure();
                Drawn::Again
            }
            Err(_) => Drawn::Lost,
        }
    }
}

/// Returns a texture format that stores 8-bit colours unchanged, without conversion to sRGB; `None` if the surface has
/// no such format. With conversion, half-transparent colours would differ from those in picture files, where the sRGB
/// values themselves are blended.
fn plain_format(formats: &[wgpu::TextureFormat]) -> Option<wgpu::TextureFormat> {
    let plain = [wgpu::TextureFormat::Bgra8Unorm, wgpu::TextureFormat::Rgba8Unorm];
    formats.iter().copied().find(|format| plain.contains(format))
}

fn no_driver(error: &dyn std::fmt::Display) -> Error {
    let reason = error.to_string().split_whitespace().collect::<Vec<_>>().join(" ");
    Error::Renderer(format!(
        "no graphics driver can draw in a window: install the Debian packages mesa-vulkan-drivers \
         and libvulkan1, or libegl1 and libgl1-mesa-dri; --headless still works ({reason})"
    ))
}
