//! Bounces under the law `range`, one after the other and many at once: a ball, a gas, a row of balls, a column.

use crate::common::*;

const RADIUS: f64 = 2.5e-3;
const BOND: f64 = 20.0;

/// A ball above a plane, and the heights that it comes to after each bounce, as far as steps show them.
fn apexes(time_step_secs: f64, restitution: f64, height: f64, count: usize) -> Vec<f64> {
    let radius = 0.05;
    let grain = Grain::at_rest(DVec2::new(0.0, radius + height), radius);
    let numbers = parameters(0.0, time_step_secs, restitution, 0.5);
    let mut run = start(&Scene {
        boundaries: vec![level()],
        ..ranged(Physics::FULL, DVec2::new(0.0, -G), numbers, vec![grain])
    });
    let (mut found, mut highest, mut falls) = (Vec::new(), 0f64, true);
    while found.len() < count {
        take_steps(&mut run, 1);
        let now = run.velocity(0).y;
        let at = run.place(0).y - radius;
        assert!(run.time_secs() < 60.0, "only {found:?}");
        if falls && now > 0.0 {
            (falls, highest) = (false, at);
        } else if !falls && now < 0.0 {
            falls = true;
            found.push(highest.max(at));
        }
        highest = highest.max(at);
    }
    found
}

#[test]
fn apexes_of_a_ball_follow_the_squares_of_rho() {
    for time_step_secs in [1e-4, 1e-3, 3e-3, 5e-3, 1e-2] {
        for (restitution, count) in [(0.5, 3), (0.7, 5), (0.9, 12), (1.0, 20)] {
            for height in [0.3, 0.41] {
                let mut ideal = height;
                for (bounce, found) in
                    apexes(time_step_secs, restitution, height, count).into_iter().enumerate()
                {
                    ideal *= restitution * restitution;
                    // Between two steps the ball comes up to gΔt²/8 higher than they show.
                    let allowed = 0.125 * G * time_step_secs.powi(2) + 1e-9 * height;
                    let below = ideal - found;
                    let what = format!("Δt {time_step_secs}, ρ {restitution}, bounce {bounce}");
                    assert!(below >= -1e-9 * height, "{what}: {found} for {ideal}");
                    assert!(below <= allowed, "{what}: {found} for {ideal}, {below:e} lower");
                }
            }
        }
    }
}

/// Discs at random places in a box, with random velocities.
fn gas(count: usize, fill: f64, numbers: Parameters, seed: u64) -> Simulation {
    let mut random = random(seed);
    let columns = (count as f64).sqrt().ceil() as usize;
    let spacing = RADIUS * (std::f64::consts::PI / fill).sqrt();
    let mut component = |scale: f64| scale * random.random_range(-1.0..=1.0);
    let grains = (0..count).map(|index| {
        let place = DVec2::new((index % columns) as f64 + 0.5, (index / columns) as f64 + 0.5);
        let jitter = DVec2::new(component(0.3), component(0.3)) * (spacing - 2.2 * RADIUS);
        let velocity = DVec2::new(component(1.0), component(1.0));
        weightless(moving(spacing * place + jitter, RADIUS * (1.0 + component(0.1)), velocity))
    });
    let wall = |point: DVec2, normal: DVec2| Boundary::HalfSpace { point, normal };
    let far = DVec2::splat(columns as f64 * spacing);
    let grains: Vec<Grain> = grains.collect();
    start(&Scene {
        mean_diameter: 2.0 * RADIUS,
        boundaries: vec![
            wall(DVec2::ZERO, DVec2::X),
            wall(DVec2::ZERO, DVec2::Y),
            wall(far, -DVec2::X),
            wall(far, -DVec2::Y),
        ],
        ..ranged(SMOOTH, DVec2::new(0.0, -G), numbers, grains)
    })
}

