//! egui on the graphics device: textures, buffers and one pass.

use egui::{ClippedPrimitive, TexturesDelta};
use egui_wgpu::{Renderer, RendererOptions, ScreenDescriptor};

use super::scene_callback::TargetFormat;

/// Draws user interfaces into targets of one format.
pub(super) struct Screen {
    /// The device.
    pub device: wgpu::Device,
    /// Its queue.
    pub queue: wgpu::Queue,
    renderer: Renderer,
}

impl Screen {
    /// A screen for targets of this format.
    pub(super) fn new(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        format: wgpu::TextureFormat,
    ) -> Self {
        // Nothing here has gradients that would show steps.
        let mut renderer = Renderer::new(
            device,
            format,
            RendererOptions { dithering: false, ..RendererOptions::default() },
        );
        renderer.callback_resources.insert(TargetFormat(format));
        Self { device: device.clone(), queue: queue.clone(), renderer }
    }

    /// Sends new and changed textures to the device: before the pass that needs them.
    pub(super) fn update_textures(&mut self, delta: &TexturesDelta) {
        for (id, changes) in &delta.set {
            for change in changes {
                self.renderer.update_texture(&self.device, &self.queue, *id, change);
            }
        }
    }

    /// Frees textures: after the pass that needed them last.
    pub(super) fn free_textures(&mut self, delta: &TexturesDelta) {
        for id in &delta.free {
            self.renderer.free_texture(id);
        }
    }

    /// Records the pass. Returns what is to be submitted before it.
    pub(super) fn paint(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        view: &wgpu::TextureView,
        size: [u32; 2],
        pixels_per_point: f32,
        primitives: &[ClippedPrimitive],
    ) -> Vec<wgpu::CommandBuffer> {
        let screen = ScreenDescriptor { size_in_pixels: size, pixels_per_point };
        let commands =
            self.renderer.update_buffers(&self.device, &self.queue, encoder, primitives, &screen);
        let pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("window"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color::BLACK),
                    store: wgpu::StoreOp::Store,
                },
            })],
            ..wgpu::RenderPassDescriptor::default()
        });
        self.renderer.render(&mut pass.forget_lifetime(), primitives, &screen);
        commands
    }
}
