//! Periodic borders, as thin dashed lines from one side of the picture to the other.

use glam::DVec2;

use super::{Camera, Colour, LinkInstance};
use crate::world::Periodic;

// All in units of the font size of the picture's labels, so that prints of any size look alike.

/// Half the width of a dash.
const HALF_WIDTH_EM: f64 = 0.035;
/// Length of a dash, and of it with the gap after it.
const DASH_EM: f64 = 0.45;
const SPACING_EM: f64 = 0.9;

/// The dashes of the borders that show in a picture of `[width, height]` pixels.
pub(super) fn border_links(
    periodic: Periodic,
    camera: &Camera,
    [width, height]: [u32; 2],
    text_px: f32,
    colour: Colour,
) -> Vec<LinkInstance> {
    let em = f64::from(text_px);
    let half = DVec2::new(f64::from(width), f64::from(height)) / 2.0;
    let dashes = |borders: Option<[f64; 2]>, across: DVec2, along: DVec2| {
        let at =
            |border: f64| camera.offset_px(border * across + camera.centre * along).dot(across);
        let shown = borders.into_iter().flatten().map(at);
        let shown = shown.filter(move |at| at.abs() <= half.dot(across) + em);
        let count = (half.dot(along) / (SPACING_EM * em)).ceil() as i32;
        let steps = move || (-count..=count).map(move |step| f64::from(step) * SPACING_EM * em);
        let dash = move |at: f64, step: f64| LinkInstance {
            start: (at * across + (step - 0.5 * DASH_EM * em) * along).as_vec2().into(),
            end: (at * across + (step + 0.5 * DASH_EM * em) * along).as_vec2().into(),
            half_width: (HALF_WIDTH_EM * em) as f32,
            colour,
        };
        shown.flat_map(move |at| steps().map(move |step| dash(at, step))).collect::<Vec<_>>()
    };
    [dashes(periodic.x, DVec2::X, DVec2::Y), dashes(periodic.y, DVec2::Y, DVec2::X)].concat()
}
