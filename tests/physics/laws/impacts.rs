//! Tests of collisions that run one after the other through touching grains, and of collisions with walls that move
//! along their normal: exact results and general properties.

use proptest::prelude::*;
use slump::scene::stability::{bounce, heap};

use crate::common::*;

const RADIUS: f64 = 0.05;
/// Overlap of touching grains, in diameters.
const TOUCH: f64 = 1e-9;
const SPEED: f64 = 2.0;

/// Returns a scene without gravity, cohesion and friction in which Slump treats collisions one after the other (with
/// the remedy `sequential_impacts`, an optional correction of the stepper).
fn struck(physics: Physics, restitution: f64, grains: Vec<Grain>) -> Scene {
    let mut scene = scene(physics, DVec2::ZERO, parameters(0.0, 1e-4, restitution, 0.0), grains);
    scene.remedies.sequential_impacts = true;
    scene
}

/// Returns touching balls in a row along `axis`, one ball for each of these velocities along the axis (m/s).
fn row_of(axis: DVec2, velocities: &[f64]) -> Vec<Grain> {
    let ball = |(place, &velocity): (usize, &f64)| {
        let x = place as f64 * 2.0 * RADIUS * (1.0 - TOUCH);
        moving(x * axis, RADIUS, velocity * axis)
    };
    velocities.iter().enumerate().map(ball).collect()
}

fn energy(run: &Simulation) -> f64 {
    let grains = run.grains();
    let squares = grains.velocities.iter().map(|velocity| velocity.length_squared());
    0.5 * grains.masses.iter().zip(squares).map(|(mass, squared)| mass * squared).sum::<f64>()
}

/// Returns the velocities along `axis` after one step, m/s.
fn after_a_step(scene: &Scene, axis: DVec2) -> Vec<f64> {
    let run = after(scene, 1);
    run.velocities().iter().map(|velocity| velocity.dot(axis)).collect()
}

#[test]
fn as_many_balls_leave_newtons_cradle_as_have_struck_it() {
    for ((physics, axis), count) in
        pairs([(LINE, DVec2::X), (SMOOTH, DVec2::new(0.6, 0.8))], 2..=20)
    {
        for strikers in 1..=3.min(count - 1) {
            let speed = |ball: usize| if ball < strikers { SPEED } else { 0.0 };
            let velocities: Vec<f64> = (0..count).map(speed).collect();
            let mut scene = struck(physics, 1.0, row_of(axis, &velocities));
            for robust in [false, true] {
                if robust {
                    Preset::Robust.apply(&mut scene);
                }
                let after = after_a_step(&scene, axis);
                for (ball, expected) in (0..count).rev().map(speed).enumerate() {
                    let off = (after[ball] - expected).abs();
                    assert!(off < 1e-10, "{strikers} of {count}, ball {ball}: {after:?}");
                }
            }
        }
    }
}

#[test]
fn balls_from_both_ends_change_places() {
    let after = after_a_step(
        &struck(LINE, 1.0, row_of(DVec2::X, &[SPEED, 0.0, 0.0, -0.5 * SPEED])),
        DVec2::X,
    );
    for (found, expected) in after.into_iter().zip([-0.5 * SPEED, 0.0, 0.0, SPEED]) {
        assert!((found - expected).abs() < 1e-12, "{found} for {expected}");
    }
}

#[test]
fn each_ball_hands_on_the_share_that_a_pair_does() {
    // An impact of two equal balls transmits the fraction (1 + ρ)/2 of the speed. With these ρ no ball catches up with
    // the last one afterwards.
    for (restitution, count) in [(0.95, 3), (0.9, 5), (0.99, 8)] {
        let velocities: Vec<f64> =
            (0..count).map(|ball| if ball == 0 { SPEED } else { 0.0 }).collect();
        let scene = struck(LINE, restitution, row_of(DVec2::X, &velocities));
        let after = after_a_step(&scene, DVec2::X);
        let expected = SPEED * (0.5 * (1.0 + restitution)).powi(count - 1);
        assert_close(after[count as usize - 1], expected, 1e-12, "the last ball");
        assert!(after.windows(2).all(|pair| pair[1] >= pair[0] - 1e-9), "{after:?}");
    }
}

/// Returns a scene of fifteen touching balls in a triangle about the x axis and one ball that strikes the apex. `order`
/// gives the order in which the balls are numbered.
fn rack(restitution: f64, order: &[usize]) -> Scene {
    let spacing = 2.0 * RADIUS * (1.0 - TOUCH);
    let mut grains = vec![moving(-spacing * DVec2::X, RADIUS, SPEED * DVec2::X)];
    for row in 0..5 {
        for place in 0..=row {
            let (row, place) = (f64::from(row), f64::from(place));
            let centre = DVec2::new(0.75f64.sqrt() * row, place - 0.5 * row);
            grains.push(Grain::at_rest(spacing * centre, RADIUS));
        }
    }
    struck(SMOOTH, restitution, order.iter().map(|&ball| grains[ball].clone()).collect())
}

