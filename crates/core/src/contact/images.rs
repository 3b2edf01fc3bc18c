//! Candidates across periodic borders.
//!
//! **Discs.** Discs near the left border are repeated one period further, beyond the right border. Discs near the
//! lower border are repeated above, and discs near the corners likewise. Only the images with the shortest offset
//! report a pair, so that each pair is reported once, however far the search looks.
//!
//! With sheared borders, images above are shifted sideways and wrapped before the images beside them are looked for.
//!
//! **Shapes** with ends lie in the cell. A disc near a border may be nearest to an image of a shape, so the disc is
//! tried at its own place and one period to each side.

use glam::DVec2;

use super::broad_phase::BroadPhase;
use super::features::Feature;
use crate::world::{Periodic, World};

/// Periods from a disc to those of its images that are searched: half of the images around the cell, because either
/// disc of a pair across a border can be the one in the cell.
const HALF_AROUND: [DVec2; 4] = [DVec2::X, DVec2::Y, DVec2::ONE, DVec2::new(-1.0, 1.0)];

/// Calls `found` once for every pair of discs, given by indices, whose nearest images are closer than the sum of
/// their extents (radii with skins, m), and for some other pairs.
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
    // The disc of each image, and the periods between them.
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
    // A tree needs a constant number of discs.
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
        // Whole periods from the second disc to its image that is nearest to the first.
        if periodic.whole(from - to) == told_by && discs[0] != discs[1] {
            found(discs[0], discs[1]);
        }
    });
}

/// True if a disc is near enough to a border that its image `periods` away along this axis matters.
fn near_border(borders: Option<[f64; 2]>, at: f64, periods: f64, reach: f64) -> bool {
    match borders {
        _ if periods == 0.0 => true,
        None => false,
        Some([low, _]) if periods > 0.0 => at < low + reach,
        Some([_, high]) => at >= high - reach,
    }
}

/// Normal and distance of the nearest image of a feature, as in [`Feature::distance`].
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

/// The smallest [`Feature::distance_to_any_point`] over the images of a feature, with or without periodic borders.
pub(super) fn distance_to_any_point(feature: &Feature, world: &World, centre: DVec2) -> f64 {
    match world.periodic {
        Some(periodic) if !feature.is_half_space() => {
            let distances = places(periodic, centre).map(|at| feature.distance_to_any_point(at));
            distances.fold(f64::INFINITY, f64::min)
        }
        _ => feature.distance_to_any_point(centre),
    }
}

/// The place of a disc in the cell, and one period to each side.
fn places(periodic: Periodic, centre: DVec2) -> impl Iterator<Item = DVec2> {
    let centre = periodic.wrap(centre);
    periodic.around().map(move |by| centre + by)
}
