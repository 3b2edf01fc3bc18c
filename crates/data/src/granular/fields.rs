//! Computes density, momentum, velocity and stress as smoothed fields (I. Goldhirsch, *Stress, stress asymmetry and
//! couple stress: from discrete particles to continuous fields*, Granular Matter 12:239, 2010):
//!
//! > ρ = Σ m φ(r − r_i),  p = Σ m v φ(r − r_i),  V = p/ρ,
//! > σ_k = Σ m v′ ⊗ v′ φ(r − r_i) with v′ = v − V(r),  σ_c = Σ f ⊗ ℓ ∫₀¹ φ(r − r_i + s ℓ) ds,
//!
//! Density ρ, momentum density p, velocity V and kinetic stress σ_k come from sums over grains with masses m, positions
//! r_i and velocities v. The contact stress σ_c comes from a sum over contacts: f is the force on grain i, and the
//! branch vector ℓ leads to the centre of grain i from the centre of grain j, or from the touched point of a wall or
//! fixed disc. Compression is positive, as everywhere in Slump.
//!
//! **The smoothing function φ** is the product of a cubic B-spline in x and one in y. It has continuous second
//! derivatives and ends at 2√3 widths, and its standard deviation along each axis is the width. **Each value is the
//! mean over a grid cell**, to which each grain contributes the integral of φ. The sums of mass, momentum and contact
//! stress over all cells are therefore exact; for the contact stress the sum is Σ f ⊗ ℓ. The integral over s is
//! computed by Gauss quadrature, whose weights add up to 1.
//!
//! **At periodic borders** the part of a grain that is smeared beyond a border appears at the opposite border. If the
//! borders shear, that part has the velocity that a grain has after crossing the border.

use glam::{DMat2, DVec2};

use super::network::Network;
use crate::error::{self, Error, Result};
use crate::sim::{GrainState, Moment};
use crate::world::Periodic;

/// Number of grid cells per smoothing width. Two cells resolve a field that varies smoothly over a smoothing width.
const CELLS_IN_WIDTH: f64 = 2.0;
/// Largest number of grid cells of a field. It limits the memory: all fields of a snapshot together have 13 numbers of
/// eight bytes per cell, about 400 MB at this limit.
const MOST_CELLS: f64 = 4e6;
/// Gauss quadrature on the interval from 0 to 1, as (point, weight). It is exact for polynomials up to degree five.
const QUADRATURE: [(f64, f64); 3] = [
    (0.112_701_665_379_258_3, 5.0 / 18.0),
    (0.5, 4.0 / 9.0),
    (0.887_298_334_620_741_7, 5.0 / 18.0),
];

/// Smoothed fields of a snapshot: density, momentum, velocity and stress. Each list has the mean over each cell of a
/// grid, row by row from below, each row from the left.
#[derive(Clone, Debug, PartialEq)]
pub struct Fields {
    /// Smoothing width, m: the standard deviation of the smoothing function along each axis.
    pub width: f64,
    /// Lower left corner of the grid cell with the index 0 along both axes, m: the origin of coordinates, or along a
    /// periodic axis the lower border.
    pub origin: DVec2,
    /// Width and height of a grid cell, m.
    pub cell: DVec2,
    /// Indices of the first grid cell along x and y, counted from the cell at `origin`.
    pub first: [i64; 2],
    /// Numbers of grid cells along x and y.
    pub counts: [usize; 2],
    /// Density ρ in each grid cell: mass per area, kg/m².
    pub density: Vec<f64>,
    /// Momentum p per area in each grid cell, kg/(m·s).
    pub momentum: Vec<DVec2>,
    /// Velocity V in each grid cell, m/s; NaN in a cell without mass.
    pub velocity: Vec<DVec2>,
    /// Kinetic stress σ_k in each grid cell, due to velocity fluctuations, N/m.
    pub kinetic_stress: Vec<DMat2>,
    /// Contact stress σ_c in each grid cell, N/m. The first index of the tensor is that of the force, the second that
    /// of the branch vector.
    pub contact_stress: Vec<DMat2>,
}

impl Fields {
    /// Computes the fields of all grains that are still in the scene, with the smoothing width `width`, m.
    ///
    /// # Errors
    /// If the smoothing width is not a finite length > 0 or is so small that the grid would have too many cells, or if
    /// the mass, position or velocity of a grain is not finite.
    pub fn of(moment: &Moment, width: f64) -> Result<Self> {
        Self::in_box(moment, width, [DVec2::MIN, DVec2::MAX])
    }