#[test]
fn a_break_shot_is_symmetric_and_does_not_depend_on_the_numbering() {
    for restitution in [1.0, 0.8] {
        let straight: Vec<usize> = (0..16).collect();
        let mut shuffled = straight.clone();
        let mut random = random(3);
        for ball in (1..16).rev() {
            shuffled.swap(ball, random.random_range(0..=ball));
        }
        let run = |order: &[usize]| {
            let mut simulation = start(&rack(restitution, order));
            let before = energy(&simulation);
            take_steps(&mut simulation, 1);
            (before, energy(&simulation), simulation.grains().clone())
        };
        let (before, after, grains) = run(&straight);
        if restitution == 1.0 {
            assert_close(after, before, 1e-9, "energy");
        } else {
            assert!(after < before, "{after} of {before}");
        }
        let mut spread = 0f64;
        for (place, velocity) in grains.positions.iter().zip(&grains.velocities) {
            let mirrored = DVec2::new(place.x, -place.y);
            let other = grains.positions.iter().position(|other| other.distance(mirrored) < 1e-6);
            let other = grains.velocities[other.expect("a ball at the mirrored place")];
            let off = DVec2::new(other.x, -other.y).distance(*velocity);
            assert!(off < 1e-9 * SPEED, "{off:e} off the mirror image");
            spread = spread.max(velocity.y);
        }
        assert!(spread > 0.1 * SPEED, "it breaks up: {spread}");
        let (.., of_shuffled) = run(&shuffled);
        for (place, &ball) in shuffled.iter().enumerate() {
            let off = of_shuffled.velocities[place].distance(grains.velocities[ball]);
            assert!(off < 1e-9 * SPEED, "ball {ball}: {off:e} off another numbering");
        }
    }
}

/// Returns a scene of discs of unequal size on a lattice, nearly touching, with random velocities.
fn crowd(restitution: f64, count: usize, seed: u64) -> Scene {
    let mut random = random(seed);
    let columns = (count as f64).sqrt().ceil() as usize;
    let grains = (0..count)
        .map(|index| {
            let radius = RADIUS * random.random_range(0.8..=1.05);
            let place = DVec2::new((index % columns) as f64, (index / columns) as f64);
            let mut component = || SPEED * random.random_range(-1.0..=1.0);
            moving(2.0 * RADIUS * place, radius, DVec2::new(component(), component()))
        })
        .collect();
    struck(SMOOTH, restitution, grains)
}

#[test]
fn shocks_keep_the_momentum_and_never_gain_energy() {
    let restitution = prop_oneof![1 => Just(1.0), 1 => Just(0.0), 4 => 0.0..1.0];
    let all = (restitution, 2usize..=40, any::<u64>());
    let run = |(restitution, count, seed)| {
        let mut simulation = start(&crowd(restitution, count, seed));
        for _ in 0..5 {
            let (energy_before, momentum_before) = (energy(&simulation), momentum(&simulation));
            simulation.step().expect("a finite state");
            let grown = energy(&simulation) - energy_before;
            prop_assert!(grown <= 1e-9 * energy_before, "{grown:e} of {energy_before:e}");
            if restitution == 1.0 {
                prop_assert!(grown >= -1e-9 * energy_before, "{grown:e} of {energy_before:e}");
            }
            let off = momentum(&simulation).distance(momentum_before);
            let scale = (energy_before * simulation.grains().masses.iter().sum::<f64>()).sqrt();
            prop_assert!(off <= 1e-12 * scale, "momentum off by {off:e}");
        }
        Ok(())
    };
    for_random(128, all, run);
}

#[test]
fn with_friction_and_spins_none_of_these_shocks_gains_energy() {
    for (seed, restitution) in pairs(0..60, [0.5, 1.0]) {
        let mut scene = crowd(restitution, 36, seed);
        let mut random = random(seed);
        scene.physics = Physics::FULL;
        scene.parameters.friction = 0.5;
        scene.solver.tolerance = 1e-10;
        for grain in &mut scene.grains {
            grain.angular_velocity = 40.0 * random.random_range(-1.0..=1.0);
        }
        let mut run = start(&scene);
        for _ in 0..5 {
            let before = run.observables().kinetic_energy;
            let after = *run.step().expect("a finite state");
            let grown = after.kinetic_energy / before - 1.0;
            assert!(grown < 1e-6, "seed {seed}, ρ {restitution}: {grown:e}");
        }
    }
}

