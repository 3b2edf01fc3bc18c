//! A picture of all worlds (simulations side by side).

use std::sync::Arc;

use image::RgbaImage;

use super::titles::caption;
use crate::error::Result;
use crate::output::Texts;
use crate::render::{Camera, Renderer, Style, WorldPanel, draw_worlds};
use crate::sim::{Settings, Snapshot};

/// A simulation in a picture.
pub(crate) struct PicturedWorld {
    pub snapshot: Arc<Snapshot>,
    /// The settings of the simulation at the time of the snapshot (the drawn state).
    pub settings: Settings,
    /// Text in the lower right corner of the simulation.
    pub note: String,
}

/// A picture of all simulations, arranged as in the window.
pub(crate) struct ScenePicture {
    pub worlds: Vec<PicturedWorld>,
    /// Number of simulations in a row.
    pub columns: usize,
    pub style: Style,
    /// Camera (centre and scale), which is the same for all simulations.
    pub camera: Camera,
    pub size: [u32; 2],
    pub texts: Texts,
}

impl ScenePicture {
    /// Draws the picture.
    pub(super) fn draw(&self, renderer: &mut Renderer) -> Result<RgbaImage> {
        let Self { worlds, columns, style, camera, size, .. } = self;
        let settings: Vec<_> = worlds.iter().map(|world| world.settings).collect();
        let time_secs = |world: &PicturedWorld| world.snapshot.observables.time_secs;
        let captions = worlds.iter().enumerate();
        let captions = captions.map(|(index, world)| caption(&settings, index, time_secs(world)));
        let captions: Vec<_> = captions.collect();
        let panels = worlds.iter().zip(&captions);
        let panels = panels.map(|(PicturedWorld { snapshot, note, .. }, title)| WorldPanel {
            snapshot,
            title,
            note,
        });
        let panels: Vec<_> = panels.collect();
        draw_worlds(renderer, &panels, style, camera, *columns, *size)
    }
}
