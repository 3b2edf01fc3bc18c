//! A user interface drawn into memory: pictures of plots, and measurements without a window.

use image::RgbaImage;

use super::graphics::Screen;
use crate::error::{Error, Result};
use crate::render::Gpu;
use crate::render::gpu::{FORMAT, OffscreenTarget};

/// A graphics device without a window.
pub struct Canvas {
    gpu: Gpu,
    screen: Screen,
    target: Option<OffscreenTarget>,
}

impl Canvas {
    /// Opens the device that pictures of scenes are drawn on.
    ///
    /// # Errors
    /// Where there is none; says what brings one.
    pub fn new() -> Result<Self> {
        let gpu = Gpu::any()?;
        let screen = Screen::new(&gpu.device, &gpu.queue, FORMAT);
        Ok(Self { gpu, screen, target: None })
    }

    /// What draws.
    pub fn name(&self) -> &str {
        &self.gpu.name
    }

    /// Runs one pass of a user interface on `size` pixels and draws it. With `read`, returns the
    /// picture; otherwise waits until it is drawn.
    ///
    /// # Errors
    /// Names `size` where the device cannot draw it, or says what the device reports.
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
        if width == 0 || height == 0 || width.max(height) > largest {
            let allowed = format!("between 1x1 and {largest}x{largest} pixels on {}", gpu.name);
            return Err(Error::value("size", format!("{width}x{height}"), allowed));
        }
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
        let output = context.run_ui(input, contents);
        let primitives = context.tessellate(output.shapes, output.pixels_per_point);
        self.screen.update_textures(&output.textures_delta);
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let extra = self.screen.paint(
            &mut encoder,
            &target.view,
            size,
            output.pixels_per_point,
            &primitives,
        );
        if read {
            target.record_copy(&mut encoder);
        }
        gpu.queue.submit(extra.into_iter().chain([encoder.finish()]));
        self.screen.free_textures(&output.textures_delta);
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
}
