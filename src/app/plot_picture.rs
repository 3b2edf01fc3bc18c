//! Pictures of the plots: the panel's own drawing, on a texture instead of the window.

use image::RgbaImage;

use super::canvas::Canvas;
use super::fill::fill;
use super::plots::{PlotData, draw};
use super::theme;
use super::world_curve::WorldCurve;
use crate::error::Result;

/// Pixels of a picture a point: words stay readable in print.
const PIXELS_PER_POINT: f32 = 2.0;
/// Passes until the axes have settled to the width of their labels.
const PASSES: usize = 4;

/// What is to be drawn.
pub(crate) struct PlotPicture {
    /// The curves.
    pub data: PlotData,
    /// Pixels.
    pub size: [u32; 2],
    /// Light ink on a dark ground.
    pub dark: bool,
}

/// Draws such pictures. Keep it: opening a device takes longer than a picture.
pub(crate) struct PlotPrinter {
    canvas: Canvas,
}

impl PlotPrinter {
    /// Opens a graphics device.
    ///
    /// # Errors
    /// Where there is none.
    pub(crate) fn new() -> Result<Self> {
        Ok(Self { canvas: Canvas::new()? })
    }

    /// Draws a picture.
    ///
    /// # Errors
    /// What the device reports.
    pub(crate) fn print(&mut self, picture: &PlotPicture) -> Result<RgbaImage> {
        let context = egui::Context::default();
        theme::install(&context);
        context.set_theme(if picture.dark { egui::Theme::Dark } else { egui::Theme::Light });
        let contents = |ui: &mut egui::Ui| {
            let ground = ui.visuals().extreme_bg_color;
            fill(ui, ui.max_rect(), ground);
            let frame = egui::Frame::new().inner_margin(12.0);
            egui::CentralPanel::default_margins().frame(frame).show(ui, |ui| {
                legend(ui, &picture.data);
                draw(ui, &picture.data);
            });
        };
        let mut image = RgbaImage::default();
        for pass in 1..=PASSES {
            let last = pass == PASSES;
            let drawn =
                self.canvas.draw(&context, picture.size, PIXELS_PER_POINT, last, contents)?;
            image = drawn.unwrap_or(image);
        }
        Ok(image)
    }
}

/// What the colours mean, where there is more than one.
fn legend(ui: &mut egui::Ui, data: &PlotData) {
    if data.worlds.len() < 2 {
        return;
    }
    ui.horizontal_wrapped(|ui| {
        for WorldCurve { name, colour, .. } in &data.worlds {
            ui.label(egui::RichText::new("■").color(*colour));
            ui.label(name);
        }
    });
}
