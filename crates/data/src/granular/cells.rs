//! Computes the cell of each grain: the region that is nearer to the grain than to any other disc, as far as the region
//! belongs to the packing.
//!
//! *Power cells.* The distance of a point p from a disc with centre x and radius r is measured by the power |p − x|² −
//! r² (Laguerre, also radical, tessellation; F. Aurenhammer, *Power Diagrams*, SIAM J. Comput. 16, 1987). If radii
//! differ, cells of the plain Voronoi diagram cut through larger discs. The power diagram separates two touching discs
//! at their contact point, so each disc lies in its cell except for overlaps. For equal radii the two diagrams are the
//! same. Fixed discs also have cells, but their area does not count for any grain.
//!
//! *Walls.* A grain is in front of a straight side of a boundary if the foot of the perpendicular from its centre lies
//! between the ends of the side. The line of the side then cuts the grain's cell. If a grain is not in front of any
//! side of a boundary, the nearest corner of the boundary cuts its cell, along a line perpendicular to the line from
//! the grain's centre to the corner. So no cell reaches into a solid or through a wall, and a small region around the
//! free end of a wall belongs to no cell. *Periodic borders.* The periodic images of discs and walls cut cells like the
//! originals.
//!
//! *Extent of the packing.* A point belongs to the packing if its power with respect to the nearest grain is below
//! 3r̄², with the mean radius r̄. If grains of that radius surround a pore that is just large enough for one more
//! grain, the centre of the pore is the first point outside the packing. A cell with a corner outside the packing is
//! open: it lies at a free surface or at a hole and says nothing about the density of the packing. Only the part of an
//! open cell that is within the packing and within the box around all grains counts as area. A packing with straight
//! sides and without holes therefore fills exactly its box, with or without walls at its sides.

use std::f64::consts::PI;

use glam::DVec2;
use parry2d_f64::query::details::clip_halfspace_polygon;

use super::network::Network;
use crate::contact::BroadPhase;
use crate::sim::{GrainState, Surroundings};
use crate::world::{Boundary, Edge, Periodic};

/// Limit of the packing: the largest power |p − x|² − r² of a point p in the packing with respect to the nearest grain
/// (centre x, radius r), in squares of the mean radius. The power is 3 in the centre of a pore that is surrounded by
/// grains of the mean radius and just large enough for one more of them: the centre of the pore is 2 radii from the
/// centres of the grains, and 2² − 1² = 3. If the limit is smaller, loose packings have open cells (cells that are not
/// entirely in the packing) inside. If the limit is larger, more of the air above a free surface counts.
const LARGEST_POWER: f64 = 3.0;

/// Relative margin for rounding errors in the test whether a cell (the region nearer to a grain than to any other disc)
/// is closed, which means that all corners of the cell are in the packing. A cell counts as closed if the squared
/// distance of each corner from the centre of the grain is less than (1 − this margin) times the largest squared
/// distance from that centre at which a point still counts as being in the packing.
const CLOSED_WITHIN: f64 = 1e-9;

pub(super) struct PowerCells {
    /// Area, m², of each grain's cell, the region that is nearer to the grain than to any other disc, as far as it
    /// belongs to the packing; NaN for a lost grain (which went through a wall or left the scene).
    pub areas: Vec<f64>,
    /// Area of each grain's disc divided by the area of the grain's cell, the region that is nearer to the grain than
    /// to any other disc. NaN if a corner of the cell is outside the packing: at a free surface or a hole.
    pub solid_fractions: Vec<f64>,
    /// Sum of the areas of the cells of all grains, m². The cell of a grain is the region that is nearer to the grain
    /// than to any other disc, as far as it belongs to the packing.
    pub area: f64,
    /// Area of the axis-parallel box around all grains, m²; NaN without grains.
    pub box_area: f64,
    /// Total area Σ πr² of the discs of all grains, m².
    pub disc_area: f64,
    pub closed: u32,
    /// Total disc area of the grains with closed cells, divided by the total area of those cells; NaN without closed
    /// cells. A cell, the region nearer to a grain than to any other disc, is closed if all its corners are in the
    /// packing.
    pub solid_fraction: f64,
}

