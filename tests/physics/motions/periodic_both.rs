//! Borders that wrap below and above, too: as those at the sides do, and both at once.

use super::periodic::{at_rest_on_discs, in_cell, sliding};
use super::{saved_and_read, through_a_file};
use crate::common::*;
use slump::data::{FormatName, Recording, RunFacts};

/// Side of a square cell, m.
const SIDE: f64 = 0.1;
const SQUARE: Periodic = Periodic::along_both([0.0, SIDE], [0.0, SIDE]);

/// The scene turned by +90°: its left is below, and what it has below is at its right.
fn turned(scene: &Scene) -> Scene {
    let mut turned = scene.clone();
    for grain in &mut turned.grains {
        (grain.position, grain.velocity) = (grain.position.perp(), grain.velocity.perp());
    }
    turned.fixed_discs.iter_mut().for_each(|disc| disc.position = disc.position.perp());
    for boundary in &mut turned.boundaries {
        let Boundary::HalfSpace { point, normal } = boundary else { panic!("half-spaces alone") };
        (*point, *normal) = (point.perp(), normal.perp());
    }
    if let Gravity::Uniform { acceleration } = &mut turned.gravity {
        *acceleration = acceleration.perp();
    }
    turned.periodic = scene.periodic.map(|cell| Periodic { y: cell.x, ..Periodic::default() });
    turned
}

#[test]
fn a_scene_turned_by_a_right_angle_does_what_it_did() {
    let (mut scene, width) = at_rest_on_discs();
    scene.parameters.bond = 2.0;
    for (stepper, method) in every_way() {
        (scene.stepper, scene.solver.method) = (stepper, method);
        for shift in [0.0, 0.5, 0.81] {
            let cell = in_cell(&scene, [-0.5 * width, width], shift * width);
            let [mut one, mut other] =
                [cell.clone(), through_a_file(&turned(&cell))].map(|scene| start(&scene));
            for step in 0..60 {
                take_steps(&mut one, 1);
                take_steps(&mut other, 1);
                for (one, other) in one.places().iter().zip(other.places()) {
                    let off = one.perp().distance(*other) / scene.mean_diameter;
                    assert!(off < 1e-6, "{stepper} {method} {shift} {step}: {off} d");
                }
            }
        }
    }
}

/// A gas that nothing bounds: discs of one or of very different sizes.
fn gas(small: f64) -> Scene {
    let mut random = random(5);
    let diameter = 0.01;
    let grains = (0..80).map(|k| {
        let place = DVec2::new(0.5 + f64::from(k % 10), 0.6 + 1.2 * f64::from(k / 10));
        let mut component = || random.random_range(-1.0..=1.0);
        let velocity = DVec2::new(component() + 0.5, component() - 0.3);
        let radius = 0.5 * diameter * if k % 3 == 0 { small } else { 0.95 };
        moving(diameter * place, radius, velocity)
    });
    let mut scene =
        scene(Physics::FULL, DVec2::ZERO, parameters(0.0, 1e-4, 1.0, 0.0), grains.collect());
    scene.mean_diameter = diameter;
    scene.solver.tolerance = 1e-12;
    scene.periodic = Some(SQUARE);
    scene
}

fn momentum(run: &Simulation) -> DVec2 {
    let grains = run.grains();
    grains.masses.iter().zip(&grains.velocities).map(|(mass, velocity)| *mass * *velocity).sum()
}

#[test]
fn a_gas_without_bounds_keeps_momentum_and_energy() {
    for small in [0.9, 0.15] {
        let mut run = start(&gas(small));
        let (before, mut crossings) = (momentum(&run), [0; 2]);
        take_steps(&mut run, 1);
        let energy = run.observables().kinetic_energy;
        for _ in 0..3000 {
            let places = run.grains().positions.clone();
            take_steps(&mut run, 1);
            let now = run.places();
            assert!(now.iter().all(|place| place.cmpge(DVec2::ZERO).all()));
            assert!(now.iter().all(|place| place.cmplt(DVec2::splat(SIDE)).all()));
            for (old, new) in places.iter().zip(now) {
                for axis in [0, 1] {
                    crossings[axis] += u32::from((old[axis] - new[axis]).abs() > 0.5 * SIDE);
                }
            }
        }
        assert!(crossings.iter().all(|count| *count > 100), "{crossings:?}");
        let after = momentum(&run);
        assert!(after.distance(before) < 1e-12 * before.length(), "{before} {after}");
        assert_close(run.observables().kinetic_energy, energy, 1e-9, "the energy");
        assert_eq!(run.observables().lost_grains, 0);
        assert!(run.observables().max_overlap < 0.05, "{:?}", run.observables());
    }
}

