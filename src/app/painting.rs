//! Shapes that Slump's own GPU pipelines paint inside egui's render pass: the scene, filled areas, and the legend.

use std::collections::HashMap;

use egui::{
    Color32, ColorImage, PaintCallback, PaintCallbackInfo, Rect, TextureHandle, TextureOptions, Ui,
};
use egui_wgpu::{Callback, CallbackResources, CallbackTrait, ScreenDescriptor};

use crate::render::{Legend, Painter, Picture, PictureArea};

/// Texture format of the picture into which egui draws. Slump's paint callbacks, which egui calls to draw shapes with
/// Slump's own GPU commands, make their GPU pipelines for this format. The owner of an egui renderer must store the
/// format among the resources of the paint callbacks; otherwise they assume `Rgba8Unorm`.
#[derive(Clone, Copy, Debug)]
pub(super) struct TargetFormat(pub wgpu::TextureFormat);

/// GPU resources of all paintings, among the resources of the paint callbacks.
#[derive(Default)]
struct Painters {
    /// Painters of the scenes that the window shows, each stored under the number of its scene. A painter owns GPU
    /// buffers with the shapes of its scene. They must exist until the GPU has drawn the frame.
    scenes: HashMap<usize, Painter>,
    /// One GPU pipeline for each colour with which an area was filled. A theme has few colours, so there are few
    /// pipelines.
    fills: HashMap<Color32, wgpu::RenderPipeline>,
}

/// Shape that a paint callback draws.
enum Painting {
    /// A picture in a rectangle (points). The number identifies the scene in the window.
    Scene(usize, Rect, Picture),
    /// An area of one colour.
    Fill(Color32),
}

/// Returns a paint callback that draws `picture` in `rect` (points). The coordinates of the picture are physical
/// pixels. `place` is the number of the scene in the window.
pub(super) fn scene_callback(place: usize, rect: Rect, picture: Picture) -> PaintCallback {
    Callback::new_paint_callback(rect, Painting::Scene(place, rect, picture))
}

/// Fills a rectangle (points) with an opaque colour. Shapes that are painted later cover it.
pub(super) fn fill(ui: &Ui, rect: Rect, colour: Color32) {
    ui.painter().add(Callback::new_paint_callback(rect, Painting::Fill(colour)));
}

impl CallbackTrait for Painting {
    fn prepare(
        &self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        screen: &ScreenDescriptor,
        _encoder: &mut wgpu::CommandEncoder,
        resources: &mut CallbackResources,
    ) -> Vec<wgpu::CommandBuffer> {
        // Tests store no format, and draw into the format that egui recommends.
        let told = resources.get::<TargetFormat>();
        let format = told.map_or(wgpu::TextureFormat::Rgba8Unorm, |TargetFormat(format)| *format);
        let painters = resources.entry::<Painters>().or_insert_with(Painters::default);
        match self {
            Self::Scene(place, rect, picture) => {
                let painter = painters.scenes.entry(*place);
                let painter = painter.or_insert_with(|| Painter::new(device, format));
                let info = PaintCallbackInfo {
                    viewport: *rect,
                    clip_rect: *rect,
                    pixels_per_point: screen.pixels_per_point,
                    screen_size_px: screen.size_in_pixels,
                };
                let viewport = info.viewport_in_pixels();
                let [left, top] = [viewport.left_px, viewport.top_px].map(|side| side as f32);
                let [width, height] =
                    [viewport.width_px, viewport.height_px].map(|side| side as f32);
                let area = PictureArea::new(left, top, width, height);
                painter.prepare(device, queue, picture, area);
            }
            Self::Fill(colour) => {
                let fill = painters.fills.entry(*colour);
                fill.or_insert_with(|| fill_pipeline(device, format, *colour));
            }
        }
        Vec::new()
    }

    fn paint(
        &self,
        _info: PaintCallbackInfo,
        pass: &mut wgpu::RenderPass<'static>,
        resources: &CallbackResources,
    ) {
        let Some(Painters { scenes, fills }) = resources.get() else { return };
        match self {
            Self::Scene(place, ..) => {
                if let Some(painter) = scenes.get(place) {
                    painter.draw(pass);
                }
            }
            Self::Fill(colour) => {
                if let Some(pipeline) = fills.get(colour) {
                    pass.set_pipeline(pipeline);
                    pass.draw(0..3, 0..1);
                }
            }
        }
    }
}

/// Returns a pipeline that fills the viewport with one colour.
fn fill_pipeline(
    device: &wgpu::Device,
    format: wgpu::TextureFormat,
    colour: Color32,
) -> wgpu::RenderPipeline {
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some("fill"),
        source: wgpu::ShaderSource::Wgsl(include_str!("../../shaders/fill.wgsl").into()),
    });
    let [red, green, blue, _] = colour.to_array().map(|byte| f64::from(byte) / 255.0);
    let constants = [("red", red), ("green", green), ("blue", blue)];
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("fill"),
        layout: None,
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some("vertex"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers: &[],
        },
        primitive: wgpu::PrimitiveState::default(),
        depth_stencil: None,
        multisample: wgpu::MultisampleState::default(),
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: Some("fragment"),
            compilation_options: wgpu::PipelineCompilationOptions {
                constants: &constants,
                ..wgpu::PipelineCompilationOptions::default()
            },
            targets: &[Some(format.into())],
        }),
        multiview_mask: None,
        cache: None,
    })
}

/// Texture of the legend that was drawn last, with the legend and its size in pixels.
#[derive(Default)]
pub(crate) struct LegendCache(Option<(Legend, [u32; 2], TextureHandle)>);

impl LegendCache {
    /// Paints a legend of `size` pixels into `rect` (points).
    pub(super) fn paint(&mut self, ui: &Ui, rect: Rect, legend: Legend, size: [u32; 2]) {
        let last = self.0.take().filter(|(old, at, _)| *old == legend && *at == size);
        let (.., texture) = self.0.insert(last.unwrap_or_else(|| {
            let strip = legend.draw(size[0], size[1]);
            let pixels = size.map(|side| side as usize);
            let image = ColorImage::from_rgba_unmultiplied(pixels, strip.as_raw());
            let texture = ui.ctx().load_texture("legend", image, TextureOptions::NEAREST);
            (legend, size, texture)
        }));
        let whole = Rect::from_min_max(egui::pos2(0.0, 0.0), egui::pos2(1.0, 1.0));
        ui.painter().image(texture.id(), rect, whole, Color32::WHITE);
    }
}