#[test]
fn a_wall_that_moves_strikes_twice_and_its_work_is_no_gain_of_the_bounces() {
    let mut scene = struck(Physics::FULL, 1.0, row_of(DVec2::X, &[0.0, 0.0]));
    scene.parameters.friction = 0.5;
    let point = -RADIUS * (1.0 - TOUCH) * DVec2::X;
    scene.boundaries = vec![piston(point, DVec2::X, SPEED, 1.0)];
    // The wall moves at V. The first ball passes its speed 2V on to the second ball and is then struck again by the
    // wall.
    for velocity in after_a_step(&scene, DVec2::X) {
        assert_close(velocity, 2.0 * SPEED, 1e-9, "a ball in front of the wall");
    }
}

/// Returns the largest difference between the velocities of a run with and a run without the remedy
/// `sequential_impacts` (an optional correction, which treats collisions one after the other), divided by the largest
/// velocity.
fn difference(scene: &Scene, steps: usize) -> f64 {
    let mut runs = [false, true].map(|sequential_impacts| {
        let mut scene = scene.clone();
        scene.remedies.sequential_impacts = sequential_impacts;
        start(&scene)
    });
    let (mut off, mut largest) = (0f64, 0f64);
    for _ in 0..steps {
        runs.iter_mut().for_each(|run| take_steps(run, 1));
        let [usual, sequential] = [0, 1].map(|run: usize| runs[run].velocities());
        for (usual, sequential) in usual.iter().zip(sequential) {
            off = off.max(usual.distance(*sequential));
            largest = largest.max(usual.length());
        }
    }
    off / largest
}

#[test]
fn single_contacts_rest_and_cohesion_are_left_as_they_are() {
    for restitution in [0.0, 0.5, 1.0] {
        let mut scene = bounce(restitution);
        scene.parameters.restitution_threshold = 2.0;
        let off = difference(&scene, 400);
        assert!(off < 1e-9, "ρ {restitution}: {off:e}");
    }
    let mut resting = heap(5);
    resting.parameters.restitution = 0.5;
    assert_eq!(difference(&resting, 50), 0.0, "nothing closes fast");
    let mut cohesive = paper_pile().expect("the shipped state");
    cohesive.parameters = parameters(20.0, 1e-3, 0.5, 0.5);
    assert_eq!(difference(&cohesive, 50), 0.0, "the paper's law holds bonds through shocks");
    cohesive.parameters.bond = 0.0;
    assert!(difference(&cohesive, 50) > 1e-3, "without bonds there are shocks in it");
}

#[test]
fn a_pile_whose_shocks_are_followed_closes_its_energy_budget() {
    let mut scene = paper_pile().expect("the shipped state");
    scene.parameters = parameters(0.0, 1e-3, 0.7, 0.5);
    Preset::Robust.apply(&mut scene);
    let mut run = start(&scene);
    let mut shocks = 0.0;
    for _ in 0..100 {
        let (after, off, scale) = balance(&mut run);
        assert!(off <= 1e-11 * scale, "step {}: off by {off:e}", after.step);
        shocks += after.normal_work.min(0.0);
    }
    assert!(shocks < 0.0, "there were shocks");
}

const DT: f64 = 1e-3;
const WALL_SPEED: f64 = 0.2;

/// Returns a scene with a wall parallel to the y axis. It starts `distance` (m) to the left of a disc at the origin,
/// moves towards the disc and stops after the distance `travel` (m).
fn pushed(physics: Physics, restitution: f64, distance: f64, travel: f64) -> Scene {
    let grains = vec![Grain::at_rest(DVec2::ZERO, RADIUS)];
    let point = DVec2::new(-RADIUS - distance, 0.0);
    Scene {
        boundaries: vec![piston(point, DVec2::X, WALL_SPEED, travel)],
        ..scene(physics, DVec2::ZERO, parameters(0.0, DT, restitution, 0.5), grains)
    }
}

fn wall(run: &Simulation) -> f64 {
    match run.world().boundaries[0] {
        Boundary::Piston { point, .. } => point.x,
        _ => panic!("the wall is a piston"),
    }
}

#[test]
fn a_wall_hits_a_disc_at_rest_as_a_moving_disc_hits_a_wall() {
    for (physics, restitution) in pairs([LINE, Physics::FULL], [0.0, 0.5, 1.0]) {
        // The wall starts so far away that no list of near pairs contains it.
        let run = after(&pushed(physics, restitution, 20.0 * RADIUS, 10.0), 10_000);
        let expected = (1.0 + restitution) * WALL_SPEED;
        let speed = run.velocity(0).x;
        assert_close(speed, expected, 1e-12, "speed after the wall came");
    }
}

