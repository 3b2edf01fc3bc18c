//! Places that are known exactly.

use crate::common::*;

const FLOOR: f64 = -10.0;

fn surface(half_width: f64, discs: &[[f64; 3]]) -> Deposit {
    let mut surface = Deposit::new(FLOOR, half_width, 2.0);
    for &[x, y, radius] in discs {
        surface.add(Disc { position: DVec2::new(x, y), radius });
    }
    surface
}

/// Drops a disc, and its mirror image on the mirrored surface.
fn both_ways(half_width: f64, discs: &[[f64; 3]], x: f64, radius: f64) -> Rest {
    let rest = dropped(&surface(half_width, discs), x, radius);
    let mirrored: Vec<_> = discs.iter().map(|&[x, y, radius]| [-x, y, radius]).collect();
    let other = dropped(&surface(half_width, &mirrored), -x, radius);
    assert_eq!(other.centre, DVec2::new(-rest.centre.x, rest.centre.y));
    assert_eq!(other.supports, rest.supports);
    rest
}

fn assert_at(rest: Rest, x: f64, y: f64) {
    assert!(rest.centre.distance(DVec2::new(x, y)) < 1e-14, "{rest:?} is not at ({x}, {y})");
}

#[test]
fn a_disc_alone_lies_on_the_floor_below_its_start() {
    let rest = both_ways(50.0, &[], 3.0, 1.5);
    assert_at(rest, 3.0, FLOOR + 1.5);
    assert_eq!(rest.supports, (Support::Floor, None));
}

#[test]
fn a_disc_rolls_off_one_disc_to_the_ground() {
    // A smaller one falls from beside it, a larger one leans against it.
    let rest = both_ways(50.0, &[[0.0, FLOOR + 1.0, 1.0]], 0.5, 0.5);
    assert_at(rest, 1.5, FLOOR + 0.5);
    assert_eq!(rest.supports, (Support::Floor, None));
    let rest = both_ways(50.0, &[[0.0, FLOOR + 1.0, 1.0]], 0.5, 2.0);
    assert_at(rest, 8f64.sqrt(), FLOOR + 2.0);
    assert_eq!(rest.supports, (Support::Disc(0), Some(Support::Floor)));
}

#[test]
fn a_disc_rests_between_two() {
    let rest = both_ways(50.0, &[[0.0, 0.0, 1.0], [3.0, 0.0, 1.0]], 1.0, 1.0);
    assert_at(rest, 1.5, (4.0f64 - 2.25).sqrt());
    assert_eq!(rest.supports, (Support::Disc(0), Some(Support::Disc(1))));
    let rest = both_ways(50.0, &[[0.0, 0.0, 2.0], [4.0, 0.0, 1.0]], 1.0, 1.0);
    assert_at(rest, 2.625, (9.0f64 - 2.625 * 2.625).sqrt());
    // Where the second is above the disc that leans on it: 3, 4, 5 from the first.
    let rest = both_ways(50.0, &[[0.0, 0.0, 2.0], [3.2, 1.85, 0.75]], 0.1, 0.5);
    assert_at(rest, 2.0, 1.5);
    assert_eq!(rest.supports, (Support::Disc(0), Some(Support::Disc(1))));
}

#[test]
fn a_disc_falls_through_a_gap_that_leaves_it_just_the_room() {
    let rest = both_ways(50.0, &[[0.0, 0.0, 1.0], [4.0, 0.0, 1.0]], 0.5, 1.0);
    assert_at(rest, 2.0, FLOOR + 1.0);
}

#[test]
fn a_disc_rolls_on_over_what_lies_on_the_same_side() {
    let rest = both_ways(50.0, &[[0.0, 0.0, 1.0], [1.3, -1.6, 1.0]], 0.5, 1.0);
    assert_at(rest, 3.3, FLOOR + 1.0);
}

#[test]
fn a_disc_leans_against_the_wall() {
    let rest = both_ways(2.2, &[[0.0, 0.0, 1.0]], 0.5, 1.0);
    assert_at(rest, 1.2, 1.6);
    assert_eq!(rest.supports, (Support::Disc(0), Some(Support::Wall)));
}

#[test]
fn a_disc_that_falls_off_passes_what_hangs_over() {
    // It falls from beside the first, below the second, which is not to catch it from above.
    let discs = [[0.0, 0.0, 1.0], [4.5, 1.0, 1.0], [2.5, -5.0, 1.0]];
    let rest = both_ways(50.0, &discs, 0.5, 1.0);
    // Off the first at x = 2, then left off the third at x = 0.5.
    assert_at(rest, 0.5, FLOOR + 1.0);
}
