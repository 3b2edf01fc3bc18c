//! Finds lost grains: grains that passed through a wall, or left the world.
//!
//! A wall may be thin, so a grain is lost if the path of its centre crosses the wall, wherever the grain is afterwards.
//! The centre of a disc cannot cross a segment or a polygon unless the disc overlaps it by at least its radius.
//! Half-spaces and polygons push grains out again, so a grain inside them counts as lost only if it is deep inside. A
//! path is the straight line from the last examined position to the present position. It is examined when its length
//! has reached a quarter of the grain's radius. A disc that moves around the end of a wall keeps its centre at least
//! one radius away from that end, so a path of a quarter of the radius cannot cut the wall. If walls move, paths are
//! measured relative to the walls and are examined in every step.

use glam::DVec2;
use parry2d_f64::shape::Segment;
use serde::{Deserialize, Serialize};

use crate::contact::Feature;
use crate::world::{Disc, Physics, World};

/// Distance of the world's edges from the smallest rectangle around all grains and fixed bodies at the start, divided
/// by the sum of the longest side of this rectangle and one mean diameter. A grain beyond the edges has left the world.
const ROOM_IN_SIDES: f64 = 3.0;
/// Depth at which a grain counts as lost, in diameters of the grain: the depth of its centre inside a half-space or
/// polygon, or below the lowest body of the initial state. A half-space may push the grain out again, but the grain
/// stays lost, because it was outside the scene.
const LOST_DEPTH: f64 = 1.0;
/// Length of the path of a grain at which the path is examined, in radii of the grain. A longer path around the end of
/// a wall might cut the wall although the grain does not. With a shorter length, slow grains are examined as often as
/// fast grains: in nearly every step. Then every step costs as much as a step of a collapsing pile.
const WAY_IN_RADII: f64 = 0.25;

/// Data to find grains that pass through a wall or leave the world: the path of each grain since its last examination,
/// and the world's edges.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Losses {
    /// Point at which the unexamined part of each grain's path begins, m.
    from: Vec<DVec2>,
    pub lost: Vec<bool>,
    pub count: u32,
    /// Initial heights y_i(0) of the grains, m.
    initial_heights: Vec<f64>,
    world: Edges,
    /// True in a scene with one axis, which has no slump.
    on_line: bool,
    /// True after all grains have been examined once. A grain that is inside a wall in this first examination was
    /// placed there, and has not passed through the wall.
    begun: bool,
    /// Two points of each wall at the last examination, m. They show how the wall has moved since, so that paths can be
    /// measured relative to it. Empty unless the scene has motions or the user drags a wall.
    frames: Vec<[DVec2; 2]>,
}

/// Edges of the world. A grain beyond them has left the world.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Edges {
    /// Two opposite corners of the world, m. `None` if grains may be anywhere: without fixed bodies, with an endless
    /// ground (a half-space), or if boundaries or fixed discs move.
    corners: Option<[DVec2; 2]>,
    /// Unit vector that points down, and the position of the lowest body at the start along this vector, m. `None` in a
    /// world without a bottom, for example if gravity turns.
    bottom: Option<(DVec2, f64)>,
}

/// Result of one examination of all grains: the kinds of loss that have occurred since the previous examination.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct NewLosses {
    /// True if a grain went through a wall.
    pub through_wall: bool,
    /// True if a grain left the world.
    pub left: bool,
    /// Largest speed of a grain that left the world below a fixed disc, in diameters of the grain per second; 0 if no
    /// grain did. In a long time step so fast a grain may pass through the disc. From this speed the alarm derives the
    /// longest time step in which the grain cannot pass through.
    pub diameters_per_second: f64,
    /// True if a grain was placed inside a wall.
    pub placed: bool,
}

impl Losses {
    /// Prepares the search for lost grains at time 0. The boundaries of the world consist of `features`: half-spaces,
    /// segments and polygons.
    pub(super) fn new(world: &World, features: &[Feature], physics: Physics) -> Self {
        let positions = &world.grains.positions;
        Self {
            from: positions.clone(),
            lost: vec![false; positions.len()],
            count: 0,
            initial_heights: positions.iter().map(|position| position.y).collect(),
            world: Edges::of(world, features),
            on_line: physics.axes == 1,
            begun: false,
            frames: match world.motions.is_empty() {
                true => Vec::new(),
                false => features.iter().map(frame).collect(),
            },
        }
    }

