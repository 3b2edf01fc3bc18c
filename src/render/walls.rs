//! Drawing of walls as thin dark lines, of solids with short hatching inside their surface, and of periodic borders as
//! dashed lines.
//!
//! Lines are clipped to the picture in f64, so that an infinite wall, or a wall that starts a million diameters away,
//! becomes f32 pixels without loss of precision. The strokes of the hatching have fixed positions in the scene, so they
//! move in the picture when the view moves.

use glam::DVec2;

use super::camera::half_size;
use super::{Camera, Colour, LinkInstance};
use crate::world::{Boundary, Edge, Periodic};

// All lengths below are in units of the font size of the picture's labels, so that prints of all sizes look alike.

/// Half of the width of a wall's line, in font sizes of the labels.
const LINE_HALF_WIDTH_EM: f64 = 0.0625;
/// Half of the width of a hatching stroke, in font sizes of the labels.
const HATCH_HALF_WIDTH_EM: f64 = 0.033;
/// Distance between hatching strokes along the wall, in font sizes of the labels.
const HATCH_SPACING_EM: f64 = 0.6;
/// Depth to which the hatching extends into a solid, in font sizes of the labels. A stroke is inclined by 45°, so it
/// extends by the same length along the surface.
const HATCH_DEPTH_EM: f64 = 0.45;

/// Half of the width of a dash of a periodic border, in font sizes of the labels.
const DASH_HALF_WIDTH_EM: f64 = 0.035;
/// Length of a dash of a periodic border, in font sizes of the labels.
const DASH_EM: f64 = 0.45;
/// Distance between the beginnings of two dashes of a periodic border, in font sizes of the labels.
const DASH_SPACING_EM: f64 = 0.9;

/// Converter of walls and solids to the thick lines (links) of one picture.
struct WallLines<'a> {
    camera: &'a Camera,
    colour: Colour,
    /// Font size of the picture's labels, pixels.
    em: f64,
    /// Half of the picture's size plus a margin, pixels. The round ends of clipped lines are in this margin, so they
    /// are not visible.
    reach: DVec2,
    links: Vec<LinkInstance>,
}

/// Returns the lines (links) that show all `boundaries` visible in a picture of `size` pixels.
pub(super) fn boundary_links(
    boundaries: &[Boundary],
    camera: &Camera,
    size: [u32; 2],
    text_px: f32,
    colour: Colour,
) -> Vec<LinkInstance> {
    let em = f64::from(text_px);
    let mut walls =
        WallLines { camera, colour, em, reach: half_size(size) + em, links: Vec::new() };
    for edge in boundaries.iter().flat_map(Boundary::edges) {
        walls.draw(edge);
    }
    walls.links
}

impl WallLines<'_> {
    fn draw(&mut self, edge: Edge) {
        match edge {
            Edge::Endless { point, normal } => {
                let along = -normal.normalize_or_zero().perp();
                // The line is long enough to cross the picture, whatever its direction.
                let anchor = self.camera.offset_px(point);
                let nearest = along * -anchor.dot(along);
                let across = along * (2.0 * self.reach.length());
                self.solid_edge(anchor, anchor + nearest - across, anchor + nearest + across);
            }
            Edge::Wall(ends) => {
                let [from, to] = ends.map(|end| self.camera.offset_px(end));
                if let Some([start, end]) = clip(from, to, self.reach) {
                    self.link(start, end, LINE_HALF_WIDTH_EM);
                }
            }
            Edge::Side(ends) => {
                let [from, to] = ends.map(|end| self.camera.offset_px(end));
                // The solid must be on the right of the line, so the line runs backwards.
                self.solid_edge(to, to, from);
            }
        }
    }

    /// Draws a surface from `from` to `to`, pixels, with the solid on its right. Along the surface, the distance of
    /// each hatching stroke from the point `anchor` is a whole multiple of the spacing.
    fn solid_edge(&mut self, anchor: DVec2, from: DVec2, to: DVec2) {
        let Some([start, end]) = clip(from, to, self.reach) else { return };
        self.link(start, end, LINE_HALF_WIDTH_EM);
        let along = (to - from).normalize_or_zero();
        if along == DVec2::ZERO {
            return;
        }
        let stroke = (-along.perp() - along) * (HATCH_DEPTH_EM * self.em);
        let spacing = HATCH_SPACING_EM * self.em;
        let number = |point: DVec2| (point - anchor).dot(along) / spacing;
        // Strokes are inclined backwards, so a stroke at the very start would extend beyond the corner of a polygon.
        let first = (number(start) + HATCH_DEPTH_EM / HATCH_SPACING_EM).ceil() as i64;
        for index in first..=number(end).floor() as i64 {
            let foot = anchor + along * (index as f64 * spacing);
            self.link(foot, foot + stroke, HATCH_HALF_WIDTH_EM);
        }
    }

    fn link(&mut self, start: DVec2, end: DVec2, half_width_em: f64) {
        let half_width = (half_width_em * self.em) as f32;
        self.links.push(LinkInstance::new([start, end], half_width, self.colour));
    }
}

