//! Moments of which little or nothing can be said: no panic, and no number that means nothing.

use crate::common::*;

use super::by_hand::{among, disc, discs, touch};

const EXACT: f64 = 1e-12;

fn row(places: &[f64]) -> Vec<GrainState> {
    places.iter().map(|&x| disc(DVec2::new(x, 0.0), 0.5)).collect()
}

/// Columns that are no number.
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
    // A scene with one axis.
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
    // A small disc within a large one, at its centre and beside it, has no cell; both bear contacts.
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
    // NaN is not NaN, but reads as it does.
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
