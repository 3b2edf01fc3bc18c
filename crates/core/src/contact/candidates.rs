//! The candidates: pairs of bodies that may touch soon. The list is kept until a grain has moved so far that another
//! pair could touch.
//!
//! Each body has a search margin, its *skin* (m). A pair of bodies is a candidate if the gap is below the sum of the
//! two skins. No pair outside the list can touch before one of its bodies has moved by its own skin, so the list is
//! rebuilt only then. A skin is a fraction of the mean diameter, but not larger than the diameter of the disc. For a
//! fast body it is larger: twice the expected displacement in the next step. So each disc has few candidates among
//! discs of its size and larger discs, and the list grows in proportion to the number of discs, whatever their sizes
//! are. Candidates are sorted by the number of the grain, and then by the number of the other body. So the order of
//! contacts depends only on positions and numbering and not on the time at which the list was built.

use glam::DVec2;
use serde::{Deserialize, Serialize};

use super::broad_phase::BroadPhase;
use super::features::Feature;
use super::images;
use super::numbering::{Numbering, Other};
use super::seam_search;
use crate::error::{Error, Result};
use crate::world::{Carry, World};

/// Lengths that decide which pairs of bodies are candidates (pairs that may touch soon) and which pairs touch, m.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Reach {
    /// Search distance, m: pairs of bodies with a smaller gap are candidates, because they may touch soon. Each of the
    /// two bodies contributes half of this distance, but a disc contributes at most its diameter. So a pair with a
    /// small disc is a candidate only up to a smaller gap.
    pub skin: f64,
    /// Largest gap of a touching pair, m. It is 0 or a small tolerance for rounding.
    pub gap_tolerance: f64,
}

/// The candidate pairs of a world: pairs of bodies that may touch soon.
///
/// A saved file contains the pairs, and the positions, search margins and displacements that determine when the list
/// is next rebuilt. All other fields are recomputed from the world.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Candidates {
    reach: Reach,
    #[serde(skip)]
    features: Vec<Feature>,
    /// The index of the boundary to which each feature (half-space, segment or polygon) belongs.
    #[serde(skip)]
    boundary_of: Vec<usize>,
    /// Upper bound, m, for the distance by which the surface of any feature (half-space, segment or polygon) has moved,
    /// near any grain, since the list of candidate pairs (pairs that may touch soon) was last built.
    way_of_features: f64,
    /// Upper bound, m, for the distance by which any fixed disc with a prescribed or force-driven motion has moved
    /// since the list of candidate pairs (pairs that may touch soon) was last built.
    way_of_discs: f64,
    /// Distance along x, m, by which the copies of the discs above and below the periodic cell have moved relative to
    /// the discs themselves since the list of candidate pairs (pairs that may touch soon) was last built. It is 0
    /// unless the periodic borders are sheared, so that these copies slide along x.
    way_of_images: f64,
    #[serde(skip)]
    broad_phase: BroadPhase,
    /// Radii of the grains, then of the fixed discs, m.
    #[serde(skip)]
    radii: Vec<f64>,
    /// Skin (search margin) of each grain and fixed disc when the list of candidate pairs (pairs that may touch soon)
    /// was last built, m. The list is rebuilt when a disc has moved farther than its skin.
    skins: Vec<f64>,
    skin_of_features: f64,
    /// Centres of the grains and fixed discs when the list of candidate pairs (pairs that may touch soon) was last
    /// built, m.
    centres: Vec<DVec2>,
    /// Candidate pairs (pairs that may touch soon) of two discs, in the order in which the search found them.
    #[serde(skip)]
    pairs: Vec<(u32, u32)>,
    /// Start indices in `others`: grain i has the candidates (bodies that it may touch soon) `others[starts[i] ..
    /// starts[i + 1]]`, in increasing order.
    starts: Vec<u32>,
    others: Vec<u32>,
}

impl Candidates {
    /// Prepares the search for candidate pairs (bodies that may touch soon) in a world. The list of pairs is still
    /// empty.
    ///
    /// # Errors
    /// If a boundary does not have a valid shape.
    pub fn new(world: &World, reach: Reach) -> Result<Self> {
        let (mut features, mut boundary_of) = (Vec::new(), Vec::new());
        for (index, boundary) in world.boundaries.iter().enumerate() {
            Feature::collect(boundary, &format!("boundaries[{index}]"), &mut features)?;
            boundary_of.resize(features.len(), index);
        }
        seam_search::find(&mut features, &boundary_of, world);
        let fixed = world.fixed_discs.iter().map(|disc| disc.radius);
        let radii: Vec<f64> = world.grains.radii.iter().copied().chain(fixed).collect();
        Ok(Self {
            reach,
            features,
            boundary_of,
            way_of_features: 0.0,
            way_of_discs: 0.0,
            way_of_images: 0.0,
            broad_phase: BroadPhase::of(&radii),
            radii,
            skins: Vec::new(),
            skin_of_features: 0.0,
            centres: Vec::new(),
            pairs: Vec::new(),
            starts: Vec::new(),
            others: Vec::new(),
        })
    }

