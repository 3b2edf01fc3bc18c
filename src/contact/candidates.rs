//! The pairs that may touch soon, kept until some grain has moved far enough to change them.
//!
//! A pair is a candidate while its gap is below the skin. No pair outside the list can touch
//! before two grains have together moved by the skin, so the list is built anew only when the
//! largest displacement since the last build passes half of it. Candidates are sorted by (i, other):
//! the order of contacts depends on positions and numbering alone, not on when the list was built.

use glam::DVec2;

use super::features::Feature;
use super::grid::Grid;
use super::numbering::{Numbering, Other};
use super::tree::Tree;
use crate::error::Result;
use crate::world::World;

/// How far the candidate search looks, m.
#[derive(Clone, Copy, Debug)]
pub struct Reach {
    /// Pairs with a gap below this are candidates.
    pub skin: f64,
    /// Pairs with a gap below this touch: 0 but for a rounding tolerance.
    pub gap_tolerance: f64,
}

/// Where the largest disc is more than this many times as large as the smallest, the tree finds the
/// pairs, else the grid. At 1:1.5 the two take about the same time, at 1:20 the grid takes 1.2 to 18
/// times as long (`cargo bench --bench broad_phase`).
const SIZE_RATIO_OF_TREE: f64 = 4.0;

/// What finds the pairs.
#[derive(Clone, Debug)]
enum BroadPhase {
    Grid(Grid),
    Tree(Box<Tree>),
}

