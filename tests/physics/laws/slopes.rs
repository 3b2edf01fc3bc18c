//! Tests of a disc on a slope, for every kind of fixed shape: Coulomb's threshold, sliding and rolling.
//!
//! The slope is a level shape under gravity that is inclined by the angle θ (g: gravitational acceleration, μ: friction
//! coefficient, r: radius of the disc). Per mass, g cosθ presses the disc against the slope and g sinθ pulls it down
//! the slope. A disc that cannot rotate sticks up to tanθ = μ, and above slides with the acceleration g (sinθ − μ
//! cosθ). A solid disc that rotates rolls without slip up to tanθ = 3μ, with the acceleration ⅔ g sinθ. Above, it
//! slides with g (sinθ − μ cosθ) while its angular velocity grows by 2μ g cosθ / r per second. The scheme gives these
//! values exactly in every step and for every time step Δt, because one update solves one contact exactly.

use crate::common::*;

const RADIUS: f64 = 0.1;
const MU: f64 = 0.3;
const DT: f64 = 1e-3;

/// Returns a scene with a disc that touches the level y = 0 from above, under gravity inclined by θ (`slope` = tanθ).
fn on_level(physics: Physics, slope: f64, mu: f64, boundary: Boundary) -> Scene {
    let grain = Grain::at_rest(DVec2::new(0.0, RADIUS * (1.0 - 1e-10)), RADIUS);
    let gravity = G * DVec2::new(slope, -1.0).normalize();
    Scene {
        boundaries: vec![boundary],
        ..scene(physics, gravity, parameters(0.0, DT, 0.0, mu), vec![grain])
    }
}

fn levels() -> Vec<(&'static str, Boundary)> {
    let at = |x: f64| DVec2::new(x, 0.0);
    let low = |x: f64| DVec2::new(x, -1.0);
    vec![
        ("half-space", plane(at(3.0), DVec2::new(0.0, 2.0))),
        ("segment", Boundary::Segment { from: at(-1.0), to: at(50.0) }),
        ("segment backwards", Boundary::Segment { from: at(50.0), to: at(-1.0) }),
        ("polyline", Boundary::Polyline { points: [-1.0, 0.04, 0.9, 50.0].map(at).to_vec() }),
        (
            "polygon",
            Boundary::ConvexPolygon { points: vec![low(-1.0), low(50.0), at(50.0), at(-1.0)] },
        ),
    ]
}

fn acceleration(slope: f64) -> (f64, f64) {
    let hypotenuse = slope.hypot(1.0);
    (G * slope / hypotenuse, G / hypotenuse)
}

#[test]
fn a_disc_that_cannot_roll_slides_above_coulombs_threshold_and_not_below() {
    for (name, level) in levels() {
        let stuck = after(&on_level(UNTURNING, MU * (1.0 - 1e-6), MU, level.clone()), 500);
        assert_eq!(stuck.observables().contacts, 1, "{name}");
        assert!(stuck.velocity(0).length() < 1e-14, "{name}: sticks");
        let impulse = stuck.contacts().impulses()[0];
        assert_close(impulse.tangential.abs(), MU * impulse.normal, 2e-6, name);

        for slope in [MU * (1.0 + 1e-6), 0.5, 2.0] {
            let sliding = after(&on_level(UNTURNING, slope, MU, level.clone()), 500);
            let (along, onto) = acceleration(slope);
            let velocity = sliding.velocity(0);
            let expected = (along - MU * onto) * DT * 500.0;
            // At 1e-6 above the threshold the acceleration is a small difference, and rounding errors of μ g cosθ are
            // 1e-9 of it.
            assert_close(velocity.x, expected, 1e-8, name);
            assert!(velocity.y.abs() < 1e-12, "{name}: stays on its level");
            assert_eq!(sliding.grains().angular_velocities[0], 0.0);
        }
    }
}