    /// Returns an object for the search of candidate pairs (bodies that may touch soon) in `world`, with the search
    /// distances of `self` and an empty list of pairs.
    ///
    /// # Errors
    /// The errors of [`Self::new`].
    pub(crate) fn unbuilt(&self, world: &World) -> Result<Self> {
        Self::new(world, self.reach)
    }

    /// Returns the candidates (pairs of bodies that may touch soon) in `self`, which were read from a file, with all
    /// fields set. The fields that the file does not contain are recomputed from `world`, the world to which the
    /// candidates belong.
    ///
    /// # Errors
    ///
    /// If the candidates refer to bodies that do not exist.
    pub(crate) fn complete(self, world: &World) -> Result<Self> {
        let Self { reach, way_of_features, way_of_discs, way_of_images, .. } = self;
        let Self { skins, skin_of_features, centres, starts, others, .. } = self;
        let whole = Self {
            way_of_features,
            way_of_discs,
            way_of_images,
            skin_of_features,
            ..Self::new(world, reach)?
        };
        let count = world.grains.len();
        let bodies = whole.radii.len() + whole.features.len();
        let is_list = starts.len() == count + 1
            && starts[0] == 0
            && starts.is_sorted()
            && starts[count] as usize == others.len()
            && centres.len() == whole.radii.len()
            && skins.len() == centres.len();
        if !(is_list || starts.is_empty()) || others.iter().any(|&other| other as usize >= bodies) {
            return Err(Error::value("candidates", "no list", "pairs of bodies of the state"));
        }
        Ok(Self { skins, centres, starts, others, ..whole })
    }

    /// Returns the unit normal of a feature (half-space, segment or polygon) towards `centre`, and the distance of
    /// `centre` from the feature (m), as in [`Feature::distance`]. With periodic borders, the nearest periodic image
    /// of the feature counts.
    #[inline]
    pub(crate) fn distance(
        &self,
        world: &World,
        feature: usize,
        centre: DVec2,
    ) -> Option<(DVec2, f64)> {
        match world.periodic {
            None => self.features[feature].distance(centre),
            Some(periodic) => images::distance(&self.features[feature], periodic, centre),
        }
    }

    /// The features (half-spaces, segments and polygons) of all boundaries.
    pub(crate) fn features(&self) -> &[Feature] {
        &self.features
    }

    /// Searches again for the corners that boundaries share. This is necessary after the motion of a boundary has
    /// changed, because boundaries that move differently do not share corners.
    pub(crate) fn find_seams(&mut self, world: &World) {
        seam_search::find(&mut self.features, &self.boundary_of, world);
    }

    /// Returns the index of the boundary to which a feature (half-space, segment or polygon) belongs.
    pub(crate) fn boundary_of(&self, feature: usize) -> usize {
        self.boundary_of[feature]
    }