    /// Examines the paths of the grains, and returns the kinds of loss (through a wall, out of the world) since the
    /// last examination. `features` are the parts of boundaries at their present positions; `walls_move` is true if
    /// they may have moved.
    pub(super) fn look(
        &mut self,
        world: &World,
        features: &[Feature],
        walls_move: bool,
    ) -> NewLosses {
        let mut new = NewLosses::default();
        if features.is_empty() && self.world.corners.is_none() {
            return new;
        }
        let were_placed = !std::mem::replace(&mut self.begun, true);
        let look_at_all = walls_move || were_placed;
        let are_carried = !self.frames.is_empty();
        for (index, &to) in world.grains.positions.iter().enumerate() {
            let radius = world.grains.radii[index];
            let (way, deep) = (WAY_IN_RADII * radius, -2.0 * LOST_DEPTH * radius);
            let here = self.from[index];
            let from = world.periodic.map_or(here, |periodic| periodic.near(here, to));
            let is_long = from.distance_squared(to) > way * way;
            if !(is_long || look_at_all) || self.lost[index] {
                continue;
            }
            let frames = self.frames.iter().map(Some).chain(std::iter::repeat(None));
            // A path across a periodic border is examined from both sides of the border.
            let seen_from_there = (here != from).then(|| (here, to + (here - from)));
            let ways = move || seen_from_there.into_iter().chain([(from, to)]);
            let fates = features.iter().zip(frames).flat_map(|(feature, before)| {
                ways().map(move |(from, to)| {
                    let from = before.map_or(from, |before| carried(from, *before, frame(feature)));
                    (fate(feature, from, to, deep), from)
                })
            });
            let (fate, carried_from) =
                fates.max_by_key(|(fate, _)| *fate).unwrap_or((Fate::There, from));
            match fate {
                Fate::Inside => self.from[index] = carried_from,
                Fate::There if !self.world.is_outside(to, -deep) => {
                    if is_long || are_carried {
                        self.from[index] = to;
                    }
                }
                _ => {
                    self.lost[index] = true;
                    self.count += 1;
                    let is_in = |feature| self::fate(feature, here, here, deep) == Fate::Lost;
                    match fate {
                        _ if were_placed && features.iter().any(is_in) => new.placed = true,
                        Fate::Lost => new.through_wall = true,
                        Fate::There | Fate::Inside => {
                            new.left = true;
                            if self.world.is_below_a_disc(world, to, radius) {
                                let speed = world.grains.velocities[index].length();
                                let rate = speed / (2.0 * radius);
                                new.diameters_per_second = new.diameters_per_second.max(rate);
                            }
                        }
                    }
                }
            }
        }
        for (before, feature) in self.frames.iter_mut().zip(features) {
            *before = frame(feature);
        }
        new
    }

    /// Returns the slump Δy_G (relative drop of the mean height; Abramian & Staron 2020, eq. 11) of all grains that are
    /// not lost: the initial and the present mean height, from which it is computed, both exclude lost grains. Returns
    /// NaN if all grains are lost, because the mean height of no grains is undefined.
    pub(super) fn slump(&self, world: &World) -> f64 {
        if self.count as usize == self.lost.len() {
            return f64::NAN;
        }
        let there = || (0..self.lost.len()).filter(|&index| !self.lost[index]);
        let initial: f64 = there().map(|index| self.initial_heights[index]).sum();
        let heights: f64 = there().map(|index| world.grains.positions[index].y).sum();
        if self.on_line || initial == 0.0 { 0.0 } else { (initial - heights) / initial }
    }

    /// True if these data fit a world with `grains` grains: each list has one entry per grain, and the number of lost
    /// grains is equal to the count of grains that are marked as lost.
    pub(super) fn is_of(&self, grains: usize) -> bool {
        [self.from.len(), self.lost.len(), self.initial_heights.len()] == [grains; 3]
            && self.lost.iter().filter(|&&lost| lost).count() == self.count as usize
    }

