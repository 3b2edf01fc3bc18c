//! Check that discs of an initial state do not overlap too deeply.
//!
//! If the centres of n discs keep a minimum distance from each other, each disc touches few others, and the number of
//! contacts and the computing time grow in proportion to n. If all n discs are at one point, all n²/2 pairs touch. So
//! discs count as too close if their centres are nearer than half the smaller radius.
//!
//! The search handles one range of radii after the other, from 2^e to 2^(e + 1) metres for an integer e, on a grid with
//! cells 2^e metres wide. Half of such a radius is less than the width of a cell, so all discs that are too close to a
//! disc are in its own cell and in the 8 cells around it. The discs are sorted by column of cells and then by row. So
//! the three cells of each column are next to each other in the list, and the nine cells are three ranges of it.

use glam::DVec2;

use crate::error::{Error, Result};
use crate::world::World;

/// Smallest allowed distance between the centres of a grain and another disc, in radii of the smaller disc. In
/// compressed packings the distance is more than 1.8 radii in practice. In the scene `overlap` two discs start at a
/// distance of 1 radius.
const LEAST_DISTANCE_IN_RADII: f64 = 0.5;
/// Largest number of fixed discs (discs that are not grains) that may be closer to one fixed disc than
/// [`LEAST_DISTANCE_IN_RADII`]. Overlapping fixed discs can form a smooth wall, but a grain would touch all of them at
/// once.
const MOST_FIXED_TOO_CLOSE: usize = 1000;

/// Checks that no grain is too close to another disc (nearer than half the smaller radius, between the centres), and
/// that no fixed disc has more than [`MOST_FIXED_TOO_CLOSE`] fixed discs that are so close to it. Computing time and
/// memory are proportional to the number of discs.
///
/// # Errors
/// If a grain is too close to another disc, or too many fixed discs are too close to one fixed disc. The error names
/// two of these discs.
pub(crate) fn check_distances(world: &World) -> Result<()> {
    let grains = &world.grains;
    let fixed = world.fixed_discs.iter().map(|disc| (disc.position, disc.radius));
    let discs: Vec<(DVec2, f64)> =
        grains.positions.iter().copied().zip(grains.radii.iter().copied()).chain(fixed).collect();
    let mut found = first_too_close(&discs, grains.len());
    if let Some(periodic) = world.periodic {
        // After a shift by half a period, two discs that were close to each other across a periodic border are
        // neighbours inside the cell.
        let half = periodic.periods().map(|period| 0.5 * period.unwrap_or(0.0));
        for by in [DVec2::new(half[0], 0.0), DVec2::new(0.0, half[1]), DVec2::from(half)] {
            let shifted = discs.iter().map(|&(place, radius)| (periodic.wrap(place + by), radius));
            let shifted: Vec<(DVec2, f64)> = shifted.collect();
            found = found.or_else(|| first_too_close(&shifted, grains.len()));
        }
    }
    let Some((one, other)) = found else { return Ok(()) };
    let name = |index: usize| match index.checked_sub(grains.len()) {
        Some(fixed) => format!("fixed_discs[{fixed}]"),
        None => format!("grains[{index}]"),
    };
    let ((place, radius), (place_of_other, radius_of_other)) = (discs[one], discs[other]);
    let distance = world.shortest(place - place_of_other).length();
    let found = format!("{place} m, {distance} m from that of {}", name(other));
    let least = LEAST_DISTANCE_IN_RADII * radius.min(radius_of_other);
    let allowed = format!("at least {least} m from it, half the smaller radius");
    Err(Error::value(format!("{}.position", name(one)), found, allowed))
}

