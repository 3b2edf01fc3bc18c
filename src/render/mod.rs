//! Pictures of snapshots.
//!
//! From the bottom up: `colour`; the primitives `disc` and `link`, each one Rust file and one shader;
//! [`Picture`], lists of primitives in pixels; [`Renderer`], which draws them on Vulkan, OpenGL or
//! the processor; [`Camera`] and [`Style`], which turn a snapshot into a picture
//! ([`scene_picture`]); [`draw_scene`], which adds scale bar, legend and words; [`Figure`], which
//! arranges several pictures as a journal does.

#[cfg(test)]
mod agreement_tests;
mod arrows;
mod backend;
mod boundaries;
mod camera;
mod colour;
mod colour_scale;
mod cpu;
mod disc;
mod figure;
mod figure_layout;
mod font;
mod forces;
mod layers;
mod legend;
mod link;
pub mod numbers;
pub(crate) mod offscreen;
mod painter;
mod picture;
mod primitive;
mod renderer;
mod scale_bar;
mod scene_image;
#[cfg(test)]
mod scene_tests;
mod style;
mod text;

pub use arrows::speed_reference;
pub(crate) use backend::Gpu;
pub use backend::{RendererChoice, quieten_drivers};
pub use camera::{Camera, bounds};
pub use colour::Colour;
pub use colour_scale::{ColourScale, automatic_range, contact_colour, map_colour};
pub use disc::DiscInstance;
pub use figure::Figure;
pub use font::{TextStyle, Weight};
pub use forces::force_reference;
pub use layers::scene_picture;
pub use legend::Legend;
pub use link::LinkInstance;
pub use painter::Painter;
pub use picture::{Batch, Picture};
pub use primitive::{Frame, FrameUniform, Instance, PrimitivePipeline};
pub use renderer::Renderer;
pub use scale_bar::ScaleBar;
pub use scene_image::draw_scene;
pub use style::{ColourBy, Palette, Style, Theme};
pub use text::{Align, TextBlock};
