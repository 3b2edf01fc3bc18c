//! Tests of collisions under the stepper `range` against exact motion, for every time step Δt and any time of impact
//! within a step.

use crate::common::*;

const RADIUS: f64 = 2.5e-3;
const BOND: f64 = 20.0;
const TIME_STEPS: [f64; 6] = [1e-4, 3e-4, 1e-3, 2e-3, 5e-3, 2e-2];

/// Returns a run of two discs without gravity; the second disc is at rest. They collide after the first has moved by
/// `gap` (m) along x at `speed` (m/s). Their centres are offset along y by `aside` times the sum of the radii. `size`
/// is the ratio of the radii.
fn two(physics: Physics, numbers: Parameters, [gap, aside, speed, size]: [f64; 4]) -> Simulation {
    let radii = RADIUS * (1.0 + size);
    let ahead = (1.0 - aside * aside).sqrt() * radii;
    let place = DVec2::new(-gap - ahead, aside * radii);
    let grains = vec![
        weightless(Grain {
            angular_velocity: if physics.rotation { 20.0 } else { 0.0 },
            ..moving(place, RADIUS, DVec2::new(speed, 0.0))
        }),
        weightless(Grain::at_rest(DVec2::ZERO, size * RADIUS)),
    ];
    start(&ranged(physics, DVec2::new(0.0, -G), numbers, grains))
}

#[test]
fn two_discs_bounce_by_rho_at_any_time_step_phase_mass_ratio_and_slant() {
    let mut met = 0;
    for (physics, asides) in
        [(LINE, &[0.0][..]), (SMOOTH, &[0.0, 0.3, -0.8, 0.99]), (Physics::FULL, &[0.0, 0.5, -0.95])]
    {
        for (&aside, time_step_secs, restitution) in
            triples(asides, TIME_STEPS, [0.0, 0.3, 0.8, 1.0])
        {
            for ((size, speed), phase) in pairs(
                [(1.0, 0.1), (1.7, 0.1), (0.3, 2.0)],
                [1e-9, 0.11, 0.37, 0.5, 0.93, 1.0 - 1e-9, 1.4],
            ) {
                let numbers = parameters(0.0, time_step_secs, restitution, 0.2);
                let gap = phase * speed * time_step_secs;
                let what = [gap, aside, speed, size];
                let mut run = two(physics, numbers, what);
                check_bounce(&mut run, restitution, what);
                met += 1;
            }
        }
    }
    assert!(met > 3000, "{met} bounces");
}

/// Takes steps past the collision of [`two`] and compares the velocities with those of a collision at the exact
/// position.
fn check_bounce(run: &mut Simulation, restitution: f64, [gap, aside, speed, size]: [f64; 4]) {
    let (momentum_before, friction) = (momentum(run), run.parameters().friction);
    let mass = effective_mass(run);
    let physics = run.physics();
    // Normal from the second grain, which is at rest until the shock, to the first grain.
    let normal = DVec2::new(-(1.0 - aside * aside).sqrt(), aside);
    let tangent = normal.perp();
    let spin = RADIUS * run.grains().angular_velocities[0];
    let before = DVec2::new(speed, 0.0);
    let lambda = -(1.0 + restitution) * before.dot(normal);
    let sliding = before.dot(tangent) - spin;
    let (compliance, bound) = match (physics.friction, physics.rotation) {
        (false, _) => (1.0, 0.0),
        (_, turns) => (if turns { 3.0 } else { 1.0 }, friction * lambda),
    };
    let rubbing = (-sliding / compliance).clamp(-bound, bound);
    let expected = before + lambda * normal + rubbing * tangent;
    let dt = run.parameters().time_step_secs;
    take_steps(run, (gap / speed / dt) as usize + 2);
    let found = -relative_velocity(run);
    let what =
        format!("gap {gap:e}, aside {aside}, v {speed}, size {size}, ρ {restitution}, Δt {dt}");
    let off = (found - expected).length();
    assert!(off <= 1e-9 * speed, "{what}: {found} for {expected}");
    let lost = (momentum(run) - momentum_before).length();
    assert!(lost <= 1e-12 * mass * speed, "{what}: momentum {lost:e}");
    // The distance moved after the shock shows whether the shock had the right time.
    let way = run.time_secs() - gap / speed;
    let apart = RADIUS * (1.0 + size) * normal + way * expected;
    let places = run.places();
    let off = (places[0] - places[1] - apart).length();
    assert!(off <= 1e-6 * RADIUS + 1e-9 * apart.length(), "{what}: off by {off:e} m");
}

