//! Tests of a single contact: the three cases of the paper's §2.2, and the force that pulls a contact open.
//!
//! Let v = v^{n−1} be the normal velocity at the beginning of a step (positive opens the contact), v^n the normal
//! velocity at the end of the step, ρ the restitution, and a the relative normal acceleration by external forces. The
//! normal impulse P and the cohesion force C₀ are divided by the effective mass m_ij: λ = P/m_ij and c = C₀Δt/m_ij. The
//! contact law (`contact::law`) requires 0 ≤ λ + c ⟂ u ≥ 0 with u = v^n + ρv and v^n = v + aΔt + λ. The contact force
//! that gives u = 0 is A = −m_ij ((1 + ρ) v/Δt + a). So there are these cases:
//!
//! * A ≥ −C₀: λ = AΔt/m_ij fulfils the law with u = 0, and v^n = −ρ v for any a. For A > 0 the contact pushes (a
//!   closing pair bounces), for A < 0 it pulls (an opening pair closes again).
//! * A < −C₀: λ = −c, and v^n = v + aΔt − C₀Δt/m_ij: the contact opens (u > 0).

use crate::common::*;

/// A test case: initial state of a contact between a grain i and another body. The velocity of the grain relative to
/// the other body (m/s) is along the normal.
#[derive(Clone)]
struct Case {
    parameters: Parameters,
    velocity: f64,
    /// Direction of gravity: 1 presses grain i against the other body of the contact, −1 pulls it away, 0 switches
    /// gravity off.
    pressing: f64,
}

const RADIUS: f64 = 0.15;
const OTHER_RADIUS: f64 = 0.1;
/// Initial overlap, m: enough for a contact to be detected, too small for any other effect.
const OVERLAP: f64 = 1e-9;

fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for (bond, time_step_secs, restitution) in
        triples([0.0, 3.0, 50.0], [1e-5, 1e-3, 1e-2], [0.0, 0.2, 1.0])
    {
        for (velocity, pressing) in pairs([-1.0, -1e-3, 1e-4, 0.05, 2.0], [-1.0, 0.0, 1.0]) {
            let parameters = parameters(bond, time_step_secs, restitution, 0.5);
            cases.push(Case { parameters, velocity, pressing });
        }
    }
    cases
}

/// Returns a scene in which grain i touches a disc that does not move. `direction` is the unit vector from this disc to
/// the grain.
fn against_fixed(case: &Case, physics: Physics, direction: DVec2) -> Scene {
    let place = (RADIUS + OTHER_RADIUS - OVERLAP) * direction;
    let mut grain = moving(place, RADIUS, case.velocity * direction);
    grain.feels_gravity = case.pressing != 0.0;
    let gravity = if case.pressing == 0.0 { -G } else { -G * case.pressing } * direction;
    Scene {
        fixed_discs: vec![fixed(DVec2::ZERO, OTHER_RADIUS)],
        // One update solves a single contact. More updates would add rounding errors to P that are too small to move
        // the bodies.
        solver: SolverSettings { max_sweeps: 1, ..tight() },
        ..scene(physics, gravity, case.parameters, vec![grain])
    }
}

/// Returns the scene of [`against_fixed`] with a weightless grain j in place of the disc that does not move. Both
/// grains have an additional common velocity.
fn free_pair(case: &Case, physics: Physics, direction: DVec2) -> Scene {
    let mut scene = against_fixed(case, physics, direction);
    let drift = 0.3 * direction;
    let j = scene.fixed_discs.remove(0);
    scene.grains[0].velocity += drift;
    scene.grains.push(weightless(moving(j.position, j.radius, drift)));
    scene
}

