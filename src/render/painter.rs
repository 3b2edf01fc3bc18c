//! A whole picture in any render pass: the pipelines of all primitives, and the order of batches.
//!
//! A window calls [`Painter::prepare`] before its pass and [`Painter::draw`] inside it; the
//! offscreen target does the same.

use std::ops::Range;

use super::primitive::{Frame, FrameUniform, PrimitivePipeline};
use super::{Batch, DiscInstance, LinkInstance, Picture};

/// Draws pictures into passes whose target has one given format.
#[derive(Debug)]
pub(crate) struct Painter {
    frame: FrameUniform,
    discs: PrimitivePipeline<DiscInstance>,
    links: PrimitivePipeline<LinkInstance>,
    order: Vec<Span>,
}

/// A batch as a range of its primitive's instance buffer.
#[derive(Clone, Debug)]
enum Span {
    Discs(Range<usize>),
    Links(Range<usize>),
}

impl Painter {
    /// A painter for targets of this format, which must not be an sRGB one.
    pub(crate) fn new(device: &wgpu::Device, format: wgpu::TextureFormat) -> Self {
        let frame = FrameUniform::new(device);
        let discs = PrimitivePipeline::new(device, format, &frame);
        let links = PrimitivePipeline::new(device, format, &frame);
        Self { frame, discs, links, order: Vec::new() }
    }

    /// Sends a picture to the GPU, to be drawn in the given part of the target.
    pub(crate) fn prepare(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        picture: &Picture,
        frame: Frame,
    ) {
        self.frame.write(queue, frame);
        let (mut discs, mut links) = (Vec::new(), Vec::new());
        self.order.clear();
        for batch in &picture.batches {
            self.order.push(match batch {
                Batch::Discs(batch) => Span::Discs(append(&mut discs, batch)),
                Batch::Links(batch) => Span::Links(append(&mut links, batch)),
            });
        }
        self.discs.prepare(device, queue, &discs);
        self.links.prepare(device, queue, &links);
    }

    /// Records the drawing of the prepared picture. The ground is the pass's own clear colour.
    pub(crate) fn draw(&self, pass: &mut wgpu::RenderPass<'_>) {
        for span in &self.order {
            match span {
                Span::Discs(range) => self.discs.draw(pass, &self.frame, range.clone()),
                Span::Links(range) => self.links.draw(pass, &self.frame, range.clone()),
            }
        }
    }
}

fn append<T: Copy>(all: &mut Vec<T>, batch: &[T]) -> Range<usize> {
    let start = all.len();
    all.extend_from_slice(batch);
    start..all.len()
}
