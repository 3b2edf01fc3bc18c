//! Tests of measured quantities that can be counted by hand (rattlers, clusters, fractions of contacts, force
//! distributions), and of states with few or no measurable quantities.

use super::packings::{RADIUS, among, box_walls, disc, discs, lean, touch, triangular_discs};
use crate::common::*;

const EXACT: f64 = 1e-12;

/// Returns a state of a ring of four discs with a chain of two discs attached, and a disc inside the ring that presses
/// on no other disc. Away from the ring, two discs press on each other, and one disc is isolated.
fn ring_and_chain() -> Moment {
    let place = |x: f64, y: f64| disc(2.0 * RADIUS * DVec2::new(x, y), RADIUS);
    let ring = [place(0.0, 0.0), place(1.0, 0.0), place(1.0, 1.0), place(0.0, 1.0)];
    let chain = [place(2.0, 0.0), place(3.0, 0.0)];
    let rattler = disc(2.0 * RADIUS * DVec2::splat(0.5), (2f64.sqrt() - 1.0) * RADIUS);
    let apart = [place(8.0, 0.0), place(9.0, 0.0), place(20.0, 0.0)];
    let mut moment = discs([ring.as_slice(), &chain, &[rattler], &apart].concat());
    for pair in [[1, 0], [2, 1], [3, 2], [3, 0]] {
        touch(&mut moment, pair, [10.0, 0.0]);
    }
    touch(&mut moment, [4, 1], [2.0, 0.0]);
    touch(&mut moment, [5, 4], [2.0, 0.0]);
    // Forces as small as the solver's error do not count.
    for corner in 0..4 {
        touch(&mut moment, [6, corner], [if corner < 2 { 1e-6 } else { 0.0 }, 0.0]);
    }
    touch(&mut moment, [8, 7], [5.0, 0.0]);
    moment
}

#[test]
fn rattlers_are_taken_away_until_none_is_left() {
    let measured = measure(&ring_and_chain());
    let rattlers: Vec<usize> = (0..10).filter(|&index| measured.grains[index].rattler).collect();
    assert_eq!(rattlers, [4, 5, 6, 7, 8, 9]);
    assert_eq!(measured.pile.rattlers, 6);
    assert_close(measured.pile.coordination, 22.0 / 10.0, EXACT, "Z");
    assert_close(measured.pile.coordination_without_rattlers, 2.0, EXACT, "Z without rattlers");
    let contacts: Vec<u32> = measured.grains.iter().map(|grain| grain.coordination).collect();
    assert_eq!(contacts, [3, 4, 3, 3, 2, 1, 4, 1, 1, 0]);
}

#[test]
fn a_body_that_does_not_move_holds_grains() {
    // Of two discs, one is in a corner and has two contacts. The other disc lies on the floor and has one contact.
    let floor = [RADIUS, 9.0 * RADIUS].map(|x| disc(DVec2::new(x, RADIUS), RADIUS));
    let walls = box_walls(DVec2::ZERO, DVec2::splat(1.0));
    let mut moment = among(discs(floor.to_vec()), walls, Vec::new());
    lean(&mut moment, 0, 0, [1.0, 0.0]);
    lean(&mut moment, 0, 2, [1.0, 0.0]);
    lean(&mut moment, 1, 2, [1.0, 0.0]);
    let pile = PileMeasures::of(&moment);
    assert_eq!((pile.rattlers, pile.clusters, pile.largest_cluster), (1, 2, 1));
    assert_close(pile.coordination, 1.5, EXACT, "Z");
    assert_close(pile.coordination_without_rattlers, 2.0, EXACT, "Z without rattlers");
}

#[test]
fn clusters_are_what_contacts_join() {
    let mut moment = ring_and_chain();
    let clusters = |moment: &Moment| {
        let pile = PileMeasures::of(moment);
        (pile.clusters, pile.largest_cluster)
    };
    assert_eq!(clusters(&moment), (3, 7));
    // Removes the disc that connects the end of the chain with the ring.
    moment.grains[4].lost = true;
    assert_eq!(clusters(&moment), (4, 5));
    moment.contacts.clear();
    assert_eq!(clusters(&moment), (9, 1));
}

