//! Drawing of egui's user interface on a graphics device, in a window or in memory. Pictures of plots and measurements
//! of the drawing time need no window.

use egui::{ClippedPrimitive, TexturesDelta};
use egui_wgpu::{Renderer, RendererOptions, ScreenDescriptor};
use image::RgbaImage;

use super::painting::{TargetFormat, fill};
use super::theme;
use crate::error::{Error, Result, check};
use crate::render::Gpu;
use crate::render::gpu::{FORMAT, OffscreenTarget, begin_pass};

/// Renderer of user interfaces, for render targets of one texture format.
pub(super) struct Screen {
    pub device: wgpu::Device,
    pub queue: wgpu::Queue,
    renderer: Renderer,
}

impl Screen {
    /// Returns a renderer for render targets with this texture format.
    pub(super) fn new(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        format: wgpu::TextureFormat,
    ) -> Self {
        // Without dithering, because the user interface has no colour gradients that would show bands.
        let options = RendererOptions { dithering: false, ..RendererOptions::default() };
        let mut renderer = Renderer::new(device, format, options);
        renderer.callback_resources.insert(TargetFormat(format));
        Self { device: device.clone(), queue: queue.clone(), renderer }
    }

    /// Uploads egui's textures and draws egui's shapes into a render target of `size` pixels. `then` can record GPU
    /// commands that run after the drawing.
    pub(super) fn draw(
        &mut self,
        view: &wgpu::TextureView,
        size: [u32; 2],
        pixels_per_point: f32,
        primitives: &[ClippedPrimitive],
        textures: &mut TexturesDelta,
        then: impl FnOnce(&mut wgpu::CommandEncoder),
    ) {
        let Self { device, queue, renderer } = self;
        for (id, changes) in &textures.set {
            for change in changes {
                renderer.update_texture(device, queue, *id, change);
            }
        }
        let screen = ScreenDescriptor { size_in_pixels: size, pixels_per_point };
        let mut encoder = device.create_command_encoder(&Default::default());
        let extra = renderer.update_buffers(device, queue, &mut encoder, primitives, &screen);
        let pass = begin_pass(&mut encoder, view, wgpu::Color::BLACK);
        renderer.render(&mut pass.forget_lifetime(), primitives, &screen);
        then(&mut encoder);
        queue.submit(extra.into_iter().chain([encoder.finish()]));
        for id in &textures.free {
            renderer.free_texture(id);
        }
        textures.clear();
    }
}

/// Pixels per point in a picture of plots. The value is large enough that text is readable in print.
const PIXELS_PER_POINT: f32 = 2.0;
/// Number of passes (layout and drawing of one frame) until egui's plots have adapted to the width of their labels.
const PASSES: usize = 4;

/// A graphics device that draws into memory.
pub struct Canvas {
    gpu: Gpu,
    screen: Screen,
    target: Option<OffscreenTarget>,
}

impl Canvas {
    /// Opens a graphics device.
    ///
    /// # Errors
    /// If there is no graphics device. The message names the packages that provide one.
    pub fn new() -> Result<Self> {
        let gpu = Gpu::any()?;
        let screen = Screen::new(&gpu.device, &gpu.queue, FORMAT);
        Ok(Self { gpu, screen, target: None })
    }

    /// Name of the graphics device.
    pub fn name(&self) -> &str {
        &self.gpu.name
    }

    /// Runs one pass of a user interface and draws it on a picture of `size` pixels. If `read` is true, returns the
    /// picture; otherwise waits until the drawing is complete.
    ///
    /// # Errors
    /// Names `size` if the device cannot draw a picture of that size; other errors have the message of the device.
    pub fn draw(
        &mut self,
        context: &egui::Context,
        size: [u32; 2],
        pixels_per_point: f32,
        read: bool,
        contents: impl FnMut(&mut egui::Ui),
    ) -> Result<Option<RgbaImage>> {
        let [width, height] = size;
        let gpu = &self.gpu;
        let largest = gpu.device.limits().max_texture_dimension_2d;
        let is_possible = width.min(height) > 0 && width.max(height) <= largest;
        let allowed = format!("between 1x1 and {largest}x{largest} pixels on {}", gpu.name);
        check(is_possible, "size", format!("{width}x{height}"), allowed)?;
        let target = match self.target.take() {
            Some(target) if (target.width, target.height) == (width, height) => target,
            _ => OffscreenTarget::new(gpu, width, height)?,
        };
        context.set_pixels_per_point(pixels_per_point);
        let points = egui::vec2(width as f32, height as f32) / pixels_per_point;
        let input = egui::RawInput {
            screen_rect: Some(egui::Rect::from_min_size(egui::Pos2::ZERO, points)),
            ..egui::RawInput::default()
        };
        let mut output = context.run_ui(input, contents);
        let primitives = context.tessellate(output.shapes, output.pixels_per_point);
        let (ppp, textures) = (output.pixels_per_point, &mut output.textures_delta);
        self.screen.draw(&target.view, size, ppp, &primitives, textures, |encoder| {
            if read {
                target.record_copy(encoder);
            }
        });
        let image = if read {
            Some(target.read(gpu)?)
        } else {
            let waited = gpu.device.poll(wgpu::PollType::wait_indefinitely());
            waited.map_err(|error| Error::Renderer(format!("{} failed: {error}", gpu.name)))?;
            None
        };
        self.target = Some(target);
        gpu.check()?;
        Ok(image)
    }

    /// Draws a picture of plots. If `dark` is true, its lines and text are light on a dark ground.
    pub(super) fn print(
        &mut self,
        size: [u32; 2],
        dark: bool,
        plots: impl Fn(&mut egui::Ui),
    ) -> Result<RgbaImage> {
        let context = egui::Context::default();
        theme::install(&context);
        context.set_theme(if dark { egui::Theme::Dark } else { egui::Theme::Light });
        let contents = |ui: &mut egui::Ui| {
            let ground = ui.visuals().extreme_bg_color;
            fill(ui, ui.max_rect(), ground);
            let frame = egui::Frame::new().inner_margin(12.0);
            egui::CentralPanel::default_margins().frame(frame).show(ui, |ui| plots(ui));
        };
        let mut image = None;
        for pass in 1..=PASSES {
            image = self.draw(&context, size, PIXELS_PER_POINT, pass == PASSES, contents)?;
        }
        Ok(image.unwrap_or_default())
    }
}
