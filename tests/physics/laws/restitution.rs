//! Bounces on a plane: every shock turns the normal velocity into −ρ times itself.

use crate::common::*;

const RADIUS: f64 = 0.05;
const HEIGHT: f64 = 0.3;
const DT: f64 = 1e-4;

/// A disc dropped from [`HEIGHT`] on the plane through the origin, along `up`.
fn drop(physics: Physics, up: DVec2, restitution: f64, bond: f64) -> Scene {
    let grain = Grain::at_rest((RADIUS + HEIGHT) * up, RADIUS);
    let parameters = parameters(bond, DT, restitution, 0.5);
    Scene {
        boundaries: vec![plane(DVec2::ZERO, up)],
        ..scene(physics, -G * up, parameters, vec![grain])
    }
}

/// Speeds (before, after) of each of the first `count` shocks, and the highest point after each.
fn bounces(scene: &Scene, up: DVec2, count: usize) -> (Vec<[f64; 2]>, Vec<f64>) {
    let mut run = start(scene);
    let (mut shocks, mut heights) = (Vec::new(), Vec::new());
    let mut highest = 0f64;
    while heights.len() < count {
        let before = run.velocity(0).dot(up);
        run.step().expect("a finite state");
        let after = run.velocity(0).dot(up);
        let height = run.place(0).dot(up) - RADIUS;
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
                // A shock comes up to one step late, at the wrong height by up to speed × Δt, and
                // leaves gravity out for that step: two times speed × Δt a bounce at the most.
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
        // It lies as deep as one step of the fall took it.
        let depth = run.observables().max_overlap * run.world().mean_diameter;
        assert!(depth > 0.0 && depth <= 1.01 * (2.0 * G * HEIGHT).sqrt() * DT);
    }
}

#[test]
fn cohesion_holds_what_bounces_slower_than_the_capture_speed() {
    // The shock itself is the same (A > 0); the step after it pulls back Bond·g·Δt, and where that
    // is more than (1 + ρ) times the speed, the contact closes again.
    let (restitution, speed) = (0.5, (2.0 * G * HEIGHT).sqrt());
    for (times, escapes) in [(0.8, true), (1.2, false)] {
        let bond = times * (1.0 + restitution) * restitution * speed / (G * DT);
        let mut scene = drop(LINE, DVec2::X, restitution, bond);
        // Deep enough to touch still after the shock.
        scene.grains[0].position.x = RADIUS - speed * DT;
        scene.grains[0].velocity.x = -speed;
        let mut run = start(&scene);
        run.step().expect("a finite state");
        let rebound = run.velocity(0).x;
        assert_close(rebound, restitution * speed, 1e-12, "it bounced");
        let still_overlapping = run.place(0).x < RADIUS;
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
