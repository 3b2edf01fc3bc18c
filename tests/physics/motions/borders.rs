//! What else knows of borders that wrap: measures, recordings, walls beside them, and what is refused.

use super::periodic::sliding;
use crate::common::*;
use slump::data::{FormatName, Recording, RunFacts, read_grains};

#[test]
fn measures_of_a_packing_do_not_depend_on_where_the_border_is() {
    let run = after(&sliding(0.0), 200);
    let state = |shift: f64| {
        let (mut moment, cell) = (run.moment(), run.world().periodic.expect("a cell"));
        let by = shift * cell.periods()[0].expect("a width") * DVec2::X;
        moment.grains.iter_mut().for_each(|grain| grain.position = cell.wrap(grain.position + by));
        let around = std::sync::Arc::make_mut(&mut moment.surroundings);
        around
            .fixed_discs
            .iter_mut()
            .for_each(|disc| disc.position = cell.wrap(disc.position + by));
        measure(&moment)
    };
    let one = state(0.0);
    assert!(one.pile.closed_cells > 5, "{:?}", one.pile);
    for shift in [0.2, 0.5, 0.77] {
        let other = state(shift);
        let found = |measured: &MomentMeasures| {
            let pile = &measured.pile;
            let of_grains = measured.grains.iter().flat_map(|grain| [grain.solid_fraction]);
            [pile.area, pile.box_area, pile.stress_yy, pile.stress_xy, pile.solid_fraction_cells]
                .into_iter()
                .chain(of_grains)
                .collect::<Vec<f64>>()
        };
        for (k, (one, other)) in found(&one).into_iter().zip(found(&other)).enumerate() {
            assert!(one.is_nan() == other.is_nan(), "{shift}: measure {k}");
            if !one.is_nan() {
                assert_close(other, one, 1e-9, &format!("measure {k} moved by {shift}"));
            }
        }
    }
}

#[test]
fn a_recording_says_where_the_borders_are_and_is_a_start() {
    let scene = sliding(0.0);
    let folder = tempfile::tempdir().expect("a folder");
    let place = folder.path().join("run");
    let about: RunFacts = slump::config::scene_facts(&scene).expect("facts");
    let mut recording = Recording::start(&place, FormatName::ALL, &about, false).expect("a start");
    let run = after(&scene, 100);
    recording.add(run.moment()).expect("a frame");
    recording.finish().expect("an end");
    let dump = std::fs::read_to_string(place.join("ovito/grains.dump")).expect("a dump");
    let [left, right] = scene.periodic.expect("a cell").x.expect("borders");
    let bounds = format!("ITEM: BOX BOUNDS pp ss ss\n{left:?} {right:?}\n");
    assert!(dump.contains(&bounds), "{}", &dump[..2000.min(dump.len())]);
    let said = std::fs::read_to_string(place.join("data.json")).expect("a manifest");
    assert!(said.contains("periodic"), "{said}");
    let read = read_grains(&place, None).expect("grains").grains;
    let places: Vec<DVec2> = read.iter().map(|grain| grain.position).collect();
    assert_eq!(places, run.grains().positions);
}

#[test]
fn a_wall_at_the_border_that_a_grain_goes_through_across_it_is_told_of() {
    let wall = |x: f64| Boundary::Segment { from: DVec2::new(x, -1.0), to: DVec2::new(x, 1.0) };
    let grain = moving(DVec2::new(0.995, 0.0), 0.002, 40.0 * DVec2::X);
    let of = |boundaries: Vec<Boundary>| {
        let mut scene =
            scene(Physics::FULL, DVec2::ZERO, parameters(0.0, 1e-3, 0.0, 0.0), vec![grain.clone()]);
        scene.periodic = Some(Periodic::along_x([0.0, 1.0]));
        scene.boundaries = boundaries;
        scene
    };
    let lost = |scene: &Scene| {
        let run = after(scene, 1);
        (run.observables().lost_grains, run.place(0).x)
    };
    let (count, x) = lost(&of(vec![wall(0.5)]));
    assert!(count == 0 && x < 0.05, "it crosses the border and nothing else: {x}");
    // The wall stands beyond the border, on either side of which the way is looked at, and before it.
    assert_eq!(lost(&of(vec![wall(0.017)])).0, 1);
    assert_eq!(lost(&of(vec![wall(0.999)])).0, 1);
}