/// Candidate pairs of a world.
#[derive(Clone, Debug)]
pub struct Candidates {
    reach: Reach,
    features: Vec<Feature>,
    /// Boundaries that can move, each with the number of its feature.
    pistons: Vec<(usize, usize)>,
    /// Longest way that a feature can have gone since the last build, m.
    way_of_features: f64,
    cell_width: f64,
    broad_phase: BroadPhase,
    /// Radii of grains, then of fixed discs.
    radii: Vec<f64>,
    /// Their centres at the last build.
    centres: Vec<DVec2>,
    /// Pairs of discs in the order that they are found in.
    pairs: Vec<(u32, u32)>,
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
        let (mut features, mut pistons) = (Vec::new(), Vec::new());
        for (index, boundary) in world.boundaries.iter().enumerate() {
            if boundary.can_move() {
                pistons.push((index, features.len()));
            }
            Feature::collect(boundary, &format!("boundaries[{index}]"), &mut features)?;
        }
        let fixed = world.fixed_discs.iter().map(|disc| disc.radius);
        let radii: Vec<f64> = world.grains.radii.iter().copied().chain(fixed).collect();
        let largest = radii.iter().copied().fold(0.0, f64::max);
        let smallest = radii.iter().copied().fold(f64::INFINITY, f64::min);
        Ok(Self {
            reach,
            features,
            pistons,
            way_of_features: 0.0,
            cell_width: 2.0 * largest + reach.skin,
            broad_phase: if largest > SIZE_RATIO_OF_TREE * smallest {
                BroadPhase::Tree(Box::default())
            } else {
                BroadPhase::Grid(Grid::default())
            },
            radii,
            centres: Vec::new(),
            pairs: Vec::new(),
            starts: Vec::new(),
            others: Vec::new(),
        })
    }

    /// The boundaries' features.
    pub(crate) fn features(&self) -> &[Feature] {
        &self.features
    }

    /// The boundaries that can move, by their number, each with the number of its feature.
    pub(crate) fn pistons(&self) -> &[(usize, usize)] {
        &self.pistons
    }

    /// Moves features, given by their numbers, each by its way, m.
    pub(crate) fn shift_features(&mut self, ways: impl Iterator<Item = (usize, DVec2)>) {
        let mut longest = 0f64;
        for (feature, way) in ways {
            self.features[feature].shift(way);
            longest = longest.max(way.length());
        }
        self.way_of_features += longest;
    }

    /// The gap below which a pair touches, m.
    pub(crate) fn gap_tolerance(&self) -> f64 {
        self.reach.gap_tolerance
    }

    /// Candidates of grain `index`, rising.
    pub fn of(&self, index: usize) -> &[u32] {
        &self.others[self.starts[index] as usize..self.starts[index + 1] as usize]
    }

    /// Builds the list anew if the grains have moved too far for the present one; tells whether.
    pub fn update<const AXES: usize>(&mut self, world: &World) -> bool {
        self.update_ahead::<AXES>(world, self.reach.gap_tolerance)
    }

    /// The same where all pairs with a gap below `look_ahead` (m) are asked for. The skin grows where
    /// it is too thin for that.
    pub(crate) fn update_ahead<const AXES: usize>(
        &mut self,
        world: &World,
        look_ahead: f64,
    ) -> bool {
        if self.reach.skin < 1.25 * look_ahead {
            self.reach.skin = 2.0 * look_ahead;
            let largest = self.radii.iter().copied().fold(0.0, f64::max);
            self.cell_width = 2.0 * largest + self.reach.skin;
            self.starts.clear();
        }
        let allowed = 0.5 * (self.reach.skin - look_ahead);
        let positions = &world.grains.positions;
        let still_good = self.starts.len() == positions.len() + 1
            && self.way_of_features <= allowed
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
        let grain_count = world.grains.len();
        self.way_of_features = 0.0;
        let skin = self.reach.skin;
        self.centres.clone_from(&world.grains.positions);
        self.centres.extend(world.fixed_discs.iter().map(|disc| disc.position));
        self.pairs.clear();
        let (centres, radii, pairs) = (&self.centres, &self.radii, &mut self.pairs);
        let keep = |i: u32, j: u32| {
            let (first, second) = (i.min(j) as usize, i.max(j) as usize);
            // Fixed discs come last: a pair whose first is one moves nothing.
            if first < grain_count
                && distance::<AXES>(centres[first], centres[second])
                    < radii[first] + radii[second] + skin
            {
                pairs.push((first as u32, second as u32));
            }
        };
        match &mut self.broad_phase {
            BroadPhase::Grid(grid) => {
                grid.rebuild::<AXES>(centres, self.cell_width);
                grid.pairs::<AXES>(keep);
            }
            BroadPhase::Tree(tree) => {
                let reach = radii.iter().map(|radius| radius + 0.5 * skin);
                let on_axes = |&centre: &DVec2| match AXES {
                    1 => DVec2::new(centre.x, 0.0),
                    _ => centre,
                };
                tree.update(centres.iter().map(on_axes).zip(reach));
                tree.pairs(keep);
            }
        }
        self.sort_pairs(grain_count);
        self.add_features(world);
    }

    /// Sorts the pairs by counting: into `others`, by their first grain.
    fn sort_pairs(&mut self, grain_count: usize) {
        self.starts.clear();
        self.starts.resize(grain_count + 1, 0);
        for &(first, _) in &self.pairs {
            self.starts[first as usize + 1] += 1;
        }
        for index in 0..grain_count {
            self.starts[index + 1] += self.starts[index];
        }
        self.others.clear();
        self.others.resize(self.pairs.len(), 0);
        // Each stretch is filled from its start, which moves to its end meanwhile.
        for &(first, second) in &self.pairs {
            let place = &mut self.starts[first as usize];
            self.others[*place as usize] = second;
            *place += 1;
        }
        self.starts.copy_within(..grain_count, 1);
        self.starts[0] = 0;
        for index in 0..grain_count {
            let stretch = self.starts[index] as usize..self.starts[index + 1] as usize;
            self.others[stretch].sort_unstable();
        }
    }

    /// Adds the features within reach behind each grain's discs.
    fn add_features(&mut self, world: &World) {
        if self.features.is_empty() {
            return;
        }
        let grains = &world.grains;
        let numbering = Numbering::of(world);
        let within_reach = |index: usize, feature: &Feature| {
            let reach = grains.radii[index] + self.reach.skin;
            feature.distance_to_any_point(grains.positions[index]) < reach
        };
        // The pairs are no longer needed: their memory takes the longer list.
        self.pairs.clear();
        for index in 0..grains.len() {
            let grain = index as u32;
            let discs = self.starts[index] as usize..self.starts[index + 1] as usize;
            self.pairs.extend(self.others[discs].iter().map(|&other| (grain, other)));
            for (number, feature) in self.features.iter().enumerate() {
                if within_reach(index, feature) {
                    self.pairs.push((grain, numbering.number(Other::Feature(number))));
                }
            }
        }
        self.sort_pairs(grains.len());
    }
}

/// Distance between two points: along x alone where the scene has one axis.
#[inline(always)]
fn distance<const AXES: usize>(from: DVec2, to: DVec2) -> f64 {
    if AXES == 1 { (from.x - to.x).abs() } else { from.distance(to) }
}
