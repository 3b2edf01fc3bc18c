//! A picture of all worlds.

use std::sync::Arc;

use image::RgbaImage;

use crate::error::Result;
use crate::output::Texts;
use crate::render::{Camera, Renderer, Style, WorldPanel, draw_scene, draw_worlds};
use crate::sim::Snapshot;

/// A world of a picture.
pub(crate) struct PicturedWorld {
    pub snapshot: Arc<Snapshot>,
    /// What tells it from the others.
    pub title: String,
    /// What stands below it.
    pub note: String,
}

/// A picture of the worlds, as they are seen side by side.
pub(crate) struct ScenePicture {
    pub worlds: Vec<PicturedWorld>,
    /// How many stand in a row.
    pub columns: usize,
    pub style: Style,
    /// What of one is seen.
    pub camera: Camera,
    pub size: [u32; 2],
    pub texts: Texts,
}

impl ScenePicture {
    /// Draws it.
    pub(super) fn draw(&self, renderer: &mut Renderer) -> Result<RgbaImage> {
        let Self { worlds, columns, style, camera, size, .. } = self;
        if let [PicturedWorld { snapshot, .. }] = &worlds[..] {
            return draw_scene(renderer, snapshot, style, camera, size[0], size[1]);
        }
        let panels = worlds.iter().map(|PicturedWorld { snapshot, title, note }| WorldPanel {
            snapshot,
            title,
            note,
        });
        let panels: Vec<_> = panels.collect();
        draw_worlds(renderer, &panels, style, camera, *columns, *size)
    }
}
