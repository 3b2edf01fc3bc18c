//! Candidates across periodic borders.
//!
//! **Discs.** Those that lie near the left border are looked for once more beyond the right one, a period on, and so are
//! those near the lower one, above, and those near its corners. A pair is told by that of its images whose offset is
//! the shortest, so no pair is told twice, however far the search looks.
//!
//! Where borders shear, images above lean to a side and wrap again there, before those beside them are looked for.
//!
//! **Shapes** with ends lie in the cell. A disc near a border may be nearest to an image of theirs, so the disc is tried
//! where it is and a period to each side.

use glam::DVec2;

use super::broad_phase::BroadPhase;
use super::features::Feature;
use crate::world::{Periodic, World};

/// The images of a disc that others are looked for around, in periods: half of those around the cell, since of a pair
/// across a border either disc can be the one in the cell.
const HALF_AROUND: [DVec2; 4] = [DVec2::X, DVec2::Y, DVec2::ONE, DVec2::new(-1.0, 1.0)];

/// Calls `found` once with every pair of discs, by their numbers, whose nearest images are nearer to each other than
/// their extents together: radii with skins, m. And with some others.
pub(super) fn pairs<const AXES: usize>(
    broad_phase: &mut BroadPhase,
    periodic: Periodic,
    centres: &[DVec2],
    extents: impl Iterator<Item = f64> + Clone,
    mut found: impl FnMut(u32, u32),
) {
    let count = centres.len();
    let reach = 2.0 * extents.clone().fold(0.0, f64::max);
    let mut places: Vec<DVec2> = centres.iter().map(|&centre| periodic.wrap(centre)).collect();
    let mut extents: Vec<f64> = extents.collect();
    let size = DVec2::from(periodic.periods().map(|period| period.unwrap_or(0.0)));
    // Which disc an image is of, and how many periods from it.
    let mut images: Vec<(u32, DVec2)> = Vec::new();
    for disc in 0..count {
        let place = places[disc];
        for by in HALF_AROUND {
            let lean = periodic.lean_into_cell(place.x, by.y * size.y);
            let is_near = near_border(periodic.x, place.x + lean, by.x, reach)
                && near_border(periodic.y, place.y, by.y, reach);
            if !is_near {
                continue;
            }
            let image = place + by * size + DVec2::new(lean, 0.0);
            images.push((disc as u32, periodic.whole(image - place)));
            places.push(image);
            extents.push(extents[disc]);
        }
    }
    // A tree is kept for a number of discs that stays the same.
    broad_phase.forget_discs();
    broad_phase.pairs::<AXES>(&places, extents.iter().copied(), |first, second| {
        let image = |place: u32| (place as usize).checked_sub(count).map(|number| images[number]);
        let (discs, told_by) = match (image(first), image(second)) {
            (None, None) => ([first, second], DVec2::ZERO),
            (None, Some((disc, by))) => ([first, disc], by),
            (Some((disc, by)), None) => ([disc, second], -by),
            (Some(_), Some(_)) => return,
        };
        let [from, to] = discs.map(|disc| places[disc as usize]);
        // Whole periods from the second disc to that image of it which the first is nearest to.
        if periodic.whole(from - to) == told_by && discs[0] != discs[1] {
            found(discs[0], discs[1]);
        }
    });
}

/// True where a disc whose image is so many periods on, along an axis, is near enough to the border for that to show.
fn near_border(borders: Option<[f64; 2]>, at: f64, periods: f64, reach: f64) -> bool {
    match borders {
        _ if periods == 0.0 => true,
        None => false,
        Some([low, _]) if periods > 0.0 => at < low + reach,
        Some([_, high]) => at >= high - reach,
    }
}

/// Normal and distance of the nearest image of a feature, as [`Feature::distance`] has them.
pub(super) fn distance(
    feature: &Feature,
    periodic: Periodic,
    centre: DVec2,
) -> Option<(DVec2, f64)> {
    if feature.is_half_space() {
        return feature.distance(centre);
    }
    let distances = places(periodic, centre).filter_map(|at| feature.distance(at));
    distances.min_by(|(_, one), (_, other)| one.total_cmp(other))
}

/// The same of [`Feature::distance_to_any_point`], whether borders are periodic or not.
pub(super) fn distance_to_any_point(feature: &Feature, world: &World, centre: DVec2) -> f64 {
    match world.periodic {
        Some(periodic) if !feature.is_half_space() => {
            let distances = places(periodic, centre).map(|at| feature.distance_to_any_point(at));
            distances.fold(f64::INFINITY, f64::min)
        }
        _ => feature.distance_to_any_point(centre),
    }
}

/// Where a disc is in the cell, and a period to each side.
fn places(periodic: Periodic, centre: DVec2) -> impl Iterator<Item = DVec2> {
    let centre = periodic.wrap(centre);
    periodic.around().map(move |by| centre + by)
}
