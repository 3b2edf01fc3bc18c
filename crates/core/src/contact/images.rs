//! Search for pairs of bodies that are near each other across periodic borders.
//!
//! **Discs.** Discs near the left border are repeated one period further right, beyond the right border. Discs near
//! the lower border are repeated one period higher, and discs near the corners are repeated diagonally. A pair is
//! reported only for the two nearest images of its discs, so that each pair is reported once, however large the search
//! distance is.
//!
//! If the lower and the upper border are sheared (they slide along x relative to each other), the images of discs above
//! the periodic cell are shifted along x. Before the images to the left and right are searched for, the shifted images
//! are moved along x by whole periods, so that they are directly above the cell.
//!
//! **Segments and polygons** of boundaries are not repeated: they are stored once, inside the periodic cell (the
//! rectangle that repeats). A disc near a border may be nearest to a periodic image of a segment or polygon. So the
//! distance is computed for the disc at its own position and for positions one period to each side.

use glam::DVec2;

use super::broad_phase::BroadPhase;
use super::features::Feature;
use crate::world::{Periodic, World};

/// Offsets, in periods, from a disc to those of its periodic images that the search visits. Half of the images around
/// the cell are enough, because each pair across a border is then found from one of its two discs.
const HALF_AROUND: [DVec2; 4] = [DVec2::X, DVec2::Y, DVec2::ONE, DVec2::new(-1.0, 1.0)];

/// Calls `found` once for every pair of discs, given by their indices, if the centres of their nearest periodic images
/// are closer than the sum of the extents of the discs (radius plus search margin, m). It is also called for some pairs
/// that are farther apart.
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
    // For each periodic image, the index of its disc and the number of periods between disc and image along each
    // axis.
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
    // A tree keeps its discs from search to search, so it needs a constant number of discs. The number of periodic
    // images changes.
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
        // The number of periods along each axis from the second disc to its periodic image that is nearest to the
        // first disc.
        if periodic.whole(from - to) == told_by && discs[0] != discs[1] {
            found(discs[0], discs[1]);
        }
    });
}

/// Returns true if a disc with the coordinate `at` (m) is so near to a border that one of its periodic images can be
/// within `reach` (m) of another disc. This image is `periods` periods away along the axis.
fn near_border(borders: Option<[f64; 2]>, at: f64, periods: f64, reach: f64) -> bool {
    match borders {
        _ if periods == 0.0 => true,
        None => false,
        Some([low, _]) if periods > 0.0 => at < low + reach,
        Some([_, high]) => at >= high - reach,
    }
}

/// Returns the unit normal of the nearest periodic image of a feature (half-space, segment or polygon) towards
/// `centre`, and the distance of `centre` from this image (m), as in [`Feature::distance`]. A half-space has no images.
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

/// Returns the distance (m) between a point and the nearest periodic image of a feature (half-space, segment or
/// polygon), as in [`Feature::distance_to_any_point`]. Without periodic borders only the feature itself counts.
pub(super) fn distance_to_any_point(feature: &Feature, world: &World, centre: DVec2) -> f64 {
    match world.periodic {
        Some(periodic) if !feature.is_half_space() => {
            let distances = places(periodic, centre).map(|at| feature.distance_to_any_point(at));
            distances.fold(f64::INFINITY, f64::min)
        }
        _ => feature.distance_to_any_point(centre),
    }
}

/// Returns the periodic image of the point `centre` in the periodic cell, and its images one period away on each side,
/// m.
fn places(periodic: Periodic, centre: DVec2) -> impl Iterator<Item = DVec2> {
    let centre = periodic.wrap(centre);
    periodic.around().map(move |by| centre + by)
}