/// Takes one step and compares the final normal velocity v^n and the normal impulse P with theory. Returns which of the
/// three cases occurred: 0 if the contact pushes (a closing pair bounces), 1 if it pulls (an opening pair closes
/// again), 2 if it opens because it cannot pull strongly enough.
fn check(case: &Case, scene: &Scene, direction: DVec2) -> usize {
    let mut run = start(scene);
    run.step().expect("a finite state");
    let grains = run.grains();
    let (mass, other) = match grains.masses[..] {
        [i] => (i, DVec2::ZERO),
        [i, j] => (1.0 / (1.0 / i + 1.0 / j), grains.velocities[1]),
        _ => unreachable!("one or two grains"),
    };
    assert_eq!(run.contacts().contacts().len(), 1, "the pair was to touch");
    let found = (grains.velocities[0] - other).dot(direction);
    let impulse = run.contacts().impulses()[0];

    let Parameters { bond, time_step_secs: dt, restitution, .. } = case.parameters;
    let acceleration = -G * case.pressing;
    let cohesion_force = bond * mass * G;
    let force = -mass * ((1.0 + restitution) * case.velocity / dt + acceleration);
    let (velocity, normal_force) = if force > -cohesion_force {
        (-restitution * case.velocity, force)
    } else {
        (case.velocity + acceleration * dt - dt * cohesion_force / mass, -cohesion_force)
    };
    // Velocities are sums of terms of this size (m/s), so their rounding errors are proportional to it.
    let scale = case.velocity.abs() + 0.3 + G * dt + dt * cohesion_force / mass;
    let off = (found - velocity).abs();
    assert!(off <= 1e-12 * scale, "A = {force}: v^n is {found}, not {velocity}");
    let off = (impulse.normal - dt * normal_force).abs();
    assert!(off <= 1e-12 * mass * scale, "A = {force}: P is {}", impulse.normal);
    assert_eq!(impulse.tangential.abs(), 0.0, "nothing slides");
    if force > 0.0 {
        0
    } else if force > -cohesion_force {
        1
    } else {
        2
    }
}

#[test]
fn one_contact_bounces_closes_again_or_opens_as_in_section_2_2() {
    // Along an axis the tangential velocity is exactly 0, so friction and rotation do not affect a head-on shock.
    for (physics, direction) in [
        (LINE, DVec2::X),
        (LINE, -DVec2::X),
        (SMOOTH, DVec2::new(0.6, -0.8)),
        (Physics::FULL, DVec2::Y),
        (Physics::FULL, -DVec2::X),
    ] {
        let mut against_fixed_seen = [0; 3];
        let mut free_seen = [0; 3];
        for case in cases() {
            let scene = against_fixed(&case, physics, direction);
            against_fixed_seen[check(&case, &scene, direction)] += 1;
            let scene = free_pair(&case, physics, direction);
            free_seen[check(&case, &scene, direction)] += 1;
        }
        for seen in [against_fixed_seen, free_seen] {
            assert!(seen.iter().all(|&count| count > 30), "all three cases arise: {seen:?}");
        }
    }
}

/// Time steps (s) at which the same force must pull a bonded grain off.
const TIME_STEPS: [f64; 7] = [1e-5, 3e-5, 1e-4, 3e-4, 1e-3, 2e-3, 5e-3];

/// Returns a scene in which gravity pulls a bonded grain off another body, on which gravity does not act: a second
/// grain if `free` is true, otherwise a disc that does not move. The pull is m_ij g and the cohesion force C₀ is
/// Bond·m_ij·g (m_ij: effective mass), so the bond breaks for Bond < 1.
fn pulled(bond: f64, dt: f64, physics: Physics, free: bool) -> Scene {
    let parameters = Parameters { touch_tolerance: 0.0, ..parameters(bond, dt, 0.2, 0.5) };
    let case = Case { parameters, velocity: 0.0, pressing: -1.0 };
    let direction = if physics.axes == 1 { DVec2::X } else { -DVec2::Y };
    let mut scene = against_fixed(&case, physics, direction);
    if free {
        let j = scene.fixed_discs.remove(0);
        scene.grains.push(weightless(Grain::at_rest(j.position, j.radius)));
    }
    scene
}

