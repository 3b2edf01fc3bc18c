//! Tests that no measured quantity depends on the position or orientation of the pile, or on the numbering of the
//! grains.

use std::sync::Arc;

use crate::common::*;
use proptest::prelude::*;
use rand::seq::SliceRandom;

use super::packings::{among, disc, discs, lean, touch};

const CASES: u32 = 64;
const FLOOR: usize = 0;

fn for_random_moments(property: impl Fn(u64, Moment) -> Result<(), TestCaseError>) {
    for_random(CASES, (any::<u64>(), 1usize..60), |(seed, count)| {
        property(seed, heap(seed, count))
    });
}

/// Returns a state of random discs over a floor and over some discs that are not grains, with random forces at all
/// overlaps. One grain is marked as lost (it has left the scene).
fn heap(seed: u64, count: usize) -> Moment {
    let mut random = random(seed);
    let grains = (0..count).map(|_| {
        let place = DVec2::new(random.random_range(0.0..6.0), random.random_range(0.5..6.0));
        let mut grain = disc(place, random.random_range(0.3..0.7));
        grain.velocity = DVec2::new(random.random_range(-1.0..1.0), random.random_range(-1.0..1.0));
        grain
    });
    let mut heap = discs(grains.collect());
    let base = (0..4).map(|k| fixed(DVec2::new(2.0 * f64::from(k), -0.2), 0.5)).collect();
    let floor = level();
    let end = Boundary::Segment { from: DVec2::new(3.0, 3.0), to: DVec2::new(4.0, 4.5) };
    heap = among(heap, vec![floor, end], base);
    let mut forces = || [random.random_range(-1.0..3.0), random.random_range(-1.0..1.0)];
    let overlap = |heap: &Moment, i: usize, j: usize| {
        let (first, second) = (heap.grains[i], heap.grains[j]);
        first.position.distance(second.position) < first.radius + second.radius
    };
    for i in 0..count {
        for j in i + 1..count {
            if overlap(&heap, i, j) {
                touch(&mut heap, [i, j], forces());
            }
        }
        if heap.grains[i].position.y < 1.0 {
            lean(&mut heap, i, FLOOR, forces());
        }
    }
    for (index, contact) in heap.contacts.iter_mut().enumerate() {
        contact.status = [ContactStatus::Slip, ContactStatus::Stick][index % 2];
    }
    heap.grains[count / 2].lost = count > 9;
    heap
}

/// Returns the state with all positions mapped by the function `place` and all vectors (velocities, forces) by the
/// function `vector`.
fn mapped(
    moment: &Moment,
    place: impl Fn(DVec2) -> DVec2,
    vector: impl Fn(DVec2) -> DVec2,
) -> Moment {
    let mut mapped = moment.clone();
    for grain in &mut mapped.grains {
        grain.position = place(grain.position);
        grain.velocity = vector(grain.velocity);
    }
    for contact in &mut mapped.contacts {
        contact.normal = vector(contact.normal);
        contact.branch = vector(contact.branch);
        contact.force = vector(contact.force);
        contact.point = place(contact.point);
    }
    let boundary = |boundary: &Boundary| match *boundary {
        Boundary::HalfSpace { point, normal } => plane(place(point), vector(normal)),
        Boundary::Segment { from, to } => Boundary::Segment { from: place(from), to: place(to) },
        ref other => panic!("{other:?}"),
    };
    let discs = moment.surroundings.fixed_discs.iter();
    mapped.surroundings = Arc::new(Surroundings {
        fixed_discs: discs.map(|disc| Disc { position: place(disc.position), ..*disc }).collect(),
        boundaries: moment.surroundings.boundaries.iter().map(boundary).collect(),
        ..(*moment.surroundings).clone()
    });
    mapped
}

/// Function that returns the expected new value of a table's column from the name of the column and the old values of
/// all columns in the row.
type Expected<'a> = &'a dyn Fn(&str, &dyn Fn(&str) -> f64) -> f64;

fn compare<Row>(
    columns: &'static [ColumnSpec<Row>],
    [before, after]: [&Row; 2],
    expected: Expected,
) -> Result<(), TestCaseError> {
    let was = |name: &str| {
        let column = columns.iter().find(|column| column.name == name);
        column.expect("a column").value.number(before).unwrap_or(f64::NAN)
    };
    for column in columns {
        let (found, expected) =
            (column.value.number(after).unwrap_or(f64::NAN), expected(column.name, &was));
        let off = if column.name.ends_with("_direction") {
            // Angles of an axis: 0° and 180° are the same.
            (found - expected).to_radians().sin().abs()
        } else {
            (found - expected).abs() / expected.abs().max(1.0)
        };
        let same = off < 1e-8 || (found.is_nan() && expected.is_nan());
        prop_assert!(same, "{}: {found} instead of {expected}", column.name);
    }
    Ok(())
}