/// Returns the part of the segment from `from` to `to` inside the box from −`reach` to `reach`. `None` if no part is
/// inside or an end is not finite.
pub(super) fn clip(from: DVec2, to: DVec2, reach: DVec2) -> Option<[DVec2; 2]> {
    let span = to - from;
    if !span.is_finite() {
        return None;
    }
    let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
    for (start, length, limit) in [(from.x, span.x, reach.x), (from.y, span.y, reach.y)] {
        if length == 0.0 {
            if start.abs() > limit {
                return None;
            }
            continue;
        }
        let crossings = [(-limit - start) / length, (limit - start) / length];
        enter = enter.max(crossings[0].min(crossings[1]));
        leave = leave.min(crossings[0].max(crossings[1]));
    }
    (enter <= leave).then(|| [from + span * enter, from + span * leave])
}

/// Returns the dashes of the periodic borders that are visible in a picture of `size` pixels.
pub(super) fn border_links(
    periodic: Periodic,
    camera: &Camera,
    size: [u32; 2],
    text_px: f32,
    colour: Colour,
) -> Vec<LinkInstance> {
    let em = f64::from(text_px);
    let half = half_size(size);
    let dashes = |borders: Option<[f64; 2]>, across: DVec2, along: DVec2| {
        let at =
            |border: f64| camera.offset_px(border * across + camera.centre * along).dot(across);
        let shown = borders.into_iter().flatten().map(at);
        let shown = shown.filter(move |at| at.abs() <= half.dot(across) + em);
        let count = (half.dot(along) / (DASH_SPACING_EM * em)).ceil() as i32;
        let steps =
            move || (-count..=count).map(move |step| f64::from(step) * DASH_SPACING_EM * em);
        let dash = move |at: f64, step: f64| {
            let ends = [step - 0.5 * DASH_EM * em, step + 0.5 * DASH_EM * em];
            let ends = ends.map(|end| at * across + end * along);
            LinkInstance::new(ends, (DASH_HALF_WIDTH_EM * em) as f32, colour)
        };
        shown.flat_map(move |at| steps().map(move |step| dash(at, step))).collect::<Vec<_>>()
    };
    [dashes(periodic.x, DVec2::X, DVec2::Y), dashes(periodic.y, DVec2::Y, DVec2::X)].concat()
}

#[cfg(test)]
mod tests {

    use super::*;

    const REACH: DVec2 = DVec2::new(10.0, 5.0);

    #[test]
    fn clipping_keeps_what_is_inside() {
        let inside = [DVec2::new(-1.0, 2.0), DVec2::new(3.0, -4.0)];
        assert_eq!(clip(inside[0], inside[1], REACH), Some(inside));
        let [start, end] = clip(DVec2::new(-1e9, 1.0), DVec2::new(1e9, 1.0), REACH).unwrap();
        assert!(start.distance(DVec2::new(-10.0, 1.0)) < 1e-6);
        assert!(end.distance(DVec2::new(10.0, 1.0)) < 1e-6);
        assert_eq!(clip(DVec2::new(-20.0, 6.0), DVec2::new(20.0, 6.0), REACH), None);
        assert_eq!(clip(DVec2::new(11.0, -20.0), DVec2::new(30.0, 20.0), REACH), None);
    }

    #[test]
    fn the_ground_is_hatched_below_its_surface() {
        let ground = Boundary::HalfSpace { point: DVec2::new(1e6, 0.0), normal: DVec2::Y };
        let camera = Camera { centre: DVec2::new(0.0, 0.1), metres_per_pixel: 0.01 };
        let links = boundary_links(&[ground], &camera, [200, 100], 15.0, Colour::BLACK);
        let (surface, hatching) = links.split_first().unwrap();
        assert!(surface.start[1] == -10.0 && surface.end[1] == -10.0);
        assert!(surface.start[0] <= -100.0 && surface.end[0] >= 100.0);
        assert!(hatching.len() > 20);
        assert!(hatching.iter().all(|stroke| stroke.start[1] == -10.0 && stroke.end[1] < -10.0));
    }

    #[test]
    fn a_polygon_is_hatched_inside() {
        let corners = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)];
        let points = corners.map(DVec2::from).to_vec();
        let camera = Camera { centre: DVec2::splat(0.5), metres_per_pixel: 0.01 };
        let polygon = Boundary::ConvexPolygon { points };
        let links = boundary_links(&[polygon], &camera, [200, 200], 15.0, Colour::BLACK);
        assert!(links.len() > 20);
        for link in links {
            for point in [link.start, link.end] {
                assert!(point.iter().all(|along| along.abs() <= 50.0 + 1e-3), "{point:?}");
            }
        }
    }
}
