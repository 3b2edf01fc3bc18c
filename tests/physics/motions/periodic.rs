//! Borders that wrap: nothing depends on where they are, and nothing is lost across them.

use super::{saved_and_read, through_a_file};
use crate::common::*;

/// The scene with a cell of this width whose left border is at `left`, and all discs moved by `shift`, m.
pub(super) fn in_cell(scene: &Scene, [left, width]: [f64; 2], shift: f64) -> Scene {
    let cell = Periodic::along_x([left, left + width]);
    let mut scene = Scene { periodic: Some(cell), ..scene.clone() };
    let fixed = scene.fixed_discs.iter_mut().map(|disc| &mut disc.position);
    for place in scene.grains.iter_mut().map(|grain| &mut grain.position).chain(fixed) {
        *place = cell.wrap(*place + shift * DVec2::X);
    }
    scene
}

/// Longest distance, m, of a grain in a run from where the same one is in another that was moved by `shift`.
fn farthest(one: &Simulation, other: &Simulation, shift: f64) -> f64 {
    let cell = one.world().periodic.or(other.world().periodic).expect("a cell");
    let [one, other] = [one, other].map(|run| run.places());
    let ways = one.iter().zip(other).map(|(one, other)| *one + shift * DVec2::X - *other);
    ways.map(|way| cell.shortest(way).length()).fold(0.0, f64::max)
}

/// A scene in which every grain comes to where no other solution leads, on discs and on the level, 16 d wide.
pub(super) fn at_rest_on_discs() -> (Scene, f64) {
    let mut scene = at_rest_and_falling();
    scene.boundaries = vec![level()];
    let below = |grain: &Grain| fixed(grain.position - (grain.radius + 0.02) * DVec2::Y, 0.02);
    scene.fixed_discs = scene.grains[3..].iter().map(below).collect();
    let width = 20.0 * scene.mean_diameter;
    (scene, width)
}

#[test]
fn a_packing_moved_across_the_border_goes_the_same_way() {
    let (mut scene, width) = at_rest_on_discs();
    for (stepper, method) in every_way() {
        (scene.stepper, scene.solver.method) = (stepper, method);
        for bond in [0.0, 2.0] {
            scene.parameters.bond = bond;
            let mut still = start(&scene);
            // Far from both borders nothing is other than without them, to the last bit.
            let mut inside = start(&in_cell(&scene, [-0.75 * width, 1.5 * width], 0.0));
            let shifts = [0.37, 0.5, 0.81].map(|part| part * width);
            let moved = |shift| start(&in_cell(&scene, [-0.5 * width, width], shift));
            let mut moved = shifts.map(|shift| (shift, moved(shift)));
            for step in 0..60 {
                take_steps(&mut still, 1);
                take_steps(&mut inside, 1);
                assert_eq!(
                    still.world().grains,
                    inside.world().grains,
                    "{stepper} {method} {step}"
                );
                for (shift, moved) in &mut moved {
                    take_steps(moved, 1);
                    let off = farthest(&still, moved, *shift) / scene.mean_diameter;
                    // Under range a gap of 1e-4 d is as good as none, and a grain comes to rest with it or without.
                    let rests = if stepper == Stepper::Range { 1.1e-4 } else { 1e-6 };
                    assert!(off < rests, "{stepper} {method} {bond}, {shift} m, {step}: {off} d");
                }
            }
        }
    }
}

#[test]
fn a_pair_that_meets_across_the_border_is_a_pair_that_meets_inside() {
    let (radius, width) = (0.01, 0.25);
    let at = |x: f64, y: f64, speed: f64| moving(DVec2::new(x, y), radius, speed * DVec2::X);
    for (stepper, method) in every_way() {
        let mut met = Vec::new();
        for shift in [0.0, 0.12] {
            let parameters = parameters(0.0, 1e-3, 0.5, 0.4);
            let mut pair = scene(
                Physics::FULL,
                DVec2::ZERO,
                parameters,
                vec![at(-0.0102, 0.0, 0.3), at(0.0102, 0.004, -0.1)],
            );
            (pair.stepper, pair.solver.method) = (stepper, method);
            let run = after(&through_a_file(&in_cell(&pair, [-0.12, width], shift)), 20);
            let grains = run.grains();
            assert!(grains.velocities[0].x < 0.29, "{stepper} {method} {shift}: they met");
            met.push((grains.velocities.clone(), grains.angular_velocities.clone()));
        }
        for (one, other) in met[0].0.iter().zip(&met[1].0) {
            assert!(one.distance(*other) < 1e-12, "{stepper} {method}: {one} {other}");
        }
        for (one, other) in met[0].1.iter().zip(&met[1].1) {
            assert!((one - other).abs() < 1e-9, "{stepper} {method}: {one} {other} rad/s");
        }
    }
}

/// A gas between a floor and a ceiling that do not rub: discs of one or of very different sizes.
fn gas(small: f64) -> Scene {
    let mut random = random(5);
    let diameter = 0.01;
    let grains = (0..80).map(|k| {
        let place = DVec2::new(0.5 + f64::from(k % 10), 0.6 + 1.1 * f64::from(k / 10));
        let mut component = || random.random_range(-1.0..=1.0);
        let velocity = DVec2::new(component() + 0.5, component());
        let radius = 0.5 * diameter * if k % 3 == 0 { small } else { 0.95 };
        moving(diameter * place, radius, velocity)
    });
    let mut scene =
        scene(Physics::FULL, DVec2::ZERO, parameters(0.0, 1e-4, 1.0, 0.0), grains.collect());
    let ceiling = plane(0.1 * DVec2::Y, DVec2::NEG_Y);
    scene.boundaries = vec![level(), ceiling];
    scene.mean_diameter = diameter;
    scene.periodic = Some(Periodic::along_x([0.0, 0.1]));
    scene
}