fn compare_all(
    before: &MomentMeasures,
    after: &MomentMeasures,
    order: &[usize],
    expected: Expected,
) -> Result<(), TestCaseError> {
    use slump::granular::{GrainMeasures, PileMeasures};
    compare(PileMeasures::COLUMNS, [&before.pile, &after.pile], expected)?;
    for (index, grain) in before.grains.iter().enumerate() {
        compare(GrainMeasures::COLUMNS, [grain, &after.grains[order[index]]], expected)?;
    }
    Ok(())
}

fn as_numbered(moment: &Moment) -> Vec<usize> {
    (0..moment.grains.len()).collect()
}

fn is_shear(name: &str) -> bool {
    name.ends_with("_xy") || name.ends_with("_yx")
}

#[test]
fn a_pile_that_is_moved_has_the_same_measures() {
    for_random_moments(|_, heap| {
        let by = DVec2::new(30.0, -70.0);
        let (before, after) = (measure(&heap), measure(&mapped(&heap, |at| at + by, |way| way)));
        compare_all(&before, &after, &as_numbered(&heap), &|name, was| was(name))?;
        prop_assert_eq!(before.histograms, after.histograms);
        Ok(())
    });
}

#[test]
fn in_a_mirror_shear_changes_its_sign() {
    for_random_moments(|_, heap| {
        let flip = |at: DVec2| DVec2::new(-at.x, at.y);
        let mut mirrored = mapped(&heap, flip, flip);
        mirrored.contacts.iter_mut().for_each(|contact| contact.tangential_force *= -1.0);
        let (before, after) = (measure(&heap), measure(&mirrored));
        compare_all(&before, &after, &as_numbered(&heap), &|name, was| match name {
            _ if is_shear(name) => -was(name),
            _ if name.ends_with("_direction") => 180.0 - was(name),
            _ => was(name),
        })?;
        let directions = |measured: &MomentMeasures| measured.histograms[1].counts.clone();
        let (mut counts, bins) = (directions(&before), directions(&before).len());
        counts[1..bins].reverse();
        prop_assert_eq!(counts, directions(&after));
        Ok(())
    });
}

#[test]
fn a_quarter_turn_changes_x_for_y() {
    for_random_moments(|_, heap| {
        let (before, after) = (measure(&heap), measure(&mapped(&heap, DVec2::perp, DVec2::perp)));
        compare_all(&before, &after, &as_numbered(&heap), &|name, was| {
            let (kind, axes) = name.rsplit_once('_').unwrap_or((name, ""));
            match axes {
                "xx" => was(&format!("{kind}_yy")),
                "yy" => was(&format!("{kind}_xx")),
                "xy" if kind == "stress" => -was("stress_yx"),
                "xy" | "yx" => -was(&format!("{kind}_xy")),
                "direction" => was(name) + 90.0,
                _ => was(name),
            }
        })
    });
}

#[test]
fn numbers_of_grains_are_names_alone() {
    for_random_moments(|seed, heap| {
        let mut order = as_numbered(&heap);
        order.shuffle(&mut random(seed));
        let mut renumbered = heap.clone();
        for (index, &grain) in heap.grains.iter().enumerate() {
            renumbered.grains[order[index]] = grain;
        }
        for contact in &mut renumbered.contacts {
            let grain = order[contact.grain as usize] as u32;
            *contact = match contact.other {
                OtherBody::Grain(other) => {
                    by_number(*contact, [grain, order[other as usize] as u32])
                }
                other => ContactState { grain, other, ..*contact },
            };
        }
        renumbered.contacts.shuffle(&mut random(seed + 1));
        let (before, after) = (measure(&heap), measure(&renumbered));
        compare_all(&before, &after, &order, &|name, was| was(name))?;
        prop_assert_eq!(before.histograms, after.histograms);
        Ok(())
    });
}

/// Returns a contact in the stored form, in which the grain with the smaller number is grain i. If `grain` has the
/// larger number, the two grains are exchanged, and normal, branch vector and force change their signs.
fn by_number(contact: ContactState, [grain, other]: [u32; 2]) -> ContactState {
    if grain < other {
        return ContactState { grain, other: OtherBody::Grain(other), ..contact };
    }
    ContactState {
        grain: other,
        other: OtherBody::Grain(grain),
        normal: -contact.normal,
        branch: -contact.branch,
        force: -contact.force,
        ..contact
    }
}