#[test]
fn cohesion_steepens_the_threshold_with_the_shifted_cone_alone() {
    // |T| ≤ μ(N + C₀) with C₀ = Bond·m·g: the disc sticks if sinθ ≤ μ (cosθ + Bond).
    let (bond, level) = (0.8, levels().remove(0).1);
    let moves = |slope: f64, cone: FrictionCone| {
        let mut scene = on_level(UNTURNING, slope, MU, level.clone());
        scene.parameters.bond = bond;
        scene.parameters.cone = cone;
        let run = after(&scene, 100);
        run.velocity(0).x / (G * DT * 100.0)
    };
    // sinθ − μ cosθ = μ·Bond, that is sin(θ − φ) = μ·Bond·cosφ with tanφ = μ.
    let steepest = (MU.atan() + (MU * bond * MU.atan().cos()).asin()).tan();
    assert!(steepest > 1.5 * MU);
    assert!(moves(steepest * (1.0 - 1e-6), FrictionCone::Shifted).abs() < 1e-14);
    assert!(moves(steepest * (1.0 + 1e-6), FrictionCone::Shifted) > 1e-8);
    assert!(moves(MU * (1.0 - 1e-6), FrictionCone::Compressive).abs() < 1e-14);
    assert!(moves(MU * (1.0 + 1e-6), FrictionCone::Compressive) > 1e-8);
}

#[test]
fn a_disc_rolls_without_slip_up_to_three_mu_and_with_slip_above() {
    for ((name, level), slope) in
        pairs(levels(), [0.1, MU, 3.0 * MU * (1.0 - 1e-6), 3.0 * MU * (1.0 + 1e-6), 2.0])
    {
        let run = after(&on_level(Physics::FULL, slope, MU, level.clone()), 500);
        let (along, onto) = acceleration(slope);
        let grains = run.grains();
        let secs = 500.0 * DT;
        let spin = -RADIUS * grains.angular_velocities[0];
        let (speed, expected_spin) = if slope < 3.0 * MU {
            (along * secs * 2.0 / 3.0, along * secs * 2.0 / 3.0)
        } else {
            ((along - MU * onto) * secs, 2.0 * MU * onto * secs)
        };
        assert_close(grains.velocities[0].x, speed, 1e-10, &format!("{name}, tanθ {slope}"));
        assert_close(spin, expected_spin, 1e-10, &format!("{name}: spin at tanθ {slope}"));
        assert!(grains.positions[0].x > 0.05, "{name}: got past the polyline's vertex");
        let turned = -RADIUS * grains.angles[0];
        let way = grains.positions[0].x;
        assert_eq!((turned - way).abs() < 1e-9 * way, slope < 3.0 * MU, "{name}: no slip");
    }
}

#[test]
fn a_vertex_of_a_nearly_flat_polyline_is_not_felt() {
    let tilt = 1e-6;
    for kink in [-tilt, tilt] {
        let points = [DVec2::new(-1.0, 0.0), DVec2::new(0.5, 0.0), DVec2::new(20.0, 19.5 * kink)];
        let bent = Boundary::Polyline { points: points.to_vec() };
        let on_bent = after(&on_level(Physics::FULL, 0.2, MU, bent), 2000);
        let on_level = after(&on_level(Physics::FULL, 0.2, MU, levels().remove(0).1), 2000);
        let [a, b] = [&on_bent, &on_level].map(|run| run.grains().clone());
        assert!(a.positions[0].x > 2.0, "it rolled over the vertex");
        let off = a.velocities[0].distance(b.velocities[0]);
        assert!(off < 10.0 * tilt * b.velocities[0].length(), "kink {kink}: off by {off}");
        assert!(off > 0.0, "there was a vertex");
    }
}