    /// Moves the features (half-spaces, segments, polygons) after their boundaries have moved. `carry_of` returns the
    /// displacement of the boundary with a given index, or `None` for a boundary at rest. `way_of_discs` is the
    /// largest displacement of a fixed disc in the same time, m.
    pub(crate) fn follow<'a>(
        &mut self,
        world: &World,
        carry_of: impl Fn(usize) -> Option<&'a Carry>,
        way_of_discs: f64,
    ) {
        let mut longest = 0f64;
        for (feature, &boundary) in self.features.iter_mut().zip(&self.boundary_of) {
            let Some(carry) = carry_of(boundary) else { continue };
            // A half-space that rotates changes its distance from a grain in proportion to the distance of the grain
            // from the pivot.
            let far = |from: f64, place: DVec2| from.max(place.distance(carry.pivot));
            let reach = match (carry.angle == 0.0, feature.is_half_space()) {
                (true, _) => 0.0,
                (false, true) => self.centres.iter().copied().fold(0.0, far),
                (false, false) => feature.corners().fold(0.0, far),
            };
            longest = longest.max(carry.longest_way(reach));
            feature.carry(carry, &world.boundaries[boundary]);
        }
        self.way_of_features += longest;
        self.way_of_discs += way_of_discs;
    }

    /// Adds the length of `way` (m) to the distance by which the copies of the discs above and below the periodic cell
    /// have moved along x, relative to the discs themselves. Such copies slide only if the periodic borders are
    /// sheared.
    pub(crate) fn slide(&mut self, way: f64) {
        self.way_of_images += way.abs();
    }

    /// Gap below which a pair of bodies touches, m.
    pub(crate) fn gap_tolerance(&self) -> f64 {
        self.reach.gap_tolerance
    }

    /// Returns the numbers of the bodies with which the grain `index` forms candidate pairs (pairs that may touch
    /// soon), in increasing order.
    pub fn of(&self, index: usize) -> &[u32] {
        &self.others[self.starts[index] as usize..self.starts[index + 1] as usize]
    }

    /// Rebuilds the list of candidates (pairs of bodies that may touch soon) if the grains have moved so far that the
    /// present list may be incomplete. Returns true if the list was rebuilt.
    pub fn update<const AXES: usize>(&mut self, world: &World) -> bool {
        self.update_ahead::<AXES>(world, |_| 0.0, 0.0)
    }

    /// Rebuilds the list of candidates (pairs of bodies that may touch soon) if it may be incomplete at the end of the
    /// next step. Returns true if the list was rebuilt. Unlike the list of [`update`](Self::update), this list also
    /// contains pairs whose gap can be closed by the displacements of their bodies in the next step. `way_of_grain`
    /// returns the displacement of a grain (m), and `way_of_others` is the displacement of walls and fixed discs (m).
    pub(crate) fn update_ahead<const AXES: usize>(
        &mut self,
        world: &World,
        way_of_grain: impl Fn(usize) -> f64,
        way_of_others: f64,
    ) -> bool {
        let touch = 0.5 * self.reach.gap_tolerance;
        let way_of_grain = |grain: usize| way_of_grain(grain) + touch;
        let way_of_images = 0.5 * self.way_of_images;
        let way_of_others = way_of_others + touch;
        let positions = &world.grains.positions;
        let grains = positions.iter().zip(&self.centres).zip(&self.skins).enumerate();
        let still_good = self.starts.len() == positions.len() + 1
            && self.way_of_features + way_of_others <= self.skin_of_features
            && self.skins[positions.len()..]
                .iter()
                .all(|&skin| self.way_of_discs + way_of_others <= skin)
            && grains.take(positions.len()).all(|(at, ((&now, &then), &skin))| {
                let way = length::<AXES>(world.shortest(now - then)) + way_of_images;
                way + way_of_grain(at) <= skin
            });
        if !still_good {
            self.set_skins(positions.len(), way_of_grain, way_of_others);
            self.rebuild::<AXES>(world);
        }
        !still_good
    }

    /// Sets the skin (search margin, m) of each body to at least twice its expected displacement in the next step, so
    /// that the list of candidates (pairs of bodies that may touch soon) can be used for more than one step. `of_grain`
    /// returns the displacement of a grain, and `of_others` is the displacement of fixed discs and features
    /// (half-spaces, segments, polygons), m.
    fn set_skins(&mut self, grains: usize, of_grain: impl Fn(usize) -> f64, of_others: f64) {
        let usual = 0.5 * self.reach.skin;
        self.skin_of_features = usual.max(2.0 * of_others);
        self.skins.clear();
        self.skins.extend(self.radii.iter().enumerate().map(|(at, radius)| {
            let way = if at < grains { of_grain(at) } else { of_others };
            usual.min(2.0 * radius).max(2.0 * way)
        }));
    }

    fn rebuild<const AXES: usize>(&mut self, world: &World) {
        let grain_count = world.grains.len();
        (self.way_of_features, self.way_of_discs, self.way_of_images) = (0.0, 0.0, 0.0);
        self.centres.clone_from(&world.grains.positions);
        self.centres.extend(world.fixed_discs.iter().map(|disc| disc.position));
        self.pairs.clear();
        let (centres, pairs) = (&self.centres, &mut self.pairs);
        let extent = |at: usize| self.radii[at] + self.skins[at];
        let keep = |i: u32, j: u32| {
            let (first, second) = (i.min(j) as usize, i.max(j) as usize);
            // Fixed discs have the largest indices. If the first disc of a pair is fixed, so is the second, and the
            // pair is omitted.
            if first < grain_count
                && length::<AXES>(world.shortest(centres[first] - centres[second]))
                    < extent(first) + extent(second)
            {
                pairs.push((first as u32, second as u32));
            }
        };
        let extents = (0..self.radii.len()).map(extent);
        match world.periodic {
            None => self.broad_phase.pairs::<AXES>(centres, extents, keep),
            Some(periodic) => {
                images::pairs::<AXES>(&mut self.broad_phase, periodic, centres, extents, keep);
            }
        }
        self.sort_pairs(grain_count);
        self.add_features(world);
    }

    /// Sorts the candidate pairs (pairs of bodies that may touch soon) by the index of their first grain, with a
    /// counting sort, and writes the second bodies of the sorted pairs to the list `others`. `starts` receives the
    /// index at which each grain's part of this list begins.
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
        // Fill each range from its start. While a range is filled, its stored start moves to its end.
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

    /// Adds to the candidates of each grain (bodies that it may touch soon) the features (half-spaces, segments,
    /// polygons) whose gap to the grain is below the sum of two search margins, m: the margin of the grain and the
    /// margin of all features.
    fn add_features(&mut self, world: &World) {
        if self.features.is_empty() {
            return;
        }
        let grains = &world.grains;
        let numbering = Numbering::of(world);
        let within_reach = |index: usize, feature: &Feature| {
            let reach = grains.radii[index] + self.skins[index] + self.skin_of_features;
            images::distance_to_any_point(feature, world, grains.positions[index]) < reach
        };
        // The list of pairs is no longer needed, so its memory is used for the longer list.
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

/// Returns the length of a vector, m. In scenes on a line only the x component counts.
#[inline(always)]
fn length<const AXES: usize>(way: DVec2) -> f64 {
    if AXES == 1 { way.x.abs() } else { way.length() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::world::{Grain, Grains, Gravity};

    /// Returns a world with `count` discs on a square lattice. Neighbouring centres are three times the largest radius
    /// apart. The radii of the discs are the values of `radii`, in turn.
    fn rows(count: usize, radii: &[f64], mean_diameter: f64) -> World {
        let largest = radii.iter().copied().fold(0.0, f64::max);
        let columns = (count as f64).sqrt() as usize;
        let grain = |k: usize| {
            let place = DVec2::new((k % columns) as f64, (k / columns) as f64);
            Grain::at_rest(3.0 * largest * place, radii[k % radii.len()])
        };
        let grains = Grains::new(&(0..count).map(grain).collect::<Vec<_>>(), 1.0);
        World::of(grains, Gravity::Uniform { acceleration: DVec2::ZERO }, mean_diameter)
    }

    fn of(world: &World) -> Candidates {
        let reach = Reach { skin: 0.2 * world.mean_diameter, gap_tolerance: 0.0 };
        Candidates::new(world, reach).expect("no boundaries")
    }

    #[test]
    fn one_grain_that_looks_far_ahead_makes_candidates_of_its_own_pairs_alone() {
        let count = 4_000;
        let world = rows(count, &[1.0], 2.0);
        let mut candidates = of(&world);
        assert!(candidates.update::<2>(&world));
        let at_rest = candidates.others.len();
        let fast = 777;
        // The fast grain forms a candidate pair with every other grain. No other new pair becomes a candidate.
        let way = |grain: usize| if grain == fast { 1e3 } else { 0.0 };
        assert!(candidates.update_ahead::<2>(&world, way, 0.0));
        assert_eq!(candidates.others.len(), at_rest + count - 1);
        assert!(!candidates.update_ahead::<2>(&world, way, 0.0), "good for another step");
        let farther = |grain: usize| if grain == fast { 3e3 } else { 0.0 };
        assert!(candidates.update_ahead::<2>(&world, farther, 0.0));
        assert!(!candidates.update::<2>(&world), "what looks ahead sees what touches");
    }

    #[test]
    fn small_discs_have_few_candidates_whatever_lengths_are_measured_in() {
        for mean_diameter in [1.0, 100.0, 1e6] {
            let count = 4_000;
            let world = rows(count, &[0.5, 0.45, 0.4], mean_diameter);
            let mut candidates = of(&world);
            candidates.update::<2>(&world);
            assert!(candidates.others.len() < 24 * count, "{}", candidates.others.len());
        }
        // The limit on the number of candidates is also valid next to one disc that is as large as all the other
        // discs together.
        let count = 4_000;
        let mut world = rows(count, &[1e-3], 1.0);
        let large = Grain::at_rest(DVec2::new(-2.0, 0.0), 2.0);
        let mut grains: Vec<Grain> =
            world.grains.positions.iter().map(|&place| Grain::at_rest(place, 1e-3)).collect();
        grains.push(large);
        world.grains = Grains::new(&grains, 1.0);
        let mut candidates = of(&world);
        candidates.update::<2>(&world);
        assert!(candidates.others.len() < 24 * count, "{}", candidates.others.len());
    }
}
