//! The cell of each grain: the room that is nearer to it than to any other, as far as it belongs to the packing.
//!
//! *Power cells.* Near is measured by the power |p − x|² − r² of a point to a disc (Laguerre, also radical, tessellation;
//! F. Aurenhammer, *Power Diagrams*, SIAM J. Comput. 16, 1987). Where radii differ, cells of the plain Voronoi diagram
//! cut through larger discs; those of the power diagram part two discs that touch at their contact point, so that each
//! disc lies in its cell but for overlaps. Where radii are equal, both are the same. Fixed discs have cells, too, which
//! are no grain's.
//!
//! *Walls* cut cells: see `walls`. *Across periodic borders* the images of discs and walls cut cells as they do themselves.
//!
//! *How far.* A point belongs to the packing if its power to the nearest grain is below 3r̄², r̄ the mean radius: in a
//! pore between grains of that radius which is just large enough for one more, the middle is the first point that does
//! not. A cell with corners beyond is open: it lies at a free surface or at a hole, and says nothing of how densely
//! grains are packed. Its area counts up to that border and inside of the box around all grains, so that a packing with
//! straight sides and no hole has just its box, whether there are walls at its sides or not.

mod images;
mod polygon;
mod site;
mod walls;

use std::f64::consts::PI;

use glam::DVec2;

use self::polygon::Cell;
use self::site::{Cut, Site};
use self::walls::Walls;
use super::network::Network;
use crate::contact::BroadPhase;
use crate::sim::{GrainState, Surroundings};
use crate::world::Periodic;

/// The border of the packing: the largest power to the nearest grain, in squares of the mean radius. Smaller: loose
/// packings have open cells inside; larger: more of the air above a free surface counts.
const LARGEST_POWER: f64 = 3.0;

/// The cells of all grains.
pub(super) struct Cells {
    /// Areas, m²; NaN for a grain that does not count.
    pub areas: Vec<f64>,
    /// Area of a grain's disc in that of its cell; NaN where the cell is not closed.
    pub solid_fractions: Vec<f64>,
    /// Σ areas of cells, m².
    pub area: f64,
    /// Area of the box around all grains, m²; NaN without grains.
    pub box_area: f64,
    /// Σ πr² over all grains, m².
    pub disc_area: f64,
    /// Number of closed cells.
    pub closed: u32,
    /// Σ πr² over the grains with closed cells, in Σ areas of those; NaN without any.
    pub solid_fraction: f64,
}

/// Corners of the upright box around all grains, without end across periodic borders.
#[derive(Clone, Copy)]
struct Bounds {
    low: DVec2,
    high: DVec2,
    periodic: Option<Periodic>,
}

impl Cells {
    pub(super) fn of(network: &Network, surroundings: &Surroundings) -> Self {
        let (indices, mut sites) = sites(network, surroundings);
        let bounds = Bounds::around(&sites[..indices.len()], surroundings.periodic);
        images::append(&mut sites, surroundings.periodic);
        let grains = &sites[..indices.len()];
        let walls = Walls::of(&surroundings.boundaries);
        let neighbours = Neighbours::of(&sites, grains.len());
        let mut cells = Self::without_any(network.grains.len());
        let (mut cuts, mut cell) = (Vec::new(), Cell::default());
        let mut closed_areas = [0.0; 2];
        for (place, (&index, site)) in indices.iter().zip(grains).enumerate() {
            cuts.clear();
            cuts.extend(
                neighbours.of_site(place).iter().map(|&other| cut(&sites, place, other as usize)),
            );
            for image in images::of(site, surroundings.periodic) {
                walls.cut(&image, &mut cuts);
            }
            cell.fill(site.reach, &mut cuts);
            let disc_area = PI * site.radius * site.radius;
            let is_closed = cell.is_closed(site.reach);
            if !is_closed {
                cell.clip(bounds.cuts(site.position));
            }
            let area = cell.area_within(site.reach);
            if is_closed {
                cells.solid_fractions[index] = disc_area / area;
                cells.closed += 1;
                closed_areas[0] += disc_area;
                closed_areas[1] += area;
            }
            cells.areas[index] = area;
            cells.area += area;
            cells.disc_area += disc_area;
        }
        cells.box_area = bounds.area();
        cells.solid_fraction = closed_areas[0] / closed_areas[1];
        cells
    }

    fn without_any(grains: usize) -> Self {
        Self {
            areas: vec![f64::NAN; grains],
            solid_fractions: vec![f64::NAN; grains],
            area: 0.0,
            box_area: f64::NAN,
            disc_area: 0.0,
            closed: 0,
            solid_fraction: f64::NAN,
        }
    }
}

