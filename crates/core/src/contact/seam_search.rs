//! Search for corners that two separate boundaries share. The rule for contacts at such corners is in
//! `contact::seams`.

use glam::DVec2;
use parry2d_f64::query::PointQuery;

use super::features::Feature;
use super::seams::{Piece, Seam};
use crate::world::World;

/// Largest distance of a corner from another boundary, in mean diameters, at which the two share the corner. If the
/// value is smaller, corners that are equal except for rounding slow down discs that slide over them. If it is larger,
/// small steps that a floor is meant to have are ignored, and discs slide over them.
const APART_IN_DIAMETERS: f64 = 1e-9;

/// Finds the corners that features (segments, polygons) of different boundaries share and stores them in the
/// features. Feature `k` is a part of boundary `boundary_of[k]`.
pub(super) fn find(features: &mut [Feature], boundary_of: &[usize], world: &World) {
    let tolerance = APART_IN_DIAMETERS * world.mean_diameter;
    // Boundaries that move differently do not share corners.
    let mut carried_by = vec![None; world.boundaries.len()];
    for (number, motion) in world.motions.iter().enumerate() {
        if motion.course.is_some() || motion.drive.is_some() {
            motion.boundaries.iter().for_each(|&boundary| carried_by[boundary] = Some(number));
        }
    }
    let mut corners: Vec<(DVec2, usize, usize)> = Vec::new();
    for (number, feature) in features.iter_mut().enumerate() {
        corners.extend(feature.corners().enumerate().map(|(corner, at)| (at, number, corner)));
        if let Some(seams) = feature.seams_mut() {
            seams.0.clear();
        }
    }
    corners.sort_by(|one, other| one.0.x.total_cmp(&other.0.x));
    let mut found = Vec::new();
    for (other, feature) in features.iter().enumerate() {
        let boundary = boundary_of[other];
        if world.boundaries[boundary].moves_by_itself() {
            continue;
        }
        let mut range = [f64::INFINITY, f64::NEG_INFINITY];
        if feature.is_half_space() {
            range.swap(0, 1);
        }
        for corner in feature.corners() {
            range = [range[0].min(corner.x - tolerance), range[1].max(corner.x + tolerance)];
        }
        let first = corners.partition_point(|corner| corner.0.x < range[0]);
        let near = corners[first..].iter().take_while(|corner| corner.0.x <= range[1]);
        for &(at, number, corner) in near {
            let is_apart = boundary_of[number] == boundary
                || carried_by[boundary_of[number]] != carried_by[boundary];
            if is_apart || distance_from_surface(feature, at) > tolerance {
                continue;
            }
            let other_corner = feature.corners().position(|place| place.distance(at) <= tolerance);
            let is_earlier = number < other;
            found.push((number, Seam { corner, other: piece(feature), other_corner, is_earlier }));
        }
    }
    for (number, seam) in found {
        if let Some(seams) = features[number].seams_mut() {
            seams.0.push(seam);
        }
    }
}

fn piece(feature: &Feature) -> Piece {
    match feature {
        Feature::HalfSpace { .. } => Piece::HalfSpace,
        Feature::Segment { shape, .. } => Piece::Segment(*shape),
        Feature::ConvexPolygon { sides, .. } => Piece::ConvexPolygon(sides.clone()),
    }
}

