//! Models of friction on what slides, against what theory says of each.

use crate::common::*;
use slump::scene::stability::{blow, dilatancy};

fn settings(method: Method, friction_model: FrictionModel, model_solves: u32) -> SolverSettings {
    SolverSettings {
        method,
        stop: StopTest::Residual,
        tolerance: 1e-13,
        friction_model,
        model_solves,
        ..SolverSettings::default()
    }
}

fn sliding(time_step_secs: f64, solver: SolverSettings) -> Simulation {
    let mut scene = dilatancy();
    scene.parameters.time_step_secs = time_step_secs;
    scene.solver = solver;
    start(&scene)
}

/// v₀, μ, g and d of the scene.
fn numbers() -> [f64; 4] {
    let scene = dilatancy();
    let speed = scene.grains[0].velocity.x;
    [speed, scene.parameters.friction, scene.gravity.magnitude(), scene.mean_diameter]
}

/// The way from the start to where the disc has been still for long.
fn way(run: &mut Simulation) -> glam::DVec2 {
    let [speed, friction, gravity, _] = numbers();
    let start = run.place(0);
    while run.time_secs() < 1.5 * speed / (friction * gravity) {
        run.step().expect("a finite state");
    }
    assert!(run.velocity(0).length() < 1e-9, "it has stopped");
    run.place(0) - start
}

/// Long steps and short ones; at some of them the disc stops within a step, not at its end.
const TIME_STEPS_SECS: [f64; 4] = [2e-4, 1e-3, 5e-3, 1.7e-2];

#[test]
fn what_slides_keeps_its_level_and_stops_where_the_sum_of_its_steps_says() {
    let [speed, friction, gravity, diameter] = numbers();
    let ways = [
        (Method::Nsgs, FrictionModel::Coulomb),
        (Method::Newton, FrictionModel::Coulomb),
        (Method::InteriorPoint, FrictionModel::Coulomb),
        (Method::Nsgs, FrictionModel::Tresca),
        (Method::InteriorPoint, FrictionModel::Tresca),
    ];
    for (method, model) in ways {
        for time_step_secs in TIME_STEPS_SECS {
            let what = format!("{method}, {model}, {time_step_secs} s");
            let found = way(&mut sliding(time_step_secs, settings(method, model, 1)));
            let slowing = friction * gravity * time_step_secs;
            let steps = (speed / slowing).floor();
            let sum = time_step_secs * (steps * speed - 0.5 * slowing * steps * (steps + 1.0));
            assert!((found.x / sum - 1.0).abs() < 1e-9, "{what}: {} for {sum}", found.x);
            assert!(found.y.abs() < 1e-11 * diameter, "{what}: lifted by {:e}", found.y);
            let short = speed * speed / (2.0 * friction * gravity) - sum;
            assert!((0.0..=0.5 * speed * time_step_secs).contains(&short), "{what}: {short}");
        }
    }
}

#[test]
fn associated_throws_what_slides_to_the_same_height_at_every_time_step() {
    let [speed, friction, gravity, diameter] = numbers();
    for time_step_secs in TIME_STEPS_SECS {
        let solver = settings(Method::InteriorPoint, FrictionModel::Associated, 1);
        let mut run = sliding(time_step_secs, solver);
        let level = run.place(0).y;
        run.step().expect("a finite state");
        let after = run.velocity(0);
        let along = (speed - friction * gravity * time_step_secs) / (1.0 + friction * friction);
        let right = glam::DVec2::new(along, friction * along);
        assert!((after - right).length() < 1e-9 * speed, "{after} for {right}");
        let lift = run.place(0).y - level;
        assert!((lift / (time_step_secs * friction * along) - 1.0).abs() < 1e-6, "{lift:e}");

        let (mut highest, mut expected, mut rising) = (lift, lift, after.y);
        while rising > 0.0 {
            rising -= gravity * time_step_secs;
            expected += (time_step_secs * rising).max(0.0);
            run.step().expect("a finite state");
            highest = highest.max(run.place(0).y - level);
        }
        assert!((highest / expected - 1.0).abs() < 1e-9, "{highest} for {expected}");
        assert!(highest > 0.6 * diameter, "{time_step_secs} s: {highest:e}");
    }
}

