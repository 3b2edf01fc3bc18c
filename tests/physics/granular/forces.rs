//! How forces and directions are distributed.

use crate::common::*;

use super::by_hand::{disc, discs, touch};
use super::packings::{RADIUS, triangular_discs};

const EXACT: f64 = 1e-12;

/// Pairs of discs that touch with these forces.
fn pairs(forces: &[f64]) -> Moment {
    let place = |k: usize, x: f64| disc(RADIUS * DVec2::new(x, 8.0 * k as f64), RADIUS);
    let mut moment =
        discs((0..forces.len()).flat_map(|k| [place(k, 0.0), place(k, 2.0)]).collect());
    for (k, &force) in forces.iter().enumerate() {
        touch(&mut moment, [2 * k + 1, 2 * k], [force, 0.0]);
    }
    moment
}

fn histogram(moment: &Moment, quantity: &str) -> Histogram {
    let all = histograms(moment);
    all.into_iter().find(|histogram| histogram.quantity == quantity).expect("a histogram")
}

/// What bins hold something, each by its lower edge, with its count.
fn filled(histogram: &Histogram) -> Vec<(f64, u64)> {
    let bins = histogram.edges.iter().copied().zip(histogram.counts.iter().copied());
    bins.filter(|&(_, count)| count > 0).collect()
}

#[test]
fn moments_of_forces_are_those_of_their_ratios_to_the_mean() {
    let pile = PileMeasures::of(&pairs(&[1.0, 2.0, 3.0, 6.0, -3.0, 0.0]));
    // What bears nothing does not count: five contacts with ⟨|N|⟩ = 3.
    assert_close(pile.mean_normal_force, 3.0, EXACT, "⟨|N|⟩");
    assert_close(pile.normal_force_second_moment, 59.0 / 45.0, EXACT, "⟨f²⟩");
    assert_close(pile.normal_force_third_moment, 279.0 / 135.0, EXACT, "⟨|f|³⟩");
    assert_close(pile.largest_normal_force, 2.0, EXACT, "largest f");
    assert_close(pile.strong_share, 0.2, EXACT, "strong contacts");
    assert_close(pile.tensile_share, 1.0 / 6.0, EXACT, "tensile contacts");
}

#[test]
fn exponential_forces_have_the_moments_and_the_histogram_of_an_exponential() {
    // One force a slice of equal probability, so that only the slices' width is missing.
    let count = 4000;
    let forces: Vec<f64> =
        (0..count).map(|k| -7.0 * (1.0 - (f64::from(k) + 0.5) / f64::from(count)).ln()).collect();
    let moment = pairs(&forces);
    let pile = PileMeasures::of(&moment);
    assert_close(pile.mean_normal_force, 7.0, 1e-3, "⟨N⟩");
    assert_close(pile.normal_force_second_moment, 2.0, 1e-2, "⟨f²⟩");
    assert_close(pile.normal_force_third_moment, 6.0, 2e-2, "⟨f³⟩");
    assert_close(pile.strong_share, (-1f64).exp(), 1e-3, "strong contacts");
    let histogram = histogram(&moment, "normal_force");
    for (bin, edges) in histogram.edges.windows(2).enumerate() {
        let above = |edge: f64| if edge < 0.0 { 1.0 } else { (-edge).exp() };
        let expected = f64::from(count) * (above(edges[0]) - above(edges[1]));
        let found = histogram.counts[bin] as f64;
        assert!((found - expected).abs() < 3.0, "{edges:?}: {found} of {expected}");
    }
}

#[test]
fn directions_of_a_triangular_packing_fall_into_three_bins() {
    let mut moment = triangular_discs(8, 8);
    let centres: Vec<DVec2> = moment.grains.iter().map(|grain| grain.position).collect();
    let mut along_rows = 0;
    for i in 0..centres.len() {
        for j in 0..centres.len() {
            // In either order of the pair the axis is the same.
            let ends = if (i + j) % 2 == 0 { [i, j] } else { [j, i] };
            if i < j && centres[i].distance(centres[j]) < 2.0001 * RADIUS {
                along_rows += u64::from(centres[i].y == centres[j].y);
                touch(&mut moment, ends, [1.0, 0.0]);
            }
        }
    }
    // Up to the right and up to the left in turn have one more: there are seven steps from row to row.
    let across = (moment.contacts.len() as u64 - along_rows) / 2;
    let directions = histogram(&moment, "contact_orientation");
    assert_eq!(filled(&directions), [(-2.5, along_rows), (57.5, across + 1), (117.5, across)]);
    assert_eq!((directions.edges.len(), directions.counts.len()), (37, 36));
    assert_eq!(directions.edges.last(), Some(&177.5));
    let contacts = histogram(&moment, "coordination");
    assert_eq!(contacts.counts.iter().sum::<u64>(), 64);
    assert_eq!(contacts.counts[6], 6 * 6);
    assert_eq!(contacts.edges.last(), Some(&f64::INFINITY));
}

#[test]
fn what_lies_beyond_the_bins_is_in_the_outermost() {
    let mut forces = vec![1.0; 20];
    forces.extend([100.0, -100.0]);
    let mut moment = pairs(&forces);
    let overlaps = [-1e-3, 0.0, 3e-8, 1.1e-7, 1.5e-4, 0.011, 0.03, 0.2];
    let overlaps = overlaps.into_iter().chain(std::iter::repeat(3e-4));
    for (contact, overlap) in moment.contacts.iter_mut().zip(overlaps) {
        contact.gap = -overlap * 2.0 * RADIUS;
    }
    let forces = filled(&histogram(&moment, "normal_force"));
    // ⟨|N|⟩ = 10: all weak ones are in the first bin that pushes.
    assert_eq!(forces, [(f64::NEG_INFINITY, 1), (0.0, 20), (8.0, 1)]);
    let below = (f64::NEG_INFINITY, 1);
    let pressed = [(0.0, 2), (1e-7, 1), (1e-4, 1), (2e-4, 14), (1e-2, 1), (2e-2, 1), (1e-1, 1)];
    assert_eq!(filled(&histogram(&moment, "overlap")), [&[below], pressed.as_slice()].concat());
}
