//! Large areas of one colour, without egui's shader.
//!
//! egui reads a texture for every pixel, filled areas included. On a software rasteriser a window's
//! worth of that takes longer than a frame may; one plain colour costs next to nothing (RESULTS.md).

use std::collections::HashMap;

use egui::{Color32, PaintCallbackInfo, Rect, Ui};
use egui_wgpu::{Callback, CallbackResources, CallbackTrait, ScreenDescriptor};

use super::scene_callback::target_format;

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