#[test]
fn desaxce_sinks_what_slides_by_the_way_of_a_step_times_friction() {
    let [speed, friction, ..] = numbers();
    for time_step_secs in TIME_STEPS_SECS {
        let sunk = |solves| {
            let solver = settings(Method::InteriorPoint, FrictionModel::Desaxce, solves);
            -way(&mut sliding(time_step_secs, solver)).y
        };
        let right = friction * speed * time_step_secs;
        let once = sunk(1);
        assert!((once / right - 1.0).abs() < 1e-6, "{time_step_secs} s: {once} for {right}");
        // A solve leaves μ²/(1 + μ²), a fifth, of what the one before it left.
        let fourth = sunk(4);
        assert!((0.0..0.02 * right).contains(&fourth), "{time_step_secs} s: {fourth} of {right}");
    }
}

/// Speed of both discs along the floor, their total way along it, and whether the blow has come.
fn along_the_floor(run: &Simulation) -> (f64, f64, bool) {
    let grains = run.grains();
    let mass: f64 = grains.masses.iter().sum();
    let mean = |of: &[glam::DVec2]| {
        of.iter().zip(&grains.masses).map(|(of, mass)| *mass * *of).sum::<glam::DVec2>() / mass
    };
    let velocity = mean(&grains.velocities);
    (velocity.x, mean(&grains.positions).x, velocity.y.abs() < 1e-9)
}

#[test]
fn a_blow_on_what_slides_takes_speed_by_impulse_balance_and_tresca_is_a_step_late() {
    let scene = blow();
    let [light, heavy] = [0, 1].map(|k| scene.grains[k].radius.powi(2));
    let fall = -scene.grains[1].velocity.y;
    let taken = scene.parameters.friction * heavy * fall / (light + heavy);
    let before = scene.grains[0].velocity.x;
    assert!(taken > 0.1 * before && taken < 0.9 * before, "it is seen, and they go on sliding");
    let ways = [
        (Method::Newton, FrictionModel::Coulomb, 1, 0.0),
        (Method::InteriorPoint, FrictionModel::Tresca, 1, 1.0),
        (Method::Nsgs, FrictionModel::Tresca, 1, 1.0),
        (Method::InteriorPoint, FrictionModel::Tresca, 2, 0.0),
    ];
    for time_step_secs in [1e-4, 1e-3, 5e-3] {
        for (method, model, solves, steps_late) in ways {
            let what = format!("{method}, {model}, {solves} solves, {time_step_secs} s");
            let mut scene = scene.clone();
            scene.parameters.time_step_secs = time_step_secs;
            scene.solver = settings(method, model, solves);
            let mut run = start(&scene);
            let mut steps = 0.0;
            let start = along_the_floor(&run).1;
            while !along_the_floor(&run).2 {
                run.step().expect("a finite state");
                steps += 1.0;
                assert!(steps < 100.0, "{what}: the blow has come");
            }
            assert!(steps > 1.0, "{what}: the floor's contact was there before the blow");
            let at_the_blow = along_the_floor(&run).0;
            let expected = before - (1.0 - steps_late) * taken;
            assert!((at_the_blow - expected).abs() < 1e-8, "{what}: {at_the_blow} for {expected}");
            take_steps(&mut run, 10);
            let (after, place, _) = along_the_floor(&run);
            assert!((after - (before - taken)).abs() < 1e-8, "{what}: {after}");
            let late = time_step_secs * taken * steps_late;
            let way = time_step_secs * ((steps + 10.0) * before - 11.0 * taken) + late;
            assert!((place - start - way).abs() < 1e-9, "{what}: {} for {way}", place - start);
        }
    }
}
