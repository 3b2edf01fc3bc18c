//! In the middle of the window: where gravity points.

use egui::{Align2, FontId, Rect, Stroke, Ui, Vec2};
use glam::DVec2;

use crate::app::state::AppState;

/// Length of the arrow, points.
const LENGTH: f32 = 34.0;
/// Its distance from the upper right corner, points.
const MARGIN: f32 = 30.0;
/// Gravity that is closer to straight down than this, as a part of itself, needs no arrow.
const STRAIGHT: f64 = 1e-9;

/// Draws the arrow of a world, where it is asked for, or gravity is not straight down.
pub(super) fn paint(ui: &Ui, state: &AppState, world: usize, cell: Rect) {
    let gravity = state.frame.worlds.get(world).and_then(|world| world.gravity);
    let Some(gravity) = gravity.filter(|&gravity| state.preferences.gravity || is_tilted(gravity))
    else {
        return;
    };
    if gravity == DVec2::ZERO {
        return;
    }
    let along = gravity.normalize();
    let along = Vec2::new(along.x as f32, -along.y as f32);
    let middle = cell.right_top() + Vec2::new(-MARGIN, MARGIN);
    let ink = ui.visuals().text_color();
    let stroke = Stroke::new(1.8, ink);
    let painter = ui.painter().with_clip_rect(cell);
    painter.arrow(middle - 0.5 * LENGTH * along, LENGTH * along, stroke);
    // Beside the arrow, wherever that points.
    let aside = middle + 12.0 * Vec2::new(along.y, -along.x);
    painter.text(aside, Align2::CENTER_CENTER, "g", FontId::proportional(13.0), ink);
}

fn is_tilted(gravity: DVec2) -> bool {
    gravity.y > 0.0 || gravity.x.abs() > STRAIGHT * gravity.length()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gravity_straight_down_goes_without_saying() {
        assert!(!is_tilted(DVec2::new(0.0, -9.8)) && !is_tilted(DVec2::ZERO));
        assert!(is_tilted(DVec2::new(0.1, -9.8)) && is_tilted(DVec2::new(0.0, 9.8)));
    }
}