/// Returns the indices of two discs that are too close (nearer than half the smaller radius, between the centres), if
/// there are any. Up to [`MOST_FIXED_TOO_CLOSE`] fixed discs may be so close to a fixed disc. A disc is a centre and a
/// radius (m). The first `grain_count` discs are grains, and the others are fixed.
fn first_too_close(discs: &[(DVec2, f64)], grain_count: usize) -> Option<(usize, usize)> {
    let level = |radius: f64| radius.to_bits() >> 52;
    let mut levels: Vec<u64> = discs.iter().map(|&(_, radius)| level(radius)).collect();
    levels.sort_unstable();
    levels.dedup();
    // For each disc, the indices of its cell along both axes and its own index.
    let mut places: Vec<([i64; 2], u32)> = Vec::with_capacity(discs.len());
    // Start with the largest radii, so that the larger discs near a smaller disc are already known to keep their
    // distance.
    for &now in levels.iter().rev() {
        let width = f64::from_bits(now << 52).max(f64::MIN_POSITIVE);
        let cell = |centre: DVec2| [(centre.x / width).floor(), (centre.y / width).floor()];
        let larger = (0..).zip(discs).filter(|(_, (_, radius))| level(*radius) >= now);
        places.clear();
        places
            .extend(larger.map(|(index, &(centre, _))| (cell(centre).map(|at| at as i64), index)));
        places.sort_unstable();
        for &([x, y], index) in &places {
            let (centre, radius) = discs[index as usize];
            if level(radius) != now {
                continue;
            }
            let mut fixed_too_close = 0;
            for column in [x.saturating_sub(1), x, x.saturating_add(1)] {
                let below = [column, y.saturating_sub(1)];
                let start = places.partition_point(|&(cell, _)| cell < below);
                let above = [column, y.saturating_add(1)];
                let stretch = places[start..].iter().take_while(|&&(cell, _)| cell <= above);
                for &(_, other) in stretch.filter(|&&(_, other)| other != index) {
                    let (centre_of_other, radius_of_other) = discs[other as usize];
                    let least = LEAST_DISTANCE_IN_RADII * radius.min(radius_of_other);
                    if centre.distance(centre_of_other) >= least {
                        continue;
                    }
                    let pair = (index.max(other) as usize, index.min(other) as usize);
                    fixed_too_close += 1;
                    if pair.1 < grain_count || fixed_too_close > MOST_FIXED_TOO_CLOSE {
                        return Some(pair);
                    }
                }
            }
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns `count` discs of seven sizes on a lattice. The centres of any two discs are farther apart than half the
    /// smaller radius, as the check requires.
    fn apart(count: usize) -> Vec<(DVec2, f64)> {
        let place = |k: usize| DVec2::new((k % 100) as f64, (k / 100) as f64);
        (0..count).map(|k| (place(k), 0.5 / (1 + k % 7) as f64)).collect()
    }

    #[test]
    fn two_discs_in_one_place_are_found_among_many_of_any_size() {
        let mut discs = apart(10_000);
        assert_eq!(first_too_close(&discs, discs.len()), None);
        for (one, radius) in [(17, 0.5), (5_000, 1e-6), (9_999, 30.0)] {
            let mut spoilt = discs.clone();
            spoilt.push((discs[one].0 + 0.2 * discs[one].1.min(radius) * DVec2::X, radius));
            let found = first_too_close(&spoilt, spoilt.len()).expect("a pair");
            assert_eq!(found.0, 10_000, "{radius}");
        }
        // All discs are in one cell, and they are slightly more than half a radius apart.
        discs.truncate(0);
        discs.extend((0..9).map(|k| (0.51 * DVec2::new((k % 3) as f64, (k / 3) as f64), 1.0)));
        assert_eq!(first_too_close(&discs, 9), None);
        discs[8].0 -= 0.03 * DVec2::X;
        assert_eq!(first_too_close(&discs, 9), Some((8, 7)));
    }

    #[test]
    fn a_hundred_thousand_discs_in_one_place_are_told_of_at_once() {
        let start = std::time::Instant::now();
        let discs = vec![(DVec2::ONE, 0.1); 100_000];
        assert!(first_too_close(&discs, discs.len()).is_some());
        assert!(first_too_close(&discs, 0).is_some(), "fixed ones, too many to touch at once");
        assert_eq!(first_too_close(&discs[..1000], 0), None, "a smooth wall");
        assert!(start.elapsed().as_secs_f64() < 10.0);
    }
}
