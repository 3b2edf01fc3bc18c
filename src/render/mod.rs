//! Pictures of snapshots.
//!
//! From the bottom up: `colour`; the primitives `disc` and `link`, each one Rust file and one shader;
//! [`Picture`], lists of primitives in pixels; [`Renderer`], which draws them on Vulkan, OpenGL or
//! the processor; [`Camera`] and [`Style`], which turn a snapshot into a picture
//! ([`scene_picture`]); [`draw_scene`], which adds scale bar, legend and words; [`Figure`], which
//! arranges several pictures as a journal does.

#[cfg(all(test, feature = "gpu"))]
mod agreement_tests;
mod align;
mod arrows;
#[cfg(feature = "gpu")]
mod backend;
mod boundaries;
mod camera;
mod colour;
mod colour_scale;
mod cpu;
mod disc;
mod drivers;
mod figure;
mod figure_layout;
mod font;
mod forces;
mod layers;
mod legend;
mod link;
#[cfg(not(feature = "gpu"))]
mod no_gpu;
pub mod numbers;
#[cfg(feature = "gpu")]
pub(crate) mod offscreen;
#[cfg(feature = "gpu")]
mod painter;
mod picture;
#[cfg(feature = "gpu")]
mod primitive;
mod renderer;
mod scale_bar;
mod scene_image;
#[cfg(test)]
mod scene_tests;
mod shade;
mod style;
mod text;

pub use align::Align;
pub use arrows::speed_reference;
#[cfg(feature = "gpu")]
pub(crate) use backend::Gpu;
pub use camera::{Camera, bounds};
pub use colour::Colour;
pub use colour_scale::{ColourScale, automatic_range, contact_colour, map_colour};
pub use disc::DiscInstance;
pub use drivers::{RendererChoice, quieten_drivers};
pub use figure::Figure;
pub use font::{TextStyle, Weight};
pub use forces::force_reference;
pub use layers::scene_picture;
pub use legend::Legend;
pub use link::LinkInstance;
#[cfg(feature = "gpu")]
pub use painter::Painter;
pub use picture::{Batch, Picture};
#[cfg(feature = "gpu")]
pub use primitive::{Frame, FrameUniform, Instance, PrimitivePipeline};
pub use renderer::Renderer;
pub use scale_bar::ScaleBar;
pub use scene_image::draw_scene;
pub use style::{ColourBy, Palette, Style, Theme};
pub use text::TextBlock;
