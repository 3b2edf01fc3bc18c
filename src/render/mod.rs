//! Pictures of snapshots.
//!
//! From the bottom up: `colour`; the primitives `disc` and `link`, each one Rust file and one shader;
//! `Picture`, lists of primitives in pixels; [`Renderer`], which draws them on Vulkan, OpenGL or
//! the processor; [`Camera`] and [`Style`], which turn a snapshot into a picture
//! (`scene_picture`); [`draw_scene`], which adds scale bar, legend and words; [`Figure`], which
//! arranges several pictures as a journal does.

#[cfg(all(test, feature = "gpu"))]
mod agreement_tests;
mod align;
mod arrows;
#[cfg(feature = "gpu")]
mod backend;
mod borders;
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
mod motions;
#[cfg(not(feature = "gpu"))]
mod no_gpu;
pub(crate) mod numbers;
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
mod worlds_image;

#[cfg(feature = "window")]
pub(crate) use arrows::speed_reference;
#[cfg(feature = "window")]
pub(crate) use backend::Gpu;
pub use camera::{Camera, bounds};
pub(crate) use colour::Colour;
pub(crate) use colour_scale::automatic_range;
pub(crate) use disc::DiscInstance;
pub use drivers::{RendererChoice, quieten_drivers};
pub use figure::Figure;
pub(crate) use forces::force_reference;
#[cfg(feature = "window")]
pub(crate) use layers::scene_picture;
#[cfg(feature = "window")]
pub(crate) use legend::Legend;
pub(crate) use link::LinkInstance;
#[cfg(feature = "window")]
pub(crate) use painter::Painter;
pub(crate) use picture::{Batch, Picture};
#[cfg(feature = "window")]
pub(crate) use primitive::Frame;
pub use renderer::Renderer;
#[cfg(feature = "window")]
pub(crate) use scale_bar::ScaleBar;
pub use scene_image::draw_scene;
pub(crate) use style::Palette;
pub use style::{ColourBy, Style, Theme};
pub use worlds_image::{Panel, draw_worlds, panel_size};