/// Lower left and upper right corner (m) of the axis-parallel box around all grains. Along a periodic axis the box is
/// unbounded.
#[derive(Clone, Copy)]
struct GrainBox {
    low: DVec2,
    high: DVec2,
    periodic: Option<Periodic>,
}

impl PowerCells {
    pub(super) fn of(network: &Network, surroundings: &Surroundings) -> Self {
        let (indices, mut sites) = sites(network, surroundings);
        let bounds = GrainBox::around(&sites[..indices.len()], surroundings.periodic);
        append_images(&mut sites, surroundings.periodic);
        let grains = &sites[..indices.len()];
        let walls = surroundings.boundaries.iter().map(Boundary::edges).collect::<Vec<_>>();
        let neighbours = neighbours(&sites, grains.len());
        let mut cells = Self::without_any(network.grains.len());
        let (mut cuts, mut cell) = (Vec::new(), CellPolygon::default());
        let mut closed_areas = [0.0; 2];
        for (place, (&index, site)) in indices.iter().zip(grains).enumerate() {
            cuts.clear();
            cuts.extend(neighbours[place].iter().map(|&other| cut(&sites, place, other)));
            for image in with_images(site, surroundings.periodic) {
                cut_by_walls(&walls, &image, &mut cuts);
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

/// Returns the indices of the grains that are still in the scene, and the discs that have cells (regions nearer to a
/// disc than to any other disc): first these grains, then the fixed discs.
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

/// Returns the half-plane that bounds the cell (the region nearer to a disc than to any other disc) of the disc `first`
/// against the cell of the disc `second` (indices in `sites`). A point p on its border has the same power |p − x|² − r²
/// with respect to both discs (centre x, radius r).
fn cut(sites: &[Site], first: usize, second: usize) -> HalfPlane {
    let (site, other) = (&sites[first], &sites[second]);
    let branch = other.position - site.position;
    let distance = branch.length();
    if distance == 0.0 {
        // If two discs have the same centre, the larger disc gets the whole cell, or the first of two equal discs.
        let has_none = (other.radius, first) > (site.radius, second);
        let offset = if has_none { f64::NEG_INFINITY } else { f64::INFINITY };
        return HalfPlane { offset, direction: DVec2::X };
    }
    let powers = (site.radius - other.radius) * (site.radius + other.radius);
    HalfPlane { offset: 0.5 * (distance + powers / distance), direction: branch / distance }
}

/// Returns, for each of the first `grains` discs of `sites`, the indices of the discs whose cells (regions nearer to a
/// disc than to any other disc) may border on the cell of this disc. Each cell lies within the circle with the radius
/// `reach` around the centre of its disc, so only cells whose circles overlap can border on each other.
fn neighbours(sites: &[Site], grains: usize) -> Vec<Vec<usize>> {
    let mut neighbours = vec![Vec::new(); grains];
    let centres: Vec<DVec2> = sites.iter().map(|site| site.position).collect();
    let reaches: Vec<f64> = sites.iter().map(|site| site.reach).collect();
    BroadPhase::of(&reaches).pairs::<2>(&centres, reaches.iter().copied(), |i, j| {
        let (first, second) = (i as usize, j as usize);
        let reach = reaches[first] + reaches[second];
        if centres[first].distance_squared(centres[second]) < reach * reach {
            for (of, other) in [(first, second), (second, first)] {
                if let Some(neighbours) = neighbours.get_mut(of) {
                    neighbours.push(other);
                }
            }
        }
    });
    neighbours
}

impl GrainBox {
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

    /// Returns the four sides of the box around all grains as half-planes relative to `centre`, a point inside the box.
    fn cuts(&self, centre: DVec2) -> [HalfPlane; 4] {
        let (mut above, mut below) = (self.high - centre, centre - self.low);
        let [width, height] = self.periodic.unwrap_or_default().periods();
        // Along a periodic axis the sides are beyond the reach of any cell.
        if let Some(width) = width {
            (above.x, below.x) = (2.0 * width, 2.0 * width);
        }
        if let Some(height) = height {
            (above.y, below.y) = (2.0 * height, 2.0 * height);
        }
        [
            HalfPlane { offset: above.x, direction: DVec2::X },
            HalfPlane { offset: above.y, direction: DVec2::Y },
            HalfPlane { offset: below.x, direction: DVec2::NEG_X },
            HalfPlane { offset: below.y, direction: DVec2::NEG_Y },
        ]
    }
}

/// A half-plane that cuts a cell (the region nearer to a disc than to any other disc): the points p with (p −
/// x)·direction ≤ offset, with the centre x of the cell's disc.
#[derive(Clone, Copy, Debug)]
struct HalfPlane {
    /// Distance of the half-plane's border from the centre of the cell's disc (the disc to which the points of the cell
    /// are nearest), m; negative if that centre is outside the half-plane.
    offset: f64,
    /// Unit normal of the half-plane's border, pointing out of the half-plane.
    direction: DVec2,
}

/// A disc that has a cell (the region nearer to it than to any other disc): a grain, a fixed disc, or a periodic image
/// of such a disc.
#[derive(Clone, Copy)]
struct Site {
    position: DVec2,
    radius: f64,
    /// Radius of the circle around the disc's centre that contains its cell (the region nearer to this disc than to any
    /// other disc), m.
    reach: f64,
}

/// Adds those periodic images of the discs whose cells (regions nearer to a disc than to any other disc) may border on
/// a cell of an original disc.
fn append_images(sites: &mut Vec<Site>, periodic: Option<Periodic>) {
    let Some(periodic) = periodic else { return };
    let reach = 2.0 * sites.iter().map(|site| site.reach).fold(0.0, f64::max);
    let images: Vec<Site> = sites
        .iter()
        .flat_map(|site| {
            let by = periodic.images([site.position - reach, site.position + reach]);
            by.map(|by| Site { position: site.position + by, ..*site })
        })
        .filter(|image| {
            let place = image.position;
            [(periodic.x, place.x), (periodic.y, place.y)].into_iter().all(|(borders, at)| {
                borders.is_none_or(|[low, high]| (low - reach..high + reach).contains(&at))
            })
        })
        .collect();
    sites.extend(images);
}

/// Returns a disc and, with periodic borders, its images one period to each side. Testing the images against the walls
/// is equivalent to testing the disc against the images of the walls.
fn with_images(site: &Site, periodic: Option<Periodic>) -> impl Iterator<Item = Site> {
    let site = *site;
    let around = periodic.unwrap_or_default().around();
    around.map(move |by| Site { position: site.position + by, ..site })
}

/// Position of a grain relative to a straight side of a boundary.
enum Stands {
    /// The grain is in front of the side of a boundary. The half-plane cuts the grain's cell (the region nearer to the
    /// grain than to any other disc) along the line of this side.
    Before(HalfPlane),
    /// The grain is beyond an end of the side of a boundary. The vector leads from the centre of the grain to the
    /// nearer end, m.
    Beside(DVec2),
}

/// Adds the half-planes by which the sides and corners of all boundaries can cut the cell of a disc (the region nearer
/// to it than to any other disc).
fn cut_by_walls(boundaries: &[Vec<Edge>], site: &Site, cuts: &mut Vec<HalfPlane>) {
    for edges in boundaries {
        let mut before = false;
        // Shortest vector from the site to a corner of the boundary so far, m.
        let mut corner: Option<DVec2> = None;
        for edge in edges {
            match stands(site.position, edge) {
                Stands::Before(cut) if cut.offset < site.reach => {
                    before = true;
                    cuts.push(cut);
                }
                Stands::Before(_) => {}
                Stands::Beside(way) => {
                    if corner.is_none_or(|found| way.length_squared() < found.length_squared()) {
                        corner = Some(way);
                    }
                }
            }
        }
        if let (false, Some(way)) = (before, corner)
            && way.length() < site.reach
        {
            cuts.push(HalfPlane { offset: way.length(), direction: way.normalize_or(DVec2::X) });
        }
    }
}

fn stands(centre: DVec2, edge: &Edge) -> Stands {
    match *edge {
        Edge::Endless { point, normal } => {
            let normal = normal.normalize_or_zero();
            Stands::Before(HalfPlane { offset: (centre - point).dot(normal), direction: -normal })
        }
        Edge::Wall([from, to]) | Edge::Side([from, to]) => {
            let along = to - from;
            let part = (centre - from).dot(along) / along.length_squared();
            if part > 0.0 && part < 1.0 {
                // If the centre is on the line itself, both normal directions are valid.
                let way = from + part * along - centre;
                let direction = way.normalize_or(-along.perp().normalize_or_zero());
                Stands::Before(HalfPlane { offset: way.length(), direction })
            } else {
                Stands::Beside(if part >= 1.0 { to } else { from } - centre)
            }
        }
    }
}

/// Polygon of a cell (the region nearer to a disc than to any other disc) during its construction: its corners,
/// anticlockwise, relative to the centre of the cell's disc, m. The buffers are reused for the next cell.
#[derive(Default)]
struct CellPolygon {
    corners: Vec<DVec2>,
    before: Vec<DVec2>,
}

impl CellPolygon {
    /// Sets the cell (the region nearer to a disc than to any other disc) to a square that contains all points within
    /// `reach` (m) of the centre of the cell's disc, and then reduces the cell by all half-planes `cuts`.
    fn fill(&mut self, reach: f64, cuts: &mut [HalfPlane]) {
        self.corners.clear();
        let signs = [DVec2::NEG_ONE, DVec2::new(1.0, -1.0), DVec2::ONE, DVec2::new(-1.0, 1.0)];
        self.corners.extend(signs.map(|sign| reach * sign));
        cuts.sort_unstable_by(|a, b| a.offset.total_cmp(&b.offset));
        for &cut in cuts.iter() {
            // Cuts are sorted by offset, so all later cuts are at least as far away and change nothing.
            if cut.offset > 0.0 && cut.offset * cut.offset >= self.farthest_squared() {
                break;
            }
            self.clip([cut]);
        }
    }

    /// Reduces the cell (the region nearer to a disc than to any other disc) to the part that is inside all half-planes
    /// `cuts`.
    fn clip<const COUNT: usize>(&mut self, cuts: [HalfPlane; COUNT]) {
        for HalfPlane { offset, direction } in cuts {
            if offset < 0.0 && offset * offset >= self.farthest_squared() {
                self.corners.clear();
                return;
            }
            std::mem::swap(&mut self.corners, &mut self.before);
            clip_halfspace_polygon(offset * direction, direction, &self.before, &mut self.corners);
        }
    }

    /// True if the cell (the region nearer to a disc than to any other disc) is not empty and the distance of all its
    /// corners from the centre of the cell's disc is below `reach`, m.
    fn is_closed(&self, reach: f64) -> bool {
        !self.corners.is_empty() && self.farthest_squared() < (1.0 - CLOSED_WITHIN) * reach * reach
    }

    /// Returns the squared distance of the farthest corner of the cell (the region nearer to a disc than to any other
    /// disc) from the centre of the cell's disc, m²; 0 if the cell is empty.
    fn farthest_squared(&self) -> f64 {
        self.corners.iter().map(|corner| corner.length_squared()).fold(0.0, f64::max)
    }

    /// Computes the area, m², of that part of the cell (the region nearer to a disc than to any other disc) that is
    /// within `radius` (m) of the centre of the cell's disc. Each side of the cell spans a triangle with the centre.
    /// The circle reduces this triangle to a smaller triangle with a circular sector at either end.
    fn area_within(&self, radius: f64) -> f64 {
        let nexts = self.corners.iter().cycle().skip(1);
        let sides = self.corners.iter().zip(nexts);
        sides.map(|(&from, &to)| area_below(from, to, radius)).sum()
    }
}

/// Computes the signed area (m²) of the part of a triangle that lies inside the circle with the given radius (m) around
/// the origin. The corners of the triangle are the origin, `from` and `to`.
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
