//! Draws a picture of the scene inside egui's pass, with the painter that draws PNG files.

use std::collections::HashMap;

use egui::{PaintCallback, PaintCallbackInfo, Rect};
use egui_wgpu::{Callback, CallbackResources, CallbackTrait, ScreenDescriptor};

use crate::render::{Painter, Picture, PictureArea};

/// The format of the target that callbacks draw into; whoever makes an egui renderer puts it among
/// the callback resources.
#[derive(Clone, Copy, Debug)]
pub(super) struct TargetFormat(pub wgpu::TextureFormat);

/// The format of the target. Tests draw into the one that egui recommends, and say nothing of it.
pub(super) fn target_format(resources: &CallbackResources) -> wgpu::TextureFormat {
    let told = resources.get::<TargetFormat>();
    told.map_or(wgpu::TextureFormat::Rgba8Unorm, |TargetFormat(format)| *format)
}

/// One painter a place in the window: their instance buffers hold what the pass is yet to draw.
struct Painters(HashMap<usize, Painter>);

struct SceneCallback {
    /// Tells the places of one window apart.
    place: usize,
    rect: Rect,
    picture: Picture,
}

/// A shape that draws `picture` in `rect` (points). Pictures are in physical pixels.
pub(super) fn scene_callback(place: usize, rect: Rect, picture: Picture) -> PaintCallback {
    Callback::new_paint_callback(rect, SceneCallback { place, rect, picture })
}

impl CallbackTrait for SceneCallback {
    fn prepare(
        &self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        screen: &ScreenDescriptor,
        _encoder: &mut wgpu::CommandEncoder,
        resources: &mut CallbackResources,
    ) -> Vec<wgpu::CommandBuffer> {
        let format = target_format(resources);
        let painters = resources.entry::<Painters>().or_insert_with(|| Painters(HashMap::new()));
        let painter = painters.0.entry(self.place).or_insert_with(|| Painter::new(device, format));
        let info = PaintCallbackInfo {
            viewport: self.rect,
            clip_rect: self.rect,
            pixels_per_point: screen.pixels_per_point,
            screen_size_px: screen.size_in_pixels,
        };
        let viewport = info.viewport_in_pixels();
        let frame = PictureArea::new(
            viewport.left_px as f32,
            viewport.top_px as f32,
            viewport.width_px as f32,
            viewport.height_px as f32,
        );
        painter.prepare(device, queue, &self.picture, frame);
        Vec::new()
    }

    fn paint(
        &self,
        _info: PaintCallbackInfo,
        pass: &mut wgpu::RenderPass<'static>,
        resources: &CallbackResources,
    ) {
        let painters = resources.get::<Painters>();
        if let Some(painter) = painters.and_then(|painters| painters.0.get(&self.place)) {
            painter.draw(pass);
        }
    }
}
