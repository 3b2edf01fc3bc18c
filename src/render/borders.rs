//! Periodic borders, as thin dashed lines from top to bottom.

use glam::DVec2;

use super::{Camera, Colour, LinkInstance};
use crate::world::Periodic;

// All in units of the font size of the picture's labels, so that prints of any size look alike.

/// Half the width of a dash.
const HALF_WIDTH_EM: f64 = 0.035;
/// Length of a dash, and of it with the gap after it.
const DASH_EM: f64 = 0.45;
const SPACING_EM: f64 = 0.9;

/// The dashes of both borders that show in a picture of `[width, height]` pixels.
pub(super) fn border_links(
    periodic: Periodic,
    camera: &Camera,
    [width, height]: [u32; 2],
    text_px: f32,
    colour: Colour,
) -> Vec<LinkInstance> {
    let em = f64::from(text_px);
    let half = DVec2::new(f64::from(width), f64::from(height)) / 2.0;
    let columns = periodic.x.map(|x| camera.offset_px(DVec2::new(x, camera.centre.y)).x);
    let shown = columns.into_iter().filter(|column| column.abs() <= half.x + em);
    let dashes = (half.y / (SPACING_EM * em)).ceil() as i32;
    let rows = move || (-dashes..=dashes).map(move |row| f64::from(row) * SPACING_EM * em);
    let dash = |column: f64, row: f64| LinkInstance {
        start: [column as f32, (row - 0.5 * DASH_EM * em) as f32],
        end: [column as f32, (row + 0.5 * DASH_EM * em) as f32],
        half_width: (HALF_WIDTH_EM * em) as f32,
        colour,
    };
    shown.flat_map(|column| rows().map(move |row| dash(column, row))).collect()
}