#[test]
fn the_momentum_of_a_gas_along_its_period_stays_and_no_grain_is_lost() {
    for small in [0.9, 0.15] {
        let mut run = start(&gas(small));
        let momentum = |run: &Simulation| -> f64 {
            let grains = run.grains();
            grains.masses.iter().zip(&grains.velocities).map(|(mass, v)| mass * v.x).sum()
        };
        let (before, mut crossings) = (momentum(&run), 0);
        for _ in 0..3000 {
            let places = run.grains().positions.clone();
            take_steps(&mut run, 1);
            let now = run.places();
            assert!(now.iter().all(|place| (0.0..0.1).contains(&place.x)));
            let jumps = places.iter().zip(now).filter(|(old, new)| (old.x - new.x).abs() > 0.05);
            crossings += jumps.count();
        }
        assert!(crossings > 100, "{crossings}");
        assert_close(momentum(&run), before, 1e-12, "the momentum");
        assert_eq!(run.observables().lost_grains, 0);
        assert!(run.observables().max_overlap < 0.05, "{:?}", run.observables());
    }
}

#[test]
fn every_pair_in_touch_is_found_across_the_border_and_none_twice() {
    for small in [0.9, 0.15] {
        let mut run = start(&gas(small));
        let mut found_across = 0;
        for _ in 0..800 {
            let grains = run.grains().clone();
            take_steps(&mut run, 1);
            let mut expected = Vec::new();
            for i in 0..grains.len() {
                for j in i + 1..grains.len() {
                    let mut offset = grains.positions[i] - grains.positions[j];
                    offset.x -= 0.1 * (offset.x / 0.1).round();
                    if offset.length() - grains.radii[i] - grains.radii[j] < 0.0 {
                        let far = (grains.positions[i].x - grains.positions[j].x).abs() > 0.05;
                        found_across += u32::from(far);
                        expected.push((i as u32, j as u32));
                    }
                }
            }
            let contacts = run.contacts().contacts().iter();
            let pairs = contacts.map(|contact| (contact.grain, contact.other));
            let found: Vec<_> =
                pairs.filter(|(_, other)| (*other as usize) < grains.len()).collect();
            assert_eq!(found, expected);
        }
        assert!(found_across > 20, "{found_across}");
    }
}

#[test]
fn numbers_of_grains_mean_nothing_across_the_border() {
    let (scene, width) = at_rest_on_discs();
    let scene = in_cell(&scene, [-0.5 * width, width], 0.5 * width);
    let mut turned = scene.clone();
    turned.grains.reverse();
    let [mut one, mut other] = [&scene, &turned].map(start);
    take_steps(&mut one, 100);
    take_steps(&mut other, 100);
    let (count, run_cell) = (scene.grains.len(), scene.periodic.expect("a cell"));
    for k in 0..count {
        let [one, other] =
            [(&one, k), (&other, count - 1 - k)].map(|(run, grain)| run.place(grain));
        let off = run_cell.shortest(one - other).length();
        assert!(off < 1e-9 * scene.mean_diameter, "{one} {other}");
    }
}

/// A pile that slides over the border of its cell, on a base that is moved along.
pub(super) fn sliding(bond: f64) -> Scene {
    let mut scene = pressed_pile(36, 0.3, 11, parameters(bond, 5e-4, 0.3, 0.5));
    // Discs of the base touch one another, the last and the first across the border.
    let (left, count) = (scene.fixed_discs[0].position.x, scene.fixed_discs.len());
    let width = count as f64 * 2.0 * scene.fixed_discs[0].radius;
    scene.periodic = Some(Periodic::along_x([left, left + width]));
    scene.motions = vec![Motion {
        fixed_discs: (0..count).collect(),
        course: Some(straight(0.4 * DVec2::X)),
        ..Motion::default()
    }];
    scene
}

#[test]
fn a_run_goes_on_from_a_file_bit_for_bit_across_a_crossing() {
    for stepper in Stepper::ALL {
        let scene = Scene { stepper: *stepper, ..sliding(5.0) };
        let mut run = after(&scene, 40);
        let mut read = saved_and_read(&scene, &run).simulation;
        let before = run.world().clone();
        take_steps(&mut run, 60);
        take_steps(&mut read, 60);
        assert_eq!(run.world(), read.world(), "{stepper}");
        let jumps = |old: &[DVec2], new: &[DVec2]| {
            old.iter().zip(new).filter(|(old, new)| (old.x - new.x).abs() > 0.03).count()
        };
        let discs =
            |run: &World| run.fixed_discs.iter().map(|disc| disc.position).collect::<Vec<_>>();
        assert!(jumps(&discs(&before), &discs(run.world())) > 0, "{stepper}: a disc crossed");
    }
}

#[test]
fn remedies_work_across_the_border() {
    let (mut scene, width) = at_rest_on_discs();
    scene.solver.method = Method::Nsgs;
    for remedies in [
        Remedies { push_out: true, ..Remedies::default() },
        Remedies { speculative: true, ..Remedies::default() },
        Remedies { sequential_impacts: true, ..Remedies::default() },
        Remedies { max_travel: 0.01, ..Remedies::default() },
    ] {
        scene.remedies = remedies;
        let [mut inside, mut across] = [-0.05 * width, 0.4 * width]
            .map(|shift| start(&in_cell(&scene, [-0.5 * width, width], shift)));
        take_steps(&mut inside, 60);
        take_steps(&mut across, 60);
        let off = farthest(&inside, &across, 0.45 * width) / scene.mean_diameter;
        assert!(off < 1e-6, "{remedies:?}: {off} d");
    }
}