#[test]
fn the_static_pull_off_force_does_not_depend_on_the_time_step() {
    for (dt, physics, free) in triples(TIME_STEPS, [LINE, SMOOTH, Physics::FULL], [false, true]) {
        let relative = |run: &Simulation| {
            let velocities = run.velocities();
            velocities[0] - velocities.get(1).copied().unwrap_or_default()
        };

        let holding = after(&pulled(1.0 + 1e-6, dt, physics, free), 100);
        assert_eq!(holding.observables().contacts, 1, "Δt {dt}: held");
        assert!(relative(&holding).length() < 1e-12 * G * dt, "Δt {dt}: held still");
        let mass = holding.grains().masses[0];
        let share = if free { holding.grains().masses[1] } else { f64::INFINITY };
        let pull = G / (1.0 / mass + 1.0 / share);
        let impulse = holding.contacts().impulses()[0].normal;
        assert_close(impulse / dt, -pull, 1e-11, "the force in the contact");

        let mut opening = start(&pulled(1.0 - 1e-6, dt, physics, free));
        opening.step().expect("a finite state");
        let speed = relative(&opening).length();
        assert_close(speed, 1e-6 * G * dt, 1e-8, "the speed it opens with");
        // The pull exceeds C₀ by 1e-6 of the weight, so the overlap is gone after at most √(2·OVERLAP / 1e-6 g).
        let mut steps = 0.02 / dt;
        while opening.observables().contacts > 0 && steps > 0.0 {
            opening.step().expect("a finite state");
            steps -= 1.0;
        }
        assert_eq!(opening.observables().contacts, 0, "Δt {dt}: opens for good");
    }
}

#[test]
fn a_corner_of_a_polyline_holds_no_more_than_one_contact() {
    for (bond, holds) in [(1.0 + 1e-6, true), (1.0 - 1e-6, false)] {
        let mut scene = pulled(bond, 1e-3, Physics::FULL, false);
        // The disc hangs under the middle point of a polyline, in which two segments meet.
        let points = vec![DVec2::new(-1.0, 0.5), DVec2::ZERO, DVec2::new(1.0, 0.3)];
        scene.fixed_discs.clear();
        scene.boundaries = vec![Boundary::Polyline { points }];
        scene.grains[0].position = DVec2::new(0.0, OVERLAP - RADIUS);
        let mut run = start(&scene);
        run.step().expect("a finite state");
        assert_eq!(run.observables().contacts, 1, "the corner is told once");
        take_steps(&mut run, 50);
        assert_eq!(run.observables().contacts == 1, holds, "Bond {bond}");
    }
}

const BALL_RADIUS: f64 = 0.05;
const HEIGHT: f64 = 0.3;
const DT: f64 = 1e-4;

/// Returns a scene with a disc at rest at the height [`HEIGHT`] above a plane through the origin. `up` is the normal of
/// the plane.
fn drop(physics: Physics, up: DVec2, restitution: f64, bond: f64) -> Scene {
    let grain = Grain::at_rest((BALL_RADIUS + HEIGHT) * up, BALL_RADIUS);
    let parameters = parameters(bond, DT, restitution, 0.5);
    Scene {
        boundaries: vec![plane(DVec2::ZERO, up)],
        ..scene(physics, -G * up, parameters, vec![grain])
    }
}

/// Runs until the disc has bounced `count` times. Returns its speeds before and after each impact (m/s), and its
/// greatest heights between consecutive impacts (m).
fn bounces(scene: &Scene, up: DVec2, count: usize) -> (Vec<[f64; 2]>, Vec<f64>) {
    let mut run = start(scene);
    let (mut shocks, mut heights) = (Vec::new(), Vec::new());
    let mut highest = 0f64;
    while heights.len() < count {
        let before = run.velocity(0).dot(up);
        run.step().expect("a finite state");
        let after = run.velocity(0).dot(up);
        let height = run.place(0).dot(up) - BALL_RADIUS;
        if run.contacts().impulses().iter().any(|impulse| impulse.normal > 0.0) {
            if !shocks.is_empty() {
                heights.push(highest);
            }
            shocks.push([before, after]);
            highest = f64::NEG_INFINITY;
        }
        highest = highest.max(height);
        assert!(run.time_secs() < 20.0, "only {} bounces", heights.len());
    }
    (shocks, heights)
}

