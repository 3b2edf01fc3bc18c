//! What comes together where borders wrap: bonds that circle, bounces under the law `range`, and gravity that leans.

use crate::common::*;

/// Side of a square cell, m.
const SIDE: f64 = 0.1;
const SQUARE: Periodic = Periodic::along_both([0.0, SIDE], [0.0, SIDE]);

/// From grain 1 to the nearest image of grain 0, m.
fn offset(run: &Simulation) -> DVec2 {
    let (places, cell) = (run.places(), run.world().periodic.expect("a cell"));
    cell.shortest(places[0] - places[1])
}

#[test]
fn a_bonded_pair_that_circles_does_so_wherever_it_is_in_the_cell() {
    // A pull that the iterations have not come to loses its bond.
    for stepper in Stepper::ALL.iter().filter(|&&stepper| stepper != Stepper::Avbd) {
        let mut pair = scene(
            Physics::FULL,
            -9.8 * DVec2::Y,
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
    let mut gas = scene(Physics::FULL, -9.8 * DVec2::Y, parameters, grains.collect());
    gas.grains.iter_mut().for_each(|grain| grain.feels_gravity = false);
    gas.parameters.debonding_distance = DISTANCE_IN_DIAMETERS;
    (gas.stepper, gas.periodic) = (Stepper::Range, Some(SQUARE));
    gas.solver = SolverSettings { tolerance: 1e-8, max_sweeps: 2000, ..SolverSettings::default() };
    let mut run = start(&gas);
    let momentum = |run: &Simulation| -> DVec2 {
        let grains = run.grains();
        grains.masses.iter().zip(&grains.velocities).map(|(mass, v)| *mass * *v).sum()
    };
    let (before, energy) = (momentum(&run), run.observables().kinetic_energy);
    let mut broken = 0.0;
    for _ in 0..400 {
        let from = run.observables().kinetic_energy;
        take_steps(&mut run, 1);
        let now = run.observables();
        let works = now.normal_work + now.tangential_work + now.gravity_work;
        assert!((now.kinetic_energy - from - works).abs() < 1e-12 * energy, "{now:?}");
        broken = now.broken_bond_energy.expect("bonds");
    }
    assert!(momentum(&run).distance(before) < 1e-12 * energy.sqrt(), "{}", momentum(&run));
    assert!(broken > 0.0 && run.observables().kinetic_energy < 0.9 * energy, "{broken} J");
    assert!(run.observables().max_overlap < 0.02, "{:?}", run.observables());
}

/// A disc on a level under gravity that leans to the right, in a cell or not.
fn on_a_slope(stepper: Stepper, tilt: f64, periodic: Option<Periodic>) -> Scene {
    let disc = moving(DVec2::new(0.05, 0.01), 0.01, DVec2::ZERO);
    let mut scene =
        scene(Physics::FULL, -9.8 * DVec2::Y, parameters(0.0, 5e-4, 0.0, 0.1), vec![disc]);
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
    for stepper in Stepper::ALL {
        let [mut free, mut wrapped] =
            [None, Some(cell)].map(|periodic| start(&on_a_slope(*stepper, degrees, periodic)));
        take_steps(&mut free, 800);
        take_steps(&mut wrapped, 800);
        let [free, wrapped] = [&free, &wrapped].map(|run| run.grains());
        assert!(free.positions[0].x > 4.0 * SIDE, "{stepper}: {}", free.positions[0]);
        assert!(cell.wrap(free.positions[0]).distance(wrapped.positions[0]) < 1e-10, "{stepper}");
        assert!(free.velocities[0].distance(wrapped.velocities[0]) < 1e-10, "{stepper}");
        // It slides, as tan 40° is above 3 μ.
        let expected = 9.8 * (sin - 0.1 * cos) * 0.4;
        let tolerance = if *stepper == Stepper::Avbd { 2e-2 } else { 2e-3 };
        assert_close(wrapped.velocities[0].x, expected, tolerance, stepper.name());
        assert!(wrapped.angular_velocities[0] < 0.0, "{stepper}: it rolls as well");
    }
}
