//! Tests of cells that are periodic in x, in y, or in both: results do not depend on the position of the borders.

use super::images::gas;
use super::through_a_file;
use crate::common::*;

/// Returns the scene in a periodic cell of this width (m) with the left border at x = `left`. All discs are moved by
/// `shift` (m) along x.
pub(super) fn in_cell(scene: &Scene, [left, width]: [f64; 2], shift: f64) -> Scene {
    let cell = Periodic::along_x([left, left + width]);
    let mut scene = Scene { periodic: Some(cell), ..scene.clone() };
    let fixed = scene.fixed_discs.iter_mut().map(|disc| &mut disc.position);
    for place in scene.grains.iter_mut().map(|grain| &mut grain.position).chain(fixed) {
        *place = cell.wrap(*place + shift * DVec2::X);
    }
    scene
}

/// Returns the longest distance, m, between a grain of the first run, moved by `shift` along x, and the same grain of
/// the second run. Distances across the borders of the periodic cell count.
fn farthest(one: &Simulation, other: &Simulation, shift: f64) -> f64 {
    let cell = one.world().periodic.or(other.world().periodic).expect("a cell");
    let [one, other] = [one, other].map(|run| run.places());
    let ways = one.iter().zip(other).map(|(one, other)| *one + shift * DVec2::X - *other);
    ways.map(|way| cell.shortest(way).length()).fold(0.0, f64::max)
}

/// Returns a scene of grains on a floor and on discs that are not grains, and the width of a periodic cell for this
/// scene, m (20 mean diameters). Each grain can come to rest at only one position.
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
            // If all grains are far from both borders, the run is bitwise equal to the run without borders.
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
                    // Under `range` a gap of up to 1e-4 d counts as a contact, so the gap of a grain at rest can differ
                    // by 1e-4 d.
                    let rests = if stepper == Stepper::Range { 1.1e-4 } else { 1e-6 };
                    assert!(off < rests, "{stepper} {method} {bond}, {shift} m, {step}: {off} d");
                }
            }
        }
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

