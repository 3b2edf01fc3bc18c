//! How far what touches overlaps.

use crate::contact::{Numbering, Other};
use crate::sim::state::State;

/// Mean overlap of grains that touch and largest of all contacts, in d.
pub(super) fn overlaps(state: &State, bonds: bool) -> [f64; 2] {
    let State { world, contacts, .. } = state;
    let numbering = Numbering::of(world);
    let mut overlap_of_pairs = 0.0;
    let mut pairs = 0u32;
    let mut smallest_gap = 0f64;
    for (index, contact) in contacts.contacts().iter().enumerate() {
        if !contacts.is_in_touch(index) {
            continue;
        }
        smallest_gap = smallest_gap.min(contact.gap);
        if let Other::Grain(_) = numbering.other(contact.other) {
            // A bond may be stretched; what is not overlap does not count as such.
            overlap_of_pairs += if bonds { (-contact.gap).max(0.0) } else { contact.gap.abs() };
            pairs += 1;
        }
    }
    [
        overlap_of_pairs / f64::from(pairs.max(1)) / world.mean_diameter,
        -smallest_gap / world.mean_diameter,
    ]
}