#[test]
fn every_pair_in_touch_is_found_across_both_borders_and_none_twice() {
    for small in [0.9, 0.15] {
        let mut run = start(&gas(small));
        let mut found_across = [0; 3];
        for _ in 0..1500 {
            let grains = run.grains().clone();
            take_steps(&mut run, 1);
            let mut expected = Vec::new();
            for i in 0..grains.len() {
                for j in i + 1..grains.len() {
                    let apart = grains.positions[i] - grains.positions[j];
                    let offset = apart - SIDE * (apart / SIDE).round();
                    if offset.length() - grains.radii[i] - grains.radii[j] < 0.0 {
                        let is_far = apart.abs().cmpgt(DVec2::splat(0.5 * SIDE));
                        found_across[0] += u32::from(is_far.x);
                        found_across[1] += u32::from(is_far.y);
                        found_across[2] += u32::from(is_far.all());
                        expected.push((i as u32, j as u32));
                    }
                }
            }
            let contacts = run.contacts().contacts().iter();
            let found: Vec<_> = contacts.map(|contact| (contact.grain, contact.other)).collect();
            assert_eq!(found, expected);
        }
        assert!(found_across[..2].iter().all(|count| *count > 20), "{found_across:?}");
    }
}

/// Two discs that meet, moved by a shift in a square cell.
fn pair(shift: DVec2) -> Scene {
    let at = |x: f64, y: f64, speed: f64| {
        moving(SQUARE.wrap(DVec2::new(x, y) + shift), 0.01, speed * DVec2::ONE)
    };
    let grains = vec![at(-0.0073, -0.0071, 0.3), at(0.0073, 0.0072, -0.1)];
    let mut pair = scene(Physics::FULL, DVec2::ZERO, parameters(0.0, 1e-3, 0.5, 0.4), grains);
    pair.periodic = Some(SQUARE);
    pair
}

#[test]
fn a_pair_that_meets_across_a_corner_is_a_pair_that_meets_inside() {
    for (stepper, method) in every_way() {
        let run = |shift: DVec2| {
            let mut scene = pair(shift);
            (scene.stepper, scene.solver.method) = (stepper, method);
            let run = after(&through_a_file(&scene), 20);
            run.grains().clone()
        };
        let inside = run(DVec2::splat(0.05));
        assert!(inside.velocities[0].x < 0.29, "{stepper} {method}: they met");
        for shift in [DVec2::ZERO, DVec2::new(0.05, 0.0), DVec2::new(0.0, 0.05)] {
            let across = run(shift);
            for k in 0..2 {
                let [one, other] = [&inside, &across].map(|grains| grains.velocities[k]);
                assert!(one.distance(other) < 1e-12, "{stepper} {method}: {one} {other}");
                let [one, other] = [&inside, &across].map(|grains| grains.angular_velocities[k]);
                assert!((one - other).abs() < 1e-9, "{stepper} {method}: {one} {other} rad/s");
            }
        }
    }
}

/// Grains that fall without end past a fixed disc and one that is drawn upward.
fn falling(bond: f64) -> Scene {
    let mut scene = gas(0.9);
    scene.gravity = Gravity::Uniform { acceleration: -9.8 * DVec2::Y };
    scene.parameters = parameters(bond, 2e-4, 0.3, 0.5);
    scene.solver.tolerance = 1e-8;
    let disc = |x: f64, y: f64| crate::common::fixed(DVec2::new(x, y), 0.003);
    scene.grains.retain(|grain| {
        [0.03, 0.07].iter().all(|x| (grain.position - DVec2::new(*x, 0.099)).length() > 0.01)
    });
    scene.fixed_discs = vec![disc(0.03, 0.099), disc(0.07, 0.099)];
    scene.motions = vec![Motion {
        fixed_discs: vec![1],
        course: Some(straight(0.2 * DVec2::Y)),
        ..Motion::default()
    }];
    scene
}

#[test]
fn a_run_goes_on_from_a_file_bit_for_bit_and_loses_no_grain_that_falls_round() {
    for stepper in Stepper::ALL {
        let scene = Scene { stepper: *stepper, ..falling(5.0) };
        let mut run = after(&scene, 400);
        let mut read = saved_and_read(&scene, &run).simulation;
        take_steps(&mut run, 200);
        take_steps(&mut read, 200);
        assert_eq!(run.world(), read.world(), "{stepper}");
        assert_eq!(run.observables().lost_grains, 0, "{stepper}");
    }
    let mut still = falling(0.0);
    still.motions.clear();
    let run = after(&still, 600);
    assert_eq!(run.observables().lost_grains, 0, "nothing moves by itself");
}

