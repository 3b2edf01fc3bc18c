//! The legend's strip as a texture, drawn again only where it says something new.

use egui::{ColorImage, Rect, TextureHandle, TextureOptions};

use crate::render::Legend;

/// The legend that was drawn last.
#[derive(Default)]
pub(super) struct LegendCache(Option<(Legend, [u32; 2], TextureHandle)>);

impl LegendCache {
    /// Paints a legend into `rect`, `size` pixels.
    pub(super) fn paint(&mut self, ui: &egui::Ui, rect: Rect, legend: Legend, size: [u32; 2]) {
        let fresh = self.0.as_ref().is_some_and(|(old, at, _)| *old == legend && *at == size);
        if !fresh {
            let strip = legend.draw(size[0], size[1]);
            let pixels = [size[0] as usize, size[1] as usize];
            let image = ColorImage::from_rgba_unmultiplied(pixels, strip.as_raw());
            let options = TextureOptions::NEAREST;
            match &mut self.0 {
                Some((old, at, texture)) => {
                    texture.set(image, options);
                    (*old, *at) = (legend, size);
                }
                empty => {
                    let texture = ui.ctx().load_texture("legend", image, options);
                    *empty = Some((legend, size, texture));
                }
            }
        }
        if let Some((_, _, texture)) = &self.0 {
            let whole = Rect::from_min_max(egui::pos2(0.0, 0.0), egui::pos2(1.0, 1.0));
            ui.painter().image(texture.id(), rect, whole, egui::Color32::WHITE);
        }
    }

    /// Forgets the texture: its context is gone.
    pub(super) fn forget(&mut self) {
        self.0 = None;
    }
}
