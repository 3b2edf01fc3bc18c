//! The visible part of the scene. It is the whole scene until the user pans or zooms.

use glam::DVec2;
use serde::{Deserialize, Serialize};

use crate::render::{Camera, Style};

/// Smallest and largest width of the view, as multiples of the width that shows the whole scene.
const ZOOM_LIMITS: [f64; 2] = [1e-3, 30.0];

/// The view of the scene, which all simulations of a window share.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SceneCamera {
    framed: bool,
    centre: DVec2,
    metres_per_point: f64,
    framed_metres_per_point: f64,
}

impl Default for SceneCamera {
    fn default() -> Self {
        let (centre, metres_per_point) = (DVec2::ZERO, 1.0);
        Self { framed: true, centre, metres_per_point, framed_metres_per_point: 1.0 }
    }
}

impl SceneCamera {
    /// Shows the whole scene again.
    pub(crate) fn frame_scene(&mut self) {
        self.framed = true;
    }

    /// Returns the camera (centre and scale) of a picture of `size` pixels. It shows the whole scene until the user
    /// pans or zooms. `view` is the lower left and upper right corner of the whole scene, m.
    pub(crate) fn camera(
        &mut self,
        view: [DVec2; 2],
        style: &Style,
        size: [u32; 2],
        pixels_per_point: f64,
    ) -> Camera {
        let whole = style.camera(view[0], view[1], size[0], size[1]);
        self.framed_metres_per_point = whole.metres_per_pixel * pixels_per_point;
        if self.framed {
            self.centre = whole.centre;
            self.metres_per_point = self.framed_metres_per_point;
            return whole;
        }
        let metres_per_pixel = self.metres_per_point / pixels_per_point;
        Camera { centre: self.centre, metres_per_pixel }
    }

    /// Returns the camera (centre and scale) of an exported picture of `size` pixels, whose shape can differ from the
    /// window's. The picture shows at least the part of the scene that is visible in the window. `window_points` is the
    /// size of this visible part on the screen, points.
    pub(crate) fn for_picture(
        &self,
        view: [DVec2; 2],
        style: &Style,
        size: [u32; 2],
        window_points: DVec2,
    ) -> Camera {
        if self.framed {
            return style.camera(view[0], view[1], size[0], size[1]);
        }
        let [width, height] = size;
        let scene =
            DVec2::new(f64::from(width - style.legend_width(width, height)), f64::from(height));
        let metres_per_pixel = self.metres_per_point * (window_points / scene).max_element();
        Camera { centre: self.centre, metres_per_pixel }
    }

    /// Moves the scene by the motion `moved` of the mouse, points (y down).
    pub(crate) fn pan(&mut self, moved: egui::Vec2) {
        self.framed = false;
        let moved = DVec2::new(f64::from(moved.x), -f64::from(moved.y));
        self.centre -= moved * self.metres_per_point;
    }

    /// Magnifies the view by `factor`. The point of the scene that is `from_middle` points (y down) away from the
    /// centre of the view keeps its position on the screen.
    pub(crate) fn zoom(&mut self, factor: f64, from_middle: egui::Vec2) {
        let [nearest, farthest] = ZOOM_LIMITS.map(|limit| limit * self.framed_metres_per_point);
        let scale = (self.metres_per_point / factor).clamp(nearest, farthest);
        let offset = DVec2::new(f64::from(from_middle.x), -f64::from(from_middle.y));
        self.centre += offset * (self.metres_per_point - scale);
        self.metres_per_point = scale;
        self.framed = false;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_lies_under_the_cursor_stays_there() {
        let mut scene = SceneCamera::default();
        let style = Style::default();
        let view = [DVec2::ZERO, DVec2::new(4.0, 2.0)];
        let before = scene.camera(view, &style, [800, 600], 2.0);
        let cursor = egui::vec2(70.0, -40.0);
        let point = |camera: Camera| camera.unproject(DVec2::new(140.0, 80.0));
        scene.zoom(3.0, cursor);
        let after = scene.camera(view, &style, [800, 600], 2.0);
        assert!(point(before).distance(point(after)) < 1e-12);
        assert!((before.metres_per_pixel / after.metres_per_pixel - 3.0).abs() < 1e-12);
    }
}