/// The grains that count, with their indices, and after them the fixed discs.
fn sites(network: &Network, surroundings: &Surroundings) -> (Vec<usize>, Vec<Site>) {
    let (indices, grains): (Vec<usize>, Vec<&GrainState>) = network.grains().unzip();
    let mean_radius = grains.iter().map(|grain| grain.radius).sum::<f64>() / grains.len() as f64;
    let largest_power = LARGEST_POWER * mean_radius * mean_radius;
    let site = |(position, radius): (DVec2, f64)| Site {
        position,
        radius,
        reach: (radius * radius + largest_power).sqrt(),
    };
    let grains = grains.iter().map(|grain| (grain.position, grain.radius));
    let fixed = surroundings.fixed_discs.iter().map(|disc| (disc.position, disc.radius));
    (indices, grains.chain(fixed).map(site).collect())
}

/// The line of equal powers, as it cuts the cell of the first site.
fn cut(sites: &[Site], first: usize, second: usize) -> Cut {
    let (site, other) = (&sites[first], &sites[second]);
    let way = other.position - site.position;
    let distance = way.length();
    if distance == 0.0 {
        // One of two discs in one place has all: the larger one, or else the first.
        let has_none = (other.radius, first) > (site.radius, second);
        let offset = if has_none { f64::NEG_INFINITY } else { f64::INFINITY };
        return Cut { offset, direction: DVec2::X };
    }
    let powers = (site.radius - other.radius) * (site.radius + other.radius);
    Cut { offset: 0.5 * (distance + powers / distance), direction: way / distance }
}

/// The sites whose cells may border on that of each grain: what two cells can reach overlaps where they do.
struct Neighbours {
    starts: Vec<usize>,
    others: Vec<u32>,
}

impl Neighbours {
    /// Of the first `grains` sites.
    fn of(sites: &[Site], grains: usize) -> Self {
        let mut pairs = Vec::new();
        let centres: Vec<DVec2> = sites.iter().map(|site| site.position).collect();
        let reaches: Vec<f64> = sites.iter().map(|site| site.reach).collect();
        BroadPhase::of(&reaches).pairs::<2>(&centres, reaches.iter().copied(), |i, j| {
            let (first, second) = (i as usize, j as usize);
            let reach = reaches[first] + reaches[second];
            if centres[first].distance_squared(centres[second]) < reach * reach {
                pairs.extend([(i, j), (j, i)]);
            }
        });
        pairs.retain(|&(of, _)| (of as usize) < grains);
        let mut starts = vec![0; grains + 1];
        for &(of, _) in &pairs {
            starts[of as usize + 1] += 1;
        }
        for index in 0..grains {
            starts[index + 1] += starts[index];
        }
        let (mut ends, mut others) = (starts.clone(), vec![0; pairs.len()]);
        for (of, other) in pairs {
            let end = &mut ends[of as usize];
            others[*end] = other;
            *end += 1;
        }
        Self { starts, others }
    }

    fn of_site(&self, place: usize) -> &[u32] {
        &self.others[self.starts[place]..self.starts[place + 1]]
    }
}

impl Bounds {
    fn around(sites: &[Site], periodic: Option<Periodic>) -> Self {
        let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        for site in sites {
            low = low.min(site.position - site.radius);
            high = high.max(site.position + site.radius);
        }
        Self { low, high, periodic }
    }

    fn area(&self) -> f64 {
        let size = self.high - self.low;
        let [width, height] = self.periodic.unwrap_or_default().periods();
        let area = width.unwrap_or(size.x) * height.unwrap_or(size.y);
        if size.y < 0.0 { f64::NAN } else { area }
    }

    /// Its sides, seen from a point inside.
    fn cuts(&self, centre: DVec2) -> [Cut; 4] {
        let (mut above, mut below) = (self.high - centre, centre - self.low);
        let [width, height] = self.periodic.unwrap_or_default().periods();
        // Farther than any cell reaches.
        if let Some(width) = width {
            (above.x, below.x) = (2.0 * width, 2.0 * width);
        }
        if let Some(height) = height {
            (above.y, below.y) = (2.0 * height, 2.0 * height);
        }
        [
            Cut { offset: above.x, direction: DVec2::X },
            Cut { offset: above.y, direction: DVec2::Y },
            Cut { offset: below.x, direction: DVec2::NEG_X },
            Cut { offset: below.y, direction: DVec2::NEG_Y },
        ]
    }
}
