//! Pictures of snapshots.
//!
//! From the bottom up: `colour`; `primitives`, discs and links in pixels, drawn by the processor, or for the window by
//! Vulkan or OpenGL (`gpu`, `painter`, a shader a primitive); [`Camera`] and [`Style`], with which `scene` turns
//! a snapshot into a picture of walls, discs and `overlays`; [`draw_scene`], which adds scale bar, legend and words;
//! [`PanelGrid`], which arranges several pictures as a journal does.

#[cfg(all(test, feature = "window"))]
mod agreement_tests;
mod camera;
mod colour;
mod figure;
#[cfg(feature = "window")]
pub(crate) mod gpu;
mod legend;
pub(crate) mod numbers;
mod overlays;
#[cfg(feature = "window")]
mod painter;
mod primitives;
mod renderer;
mod scene;
#[cfg(test)]
mod scene_tests;
mod style;
mod text;
mod walls;

pub use camera::{Camera, bounds};
pub(crate) use colour::{Colour, automatic_range};
pub use figure::PanelGrid;
pub(crate) use overlays::force_reference;
pub(crate) use primitives::{Batch, DiscInstance, LinkInstance, Picture};
pub use renderer::RendererChoice;
pub(crate) use renderer::check_size;
pub use scene::{WorldPanel, draw_scene, draw_worlds, panel_size};
pub(crate) use style::Palette;
pub use style::{ColourBy, Style, Theme};
#[cfg(feature = "window")]
pub(crate) use {
    gpu::Gpu,
    legend::{Legend, ScaleBar},
    overlays::speed_reference,
    painter::{Painter, PictureArea},
    scene::scene_picture,
};