    /// Makes the path of each grain start again at its position in `positions` (m), so that a displacement by the user
    /// does not count as a path.
    pub(super) fn place(&mut self, positions: &[DVec2]) {
        self.from = positions.to_vec();
    }

    pub(super) fn remove(&mut self, grain: usize) {
        self.from.remove(grain);
        self.initial_heights.remove(grain);
        self.count -= u32::from(self.lost.remove(grain));
    }

    pub(super) fn add(&mut self, position: DVec2) {
        self.from.push(position);
        self.initial_heights.push(position.y);
        self.lost.push(false);
    }

    /// Prepares the search for lost grains for walls that move from now on. Records the positions of the walls,
    /// relative to which paths are then measured, and removes the edges of the world, because moving walls may carry
    /// grains anywhere.
    pub(super) fn let_walls_move(&mut self, features: &[Feature]) {
        self.world = Edges::default();
        if self.frames.is_empty() {
            self.frames = features.iter().map(frame).collect();
        }
    }
}

impl Edges {
    fn of(world: &World, features: &[Feature]) -> Self {
        // If walls move, the edges of the world are unknown.
        if world.motions.iter().any(|motion| motion.course.is_some() || motion.drive.is_some()) {
            return Self::default();
        }
        let discs = world.fixed_discs.iter().map(|disc| disc.position);
        let mut fixed: Vec<DVec2> = discs.collect();
        for feature in features {
            match feature {
                // On open ground grains may roll any distance, so there are no edges.
                Feature::HalfSpace { .. } => return Self::default(),
                Feature::Segment { shape, .. } => fixed.extend([shape.a, shape.b]),
                Feature::ConvexPolygon { sides, .. } => {
                    fixed.extend(sides.iter().map(|side| side.a))
                }
            }
        }
        if fixed.is_empty() {
            return Self::default();
        }
        let all = || world.grains.positions.iter().chain(&fixed).copied();
        let min = all().fold(DVec2::INFINITY, DVec2::min);
        let max = all().fold(DVec2::NEG_INFINITY, DVec2::max);
        // In periodic borders grains can reach any place of the cell, so the box includes the whole cell.
        let periodic = world.periodic.unwrap_or_default();
        let [low, high] = periodic.borders_or([min, max]);
        let (min, max) = (min.min(low), max.max(high));
        let side = (max - min).max_element() + world.mean_diameter;
        // A scene has no bottom if gravity turns, or if it acts along an axis with periodic borders.
        let down = world.listed_down().unwrap_or(DVec2::ZERO);
        let down = (down * (1.0 - periodic.axes())).normalize_or_zero();
        let lowest = all().map(|place| place.dot(down)).fold(f64::NEG_INFINITY, f64::max);
        Self {
            corners: Some([min - ROOM_IN_SIDES * side, max + ROOM_IN_SIDES * side]),
            bottom: (down != DVec2::ZERO).then_some((down, lowest)),
        }
    }

    /// True if the point `place` (m) is outside the world's corners, or more than `depth` (m) below the world's bottom.
    fn is_outside(&self, place: DVec2, depth: f64) -> bool {
        let Self { corners, bottom } = self;
        corners.is_some_and(|[min, max]| !(place.cmpge(min).all() && place.cmple(max).all()))
            || bottom.is_some_and(|(down, lowest)| place.dot(down) > lowest + depth)
    }

    /// True if a grain of this radius (m) with its centre at `place` (m) is straight below a fixed disc.
    fn is_below_a_disc(&self, world: &World, place: DVec2, radius: f64) -> bool {
        self.bottom.is_some_and(|(down, _)| {
            let is_above = |disc: &Disc| {
                let apart = place - disc.position;
                apart.dot(down) > 0.0 && apart.perp_dot(down).abs() < disc.radius + radius
            };
            world.fixed_discs.iter().any(is_above)
        })
    }
}

/// Result of comparing a grain's path with a wall, in increasing order of severity.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Fate {
    There,
    /// The centre has entered a solid polygon. A later examination, after the centre has left the polygon, shows if the
    /// grain passed through.
    Inside,
    Lost,
}

