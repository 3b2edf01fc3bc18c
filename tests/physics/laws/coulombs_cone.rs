//! Coulomb's cone under the stepping schemes: when a disc on a slope sticks, slides and rolls.

use crate::common::*;

/// A disc on a level half-space, under a gravity that leans by `slope` = tanθ.
fn on_slope(
    stepper: Stepper,
    physics: Physics,
    slope: f64,
    bond: f64,
    cone: FrictionCone,
) -> Scene {
    let radius = 0.1;
    let grain = Grain::at_rest(DVec2::new(0.0, radius * (1.0 - 1e-10)), radius);
    let gravity = G * DVec2::new(slope, -1.0).normalize();
    let mut parameters = parameters(bond, 1e-3, 0.1, 0.3);
    parameters.cone = cone;
    let level = level();
    let scene = scene(physics, gravity, parameters, vec![grain]);
    by(stepper, 0, Scene { boundaries: vec![level], ..scene })
}

/// Its velocity and its acceleration once it lies on the slope.
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
    let mu = 0.3;
    for method in SCHEMES {
        let shifted = FrictionCone::Shifted;
        let (velocity, _) = slides(&on_slope(method, UNTURNING, 0.999 * mu, 0.0, shifted));
        assert!(velocity.abs() < 1e-9, "{method:?} sticks: {velocity:e} m/s");
        for slope in [1.001 * mu, 0.5, 1.0] {
            let along = G / slope.hypot(1.0) * (slope - mu);
            let (_, found) = slides(&on_slope(method, UNTURNING, slope, 0.0, shifted));
            assert_close(found, along, 1e-6, "how it slides");
        }
        // A disc rolls up to tanθ = 3μ, with two thirds of g sinθ, and slides above.
        let slope: f64 = 0.8;
        let (_, found) = slides(&on_slope(method, Physics::FULL, slope, 0.0, shifted));
        assert_close(found, 2.0 / 3.0 * G * slope / slope.hypot(1.0), 1e-6, "how it rolls");
        let slope: f64 = 1.0;
        let (_, found) = slides(&on_slope(method, Physics::FULL, slope, 0.0, shifted));
        assert_close(found, G / slope.hypot(1.0) * (slope - mu), 1e-6, "how it slides and turns");
        // Cohesion holds where sinθ ≤ μ (cosθ + Bond), with the shifted cone alone.
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
