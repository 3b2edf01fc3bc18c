//! Pictures of snapshots (states of a simulation).
//!
//! Modules and types, each using the earlier ones: `colour`; `primitives` (discs and straight lines, called links, in
//! pixels); [`Renderer`], which draws discs and links by Vulkan, by OpenGL (`gpu`, `painter`, one shader per shape) or
//! on the processor; [`Camera`] and [`Style`], with which `scene` turns a snapshot into a picture of walls, discs and
//! `overlays`; [`draw_scene`], which adds scale bar, legend and text; [`PanelGrid`], which arranges several pictures as
//! in a journal.

mod camera;
mod colour;
mod colour_scale;
mod figure;
#[cfg(feature = "gpu")]
pub(crate) mod gpu;
mod legend;
pub(crate) mod numbers;
mod overlays;
#[cfg(feature = "gpu")]
mod painter;
mod primitives;
mod renderer;
mod renderer_choice;
mod scene;
#[cfg(test)]
mod scene_tests;
mod style;
#[cfg(all(test, feature = "gpu"))]
mod tests_with_driver;
mod text;
mod walls;

pub use camera::{Camera, bounds};
pub(crate) use colour::Colour;
pub(crate) use colour_scale::automatic_range;
pub use figure::PanelGrid;
pub(crate) use overlays::force_reference;
#[cfg(feature = "gpu")]
pub(crate) use primitives::Batch;
pub(crate) use primitives::{DiscInstance, LinkInstance, Picture};
pub use renderer::{Renderer, quieten_drivers};
pub use renderer_choice::RendererChoice;
pub use scene::{WorldPanel, draw_scene, draw_worlds, panel_size};
pub(crate) use style::Palette;
pub use style::{ColourBy, Style, Theme};
#[cfg(feature = "panels")]
pub(crate) use {
    gpu::Gpu,
    legend::{Legend, ScaleBar},
    overlays::speed_reference,
    painter::{Painter, PictureArea},
    scene::scene_picture,
};
