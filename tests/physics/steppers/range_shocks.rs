//! Shocks under the law `range` against exact motion: whatever Δt is, and wherever in a step bodies meet.

use crate::common::*;

const RADIUS: f64 = 2.5e-3;
const BOND: f64 = 20.0;
const TIME_STEPS: [f64; 6] = [1e-4, 3e-4, 1e-3, 2e-3, 5e-3, 2e-2];

/// Two discs in free flight, the second at rest, that have `gap` metres to go along x until they meet with
/// their centres apart by `aside` sums of radii along y.
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
        for &aside in asides {
            for time_step_secs in TIME_STEPS {
                for restitution in [0.0, 0.3, 0.8, 1.0] {
                    for (size, speed) in [(1.0, 0.1), (1.7, 0.1), (0.3, 2.0)] {
                        for phase in [1e-9, 0.11, 0.37, 0.5, 0.93, 1.0 - 1e-9, 1.4] {
                            let numbers = parameters(0.0, time_step_secs, restitution, 0.2);
                            let gap = phase * speed * time_step_secs;
                            let what = [gap, aside, speed, size];
                            let mut run = two(physics, numbers, what);
                            check_bounce(&mut run, restitution, what);
                            met += 1;
                        }
                    }
                }
            }
        }
    }
    assert!(met > 3000, "{met} bounces");
}

/// Steps past a meeting of [`two`] and compares velocities with those of a shock at the exact place.
fn check_bounce(run: &mut Simulation, restitution: f64, [gap, aside, speed, size]: [f64; 4]) {
    let (momentum_before, friction) = (momentum(run), run.parameters().friction);
    let mass = effective_mass(run);
    let physics = run.physics();
    // From the second grain, which stands still until then, to the first.
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
    // Where it is tells when it bounced.
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
    for time_step_secs in TIME_STEPS {
        for restitution in [0.3, 0.8, 1.0] {
            for factor in [0.5, 0.95, 1.05, 2.0, 10.0] {
                for phase in [0.01, 0.3, 0.77, 0.99] {
                    let speed = factor * escape / restitution;
                    let gap = phase * speed * time_step_secs;
                    let numbers = parameters(BOND, time_step_secs, restitution, 0.5);
                    let mut run = two(SMOOTH, numbers, [gap, 0.0, speed, 1.0]);
                    let what =
                        format!("{factor} of it, ρ {restitution}, Δt {time_step_secs}, {phase}");
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
    }
}

#[test]
fn a_wall_that_comes_throws_a_grain_off_by_its_own_speed() {
    for time_step_secs in TIME_STEPS {
        for restitution in [0.0, 0.4, 1.0] {
            let grain =
                weightless(moving(DVec2::new(1.03 * RADIUS, 0.0), RADIUS, DVec2::new(-0.2, 0.0)));
            let run = after(
                &Scene {
                    boundaries: vec![Boundary::Piston {
                        point: DVec2::ZERO,
                        normal: DVec2::X,
                        speed: 0.3,
                        travel: 10.0,
                    }],
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
}

#[test]
fn what_passes_by_or_is_deflected_before_is_not_struck() {
    for time_step_secs in TIME_STEPS {
        // The first would pass the second by a hair: the tangents of their gap say that they meet.
        let aside = 2.0 * RADIUS * (1.0 + 1e-6);
        let grains = vec![
            weightless(moving(DVec2::new(-1.5 * RADIUS, aside), RADIUS, DVec2::new(1.0, 0.0))),
            weightless(Grain::at_rest(DVec2::ZERO, RADIUS)),
        ];
        let numbers = parameters(0.0, time_step_secs, 1.0, 0.0);
        let run = after(&ranged(SMOOTH, DVec2::new(0.0, -G), numbers, grains), 3);
        assert_eq!(run.grains().velocities, [DVec2::X, DVec2::ZERO]);
        // The first is on its way to the second, and the third hits it from below before.
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
