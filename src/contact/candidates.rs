//! The pairs that may touch soon, kept until some grain has moved far enough to change them.
//!
//! A pair is a candidate while its gap is below the skin. No pair outside the list can touch
//! before two grains have together moved by the skin, so the list is built anew only when the
//! largest displacement since the last build passes half of it. Candidates are sorted by (i, other):
//! the order of contacts depends on positions and numbering alone, not on when the list was built.

use glam::DVec2;

use super::{Feature, Grid};
use crate::error::Result;
use crate::world::{Disc, World};

/// How far the candidate search looks, m.
#[derive(Clone, Copy, Debug)]
pub struct Reach {
    /// Pairs with a gap below this are candidates.
    pub skin: f64,
    /// Pairs with a gap below this touch: 0 but for a rounding tolerance.
    pub gap_tolerance: f64,
}

/// A fixed disc this many times larger than the largest grain is tested against every grain, so
/// that it does not widen the cells for all.
const LARGE_FIXED_DISC: f64 = 4.0;

/// Candidate pairs of a world. "Other" bodies are numbered through: grains, then fixed discs, then
/// features of the boundaries.
#[derive(Clone, Debug)]
pub struct Candidates {
    reach: Reach,
    features: Vec<Feature>,
    /// Fixed discs too large for the grid.
    large_fixed_discs: Vec<u32>,
    cell_width: f64,
    grid: Grid,
    /// Centres of grains, then of fixed discs, at the last build.
    centres: Vec<DVec2>,
    /// Grain i's candidates are `others[starts[i] .. starts[i + 1]]`, rising.
    starts: Vec<u32>,
    others: Vec<u32>,
}

impl Candidates {
    /// Prepares the search in a world.
    ///
    /// # Errors
    /// Where a boundary makes no shape.
    pub fn new(world: &World, reach: Reach) -> Result<Self> {
        let mut features = Vec::new();
        for (index, boundary) in world.boundaries.iter().enumerate() {
            Feature::collect(boundary, &format!("boundaries[{index}]"), &mut features)?;
        }
        let largest_grain = world.grains.radii.iter().copied().fold(0.0, f64::max);
        let is_large = |disc: &Disc| disc.radius > LARGE_FIXED_DISC * largest_grain;
        let mut large_fixed_discs = Vec::new();
        let mut largest = largest_grain;
        for (index, disc) in world.fixed_discs.iter().enumerate() {
            if is_large(disc) {
                large_fixed_discs.push(index as u32);
            } else {
                largest = largest.max(disc.radius);
            }
        }
        Ok(Self {
            reach,
            features,
            large_fixed_discs,
            cell_width: 2.0 * largest + reach.skin,
            grid: Grid::default(),
            centres: Vec::new(),
            starts: Vec::new(),
            others: Vec::new(),
        })
    }

    /// The boundaries' features, numbered after grains and fixed discs.
    pub fn features(&self) -> &[Feature] {
        &self.features
    }

    /// The gap below which a pair touches, m.
    pub fn gap_tolerance(&self) -> f64 {
        self.reach.gap_tolerance
    }

    /// Candidates of grain `index`, rising.
    pub fn of(&self, index: usize) -> &[u32] {
        &self.others[self.starts[index] as usize..self.starts[index + 1] as usize]
    }

    /// Number of candidate pairs.
    pub fn len(&self) -> usize {
        self.others.len()
    }

    /// Whether there is no candidate.
    pub fn is_empty(&self) -> bool {
        self.others.is_empty()
    }

    /// Builds the list anew if the grains have moved too far for the present one; tells whether.
    pub fn update<const AXES: usize>(&mut self, world: &World) -> bool {
        let allowed = 0.5 * (self.reach.skin - self.reach.gap_tolerance);
        let positions = &world.grains.positions;
        let still_good = self.starts.len() == positions.len() + 1
            && positions
                .iter()
                .zip(&self.centres)
                .all(|(&now, &then)| distance::<AXES>(now, then) <= allowed);
        if !still_good {
            self.rebuild::<AXES>(world);
        }
        !still_good
    }

    fn rebuild<const AXES: usize>(&mut self, world: &World) {
        let grains = &world.grains;
        let grain_count = grains.len();
        let fixed = &world.fixed_discs;
        let skin = self.reach.skin;
        self.centres.clone_from(&grains.positions);
        self.centres.extend(fixed.iter().map(|disc| disc.position));
        self.grid.rebuild::<AXES>(&self.centres, self.cell_width);
        self.starts.clear();
        self.others.clear();
        self.starts.push(0);
        let others = &mut self.others;
        for (index, (&position, &radius)) in grains.positions.iter().zip(&grains.radii).enumerate()
        {
            let start = others.len();
            let near = |centre: DVec2, other_radius: f64| {
                distance::<AXES>(position, centre) < radius + other_radius + skin
            };
            self.grid.around::<AXES>(position, |other| {
                let at = other as usize;
                if at > index {
                    let other_radius = match at.checked_sub(grain_count) {
                        None => grains.radii[at],
                        Some(at) => fixed[at].radius,
                    };
                    if near(self.centres[at], other_radius) {
                        others.push(other);
                    }
                }
            });
            for &large in &self.large_fixed_discs {
                let disc = fixed[large as usize];
                let other = grain_count as u32 + large;
                // One that shares the grain's cell was found there already.
                if near(disc.position, disc.radius) && !others[start..].contains(&other) {
                    others.push(other);
                }
            }
            let first_feature = (grain_count + fixed.len()) as u32;
            for (feature, shape) in (first_feature..).zip(&self.features) {
                if shape.distance_to_any_point(position) < radius + skin {
                    others.push(feature);
                }
            }
            others[start..].sort_unstable();
            self.starts.push(others.len() as u32);
        }
    }
}

/// Distance between two points: along x alone where the scene has one axis.
#[inline(always)]
fn distance<const AXES: usize>(from: DVec2, to: DVec2) -> f64 {
    if AXES == 1 { (from.x - to.x).abs() } else { from.distance(to) }
}