/// Returns two points that move with a wall, m. For a half-space both are the same point, because only the present
/// depth of a grain inside it is examined, not the path.
fn frame(feature: &Feature) -> [DVec2; 2] {
    match feature {
        Feature::HalfSpace { point, .. } => [*point; 2],
        Feature::Segment { shape, .. } => [shape.a, shape.b],
        Feature::ConvexPolygon { sides, .. } => [sides[0].a, sides[0].b],
    }
}

/// Returns the present position, m, of a point that is fixed to a moving wall and that was at `place` (m) before the
/// motion. `before` and `now` are two points of the wall before and after the motion, m. The path of a grain relative
/// to the wall begins at the returned position.
fn carried(place: DVec2, before: [DVec2; 2], now: [DVec2; 2]) -> DVec2 {
    let [then, along_now] = [before, now].map(|[from, to]| to - from);
    if before == now || then == DVec2::ZERO {
        return place;
    }
    let offset = place - before[0];
    let local = DVec2::new(then.dot(offset), then.perp_dot(offset)) / then.length_squared();
    now[0] + local.x * along_now + local.y * along_now.perp()
}

/// Compares the path of a grain's centre with one wall. Returns [`Fate::Lost`] if the grain is lost, [`Fate::Inside`]
/// if its centre has entered a polygon, and otherwise [`Fate::There`]. The path is the straight line from `from`, a
/// point outside all polygons, to `to` (m). `deep` is the negative of the depth inside a half-space or polygon at which
/// a grain is lost, m.
fn fate(feature: &Feature, from: DVec2, to: DVec2, deep: f64) -> Fate {
    let if_lost = |lost: bool| if lost { Fate::Lost } else { Fate::There };
    match feature {
        Feature::HalfSpace { .. } => if_lost(feature.distance_to_any_point(to) < deep),
        Feature::Segment { shape, .. } => if_lost(crosses(from, to, shape)),
        Feature::ConvexPolygon { sides, .. } => {
            let depth = |place: DVec2| {
                let above = |side: &Segment| (place - side.a).dot(outward(side));
                sides.iter().map(above).fold(f64::NEG_INFINITY, f64::max)
            };
            match (depth(from), depth(to)) {
                (_, now) if now < deep => Fate::Lost,
                (before, now) if before > 0.0 && now <= 0.0 => Fate::Inside,
                (before, now) => if_lost(before > 0.0 && now > 0.0 && cuts(from, to, sides)),
            }
        }
    }
}

/// Returns the unit normal that points to the right of a segment, seen along the segment. For a side of an
/// anticlockwise polygon this normal points outward.
fn outward(side: &Segment) -> DVec2 {
    -(side.b - side.a).perp().normalize_or_zero()
}

/// True if the straight path from `from` to `to` (m) crosses a segment. An end of a segment that is exactly on the path
/// counts as left of the path. So a path through the point that two consecutive segments share crosses one of them, and
/// cannot pass between them.
fn crosses(from: DVec2, to: DVec2, wall: &Segment) -> bool {
    let is_left = |a: DVec2, b: DVec2, place: DVec2| (b - a).perp_dot(place - a) >= 0.0;
    // Quick test of bounding boxes first, because most walls are far from most paths.
    let (low, high) = (from.min(to), from.max(to));
    wall.a.min(wall.b).cmple(high).all()
        && wall.a.max(wall.b).cmpge(low).all()
        && is_left(wall.a, wall.b, from) != is_left(wall.a, wall.b, to)
        && is_left(from, to, wall.a) != is_left(from, to, wall.b)
}

/// True if the straight path from `from` to `to` (m), two points outside a convex polygon, passes through the polygon.
fn cuts(from: DVec2, to: DVec2, sides: &[Segment]) -> bool {
    let (mut enters, mut leaves) = (0f64, 1f64);
    for side in sides {
        let normal = outward(side);
        let (start, end) = ((from - side.a).dot(normal), (to - side.a).dot(normal));
        match (start > 0.0, end > 0.0) {
            (true, true) => return false,
            (true, false) => enters = enters.max(start / (start - end)),
            (false, true) => leaves = leaves.min(start / (start - end)),
            (false, false) => {}
        }
    }
    enters < leaves
}