#[test]
fn a_bond_takes_its_work_from_a_bounce_or_all_there_is() {
    let work = BOND * G * DISTANCE_IN_DIAMETERS * 2.0 * RADIUS;
    let escape = (2.0 * work).sqrt();
    for (time_step_secs, restitution, factor) in
        triples(TIME_STEPS, [0.3, 0.8, 1.0], [0.5, 0.95, 1.05, 2.0, 10.0])
    {
        for phase in [0.01, 0.3, 0.77, 0.99] {
            let speed = factor * escape / restitution;
            let gap = phase * speed * time_step_secs;
            let numbers = parameters(BOND, time_step_secs, restitution, 0.5);
            let mut run = two(SMOOTH, numbers, [gap, 0.0, speed, 1.0]);
            let what = format!("{factor} of it, ρ {restitution}, Δt {time_step_secs}, {phase}");
            let begun = run.observables().kinetic_energy;
            let (mut pushes, mut bonds) = (0.0, 0.0);
            for _ in 0..(0.1 / time_step_secs) as u32 + 3 {
                let now = *run.step().expect("finite");
                let of_bonds = now.bond_work.expect("bonds");
                bonds += of_bonds;
                pushes += now.normal_work - of_bonds;
                assert!(pushes <= 1e-9 * begun, "{what}: pushes gave {pushes:e}");
                let [stored, broken] =
                    [now.bond_energy, now.broken_bond_energy].map(Option::unwrap);
                assert!((bonds + stored + broken).abs() <= 1e-9 * begun, "{what}");
            }
            let velocities = run.velocities();
            let found = velocities[1].x - velocities[0].x;
            let squared = (factor * factor - 1.0) * escape * escape;
            if factor > 1.0 {
                assert_close(found, squared.sqrt(), 1e-9, &what);
            } else {
                let apart = run.place(1).x - run.place(0).x - 2.0 * RADIUS;
                assert!(apart < 0.2 * RADIUS, "{what}: held, but {apart} m apart");
            }
        }
    }
}

#[test]
fn a_wall_that_comes_throws_a_grain_off_by_its_own_speed() {
    for (time_step_secs, restitution) in pairs(TIME_STEPS, [0.0, 0.4, 1.0]) {
        let grain =
            weightless(moving(DVec2::new(1.03 * RADIUS, 0.0), RADIUS, DVec2::new(-0.2, 0.0)));
        let run = after(
            &Scene {
                boundaries: vec![piston(DVec2::ZERO, DVec2::X, 0.3, 10.0)],
                ..ranged(
                    SMOOTH,
                    DVec2::new(0.0, -G),
                    parameters(0.0, time_step_secs, restitution, 0.0),
                    vec![grain],
                )
            },
            3 + (1e-3 / time_step_secs) as usize,
        );
        let found = run.velocity(0).x;
        assert_close(found, 0.3 + restitution * 0.5, 1e-9, &format!("{time_step_secs}"));
    }
}

#[test]
fn what_passes_by_or_is_deflected_before_is_not_struck() {
    for time_step_secs in TIME_STEPS {
        // The first disc barely misses the second, but the linearised gap predicts a contact.
        let aside = 2.0 * RADIUS * (1.0 + 1e-6);
        let grains = vec![
            weightless(moving(DVec2::new(-1.5 * RADIUS, aside), RADIUS, DVec2::new(1.0, 0.0))),
            weightless(Grain::at_rest(DVec2::ZERO, RADIUS)),
        ];
        let numbers = parameters(0.0, time_step_secs, 1.0, 0.0);
        let run = after(&ranged(SMOOTH, DVec2::new(0.0, -G), numbers, grains), 3);
        assert_eq!(run.grains().velocities, [DVec2::X, DVec2::ZERO]);
        // The first disc moves towards the second, but before they meet a third disc hits the first from below.
        let up = DVec2::new(0.0, 1.0);
        let grains = vec![
            weightless(moving(DVec2::new(-2.2 * RADIUS, 0.0), RADIUS, DVec2::new(0.2, 0.0))),
            weightless(Grain::at_rest(DVec2::ZERO, RADIUS)),
            weightless(moving(
                DVec2::new(-2.2 * RADIUS, -2.05 * RADIUS),
                RADIUS,
                DVec2::new(0.2, 0.0) + up,
            )),
        ];
        let run = after(
            &ranged(SMOOTH, DVec2::new(0.0, -G), numbers, grains),
            1 + (2.0 * RADIUS / time_step_secs) as usize,
        );
        let velocities = run.velocities();
        let energy: f64 = velocities.iter().map(|velocity| velocity.length_squared()).sum();
        let off = (velocities[0] - DVec2::new(0.2, 1.0)).length() + velocities[1].length();
        assert!(off < 0.2, "the first is deflected and the second is let be: {velocities:?}");
        assert_close(energy, 0.04 + 1.04, 1e-9, "energy");
    }
}

/// Returns the heights above a plane that a ball reaches after each bounce, m. They are the highest of its positions at
/// the ends of steps.
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
    for (time_step_secs, (restitution, count), height) in triples(
        [1e-4, 1e-3, 3e-3, 5e-3, 1e-2],
        [(0.5, 3), (0.7, 5), (0.9, 12), (1.0, 20)],
        [0.3, 0.41],
    ) {
        let mut ideal = height;
        for (bounce, found) in
            apexes(time_step_secs, restitution, height, count).into_iter().enumerate()
        {
            ideal *= restitution * restitution;
            // Between the ends of two steps the ball may be up to gΔt²/8 higher.
            let allowed = 0.125 * G * time_step_secs.powi(2) + 1e-9 * height;
            let below = ideal - found;
            let what = format!("Δt {time_step_secs}, ρ {restitution}, bounce {bounce}");
            assert!(below >= -1e-9 * height, "{what}: {found} for {ideal}");
            assert!(below <= allowed, "{what}: {found} for {ideal}, {below:e} lower");
        }
    }
}

/// Returns a run of discs at random positions in a box, with random velocities. `fill` is the fraction of the area that
/// the discs cover.
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

/// Returns the final velocities of a ball that hits a row of four balls, and of these four balls, m/s. Neighbours in
/// the row are separated by `gap` (m).
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
    for (time_step_secs, bond) in pairs([1e-4, 1e-3, 5e-3], [0.0, BOND]) {
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