#[test]
fn a_disc_hits_a_wall_beyond_the_border() {
    for (from, speed, wall) in [(0.89, 1.0, 0.02), (0.11, -1.0, 0.98)] {
        let grain = moving(DVec2::new(from, 0.0), 0.1, speed * DVec2::X);
        let mut scene =
            scene(Physics::FULL, DVec2::ZERO, parameters(0.0, 1e-3, 0.5, 0.0), vec![grain]);
        scene.periodic = Some(Periodic::along_x([0.0, 1.0]));
        let ends = [-1.0, 1.0].map(|y| DVec2::new(wall, y));
        scene.boundaries = vec![Boundary::Segment { from: ends[0], to: ends[1] }];
        let run = after(&scene, 60);
        assert_close(run.velocity(0).x, -0.5 * speed, 1e-12, "the bounce");
        assert_eq!(run.observables().lost_grains, 0);
    }
}

#[test]
fn a_disc_rolls_over_a_floor_that_ends_at_the_borders_as_over_one_without_end() {
    let ends = [DVec2::ZERO, DVec2::X];
    let floor = Boundary::Segment { from: ends[0], to: ends[1] };
    let run = |floor: Boundary| {
        let grain = moving(DVec2::new(0.9, 0.0999), 0.1, DVec2::X);
        let gravity = -9.8 * DVec2::Y;
        let mut scene = scene(Physics::FULL, gravity, parameters(0.0, 1e-3, 0.0, 0.5), vec![grain]);
        scene.periodic = Some(Periodic::along_x([0.0, 1.0]));
        scene.boundaries = vec![floor];
        let run = after(&scene, 400);
        run
    };
    let [one, other] = [floor, level()].map(run);
    let [one, other] = [&one, &other].map(|run| run.place(0));
    assert!(one.distance(other) < 1e-9, "{one} {other}");
    assert!(one.x < 0.5, "it crossed: {one}");
}

#[test]
fn cells_that_cannot_be_are_refused_in_one_sentence() {
    let of = |x: [f64; 2], boundary: Boundary, motions: Vec<Motion>| {
        let grain = Grain::at_rest(DVec2::new(0.2, 0.5), 0.1);
        let physics = Physics::FULL;
        let mut scene =
            scene(physics, -9.8 * DVec2::Y, parameters(0.0, 1e-3, 0.0, 0.5), vec![grain]);
        (scene.boundaries, scene.motions) = (vec![boundary], motions);
        scene.periodic = Some(Periodic::along_x(x));
        scene.simulation().map(|_| ()).expect_err("no such cell").to_string()
    };
    assert_eq!(
        of([0.0, 0.5], level(), vec![]),
        "periodic.x is [0, 0.5], but must be at least 0.6000000000000001 m wide: 3 times the largest diameter, \
         and twice as far as discs feel each other"
    );
    assert!(of([1.0, -1.0], level(), vec![]).starts_with("periodic.x is [1, -1], but must be at"));
    let said = of([0.0, f64::NAN], level(), vec![]);
    assert_eq!(said, "periodic.x is [0, NaN], but must be two finite numbers of m");
    let wall = plane(DVec2::ZERO, DVec2::X);
    assert_eq!(
        of([0.0, 1.0], wall, vec![]),
        "boundaries[0] is a half-space that does not go on across it, but must be level, or between the borders of \
         periodic.x"
    );
    let segment = |to: f64| Boundary::Segment { from: DVec2::ZERO, to: DVec2::new(to, 0.0) };
    assert!(of([0.0, 1.0], segment(1.1), vec![]).starts_with("boundaries[0] is a segment that"));
    let aside = goes(&[0], straight(DVec2::X));
    assert!(of([0.0, 1.0], segment(0.9), vec![aside]).starts_with("motions[0].course is along x"));
    let turn = MotionCourse::Rotation { pivot: DVec2::ZERO, rate: 1.0, travel: None };
    let said = of([0.0, 1.0], segment(0.9), vec![goes(&[0], turn)]);
    assert!(said.starts_with("motions[0].course is round a pivot, but must be"), "{said}");
}

#[test]
fn two_discs_in_one_place_across_the_border_are_refused() {
    let grain = |x: f64| Grain::at_rest(DVec2::new(x, 0.0), 0.1);
    let mut scene = scene(
        Physics::FULL,
        DVec2::ZERO,
        parameters(0.0, 1e-3, 0.0, 0.0),
        vec![grain(0.99), grain(0.01)],
    );
    start(&scene);
    scene.periodic = Some(Periodic::along_x([0.0, 1.0]));
    let said = scene.simulation().map(|_| ()).expect_err("in one place").to_string();
    assert!(said.contains("from that of grains[0]"), "{said}");
}
