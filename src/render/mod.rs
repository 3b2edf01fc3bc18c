//! Pictures of snapshots.
//!
//! From the bottom up: `colour`; the primitives `disc` and `link`, each one Rust file and one shader;
//! `picture`, lists of primitives; `renderer`, which draws them on Vulkan, OpenGL or the processor.

mod backend;
mod colour;
mod cpu;
mod disc;
mod link;
mod offscreen;
mod painter;
mod picture;
mod primitive;
mod renderer;

pub use backend::RendererChoice;
pub use colour::Colour;
pub use disc::DiscInstance;
pub use link::LinkInstance;
pub use painter::Painter;
pub use picture::{Batch, Picture};
pub use primitive::{Frame, FrameUniform, Instance, PrimitivePipeline};
pub use renderer::Renderer;
