//! Drawing of pictures on a GPU: one pipeline and one instance buffer for discs and one for links (straight lines with
//! round ends), and the drawing order.
//!
//! A window and the offscreen target both call [`Painter::prepare`] before their render pass and [`Painter::draw`] in
//! it. Any render target with the painter's texture format can be used. The vertex index selects the four corners of
//! the rectangle in which a shape is drawn. Instances are in a vertex buffer, because OpenGL ES 3.0 has no storage
//! buffers in vertex shaders.

use std::ops::Range;

use super::{Batch, DiscInstance, LinkInstance, Picture};

/// Position and size of the picture in the render target, in the layout of the shaders: pixels, y down.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub(crate) struct PictureArea {
    pub centre: [f32; 2],
    pub half_size: [f32; 2],
}

impl PictureArea {
    /// Returns the area of a picture whose upper left corner is at (`left`, `top`), pixels. The viewport of the render
    /// pass must be the same rectangle.
    pub(crate) fn new(left: f32, top: f32, width: f32, height: f32) -> Self {
        let half_size = [width / 2.0, height / 2.0];
        Self { centre: [left + half_size[0], top + half_size[1]], half_size }
    }
}

/// Draws pictures into render passes whose targets have one texture format.
#[derive(Debug)]
pub(crate) struct Painter {
    /// Uniform buffer with the [`PictureArea`], which all shaders read.
    area: wgpu::Buffer,
    area_group: wgpu::BindGroup,
    /// Pipeline of discs, then pipeline of links (straight lines with round ends).
    primitives: [PrimitivePipeline; 2],
    /// For each batch of shapes in drawing order, the index of its pipeline and its range of bytes in the pipeline's
    /// instance buffer.
    order: Vec<(usize, Range<u64>)>,
}

#[derive(Debug)]
struct PrimitivePipeline {
    name: &'static str,
    /// Size of one instance (a disc, or a straight line with round ends) in the buffer, bytes.
    stride: u64,
    pipeline: wgpu::RenderPipeline,
    instances: wgpu::Buffer,
}

impl Painter {
    /// Returns a painter for render targets of this texture format. The format must not be sRGB, because colours are
    /// blended and stored as the numbers of a PNG file.
    pub(crate) fn new(device: &wgpu::Device, format: wgpu::TextureFormat) -> Self {
        let area = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("picture area"),
            size: size_of::<PictureArea>() as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("picture area"),
            entries: &[wgpu::BindGroupLayoutEntry {
                binding: 0,
                visibility: wgpu::ShaderStages::VERTEX_FRAGMENT,
                ty: wgpu::BindingType::Buffer {
                    ty: wgpu::BufferBindingType::Uniform,
                    has_dynamic_offset: false,
                    min_binding_size: None,
                },
                count: None,
            }],
        });
        let area_group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("picture area"),
            layout: &layout,
            entries: &[wgpu::BindGroupEntry { binding: 0, resource: area.as_entire_binding() }],
        });
        // The fields in order, without gaps, as the shaders read them.
        let discs = PrimitivePipeline::new::<DiscInstance>(
            device,
            format,
            &layout,
            "disc",
            include_str!("../../shaders/disc.wgsl"),
            &wgpu::vertex_attr_array![
                0 => Float32x2, 1 => Float32x3, 2 => Float32x2, 3 => Float32x4, 4 => Float32x4,
            ],
        );
        let links = PrimitivePipeline::new::<LinkInstance>(
            device,
            format,
            &layout,
            "link",
            include_str!("../../shaders/link.wgsl"),
            &wgpu::vertex_attr_array![
                0 => Float32x2, 1 => Float32x2, 2 => Float32, 3 => Float32x4,
            ],
        );
        Self { area, area_group, primitives: [discs, links], order: Vec::new() }
    }

    /// Sends a picture to the GPU, to be drawn in the given area of the target.
    pub(crate) fn prepare(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        picture: &Picture,
        area: PictureArea,
    ) {
        queue.write_buffer(&self.area, 0, bytemuck::bytes_of(&area));
        let mut instances = [Vec::new(), Vec::new()];
        self.order.clear();
        for batch in &picture.batches {
            let (primitive, bytes): (usize, &[u8]) = match batch {
                Batch::Discs(discs) => (0, bytemuck::cast_slice(discs)),
                Batch::Links(links) => (1, bytemuck::cast_slice(links)),
            };
            let start = instances[primitive].len() as u64;
            instances[primitive].extend_from_slice(bytes);
            self.order.push((primitive, start..start + bytes.len() as u64));
        }
        for (primitive, bytes) in self.primitives.iter_mut().zip(&instances) {
            let count = bytes.len() as u64 / primitive.stride;
            if bytes.len() as u64 > primitive.instances.size() {
                let size = count.next_power_of_two() * primitive.stride;
                primitive.instances = instance_buffer(device, primitive.name, size);
            }
            queue.write_buffer(&primitive.instances, 0, bytes);
        }
    }

    /// Records the drawing of the prepared picture. The caller must clear the render pass with the colour of the
    /// background.
    pub(crate) fn draw(&self, pass: &mut wgpu::RenderPass<'_>) {
        for (primitive, bytes) in self.order.iter().filter(|(_, bytes)| !bytes.is_empty()) {
            let PrimitivePipeline { stride, pipeline, instances, .. } =
                &self.primitives[*primitive];
            // The range is applied to the buffer and not to the draw call, because OpenGL cannot draw from a first
            // instance other than 0.
            pass.set_pipeline(pipeline);
            pass.set_bind_group(0, &self.area_group, &[]);
            pass.set_vertex_buffer(0, instances.slice(bytes.clone()));
            pass.draw(0..4, 0..((bytes.end - bytes.start) / stride) as u32);
        }
    }
}

impl PrimitivePipeline {
    /// Returns a pipeline that draws instances of type `I`. `shader` is WGSL code with the entry points `vertex` and
    /// `fragment`.
    fn new<I>(
        device: &wgpu::Device,
        format: wgpu::TextureFormat,
        area_layout: &wgpu::BindGroupLayout,
        name: &'static str,
        shader: &str,
        attributes: &[wgpu::VertexAttribute],
    ) -> Self {
        let stride = size_of::<I>() as u64;
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some(name),
            source: wgpu::ShaderSource::Wgsl(shader.into()),
        });
        let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some(name),
            bind_group_layouts: &[Some(area_layout)],
            immediate_size: 0,
        });
        let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(name),
            layout: Some(&layout),
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some("vertex"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                buffers: &[Some(wgpu::VertexBufferLayout {
                    array_stride: stride,
                    step_mode: wgpu::VertexStepMode::Instance,
                    attributes,
                })],
            },
            primitive: wgpu::PrimitiveState {
                topology: wgpu::PrimitiveTopology::TriangleStrip,
                ..wgpu::PrimitiveState::default()
            },
            depth_stencil: None,
            multisample: wgpu::MultisampleState::default(),
            fragment: Some(wgpu::FragmentState {
                module: &module,
                entry_point: Some("fragment"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                targets: &[Some(wgpu::ColorTargetState {
                    format,
                    blend: Some(wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING),
                    write_mask: wgpu::ColorWrites::ALL,
                })],
            }),
            multiview_mask: None,
            cache: None,
        });
        Self { name, stride, pipeline, instances: instance_buffer(device, name, stride) }
    }
}

fn instance_buffer(device: &wgpu::Device, name: &str, size: u64) -> wgpu::Buffer {
    device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(name),
        size,
        usage: wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    })
}
