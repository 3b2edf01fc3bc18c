//! A cell while it is cut, as a convex polygon about the centre of its disc.

use glam::DVec2;
use parry2d_f64::query::details::clip_halfspace_polygon;

use super::site::Cut;

/// How much nearer than the border a closed cell's corners are, as a part of the distance squared: rounding.
const CLOSED_WITHIN: f64 = 1e-9;

/// Its corners in order, anticlockwise, relative to the centre of its disc. All memory is kept from cell to cell.
#[derive(Default)]
pub(super) struct Cell {
    corners: Vec<DVec2>,
    before: Vec<DVec2>,
}

impl Cell {
    /// Makes it what the cuts leave of a square around all that is within `reach` (m) of the centre.
    pub(super) fn fill(&mut self, reach: f64, cuts: &mut [Cut]) {
        self.corners.clear();
        let signs = [DVec2::NEG_ONE, DVec2::new(1.0, -1.0), DVec2::ONE, DVec2::new(-1.0, 1.0)];
        self.corners.extend(signs.map(|sign| reach * sign));
        cuts.sort_unstable_by(|a, b| a.offset.total_cmp(&b.offset));
        for &cut in cuts.iter() {
            // Those that follow are no nearer.
            if cut.offset > 0.0 && cut.offset * cut.offset >= self.farthest_squared() {
                break;
            }
            self.clip([cut]);
        }
    }

    /// Leaves what is on this side of the cuts.
    pub(super) fn clip<const COUNT: usize>(&mut self, cuts: [Cut; COUNT]) {
        for Cut { offset, direction } in cuts {
            if offset < 0.0 && offset * offset >= self.farthest_squared() {
                self.corners.clear();
                return;
            }
            std::mem::swap(&mut self.corners, &mut self.before);
            clip_halfspace_polygon(offset * direction, direction, &self.before, &mut self.corners);
        }
    }

    /// Whether it is a cell of which all corners are nearer to the centre than `reach`, m.
    pub(super) fn is_closed(&self, reach: f64) -> bool {
        !self.corners.is_empty() && self.farthest_squared() < (1.0 - CLOSED_WITHIN) * reach * reach
    }

    /// Squared distance of its farthest corner, m²; 0 where nothing is left of it.
    fn farthest_squared(&self) -> f64 {
        self.corners.iter().map(|corner| corner.length_squared()).fold(0.0, f64::max)
    }

    /// Area of what lies within `radius` (m) of the centre: each side spans a triangle with the centre, of which the
    /// circle leaves a triangle and a sector at either end.
    pub(super) fn area_within(&self, radius: f64) -> f64 {
        let nexts = self.corners.iter().cycle().skip(1);
        let sides = self.corners.iter().zip(nexts);
        sides.map(|(&from, &to)| area_below(from, to, radius)).sum()
    }
}

/// Signed area of what a circle about the origin leaves of the triangle between the origin and a side.
fn area_below(from: DVec2, to: DVec2, radius: f64) -> f64 {
    let inside = radius * radius;
    if from.length_squared() <= inside && to.length_squared() <= inside {
        return 0.5 * from.perp_dot(to);
    }
    let sector = |from: DVec2, to: DVec2| 0.5 * inside * from.perp_dot(to).atan2(from.dot(to));
    let along = to - from;
    let length_squared = along.length_squared();
    if length_squared == 0.0 {
        return 0.0;
    }
    let middle = -from.dot(along) / length_squared;
    let half_squared = (inside - (from + middle * along).length_squared()) / length_squared;
    if half_squared <= 0.0 {
        return sector(from, to);
    }
    let half = half_squared.sqrt();
    let [enters, leaves] = [middle - half, middle + half].map(|part| part.clamp(0.0, 1.0));
    if enters >= leaves {
        return sector(from, to);
    }
    let (first, last) = (from + enters * along, from + leaves * along);
    let mut area = 0.5 * first.perp_dot(last);
    if enters > 0.0 {
        area += sector(from, first);
    }
    if leaves < 1.0 {
        area += sector(last, to);
    }
    area
}
