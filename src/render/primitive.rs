//! What all primitives share on the GPU: one pipeline and one instance buffer a primitive.
//!
//! Neither knows where it draws: [`PrimitivePipeline::draw`] records into any render pass whose
//! target has the format that the pipeline was made for, be it a texture or a window. The four
//! corners of an instance's quad come from the vertex index alone; instances travel as a vertex
//! buffer, because OpenGL ES 3.0 has no storage buffers in vertex shaders.

use std::marker::PhantomData;
use std::ops::Range;

/// One instance of a primitive, as its shader reads it.
pub(crate) trait Instance: bytemuck::Pod {
    /// Name in labels and messages.
    const NAME: &'static str;
    /// WGSL source with the entry points `vertex` and `fragment`.
    const SHADER: &'static str;
    /// Fields in order, without gaps.
    const ATTRIBUTES: &'static [wgpu::VertexAttribute];
}

/// Where in the render target the picture lies, as all shaders read it: pixels, y down.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub(crate) struct Frame {
    /// Middle of the picture.
    pub centre: [f32; 2],
    /// Half of its width and height.
    pub half_size: [f32; 2],
}

impl Frame {
    /// A picture whose upper left corner lies at (`left`, `top`). The pass's viewport must be the
    /// same rectangle.
    pub(crate) fn new(left: f32, top: f32, width: f32, height: f32) -> Self {
        let half_size = [width / 2.0, height / 2.0];
        Self { centre: [left + half_size[0], top + half_size[1]], half_size }
    }
}

/// The [`Frame`] on the GPU, shared by the pipelines of one picture.
#[derive(Debug)]
pub(crate) struct FrameUniform {
    buffer: wgpu::Buffer,
    layout: wgpu::BindGroupLayout,
    group: wgpu::BindGroup,
}

impl FrameUniform {
    /// A uniform with no valid content before [`FrameUniform::write`].
    pub(crate) fn new(device: &wgpu::Device) -> Self {
        let buffer = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("frame"),
            size: size_of::<Frame>() as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("frame"),
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
        let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("frame"),
            layout: &layout,
            entries: &[wgpu::BindGroupEntry { binding: 0, resource: buffer.as_entire_binding() }],
        });
        Self { buffer, layout, group }
    }

    /// Sends a frame to the GPU.
    pub(crate) fn write(&self, queue: &wgpu::Queue, frame: Frame) {
        queue.write_buffer(&self.buffer, 0, bytemuck::bytes_of(&frame));
    }
}

/// Pipeline and instances of one primitive.
#[derive(Debug)]
pub(crate) struct PrimitivePipeline<I> {
    pipeline: wgpu::RenderPipeline,
    buffer: wgpu::Buffer,
    instance: PhantomData<I>,
}

impl<I: Instance> PrimitivePipeline<I> {
    /// A pipeline for targets of this format. The format must not be an sRGB one: colours are
    /// written, and blended, as the file stores them.
    pub(crate) fn new(
        device: &wgpu::Device,
        format: wgpu::TextureFormat,
        frame: &FrameUniform,
    ) -> Self {
        let shader = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some(I::NAME),
            source: wgpu::ShaderSource::Wgsl(I::SHADER.into()),
        });
        let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some(I::NAME),
            bind_group_layouts: &[Some(&frame.layout)],
            immediate_size: 0,
        });
        let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(I::NAME),
            layout: Some(&layout),
            vertex: wgpu::VertexState {
                module: &shader,
                entry_point: Some("vertex"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                buffers: &[Some(wgpu::VertexBufferLayout {
                    array_stride: size_of::<I>() as u64,
                    step_mode: wgpu::VertexStepMode::Instance,
                    attributes: I::ATTRIBUTES,
                })],
            },
            primitive: wgpu::PrimitiveState {
                topology: wgpu::PrimitiveTopology::TriangleStrip,
                ..wgpu::PrimitiveState::default()
            },
            depth_stencil: None,
            multisample: wgpu::MultisampleState::default(),
            fragment: Some(wgpu::FragmentState {
                module: &shader,
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
        Self { pipeline, buffer: instance_buffer::<I>(device, 1), instance: PhantomData }
    }

    /// Sends the instances of a picture to the GPU; the buffer grows as needed.
    pub(crate) fn prepare(&mut self, device: &wgpu::Device, queue: &wgpu::Queue, instances: &[I]) {
        let bytes: &[u8] = bytemuck::cast_slice(instances);
        if bytes.len() as u64 > self.buffer.size() {
            self.buffer = instance_buffer::<I>(device, instances.len().next_power_of_two());
        }
        queue.write_buffer(&self.buffer, 0, bytes);
    }

    /// Records the drawing of a range of the prepared instances.
    pub(crate) fn draw(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        frame: &FrameUniform,
        instances: Range<usize>,
    ) {
        if instances.is_empty() {
            return;
        }
        // The range starts in the buffer, not in the draw call: OpenGL has no first instance.
        let start = (instances.start * size_of::<I>()) as u64;
        let end = (instances.end * size_of::<I>()) as u64;
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &frame.group, &[]);
        pass.set_vertex_buffer(0, self.buffer.slice(start..end));
        pass.draw(0..4, 0..instances.len() as u32);
    }
}

fn instance_buffer<I: Instance>(device: &wgpu::Device, capacity: usize) -> wgpu::Buffer {
    device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(I::NAME),
        size: (capacity * size_of::<I>()) as u64,
        usage: wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    })
}