/// Returns the distance of a point from the surface of a feature (half-space, segment or polygon), m. It is positive
/// outside and inside.
fn distance_from_surface(feature: &Feature, place: DVec2) -> f64 {
    match feature {
        Feature::ConvexPolygon { sides, .. } => {
            let distances = sides.iter().map(|side| side.distance_to_local_point(place, false));
            distances.fold(f64::INFINITY, f64::min)
        }
        Feature::HalfSpace { .. } | Feature::Segment { .. } => {
            feature.distance_to_any_point(place).abs()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::world::Boundary;

    /// Returns the features (half-spaces, segments, polygons) of these boundaries with their shared corners, in a
    /// world without motions.
    fn features(boundaries: Vec<Boundary>) -> Vec<Feature> {
        use crate::contact::{Candidates, Reach};
        use crate::world::{Grain, Grains, Gravity};
        let grains = Grains::new(&[Grain::at_rest(DVec2::new(0.0, 9.0), 0.5)], 1.0);
        let gravity = Gravity::Uniform { acceleration: DVec2::ZERO };
        let world = World { boundaries, ..World::of(grains, gravity, 1.0) };
        let reach = Reach { skin: 0.2, gap_tolerance: 0.0 };
        Candidates::new(&world, reach).expect("proper boundaries").features().to_vec()
    }

    fn touched_from(features: &[Feature], x: f64, y: f64) -> Vec<DVec2> {
        let hits = features.iter().filter_map(|feature| feature.distance(DVec2::new(x, y)));
        hits.map(|(normal, distance)| DVec2::new(x, y) - distance * normal).collect()
    }

    fn segment(from: [f64; 2], to: [f64; 2]) -> Boundary {
        Boundary::Segment { from: from.into(), to: to.into() }
    }

    fn box_from(left: f64, depth: f64) -> Boundary {
        let corners = [[left, -depth], [left + 1.0, -depth], [left + 1.0, 0.0], [left, 0.0]];
        Boundary::ConvexPolygon { points: corners.map(DVec2::from).to_vec() }
    }

    #[test]
    fn a_disc_above_one_piece_does_not_touch_the_corner_of_the_next() {
        let floors = [
            vec![segment([0.0, 0.0], [1.0, 0.0]), segment([1.0, 0.0], [2.0, 0.0])],
            vec![segment([1.0, 0.0], [0.0, 0.0]), segment([2.0, 0.0], [1.0 + 1e-16, 0.0])],
            vec![box_from(0.0, 1.0), box_from(1.0, 1.0)],
            vec![box_from(0.0, 1.0), box_from(1.0, 3.0)],
            vec![box_from(1.0, 1.0), segment([1.0, 0.0], [-1.0, 0.0])],
            // The second segment is below the first, and one of its ends lies on the first.
            vec![segment([-1.0, 0.0], [3.0, 0.0]), segment([1.0, 0.0], [2.0, -1.0])],
        ];
        for floor in floors {
            let all = features(floor.clone());
            let near_one = (-4..=4).map(|ulps| 1.0 + f64::from(ulps) * f64::EPSILON);
            for x in [0.9, 1.0 - 1e-6, 1.0 + 1e-6, 1.1].into_iter().chain(near_one) {
                let touched = touched_from(&all, x, 0.5);
                let near = touched.iter().filter(|at| at.distance(DVec2::new(x, 0.0)) < 0.2);
                assert_eq!(near.clone().count(), 1, "{floor:?} from {x}: {touched:?}");
                assert!(near.into_iter().all(|at| at.distance(DVec2::new(x, 0.0)) < 1e-12));
            }
        }
    }

    #[test]
    fn a_common_corner_that_sticks_out_is_touched_once_and_one_of_a_half_space_never() {
        let roof = vec![
            segment([-1.0, -1.0], [0.0, 0.0]),
            segment([0.0, 0.0], [1.0, -1.0]),
            segment([0.0, -2.0], [0.0, 0.0]),
        ];
        let touched = touched_from(&features(roof.clone()), 0.05, 0.5);
        assert_eq!(touched, [DVec2::ZERO], "the last piece reports it");
        let mut apart = roof;
        apart[2] = segment([0.0, -2.0], [0.0, -1e-6]);
        assert_eq!(touched_from(&features(apart), 0.05, 0.5).len(), 2, "a step is felt");
        let plane = Boundary::HalfSpace { point: DVec2::ZERO, normal: DVec2::Y };
        let all = features(vec![plane, segment([0.0, 0.0], [1.0, -0.5])]);
        assert_eq!(touched_from(&all, -0.1, 0.5), [DVec2::new(-0.1, 0.0)]);
    }
}
