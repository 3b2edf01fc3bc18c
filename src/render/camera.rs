//! Conversion of positions in the scene (metres, y up, at any distance from the origin) to pixels.
//!
//! A camera is the point in the middle of the picture and a scale. Positions relative to that point are computed in f64
//! and only then rounded to f32 pixels. So a scene a million diameters from the origin is drawn as sharply as a scene
//! at the origin.

use glam::DVec2;

use crate::sim::Snapshot;
use crate::world::{Boundary, Edge};

/// The visible part of the scene: the point in the middle of the picture, and the scale.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// The point in the middle of the picture, m.
    pub centre: DVec2,
    /// Scale, metres per pixel.
    pub metres_per_pixel: f64,
}

/// Widths of the empty border on the sides of a picture, pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Margins {
    pub left: f64,
    pub right: f64,
    pub top: f64,
    pub bottom: f64,
}

impl Camera {
    /// Returns the camera that shows the box from `min` to `max` (m) as large as possible within the margins of a
    /// picture of `width` × `height` pixels.
    pub(super) fn framing(
        min: DVec2,
        max: DVec2,
        width: u32,
        height: u32,
        margins: Margins,
    ) -> Self {
        let picture = DVec2::new(f64::from(width), f64::from(height));
        let taken = DVec2::new(margins.left + margins.right, margins.top + margins.bottom);
        // Margins that leave no space are reduced, because a pixel must have a finite length.
        let free = (picture - taken).max(DVec2::ONE);
        let extent = max - min;
        let scale = (extent / free).max_element();
        // A single point has no extent, so any scale shows it.
        let metres_per_pixel = if scale > 0.0 && scale.is_finite() { scale } else { 1.0 };
        let shift = DVec2::new(margins.right - margins.left, margins.top - margins.bottom) / 2.0;
        Self { centre: (min + max) / 2.0 + shift * metres_per_pixel, metres_per_pixel }
    }

    /// Returns the pixel position of a point of the scene (m), relative to the middle of the picture, y up.
    pub fn project(&self, position: DVec2) -> [f32; 2] {
        self.offset_px(position).as_vec2().into()
    }

    pub(super) fn offset_px(&self, position: DVec2) -> DVec2 {
        (position - self.centre) / self.metres_per_pixel
    }

    /// Returns the point of the scene (m) at `offset_px` pixels from the middle of the picture, y up.
    pub fn unproject(&self, offset_px: DVec2) -> DVec2 {
        self.centre + offset_px * self.metres_per_pixel
    }

    /// Converts a length (m) to pixels.
    pub fn pixels(&self, length: f64) -> f32 {
        (length / self.metres_per_pixel) as f32
    }
}

/// Returns the vector from the middle of a picture of `size` pixels to its upper right corner, pixels, y up.
pub(super) fn half_size(size: [u32; 2]) -> DVec2 {
    DVec2::from(size.map(f64::from)) / 2.0
}

/// Returns the smallest box (m) around all finite items of a snapshot: grains, discs that are not grains, walls, and
/// the centre of an attracting gravity field. `None` if there are no such items.
pub fn bounds(snapshot: &Snapshot) -> Option<[DVec2; 2]> {
    let surroundings = &snapshot.surroundings;
    let grains = snapshot.grains.iter().map(|grain| (grain.position, grain.radius));
    let fixed = surroundings.fixed_discs.iter().map(|disc| (disc.position, disc.radius));
    let edges = surroundings.boundaries.iter().flat_map(Boundary::edges);
    let walls = edges.flat_map(ends).map(|point| (point, 0.0));
    let centre = surroundings.centre_of_attraction.map(|point| (point, 0.0));
    grains
        .chain(fixed)
        .chain(walls)
        .chain(centre)
        .filter(|(position, radius)| position.is_finite() && radius.is_finite())
        .map(|(position, radius)| [position - radius, position + radius])
        .reduce(|all, next| [all[0].min(next[0]), all[1].max(next[1])])
}

/// Returns the two ends of an edge (a line or line segment of the outline of a wall); an infinite edge has no ends.
fn ends(edge: Edge) -> impl Iterator<Item = DVec2> {
    let ends = match edge {
        Edge::Endless { .. } => None,
        Edge::Wall(ends) | Edge::Side(ends) => Some(ends),
    };
    ends.into_iter().flatten()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn framing_fills_the_tighter_direction_and_centres_the_other() {
        let (min, max) = (DVec2::new(1.0, 2.0), DVec2::new(5.0, 3.0));
        let margins = Margins { left: 20.0, right: 20.0, top: 20.0, bottom: 20.0 };
        let camera = Camera::framing(min, max, 440, 300, margins);
        assert_eq!(camera.metres_per_pixel, 0.01);
        assert_eq!(camera.centre, DVec2::new(3.0, 2.5));
        assert_eq!(camera.project(DVec2::new(1.0, 3.0)), [-200.0, 50.0]);
    }

    #[test]
    fn unequal_margins_shift_the_box() {
        let margins = Margins { left: 0.0, right: 0.0, top: 10.0, bottom: 50.0 };
        let camera = Camera::framing(DVec2::ZERO, DVec2::new(1.0, 1.0), 100, 160, margins);
        assert_eq!(camera.metres_per_pixel, 0.01);
        // 50 px are free below the box and 10 px above it.
        assert_eq!(camera.project(DVec2::ZERO), [-50.0, -30.0]);
        assert_eq!(camera.project(DVec2::ONE), [50.0, 70.0]);
    }

    #[test]
    fn a_single_point_can_be_framed() {
        let margins = Margins { left: 200.0, right: 200.0, top: 200.0, bottom: 200.0 };
        let camera = Camera::framing(DVec2::ONE, DVec2::ONE, 100, 100, margins);
        assert!(camera.metres_per_pixel > 0.0);
        assert_eq!(camera.project(DVec2::ONE), [0.0, 0.0]);
    }

    #[test]
    fn projection_and_its_inverse_meet() {
        let camera = Camera { centre: DVec2::new(1e6, -3e5), metres_per_pixel: 1e-5 };
        let point = camera.centre + DVec2::new(0.001, 0.002);
        let [x, y] = camera.project(point);
        assert!((x - 100.0).abs() < 1e-3 && (y - 200.0).abs() < 1e-3, "{x} {y}");
        assert!(camera.unproject(DVec2::new(100.0, 200.0)).distance(point) < 1e-9);
    }
}