    /// Computes the fields, with the smoothing width `width` (m), on a grid for the grains in a box. The box is given
    /// by its lower left and upper right corner (m). The grid extends beyond these grains as far as smoothing spreads
    /// them. Grains outside the box count only as far as they are spread into this grid.
    ///
    /// # Errors
    /// If the smoothing width is not a finite length > 0 or is so small that the grid would have too many cells, or if
    /// the mass, position or velocity of a grain is not finite.
    pub fn in_box(moment: &Moment, width: f64, [least, most]: [DVec2; 2]) -> Result<Self> {
        error::check(width > 0.0 && width.is_finite(), "width", width, "a finite length > 0 in m")?;
        let is_finite = |grain: &GrainState| {
            let energy = grain.mass * grain.velocity.length_squared();
            grain.position.is_finite() && energy.is_finite()
        };
        let allowed = "finite to have fields";
        error::check(moment.grains.iter().all(is_finite), "state", "no longer finite", allowed)?;
        let network = Network::of(moment);
        let periodic = moment.surroundings.periodic.unwrap_or_default();
        let centres = network.grains().map(|(_, grain)| grain.position);
        let touched = network.links.iter();
        let touched = touched.map(|link| network.grains[link.grain].position - link.branch());
        // Along a periodic axis, all grains are inside the box.
        let is_in = |at: &DVec2| {
            (periodic.x.is_some() || (least.x..=most.x).contains(&at.x))
                && (periodic.y.is_some() || (least.y..=most.y).contains(&at.y))
        };
        let [low, high] = box_of(centres.chain(touched).filter(is_in));
        let axes = axes_over(periodic, [low, high], width);
        let count: f64 = axes.iter().map(|axis| axis.cells).product();
        if count > MOST_CELLS {
            let allowed = format!("so large that {count:.0} cells become {MOST_CELLS} or fewer");
            return Err(Error::value("width", width, allowed));
        }
        let counts = [0, 1].map(|axis| axes[axis].cells as usize);
        let cells = counts[0] * counts[1];
        let mut fields = Self {
            width,
            origin: DVec2::new(axes[0].origin, axes[1].origin),
            cell: DVec2::new(axes[0].side, axes[1].side),
            first: [axes[0].first, axes[1].first],
            counts,
            density: vec![0.0; cells],
            momentum: vec![DVec2::ZERO; cells],
            velocity: Vec::new(),
            kinetic_stress: vec![DMat2::ZERO; cells],
            contact_stress: vec![DMat2::ZERO; cells],
        };
        fields.fill(&network, &Smoothing { axes, periodic, width });
        Ok(fields)
    }

    /// True if the grid for the fields of a box, given by its lower left and upper right corner (m), has no more than
    /// the largest accepted number of cells with the smoothing width `width`, m.
    pub fn are_few(periodic: Option<Periodic>, corners: [DVec2; 2], width: f64) -> bool {
        let axes = axes_over(periodic.unwrap_or_default(), corners, width);
        axes.iter().map(|axis| axis.cells).product::<f64>() <= MOST_CELLS
    }

    fn fill(&mut self, network: &Network<'_>, smoothing: &Smoothing) {
        let per_area = 1.0 / (self.cell.x * self.cell.y);
        let Self { density, momentum, kinetic_stress, contact_stress, .. } = self;
        let speed = smoothing.periodic.border_speed();
        let seen = |velocity: DVec2, above: f64| velocity - above * speed * DVec2::X;
        for (_, grain) in network.grains() {
            smoothing.share(grain.position, |cell, share, above| {
                let mass = per_area * share * grain.mass;
                density[cell] += mass;
                momentum[cell] += mass * seen(grain.velocity, above);
            });
        }
        let velocity: Vec<DVec2> = momentum
            .iter()
            .zip(&*density)
            .map(|(&momentum, &density)| momentum / density)
            .collect();
        for (_, grain) in network.grains() {
            smoothing.share(grain.position, |cell, share, above| {
                // If the weight is rounded to zero, the cell may have no mass and no velocity.
                if share > 0.0 {
                    let own = seen(grain.velocity, above) - velocity[cell];
                    kinetic_stress[cell] += outer(per_area * share * grain.mass * own, own);
                }
            });
        }
        for link in &network.links {
            let (branch, centre) = (link.branch(), network.grains[link.grain].position);
            let pieces = (branch.length() / smoothing.width).ceil().max(1.0);
            let stress = outer(per_area / pieces * link.force, branch);
            for piece in 0..pieces as usize {
                for (place, weight) in QUADRATURE {
                    let at = centre - (piece as f64 + place) / pieces * branch;
                    smoothing.share(at, |cell, share, _| {
                        contact_stress[cell] += weight * share * stress;
                    });
                }
            }
        }
        self.velocity = velocity;
    }

    /// Returns the x coordinates of the columns of grid cells and the y coordinates of the rows of cells, at the
    /// centres of the cells, m.
    pub fn centres(&self) -> [Vec<f64>; 2] {
        [0, 1].map(|axis| {
            let of = |number: usize| {
                self.origin[axis]
                    + ((self.first[axis] + number as i64) as f64 + 0.5) * self.cell[axis]
            };
            (0..self.counts[axis]).map(of).collect()
        })
    }
}