#[test]
fn a_wall_goes_its_way_to_the_end_and_no_further_and_is_shown_where_it_is() {
    let travel = 10.3 * DT * WALL_SPEED;
    let mut run = start(&pushed(LINE, 0.0, 0.0, travel));
    let begin = wall(&run);
    take_steps(&mut run, 10);
    assert_close(wall(&run) - begin, 10.0 * DT * WALL_SPEED, 1e-12, "way in ten steps");
    take_steps(&mut run, 10);
    assert_close(wall(&run) - begin, travel, 1e-12, "way in the end");
    assert_eq!(run.snapshot().surroundings.boundaries, run.world().boundaries);
    assert!(run.place(0).x > travel, "the disc flies on");
}

#[test]
fn a_grain_that_follows_a_wall_on_its_way_back_is_not_lost() {
    let mut scene = pushed(Physics::FULL, 0.0, 0.0, 10.0);
    scene.gravity = Gravity::Uniform { acceleration: DVec2::new(-9.8, 0.0) };
    if let Boundary::Piston { speed, .. } = &mut scene.boundaries[0] {
        *speed = -20.0 * WALL_SPEED;
    }
    let run = after(&scene, 1000);
    let place = run.place(0).x;
    assert!(place < -30.0 * RADIUS, "it falls after the wall, {place} m");
    let lost = |alarm: &Alarm| alarm.kind == AlarmKind::GrainLost;
    assert!(!run.alarms().iter().any(lost));
}

#[test]
fn a_fast_wall_and_a_fast_fixed_disc_are_looked_ahead_for() {
    let gap = 0.1 * RADIUS;
    let speed = 0.5 * RADIUS / DT;
    for (physics, comes) in pairs([LINE, Physics::FULL], ["wall", "disc"]) {
        let mut scene = pushed(physics, 0.0, gap, 10.0);
        match comes {
            "wall" => {
                let point = DVec2::new(-RADIUS - gap, 0.0);
                scene.boundaries = vec![piston(point, DVec2::X, speed, 10.0)];
            }
            _ => {
                scene.boundaries.clear();
                scene.fixed_discs = vec![fixed(DVec2::new(-2.0 * RADIUS - gap, 0.0), RADIUS)];
                scene.motions = vec![discs_go(1, straight(speed * DVec2::X))];
            }
        }
        let overlap = after(&scene, 2).observables().max_overlap;
        assert_close(overlap, 0.2, 1e-6, "without the remedy the disc is overrun, d");
        scene.remedies.speculative = true;
        let run = after(&scene, 3);
        let overlap = run.observables().max_overlap;
        assert!(overlap < 1e-3, "{comes}: {overlap} d");
        assert_close(run.velocity(0).x, speed, 1e-6, comes);
    }
}

#[test]
fn a_wall_that_cannot_be_is_refused_with_its_field() {
    for (speed, travel) in [(f64::NAN, 1.0), (f64::INFINITY, 1.0), (1.0, -1.0), (1.0, f64::NAN)] {
        let mut scene = pushed(LINE, 0.0, 0.0, travel);
        if let Boundary::Piston { speed: of_wall, .. } = &mut scene.boundaries[0] {
            *of_wall = speed;
        }
        let said = scene.simulation().expect_err("no such wall").to_string();
        assert!(said.starts_with("boundaries[0] is speed"), "{said}");
    }
}

/// Checks that a wall with the speed V gives all balls of a touching row the speed 2V at restitution 1. Each collision
/// runs through the row and gives the speed 2V to the last ball that has not been struck yet, until no contact closes
/// any more.
#[test]
fn shocks_of_a_moving_wall_run_through_a_row_of_touching_balls() {
    for balls in 1..=4 {
        let place = |ball: usize| DVec2::new(2.0 * RADIUS * ball as f64, 0.0);
        let mut scene = pushed(LINE, 1.0, 0.0, 10.0);
        let row = (0..balls).map(|ball| Grain::at_rest(place(ball), RADIUS));
        scene.grains = row.collect();
        // With this tolerance the balls touch even if rounding opens their gaps slightly.
        scene.gap_tolerance = 1e-9;
        scene.remedies = Remedies { sequential_impacts: true, ..Remedies::default() };
        let run = after(&scene, 1);
        for velocity in run.velocities() {
            assert_close(velocity.x, 2.0 * WALL_SPEED, 1e-9, "speed after the wall came");
        }
    }
}