#[test]
fn a_gas_without_losses_keeps_its_energy() {
    for (time_step_secs, fill, steps) in
        [(1e-4, 0.3, 10_000), (1e-3, 0.3, 3000), (1e-3, 0.55, 3000), (5e-3, 0.3, 600)]
    {
        let mut run = gas(50, fill, parameters(0.0, time_step_secs, 1.0, 0.0), 7);
        let begun = run.observables().kinetic_energy;
        let mut pushed = 0;
        for _ in 0..steps {
            let before = run.grains().velocities.clone();
            take_steps(&mut run, 1);
            let after = run.velocities();
            pushed += before.iter().zip(after).filter(|(before, after)| before != after).count();
        }
        let ended = run.observables().kinetic_energy;
        assert_close(ended, begun, 1e-6, &format!("energy at Δt {time_step_secs}, filled {fill}"));
        assert!(run.observables().max_overlap < 0.01, "at Δt {time_step_secs}");
        assert!(pushed > 3000, "{pushed} grains were pushed");
    }
}

/// A ball on its way to a row of others, and the speeds in the end.
fn cradle(gap: f64, restitution: f64, time_step_secs: f64, stepper: Stepper) -> Vec<f64> {
    let mut place = -(2.0 * RADIUS + 1.234e-3);
    let grains = (0..5).map(|index| {
        let speed = if index == 0 { 1.0 } else { 0.0 };
        if index == 1 {
            place = 0.0;
        }
        let grain = moving(DVec2::new(place, 0.0), RADIUS, DVec2::new(speed, 0.0));
        place += 2.0 * RADIUS + gap;
        weightless(grain)
    });
    let scene = ranged(
        LINE,
        DVec2::new(G, 0.0),
        parameters(0.0, time_step_secs, restitution, 0.0),
        grains.collect(),
    );
    let solver = tight();
    let run = after(&Scene { stepper, solver, ..scene }, (0.02 / time_step_secs) as usize);
    run.velocities().iter().map(|velocity| velocity.x).collect()
}

#[test]
fn a_row_of_balls_with_gaps_hands_the_shock_on_and_one_without_flies_off_as_under_moreau() {
    for time_step_secs in [1e-4, 1e-3, 5e-3] {
        let speeds = cradle(1e-5, 1.0, time_step_secs, Stepper::Range);
        for (found, expected) in speeds.iter().zip([0.0, 0.0, 0.0, 0.0, 1.0]) {
            assert!((found - expected).abs() < 1e-9, "{speeds:?} at {time_step_secs}");
        }
        for restitution in [0.3, 1.0] {
            let found = cradle(-1e-9, restitution, time_step_secs, Stepper::Range);
            let moreau = cradle(-1e-9, restitution, 1e-6, Stepper::Moreau);
            for (found, expected) in found.iter().zip(&moreau) {
                assert!((found - expected).abs() < 1e-6, "{found} for {expected}: {moreau:?}");
            }
        }
    }
}

#[test]
fn what_rests_does_not_bounce_and_what_falls_comes_to_rest() {
    for time_step_secs in [1e-4, 1e-3, 5e-3] {
        for bond in [0.0, BOND] {
            let grains = (0..4).map(|level| {
                Grain::at_rest(DVec2::new(0.0, (3.1 + 2.2 * level as f64) * RADIUS), RADIUS)
            });
            let numbers = Parameters { restitution: 0.5, ..range(bond, time_step_secs) };
            let grains = grains.collect();
            let run = after(
                &Scene {
                    fixed_discs: vec![fixed(DVec2::new(0.0, RADIUS), RADIUS)],
                    ..ranged(SMOOTH, DVec2::new(0.0, -G), numbers, grains)
                },
                (1.0 / time_step_secs) as usize,
            );
            let now = run.observables();
            let weight: f64 = run.grains().masses.iter().sum();
            assert!(now.kinetic_energy < 1e-9 * weight * G * RADIUS, "{}", now.kinetic_energy);
        }
    }
}