/// Returns a scene of a pile that slides across the border of its periodic cell, on a moving base.
pub(super) fn sliding(bond: f64) -> Scene {
    let mut scene = pressed_pile(36, 0.3, 11, parameters(bond, 5e-4, 0.3, 0.5));
    // The discs of the base touch one another, and the last disc touches the first across the border.
    let (left, count) = (scene.fixed_discs[0].position.x, scene.fixed_discs.len());
    let width = count as f64 * 2.0 * scene.fixed_discs[0].radius;
    scene.periodic = Some(Periodic::along_x([left, left + width]));
    scene.motions = vec![discs_go(count, straight(0.4 * DVec2::X))];
    scene
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

/// Returns the vector from grain 1 to grain 0, or to the nearest periodic image of grain 0 across the borders, m.
fn offset(run: &Simulation) -> DVec2 {
    let (places, cell) = (run.places(), run.world().periodic.expect("a cell"));
    cell.shortest(places[0] - places[1])
}

#[test]
fn a_bonded_pair_that_circles_does_so_wherever_it_is_in_the_cell() {
    // The stepper `avbd` is omitted. It loses bonds if its iterations do not converge to the pull that the circular
    // motion needs.
    for stepper in Stepper::ALL.iter().filter(|&&stepper| stepper != Stepper::Avbd) {
        let mut pair = under_g(
            parameters(20.0, 2e-4, 0.5, 0.5),
            vec![
                moving(DVec2::new(-0.00999, 0.0), 0.01, DVec2::new(0.2, 0.35)),
                moving(DVec2::new(0.00999, 0.0), 0.01, DVec2::new(0.2, 0.05)),
            ],
        );
        pair.stepper = *stepper;
        pair.parameters.debonding_distance = DISTANCE_IN_DIAMETERS;
        pair.grains.iter_mut().for_each(|grain| grain.feels_gravity = false);
        pair.periodic = Some(SQUARE);
        let run = |at: DVec2| {
            let mut pair = pair.clone();
            pair.grains.iter_mut().for_each(|grain| grain.position += at);
            let mut run = start(&pair);
            let (mut turned, mut before) = (0.0, offset(&run));
            for _ in 0..1000 {
                take_steps(&mut run, 1);
                turned += before.angle_to(offset(&run));
                before = offset(&run);
            }
            (turned, before)
        };
        let (turned, inside) = run(DVec2::new(0.05, 0.02));
        assert!(turned.abs() > 0.5, "{stepper}: it turns: {turned} rad");
        assert!((inside.length() / 0.02 - 1.0).abs() < 0.02, "{stepper}: it holds: {inside}");
        for at in [DVec2::ZERO, DVec2::new(0.0, 0.05), DVec2::new(0.093, 0.099)] {
            let (of_other, across) = run(at);
            assert!(across.distance(inside) < 1e-10, "{stepper} {at}: {across} {inside}");
            assert!((of_other - turned).abs() < 1e-7, "{stepper} {at}: {of_other} {turned} rad");
        }
    }
}

#[test]
fn grains_that_bounce_under_the_law_range_keep_their_momentum_across_borders() {
    let mut random = random(3);
    let grains = (0..64).map(|k| {
        let place = 0.0125 * DVec2::new(0.5 + f64::from(k % 8), 0.5 + f64::from(k / 8));
        let mut component = || random.random_range(-1.0..=1.0);
        moving(place, 0.0055, DVec2::new(component(), component()))
    });
    let parameters = parameters(5.0, 5e-4, 0.9, 0.3);
    let mut gas = under_g(parameters, grains.collect());
    gas.grains.iter_mut().for_each(|grain| grain.feels_gravity = false);
    gas.parameters.debonding_distance = DISTANCE_IN_DIAMETERS;
    (gas.stepper, gas.periodic) = (Stepper::Range, Some(SQUARE));
    gas.solver = SolverSettings { tolerance: 1e-8, max_sweeps: 2000, ..SolverSettings::SWEEPS };
    let mut run = start(&gas);
    let (before, energy) = (momentum(&run), run.observables().kinetic_energy);
    let mut broken = 0.0;
    for _ in 0..400 {
        let (now, off, _) = balance(&mut run);
        assert!(off < 1e-12 * energy, "{now:?}");
        broken = now.broken_bond_energy.expect("bonds");
    }
    assert!(momentum(&run).distance(before) < 1e-12 * energy.sqrt(), "{}", momentum(&run));
    assert!(broken > 0.0 && run.observables().kinetic_energy < 0.9 * energy, "{broken} J");
    assert!(run.observables().max_overlap < 0.02, "{:?}", run.observables());
}

/// Returns a scene of a disc on a floor under gravity that is inclined to the right by `tilt` (degrees). `periodic` is
/// the periodic cell, if there is one.
fn on_a_slope(stepper: Stepper, tilt: f64, periodic: Option<Periodic>) -> Scene {
    let disc = moving(DVec2::new(0.05, 0.01), 0.01, DVec2::ZERO);
    let mut scene = under_g(parameters(0.0, 5e-4, 0.0, 0.1), vec![disc]);
    (scene.stepper, scene.boundaries, scene.periodic) = (stepper, vec![level()], periodic);
    scene.parameters.tilt = tilt;
    scene.gap_tolerance = 1e-8;
    scene
}

#[test]
fn a_disc_slides_down_a_slope_without_end_as_down_one_that_wraps() {
    let cell = Periodic::along_x([0.0, SIDE]);
    let degrees = 40.0f64;
    let (sin, cos) = degrees.to_radians().sin_cos();
    for &stepper in Stepper::ALL {
        let [mut free, mut wrapped] =
            [None, Some(cell)].map(|periodic| start(&on_a_slope(stepper, degrees, periodic)));
        take_steps(&mut free, 800);
        take_steps(&mut wrapped, 800);
        let [free, wrapped] = [&free, &wrapped].map(|run| run.grains());
        assert!(free.positions[0].x > 4.0 * SIDE, "{stepper}: {}", free.positions[0]);
        assert!(cell.wrap(free.positions[0]).distance(wrapped.positions[0]) < 1e-10, "{stepper}");
        assert!(free.velocities[0].distance(wrapped.velocities[0]) < 1e-10, "{stepper}");
        // The disc slides, because tan 40° is above 3 μ.
        let expected = 9.8 * (sin - 0.1 * cos) * 0.4;
        let tolerance = if stepper == Stepper::Avbd { 2e-2 } else { 2e-3 };
        assert_close(wrapped.velocities[0].x, expected, tolerance, stepper.name());
        assert!(wrapped.angular_velocities[0] < 0.0, "{stepper}: it rolls as well");
    }
}

#[test]
fn a_wall_at_the_border_that_a_grain_goes_through_across_it_is_told_of() {
    let wall = |x: f64| Boundary::Segment { from: DVec2::new(x, -1.0), to: DVec2::new(x, 1.0) };
    let grain = moving(DVec2::new(0.995, 0.0), 0.002, 40.0 * DVec2::X);
    let of = |boundaries: Vec<Boundary>| {
        let mut scene = without_g(parameters(0.0, 1e-3, 0.0, 0.0), vec![grain.clone()]);
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
    // One wall is behind the border and one before it, because Slump must check the path of the grain on both sides of
    // the border.
    assert_eq!(lost(&of(vec![wall(0.017)])).0, 1);
    assert_eq!(lost(&of(vec![wall(0.999)])).0, 1);
}

#[test]
fn a_disc_hits_a_wall_beyond_the_border() {
    for (from, speed, wall) in [(0.89, 1.0, 0.02), (0.11, -1.0, 0.98)] {
        let grain = moving(DVec2::new(from, 0.0), 0.1, speed * DVec2::X);
        let mut scene = without_g(parameters(0.0, 1e-3, 0.5, 0.0), vec![grain]);
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
        after(&scene, 400)
    };
    let [one, other] = [floor, level()].map(run);
    let [one, other] = [&one, &other].map(|run| run.place(0));
    assert!(one.distance(other) < 1e-9, "{one} {other}");
    assert!(one.x < 0.5, "it crossed: {one}");
}

/// Side of the square periodic cell, m.
pub(super) const SIDE: f64 = 0.1;
pub(super) const SQUARE: Periodic = Periodic::along_both([0.0, SIDE], [0.0, SIDE]);

/// Returns the scene turned by +90° (anticlockwise): its left side becomes the bottom, and its bottom becomes the right
/// side.
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

/// Returns a scene of grains that fall endlessly in a periodic cell, past a disc at rest and a disc that moves upward;
/// neither disc is a grain.
pub(super) fn falling(bond: f64) -> Scene {
    let mut scene = gas(0.9, true);
    scene.gravity = Gravity::Uniform { acceleration: -9.8 * DVec2::Y };
    scene.parameters = parameters(bond, 2e-4, 0.3, 0.5);
    scene.solver.tolerance = 1e-8;
    let disc = |x: f64, y: f64| fixed(DVec2::new(x, y), 0.003);
    scene.grains.retain(|grain| {
        [0.03, 0.07].iter().all(|x| (grain.position - DVec2::new(*x, 0.099)).length() > 0.01)
    });
    scene.fixed_discs = vec![disc(0.03, 0.099), disc(0.07, 0.099)];
    let up = Some(straight(0.2 * DVec2::Y));
    scene.motions = vec![Motion { fixed_discs: vec![1], course: up, ..Motion::default() }];
    scene
}
