//! The middle of the window while a new pile is made: the grains as they fall. They can be looked at, and no more.

use egui::{Rect, Ui};

use crate::app::scene_callback::scene_callback;
use crate::app::state::AppState;
use crate::render::{Style, scene_picture};

/// Shows it in place of the worlds, in so many pixels. Whether there is anything to see.
pub(super) fn show(
    ui: &Ui,
    state: &mut AppState,
    area: Rect,
    style: &Style,
    [width, height]: [u32; 2],
) -> bool {
    let preview = state.frame.loading.as_ref().and_then(|it| it.preview.clone());
    let Some(preview) = preview else { return false };
    let [lower, upper] = preview.view;
    // Forces and velocities are those of the run alone, and the scale changes as grains come down.
    let style = Style { show_forces: false, show_velocities: false, ..style.clone() };
    let style = Style { legend: false, scale_bar: false, ..style };
    let camera = style.camera(lower, upper, width, height);
    let picture = scene_picture(&preview.snapshot, &style, &camera, width, height);
    ui.painter().with_clip_rect(area).add(scene_callback(0, area, picture));
    state.note_control("pile in the making", area);
    true
}