#[test]
fn measures_and_recordings_know_of_both_borders() {
    let mut scene = gas(0.9);
    scene.parameters.restitution = 0.5;
    let run = after(&scene, 50);
    let moved = |by: DVec2| {
        let mut moment = run.moment();
        moment
            .grains
            .iter_mut()
            .for_each(|grain| grain.position = SQUARE.wrap(grain.position + by));
        measure(&moment)
    };
    let one = moved(DVec2::ZERO);
    assert_close(one.pile.box_area, SIDE * SIDE, 1e-12, "the box is the cell");
    assert!(one.pile.closed_cells > 20, "{:?}", one.pile);
    for by in [DVec2::new(0.02, 0.07), DVec2::splat(0.05)] {
        let other = moved(by);
        assert_close(other.pile.area, one.pile.area, 1e-9, "the area of all cells");
        assert_eq!(other.pile.closed_cells, one.pile.closed_cells);
    }
    let folder = tempfile::tempdir().expect("a folder");
    let place = folder.path().join("run");
    let about: RunFacts = slump::config::scene_facts(&scene).expect("facts");
    let mut recording = Recording::start(&place, FormatName::ALL, &about, false).expect("a start");
    recording.add(run.moment()).expect("a frame");
    recording.finish().expect("an end");
    let dump = std::fs::read_to_string(place.join("ovito/grains.dump")).expect("a dump");
    assert!(dump.contains("ITEM: BOX BOUNDS pp pp ss\n0.0 0.1\n0.0 0.1\n"), "{dump}");
}

#[test]
fn cells_that_cannot_be_are_refused_in_one_sentence() {
    let of = |cell: Periodic, boundaries: Vec<Boundary>, axes: u8| {
        let grain = Grain::at_rest(DVec2::new(0.2, 0.0), 0.1);
        let physics = if axes == 1 { LINE } else { Physics::FULL };
        let mut scene = scene(physics, DVec2::ZERO, parameters(0.0, 1e-3, 0.0, 0.5), vec![grain]);
        scene.boundaries = boundaries;
        scene.periodic = Some(cell);
        scene.simulation().map(|_| ()).expect_err("no such cell").to_string()
    };
    let along_y = |y: [f64; 2]| Periodic { y: Some(y), ..Periodic::default() };
    assert_eq!(
        of(along_y([0.0, 0.5]), vec![], 2),
        "periodic.y is [0, 0.5], but must be at least 0.6000000000000001 m high: 3 times the largest diameter, \
         and twice as far as discs feel each other"
    );
    let said = of(Periodic::along_both([0.0, 0.5], [0.0, 1.0]), vec![], 2);
    assert!(said.starts_with("periodic.x is [0, 0.5], but"), "{said}");
    assert_eq!(
        of(along_y([0.0, 1.0]), vec![level()], 2),
        "boundaries[0] is a half-space that does not go on across it, but must be upright, or between the borders of \
         periodic.y"
    );
    assert_eq!(
        of(Periodic::default(), vec![], 2),
        "periodic is without borders, but must be given with x, y or both"
    );
    let said = of(along_y([0.0, 1.0]), vec![], 1);
    assert_eq!(said, "periodic.y is given, but must be left out where physics.axes is 1");
    let segment = Boundary::Segment { from: DVec2::ZERO, to: DVec2::new(0.0, 1.1) };
    let said = of(along_y([0.0, 1.0]), vec![segment], 2);
    assert!(said.starts_with("boundaries[0] is a segment that does not go on"), "{said}");
    // Two in one place across the lower border alone, and across a corner.
    for places in
        [[DVec2::new(0.5, 0.99), DVec2::new(0.5, 0.01)], [DVec2::splat(0.99), DVec2::ZERO]]
    {
        let mut twins = sliding(0.0);
        twins.grains = places.map(|place| Grain::at_rest(place, 0.1)).into();
        (twins.fixed_discs, twins.motions) = (vec![], vec![]);
        twins.periodic = None;
        start(&twins);
        twins.periodic = Some(Periodic::along_both([0.0, 1.0], [0.0, 1.0]));
        let said = twins.simulation().map(|_| ()).expect_err("in one place").to_string();
        assert!(said.contains("from that of grains[0]"), "{said}");
    }
}
