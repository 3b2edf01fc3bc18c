//! What is painted inside egui's pass by other means than its own: the scene, large areas, and the legend.

use std::collections::HashMap;

use egui::{
    Color32, ColorImage, PaintCallback, PaintCallbackInfo, Rect, TextureHandle, TextureOptions, Ui,
};
use egui_wgpu::{Callback, CallbackResources, CallbackTrait, ScreenDescriptor};

use crate::render::{Frame, Legend, Painter, Picture};

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
        let frame = Frame::new(
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

/// Fills a rectangle (points) with an opaque colour, beneath what is painted later.
pub(super) fn fill(ui: &Ui, rect: Rect, colour: Color32) {
    ui.painter().add(Callback::new_paint_callback(rect, Fill { colour }));
}

struct Fill {
    colour: Color32,
}

/// The pipeline, and a colour's bind group for each colour that was ever filled: the few of a theme.
struct Fills {
    pipeline: wgpu::RenderPipeline,
    layout: wgpu::BindGroupLayout,
    colours: HashMap<Color32, wgpu::BindGroup>,
}

impl Fills {
    fn new(device: &wgpu::Device, format: wgpu::TextureFormat) -> Self {
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("fill"),
            entries: &[wgpu::BindGroupLayoutEntry {
                binding: 0,
                visibility: wgpu::ShaderStages::FRAGMENT,
                ty: wgpu::BindingType::Buffer {
                    ty: wgpu::BufferBindingType::Uniform,
                    has_dynamic_offset: false,
                    min_binding_size: None,
                },
                count: None,
            }],
        });
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("fill"),
            source: wgpu::ShaderSource::Wgsl(include_str!("../../shaders/fill.wgsl").into()),
        });
        let pipeline_layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("fill"),
            bind_group_layouts: &[Some(&layout)],
            immediate_size: 0,
        });
        let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some("fill"),
            layout: Some(&pipeline_layout),
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
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                targets: &[Some(format.into())],
            }),
            multiview_mask: None,
            cache: None,
        });
        Self { pipeline, layout, colours: HashMap::new() }
    }

    fn add(&mut self, device: &wgpu::Device, queue: &wgpu::Queue, colour: Color32) {
        let Self { layout, colours, .. } = self;
        colours.entry(colour).or_insert_with(|| {
            let channels = colour.to_array().map(|byte| f32::from(byte) / 255.0);
            let buffer = device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("fill"),
                size: size_of_val(&channels) as u64,
                usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            });
            queue.write_buffer(&buffer, 0, bytemuck::cast_slice(&channels));
            device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some("fill"),
                layout,
                entries: &[wgpu::BindGroupEntry {
                    binding: 0,
                    resource: buffer.as_entire_binding(),
                }],
            })
        });
    }
}

impl CallbackTrait for Fill {
    fn prepare(
        &self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        _screen: &ScreenDescriptor,
        _encoder: &mut wgpu::CommandEncoder,
        resources: &mut CallbackResources,
    ) -> Vec<wgpu::CommandBuffer> {
        let format = target_format(resources);
        let fills = resources.entry::<Fills>().or_insert_with(|| Fills::new(device, format));
        fills.add(device, queue, self.colour);
        Vec::new()
    }

    fn paint(
        &self,
        _info: PaintCallbackInfo,
        pass: &mut wgpu::RenderPass<'static>,
        resources: &CallbackResources,
    ) {
        let Some(fills) = resources.get::<Fills>() else { return };
        if let Some(colour) = fills.colours.get(&self.colour) {
            pass.set_pipeline(&fills.pipeline);
            pass.set_bind_group(0, colour, &[]);
            pass.draw(0..3, 0..1);
        }
    }
}

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