#[test]
fn shares_are_parts_of_all_contacts() {
    let mut moment = ring_and_chain();
    let count = moment.contacts.len() as f64;
    for index in [0, 4, 7] {
        moment.contacts[index].status = ContactStatus::Slip;
    }
    moment.contacts[1].normal_force = -1.0;
    let pile = PileMeasures::of(&moment);
    let open = moment.contacts.iter().filter(|contact| contact.status == ContactStatus::Open);
    assert_close(pile.sliding_share, 3.0 / count, EXACT, "sliding");
    assert_close(pile.open_share, open.count() as f64 / count, EXACT, "open");
    assert_close(pile.tensile_share, 1.0 / count, EXACT, "tensile");
    assert!(pile.open_share > 0.0);
}

/// Returns a scene of discs side by side on a plane under gravity inclined by `angle` (rad).
fn on_a_slope(angle: f64, friction: f64) -> Scene {
    let radius = 0.1;
    let grains = (0..5)
        .map(|k| Grain::at_rest(DVec2::new(4.0 * radius * f64::from(k), radius - 1e-9), radius));
    let gravity = G * DVec2::new(angle.sin(), -angle.cos());
    Scene {
        boundaries: vec![level()],
        ..scene(Physics::FULL, gravity, parameters(0.0, 1e-3, 0.0, friction), grains.collect())
    }
}

#[test]
fn on_a_slope_discs_slip_where_friction_is_below_a_third_of_its_tangent() {
    let angle = 0.5f64;
    for (friction, share) in [(0.9 * angle.tan() / 3.0, 1.0), (1.1 * angle.tan() / 3.0, 0.0)] {
        let run = after(&on_a_slope(angle, friction), 10);
        let pile = PileMeasures::of(&run.moment());
        assert_eq!((pile.contacts, pile.sliding_share), (5, share), "μ = {friction}");
        assert_eq!((pile.open_share, pile.clusters, pile.rattlers), (0.0, 5, 5));
    }
}

/// Returns a state of separate pairs of touching discs. Each pair has one of these contact forces (N).
fn pairs_under(forces: &[f64]) -> Moment {
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

/// Returns the lower edges and counts of all bins of a histogram that are not empty.
fn filled(histogram: &Histogram) -> Vec<(f64, u64)> {
    let bins = histogram.edges.iter().copied().zip(histogram.counts.iter().copied());
    bins.filter(|&(_, count)| count > 0).collect()
}

#[test]
fn moments_of_forces_are_those_of_their_ratios_to_the_mean() {
    let pile = PileMeasures::of(&pairs_under(&[1.0, 2.0, 3.0, 6.0, -3.0, 0.0]));
    // Contacts without a force do not count, so five contacts have the mean ⟨|N|⟩ = 3 N.
    assert_close(pile.mean_normal_force, 3.0, EXACT, "⟨|N|⟩");
    assert_close(pile.normal_force_second_moment, 59.0 / 45.0, EXACT, "⟨f²⟩");
    assert_close(pile.normal_force_third_moment, 279.0 / 135.0, EXACT, "⟨|f|³⟩");
    assert_close(pile.largest_normal_force, 2.0, EXACT, "largest f");
    assert_close(pile.strong_share, 0.2, EXACT, "strong contacts");
    assert_close(pile.tensile_share, 1.0 / 6.0, EXACT, "tensile contacts");
}

#[test]
fn exponential_forces_have_the_moments_and_the_histogram_of_an_exponential() {
    // One force per interval of equal probability, so the only error is the width of the intervals.
    let count = 4000;
    let forces: Vec<f64> =
        (0..count).map(|k| -7.0 * (1.0 - (f64::from(k) + 0.5) / f64::from(count)).ln()).collect();
    let moment = pairs_under(&forces);
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
    for (i, j) in pairs(0..centres.len(), 0..centres.len()) {
        // The direction of a contact must not depend on the order of the pair.
        let ends = if (i + j) % 2 == 0 { [i, j] } else { [j, i] };
        if i < j && centres[i].distance(centres[j]) < 2.0001 * RADIUS {
            along_rows += u64::from(centres[i].y == centres[j].y);
            touch(&mut moment, ends, [1.0, 0.0]);
        }
    }
    // Between two rows, one of the two diagonal directions has one contact more, alternating from gap to gap. There are
    // seven gaps, so one direction has one contact more in total.
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
    let mut moment = pairs_under(&forces);
    let overlaps = [-1e-3, 0.0, 3e-8, 1.1e-7, 1.5e-4, 0.011, 0.03, 0.2];
    let overlaps = overlaps.into_iter().chain(std::iter::repeat(3e-4));
    for (contact, overlap) in moment.contacts.iter_mut().zip(overlaps) {
        contact.gap = -overlap * 2.0 * RADIUS;
    }
    let forces = filled(&histogram(&moment, "normal_force"));
    // The mean ⟨|N|⟩ is 10 N, so all weak contacts are in the first bin of positive forces.
    assert_eq!(forces, [(f64::NEG_INFINITY, 1), (0.0, 20), (8.0, 1)]);
    let below = (f64::NEG_INFINITY, 1);
    let pressed = [(0.0, 2), (1e-7, 1), (1e-4, 1), (2e-4, 14), (1e-2, 1), (2e-2, 1), (1e-1, 1)];
    assert_eq!(filled(&histogram(&moment, "overlap")), [&[below], pressed.as_slice()].concat());
}

fn row(places: &[f64]) -> Vec<GrainState> {
    places.iter().map(|&x| disc(DVec2::new(x, 0.0), 0.5)).collect()
}

fn missing(pile: &PileMeasures) -> Vec<&'static str> {
    let columns = PileMeasures::COLUMNS.iter();
    columns.filter(|column| column.value.number(pile).is_none()).map(|column| column.name).collect()
}