#[test]
fn each_bounce_keeps_the_fraction_rho_of_the_speed() {
    let tilted = DVec2::new(0.6, 0.8);
    for (physics, up) in
        [(LINE, DVec2::X), (SMOOTH, DVec2::Y), (Physics::FULL, DVec2::Y), (SMOOTH, tilted)]
    {
        for (restitution, count) in [(0.1, 1), (0.3, 2), (0.5, 4), (0.8, 8), (1.0, 8)] {
            let (shocks, heights) = bounces(&drop(physics, up, restitution, 0.0), up, count);
            for [before, after] in shocks {
                assert!(before < 0.0, "a shock closes");
                assert_close(after, -restitution * before, 1e-12, "speed after a shock");
            }
            let mut ideal = HEIGHT;
            for (bounce, height) in heights.into_iter().enumerate() {
                ideal *= restitution * restitution;
                // A shock comes up to one step late. So the height at the shock is wrong by up to speed × Δt, and
                // gravity is missing for one step, which makes the error at most two times speed × Δt per bounce.
                let allowed = 2.0 * (bounce + 1) as f64 * (2.0 * G * HEIGHT).sqrt() * DT;
                let off = (height - ideal).abs();
                assert!(off <= allowed, "ρ {restitution}, bounce {bounce}: {height} for {ideal}");
            }
        }
    }
}

#[test]
fn without_restitution_the_first_shock_is_the_last() {
    for up in [DVec2::Y, DVec2::new(0.6, 0.8)] {
        let mut run = start(&drop(Physics::FULL, up, 0.0, 0.0));
        let mut shocked = false;
        for _ in 0..10_000 {
            run.step().expect("a finite state");
            let speed = run.velocity(0).dot(up);
            shocked |= run.observables().contacts > 0;
            if shocked {
                assert!(speed.abs() < 1e-14, "still after the shock: {speed:e}");
            }
        }
        assert!(shocked);
        // The overlap is at most the distance that the disc falls in one step.
        let depth = run.observables().max_overlap * run.world().mean_diameter;
        assert!(depth > 0.0 && depth <= 1.01 * (2.0 * G * HEIGHT).sqrt() * DT);
    }
}

#[test]
fn cohesion_holds_what_bounces_slower_than_the_capture_speed() {
    // The shock itself is the same with and without cohesion (A > 0). In the next step cohesion removes the speed
    // Bond·g·Δt. If this is more than (1 + ρ) times the rebound speed, the contact closes again.
    let (restitution, speed) = (0.5, (2.0 * G * HEIGHT).sqrt());
    for (times, escapes) in [(0.8, true), (1.2, false)] {
        let bond = times * (1.0 + restitution) * restitution * speed / (G * DT);
        let mut scene = drop(LINE, DVec2::X, restitution, bond);
        // The disc starts one step deep in the plane, so that the contact still exists after the shock.
        scene.grains[0].position.x = BALL_RADIUS - speed * DT;
        scene.grains[0].velocity.x = -speed;
        let mut run = start(&scene);
        run.step().expect("a finite state");
        let rebound = run.velocity(0).x;
        assert_close(rebound, restitution * speed, 1e-12, "it bounced");
        let still_overlapping = run.place(0).x < BALL_RADIUS;
        assert!(still_overlapping, "or else cohesion had no hold on it");
        run.step().expect("a finite state");
        let after = run.velocity(0).x;
        if escapes {
            let expected = rebound - (bond + 1.0) * G * DT;
            assert_close(after, expected, 1e-9, "speed after one step of cohesion");
        } else {
            assert_close(after, -restitution * rebound, 1e-12, "closed again");
        }
    }
}