#[test]
fn a_disc_leaves_a_fixed_disc_at_four_sevenths() {
    // A disc that rolls without slip, from rest at the angle α from the top of a fixed disc, has ¾v² = g R (cosα −
    // cosφ) at the angle φ, by conservation of energy. R is the distance of the centres. The normal force N = m (g cosφ
    // − v²/R) vanishes at cosφ = 4/7 cosα.
    let (other, start_angle) = (0.4, 0.2f64);
    let leaving_cosine = |dt: f64| {
        let reach = other + RADIUS;
        let place = reach * (1.0 - 1e-9) * DVec2::new(start_angle.sin(), start_angle.cos());
        let scene = Scene {
            fixed_discs: vec![fixed(DVec2::ZERO, other)],
            ..under_g(parameters(0.0, dt, 0.0, 1e3), vec![Grain::at_rest(place, RADIUS)])
        };
        let mut run = start(&scene);
        let (mut cosine, mut touched) = (1.0, 0);
        while run.place(0).length() < 1.02 * reach {
            run.step().expect("a finite state");
            if run.observables().contacts > 0 {
                cosine = run.contacts().contacts()[0].normal.y;
                touched += 1;
            }
        }
        assert!(touched > 100, "it rolled for {touched} steps");
        cosine
    };
    let ideal = 4.0 / 7.0 * start_angle.cos();
    for dt in [1e-3, 1e-4] {
        // Near N = 0 the path of the free disc separates slowly from the surface, so contacts still occur after the
        // ideal end. The last contact is late by about √Δt (measured: 0.75 and 0.98 times √Δt).
        let off = (leaving_cosine(dt) - ideal).abs();
        assert!(off < 1.2 * dt.sqrt(), "Δt {dt}: left at {off} off the ideal cosine");
    }
}

/// Returns a scene with a cohesive disc (Bond number `bond`) on a half-space, under gravity inclined by θ (`slope` =
/// tanθ). The stepper is one of [`SCHEMES`], which do not solve one contact problem for the whole step.
fn on_slope(
    stepper: Stepper,
    physics: Physics,
    slope: f64,
    bond: f64,
    cone: FrictionCone,
) -> Scene {
    let mut scene = by(stepper, 0, on_level(physics, slope, MU, level()));
    scene.parameters = Parameters { bond, cone, restitution: 0.1, ..scene.parameters };
    scene
}

/// Runs 500 steps, in which the disc settles into its contact, and 200 further steps. Returns the final velocity of the
/// disc along the slope (m/s) and its mean acceleration over the last 200 steps (m/s²).
fn slides(scene: &Scene) -> (f64, f64) {
    let mut run = after(scene, 500);
    let velocity = run.velocity(0).x;
    take_steps(&mut run, 200);
    let later = run.velocity(0).x;
    assert_eq!(run.observables().contacts, 1);
    (later, (later - velocity) / 0.2)
}

#[test]
fn friction_keeps_to_coulombs_cone() {
    let mu = MU;
    for method in SCHEMES {
        let shifted = FrictionCone::Shifted;
        let (velocity, _) = slides(&on_slope(method, UNTURNING, 0.999 * mu, 0.0, shifted));
        assert!(velocity.abs() < 1e-9, "{method:?} sticks: {velocity:e} m/s");
        for slope in [1.001 * mu, 0.5, 1.0] {
            let along = G / slope.hypot(1.0) * (slope - mu);
            let (_, found) = slides(&on_slope(method, UNTURNING, slope, 0.0, shifted));
            assert_close(found, along, 1e-6, "how it slides");
        }
        // A disc rolls up to tanθ = 3μ with two thirds of g sinθ. Above, it slides.
        let slope: f64 = 0.8;
        let (_, found) = slides(&on_slope(method, Physics::FULL, slope, 0.0, shifted));
        assert_close(found, 2.0 / 3.0 * G * slope / slope.hypot(1.0), 1e-6, "how it rolls");
        let slope: f64 = 1.0;
        let (_, found) = slides(&on_slope(method, Physics::FULL, slope, 0.0, shifted));
        assert_close(found, G / slope.hypot(1.0) * (slope - mu), 1e-6, "how it slides and turns");
        // Cohesion holds the disc if sinθ ≤ μ (cosθ + Bond), but only with the shifted friction cone (friction bounded
        // by the normal force plus the cohesion force). In the other cone only the pushing part of the normal force
        // bounds friction.
        for (bond, sticks) in [(1.01, true), (0.99, false)] {
            let slope: f64 = 0.75;
            let bond = bond * (slope / mu - 1.0) / slope.hypot(1.0);
            let (velocity, _) = slides(&on_slope(method, UNTURNING, slope, bond, shifted));
            assert_eq!(velocity.abs() < 1e-9, sticks, "{method:?}, Bond {bond}: {velocity} m/s");
            let compressive = FrictionCone::Compressive;
            let (_, found) = slides(&on_slope(method, UNTURNING, slope, bond, compressive));
            assert_close(found, G / slope.hypot(1.0) * (slope - mu), 1e-6, "without C₀");
        }
    }
}