#[test]
fn columns_are_the_fields() {
    let MomentMeasures { pile, grains, .. } = measure(&discs(row(&[0.0])));
    let of_pile: Vec<_> = PileMeasures::COLUMNS.iter().map(|column| column.name).collect();
    let of_grain: Vec<_> = GrainMeasures::COLUMNS.iter().map(|column| column.name).collect();
    for (row, names) in
        [(serde_json::to_value(pile), of_pile), (serde_json::to_value(grains[0]), of_grain)]
    {
        let row = row.expect("a row");
        let mut fields: Vec<&str> =
            row.as_object().expect("fields").keys().map(String::as_str).collect();
        let mut names = names;
        fields.sort_unstable();
        names.sort_unstable();
        assert_eq!(names, fields);
    }
    for column in PileMeasures::COLUMNS {
        let ColumnSpec { name, unit, about, .. } = column;
        assert!(["1", "m²", "N", "N/m", "degree"].contains(unit), "{name} in {unit}");
        assert!(about.ends_with('.') && !about.contains("  ") && about.trim() == *about, "{about}");
    }
}

#[test]
fn nothing_has_no_measures() {
    let mut all_lost = discs(row(&[0.0, 1.0]));
    touch(&mut all_lost, [0, 1], [1.0, 0.0]);
    all_lost.grains.iter_mut().for_each(|grain| grain.lost = true);
    for moment in [discs(Vec::new()), all_lost] {
        let measured = measure(&moment);
        assert_eq!((measured.pile.grains, measured.pile.contacts), (0, 0));
        assert_eq!((measured.pile.clusters, measured.pile.rattlers), (0, 0));
        assert_eq!(measured.pile.area, 0.0);
        assert!(measured.pile.pressure.is_nan() && measured.pile.box_area.is_nan());
        assert!(
            measured.histograms.iter().all(|found| found.counts.iter().all(|&count| count == 0))
        );
        for grain in &measured.grains {
            assert_eq!((grain.coordination, grain.rattler), (0, false));
            assert!(grain.pressure.is_nan() && grain.cell_area.is_nan());
        }
    }
}

#[test]
fn a_disc_alone_bears_nothing() {
    let pile = PileMeasures::of(&discs(row(&[3.0])));
    assert_eq!((pile.pressure, pile.deviator, pile.kinetic_pressure), (0.0, 0.0, 0.0));
    assert_eq!((pile.coordination, pile.rattlers, pile.clusters), (0.0, 1, 1));
    let of_contacts = "principal_direction fabric_xx fabric_xy fabric_yy fabric_anisotropy fabric_direction \
        coordination_without_rattlers solid_fraction_cells sliding_share open_share tensile_share mean_normal_force \
        normal_force_second_moment normal_force_third_moment largest_normal_force strong_share";
    assert_eq!(missing(&pile).join(" "), of_contacts);
}