/// Returns the lower left and upper right corner of the smallest axis-parallel box around points. Without points, both
/// are at the origin.
pub(crate) fn box_of(places: impl Iterator<Item = DVec2>) -> [DVec2; 2] {
    let wider = |[low, high]: [DVec2; 2], [other, one]: [DVec2; 2]| [low.min(other), high.max(one)];
    places.map(|at| [at, at]).reduce(wider).unwrap_or([DVec2::ZERO; 2])
}

fn axes_over(periodic: Periodic, [low, high]: [DVec2; 2], width: f64) -> [GridAxis; 2] {
    [
        GridAxis::of(periodic.x, [low.x, high.x], width),
        GridAxis::of(periodic.y, [low.y, high.y], width),
    ]
}

/// Returns the tensor product a ⊗ b.
fn outer(a: DVec2, b: DVec2) -> DMat2 {
    DMat2::from_cols(b.x * a, b.y * a)
}

/// Grid cells along one axis.
struct GridAxis {
    wraps: bool,
    origin: f64,
    side: f64,
    first: i64,
    cells: f64,
}

impl GridAxis {
    /// Creates the grid cells along one axis: all cells over which points from `from` to `to` (m) are smeared by
    /// smoothing, or, if the axis is periodic, all cells between its borders.
    fn of(borders: Option<[f64; 2]>, [from, to]: [f64; 2], width: f64) -> Self {
        let side = width / CELLS_IN_WIDTH;
        if let Some([low, high]) = borders {
            let cells = ((high - low) / side).ceil();
            return Self { wraps: true, origin: low, side: (high - low) / cells, first: 0, cells };
        }
        let reach = 2.0 * knots(width);
        let first = ((from - reach) / side).floor();
        let cells = ((to + reach) / side).floor() + 1.0 - first;
        Self { wraps: false, origin: 0.0, side, first: first as i64, cells }
    }

    /// Returns, for each grid cell over which smoothing spreads a point at `place` (m), the cell's index, its weight,
    /// and the number of periods by which the cell is beyond the upper periodic border. The weights add up to 1, unless
    /// a part of the spread point is outside the grid.
    fn shares(&self, place: f64, width: f64) -> impl Iterator<Item = (usize, f64, f64)> + '_ {
        let knots = knots(width);
        let at = move |cell: f64| self.origin + cell * self.side;
        let number = |place: f64| ((place - self.origin) / self.side).floor();
        let (from, to) = (number(place - 2.0 * knots), number(place + 2.0 * knots));
        let mut below = 0.0;
        (from as i64..=to as i64).filter_map(move |cell| {
            let whole = if cell as f64 == to {
                1.0
            } else {
                spline_below((at(cell as f64 + 1.0) - place) / knots)
            };
            let share = whole - std::mem::replace(&mut below, whole);
            if self.wraps {
                let cells = self.cells as i64;
                Some((cell.rem_euclid(cells) as usize, share, cell.div_euclid(cells) as f64))
            } else {
                let number = usize::try_from(cell - self.first).ok();
                let number = number.filter(|&number| (number as f64) < self.cells);
                number.map(|number| (number, share, 0.0))
            }
        })
    }
}

/// Returns the distance between the knots of a cubic B-spline with the standard deviation `width`, in the unit of
/// `width`.
fn knots(width: f64) -> f64 {
    3f64.sqrt() * width
}

/// Returns the integral of the cubic B-spline up to `place`, a distance from its centre in units of the knot distance.
fn spline_below(place: f64) -> f64 {
    let t = place.abs();
    let above_middle = if t < 1.0 {
        t * (2.0 / 3.0 + t * t * (t / 8.0 - 1.0 / 3.0))
    } else {
        0.5 - (2.0 - t.min(2.0)).powi(4) / 24.0
    };
    0.5 + above_middle.copysign(place)
}

struct Smoothing {
    axes: [GridAxis; 2],
    periodic: Periodic,
    width: f64,
}

impl Smoothing {
    /// Calls `to` for each grid cell over which smoothing spreads a point at `place` (m), with the cell's index, its
    /// weight, and the number of periods along y by which this part of the spread point is above the periodic cell of
    /// the scene (negative if it is below).
    fn share(&self, place: DVec2, mut to: impl FnMut(usize, f64, f64)) {
        let [along_x, along_y] = &self.axes;
        let in_row = |above: f64| {
            along_x.shares(place.x - above * self.periodic.shift, self.width).collect::<Vec<_>>()
        };
        let mut row = (0.0, in_row(0.0));
        for (y, of_row, above) in along_y.shares(place.y, self.width) {
            if above != row.0 {
                row = (above, in_row(above));
            }
            for &(x, share, _) in &row.1 {
                to(y * along_x.cells as usize + x, of_row * share, above);
            }
        }
    }
}
