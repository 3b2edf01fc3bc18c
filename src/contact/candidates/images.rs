//! Candidates across periodic borders.
//!
//! **Discs.** Those that lie near the left border are looked for once more beyond the right one, a period on. A pair is
//! told by that of its images whose offset is the shortest, so no pair is told twice, however far the search looks.
//!
//! **Shapes** with ends lie in the cell. A disc near a border may be nearest to an image of theirs, so the disc is tried
//! where it is, a period to the left and a period to the right.

use glam::DVec2;

use crate::contact::broad_phase::BroadPhase;
use crate::contact::features::Feature;
use crate::world::{Periodic, World};

/// Calls `found` once with every pair of discs, by their numbers, whose nearest images are nearer to each other than
/// their extents together: radii with skins, m. And with some others.
pub(super) fn pairs<const AXES: usize>(
    broad_phase: &mut BroadPhase,
    periodic: Periodic,
    (centres, extents): (&[DVec2], impl Iterator<Item = f64> + Clone),
    mut found: impl FnMut(u32, u32),
) {
    let count = centres.len();
    let reach = 2.0 * extents.clone().fold(0.0, f64::max);
    let mut places: Vec<DVec2> = centres.iter().map(|&centre| periodic.wrap(centre)).collect();
    let mut extents: Vec<f64> = extents.collect();
    let mut disc_of: Vec<u32> = (0..count as u32).collect();
    for disc in 0..count {
        if places[disc].x < periodic.x[0] + reach {
            disc_of.push(disc as u32);
            places.push(places[disc] + DVec2::new(periodic.width(), 0.0));
            extents.push(extents[disc]);
        }
    }
    // A tree is kept for a number of discs that stays the same.
    broad_phase.forget_discs();
    broad_phase.pairs::<AXES>(&places, extents.iter().copied(), |first, second| {
        let discs = [first, second].map(|place| disc_of[place as usize]);
        let [from, to] = discs.map(|disc| places[disc as usize].x);
        // Whole periods from the second disc to that image of it which the first is nearest to.
        let periods = ((from - to) / periodic.width()).round();
        let told_by = match [first, second].map(|place| place as usize >= count) {
            [false, false] => 0.0,
            [false, true] => 1.0,
            [true, false] => -1.0,
            [true, true] => return,
        };
        if periods == told_by && discs[0] != discs[1] {
            found(discs[0], discs[1]);
        }
    });
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
    let distances = places(periodic, centre).into_iter().filter_map(|at| feature.distance(at));
    distances.min_by(|(_, one), (_, other)| one.total_cmp(other))
}

/// The same of [`Feature::distance_to_any_point`], whether borders are periodic or not.
pub(super) fn distance_to_any_point(feature: &Feature, world: &World, centre: DVec2) -> f64 {
    match world.periodic {
        Some(periodic) if !feature.is_half_space() => {
            let distances = places(periodic, centre).map(|at| feature.distance_to_any_point(at));
            distances.into_iter().fold(f64::INFINITY, f64::min)
        }
        _ => feature.distance_to_any_point(centre),
    }
}

/// Where a disc is in the cell, and a period to either side.
fn places(periodic: Periodic, centre: DVec2) -> [DVec2; 3] {
    let centre = periodic.wrap(centre);
    let period = DVec2::new(periodic.width(), 0.0);
    [centre, centre - period, centre + period]
}