#[test]
fn discs_on_a_line_have_the_box_around_them() {
    let mut line = discs(row(&[0.0, 1.0, 2.0, 3.0]));
    for pair in [[1, 0], [2, 1], [3, 2]] {
        touch(&mut line, pair, [4.0, 0.0]);
    }
    let pile = PileMeasures::of(&line);
    assert_close(pile.area, 4.0, EXACT, "A");
    assert_close(pile.stress_xx, 3.0, EXACT, "three forces of 4 N over 1 m each, by 4 m²");
    assert_eq!((pile.stress_yy, pile.stress_xy, pile.closed_cells), (0.0, 0.0, 0));
    // A scene in one dimension must have measured quantities, too.
    let mut cradle = built_in("cradle").expect("the cradle").simulation().expect("a run");
    cradle.take_steps(50).expect("finite steps");
    let pile = PileMeasures::of(&cradle.moment());
    assert!(pile.area > 0.0 && pile.pressure.is_finite() && pile.coordination > 0.0, "{pile:?}");
}

#[test]
fn discs_in_one_place_share_one_cell() {
    for count in [2, 5] {
        let measured = measure(&discs(row(&vec![1.5; count])));
        assert_close(measured.pile.area, 1.0, EXACT, "A");
        assert_close(measured.grains[0].cell_area, 1.0, EXACT, "the first has all");
        assert!(measured.grains[1..].iter().all(|grain| grain.cell_area == 0.0));
    }
    // A small disc inside a large disc, at its centre or off the centre, has no cell. Both discs have contacts.
    for x in [0.0, 1e-300, 0.1] {
        let mut two = discs(vec![disc(DVec2::ZERO, 1.0), disc(DVec2::new(x, 0.0), 0.2)]);
        two.contacts.clear();
        let measured = measure(&two);
        assert_close(measured.pile.area, 4.0, EXACT, "A");
        assert_eq!(measured.grains[1].cell_area, 0.0);
        assert!(measured.grains[1].pressure.is_nan());
    }
}

#[test]
fn what_no_simulation_makes_is_left_out() {
    let mut moment = discs(row(&[0.0, 1.0, 2.0]));
    touch(&mut moment, [1, 0], [1.0, 0.0]);
    let whole = measure(&moment);
    let mut strange = moment.clone();
    strange.grains.push(disc(DVec2::new(f64::NAN, 0.0), 0.5));
    strange.grains.push(disc(DVec2::new(f64::INFINITY, 0.0), 0.5));
    for other in [OtherBody::Grain(3), OtherBody::Grain(70)] {
        let contact = strange.contacts[0];
        strange.contacts.push(ContactState { other, ..contact });
        strange.contacts.push(ContactState { grain: 71, ..contact });
    }
    let measured = measure(&strange);
    // The comparison is by text, because NaN is not equal to NaN.
    assert_eq!(format!("{:?}", measured.pile), format!("{:?}", whole.pile));
    assert_eq!(measured.histograms, whole.histograms);
}

#[test]
fn walls_without_length_and_far_places_do_no_harm() {
    let point = DVec2::new(0.0, 0.1);
    let nothing = vec![
        Boundary::Segment { from: point, to: point },
        Boundary::Polyline { points: vec![point; 3] },
        plane(DVec2::new(0.0, -0.5), DVec2::ZERO),
    ];
    let areas = |moment: &Moment| {
        let measured = GrainMeasures::of_each(moment);
        measured.iter().map(|grain| grain.cell_area).collect::<Vec<f64>>()
    };
    let cut = areas(&among(discs(row(&[0.0, 1.0])), nothing, Vec::new()));
    assert!(cut.iter().all(|area| area.is_finite()), "{cut:?}");
    let far = areas(&discs(row(&[1e7, 1e7 + 1.0, -1e9])));
    for area in &far[..2] {
        assert!((area - 1.0).abs() < 2.0, "{far:?}");
    }
}
