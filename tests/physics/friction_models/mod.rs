//! Tests of the convex friction models: the exact effect of each model on one contact, and the uniqueness of the
//! solution of the problem that replaces Coulomb friction.

mod piles;

use crate::common::*;

const RADIUS: f64 = 0.1;
const MU: f64 = 0.3;
const DT: f64 = 1e-3;

/// Returns a scene of a disc without rotation on the level y = 0 under gravity inclined by θ (`slope` = tan θ). The
/// disc has an initial speed along the level (m/s).
fn on_incline(model: FrictionModel, slope: f64, speed: f64) -> Scene {
    let place = DVec2::new(0.0, RADIUS * (1.0 - 1e-10));
    let gravity = G * DVec2::new(slope, -1.0).normalize();
    let grain = moving(place, RADIUS, DVec2::new(speed, 0.0));
    let mut scene = Scene {
        boundaries: vec![level()],
        ..scene(UNTURNING, gravity, parameters(0.0, DT, 0.0, MU), vec![grain])
    };
    scene.solver.friction_model = model;
    scene
}

#[test]
fn what_does_not_go_with_a_model_is_refused_in_one_sentence() {
    let good = on_incline(FrictionModel::Tresca, 0.2, 0.0);
    let cases: [Refusal; 4] = [
        (
            "friction-model is tresca, but must be coulomb where solver is newton: other models go with nsgs and interior-point and auto",
            &|scene| scene.solver.method = Method::Newton,
        ),
        (
            "friction-model is tresca, but must be coulomb where stepper is dem: other models go with moreau and range",
            &|scene| scene.stepper = Stepper::Dem,
        ),
        ("cone is compressive, but must be shifted where friction-model is…", &|scene| {
            scene.parameters.cone = FrictionCone::Compressive;
            scene.solver.friction_model = FrictionModel::Associated;
        }),
        ("model-solves is 0, but must be between 1 and 1000", &|scene| {
            scene.solver.model_solves = 0
        }),
    ];
    refuses(&good, &cases);
    let tresca = SolverSettings { friction_model: FrictionModel::Tresca, ..good.solver };
    assert_eq!(tresca.by(Method::Newton).friction_model, FrictionModel::Coulomb);
}

#[test]
fn a_block_sticks_up_to_mu_under_every_model_and_slides_above() {
    for &model in FrictionModel::ALL {
        let stuck = after(&on_incline(model, MU * (1.0 - 1e-6), 0.0), 300);
        assert!(stuck.velocity(0).length() < 1e-14, "{model}");
        assert_eq!(stuck.observables().contacts, 1, "{model}");
        let sliding = after(&on_incline(model, MU * (1.0 + 1e-6), 0.0), 1);
        assert!(sliding.velocity(0).x > 1e-10, "{model}");
    }
}

#[test]
fn what_slides_keeps_its_level_under_tresca_and_is_lifted_by_the_cone_models() {
    let (slope, speed) = (0.5f64, 2.0);
    let hypotenuse = slope.hypot(1.0);
    let (along, onto) = (G * slope / hypotenuse, G / hypotenuse);
    for &model in FrictionModel::ALL {
        let mut sliding = start(&on_incline(model, slope, speed));
        let level = sliding.place(0).y;
        take_steps(&mut sliding, 1);
        let after = sliding.velocity(0);
        let lift = sliding.place(0).y - level;
        let expected = match model {
            FrictionModel::Associated => DT * MU * after.x,
            FrictionModel::Desaxce => DT * MU * (after.x - speed),
            _ => 0.0,
        };
        assert!((lift - expected).abs() < 1e-15, "{model}: lifted by {lift:e}, not {expected:e}");
        // σ is the normal impulse divided by the mass (m/s). It follows from v_n = σ − g_n Δt, and gives v_t = v + g_t
        // Δt − μσ.
        let risen = expected / DT;
        let pressure = risen + onto * DT;
        assert_close(after.x, speed + along * DT - MU * pressure, 1e-13, model.name());
        if expected == 0.0 {
            take_steps(&mut sliding, 299);
            let velocity = sliding.velocity(0);
            assert_close(velocity.x, speed + (along - MU * onto) * DT * 300.0, 1e-10, model.name());
            assert!(velocity.y.abs() < 1e-12, "{model}");
        }
    }
    let dilated = DT * MU * speed;
    assert!(dilated > 5e-4, "{dilated}: that the lift is there is seen");
}

/// Returns the normal and tangential impulses (P_n, P_t) of the only contact of a run, N·s.
fn impulse(run: &Simulation) -> [f64; 2] {
    let [impulse] = run.contacts().impulses() else { panic!("one contact") };
    [impulse.normal, impulse.tangential]
}

#[test]
fn within_bounds_that_sweeps_lead_to_friction_keeps_up_with_the_pressure_on_what_slides() {
    for (bond, cone) in [
        (0.0, FrictionCone::Shifted),
        (5.0, FrictionCone::Shifted),
        (5.0, FrictionCone::Compressive),
    ] {
        let mut scene = on_incline(FrictionModel::Tresca, 0.0, 5.0);
        (scene.parameters.bond, scene.parameters.cone) = (bond, cone);
        let mut run = start(&scene);
        let cohesion = match cone {
            FrictionCone::Shifted => bond * run.grains().masses[0] * G * DT,
            FrictionCone::Compressive => 0.0,
        };
        take_steps(&mut run, 1);
        let [mut pressure, rubbing] = impulse(&run);
        assert_close(rubbing.abs(), MU * (pressure + cohesion), 1e-13, "the first step");
        let mut most = 0f64;
        for step in 0..5 {
            let place = run.place(0);
            let target = place - DVec2::new(0.0, RADIUS * f64::from(step));
            run.set_pull(Some(Pull { grain: 0, target }));
            take_steps(&mut run, 1);
            let [now, rubbing] = impulse(&run);
            assert_close(rubbing.abs(), MU * (now + cohesion), 1e-12, "a later step");
            most = most.max(now / pressure);
            pressure = now;
        }
        assert!(most > 1.5, "{most}: the pressure did not change");
        let coulomb = SolverSettings { friction_model: FrictionModel::Coulomb, ..scene.solver };
        run.set_solver(coulomb).expect("sound settings");
        take_steps(&mut run, 1);
        let [pressure, rubbing] = impulse(&run);
        assert_close(rubbing.abs(), MU * (pressure + cohesion), 1e-13, "Coulomb's law");
        assert_eq!(run.observables().model_residual, None);
    }
}

/// Returns a run of two discs after two steps: one disc slides on the floor, and the other rolls down on this disc.
fn two_bodies(model: FrictionModel) -> Simulation {
    let below = moving(DVec2::new(0.0, 0.999 * RADIUS), RADIUS, DVec2::new(0.8, 0.0));
    let above = Grain::at_rest(below.position + 1.998 * RADIUS * DVec2::new(0.6, 0.8), RADIUS);
    let mut scene = Scene {
        boundaries: vec![level()],
        ..under_g(parameters(0.0, DT, 0.0, MU), vec![below, above])
    };
    scene.solver.friction_model = model;
    let mut run = after(&scene, 1);
    // The pull changes the load, so friction bounds from the previous step would be wrong.
    let target = run.place(1) - DVec2::new(0.0, 8.0 * RADIUS);
    run.set_pull(Some(Pull { grain: 1, target }));
    take_steps(&mut run, 1);
    run
}

#[test]
fn within_bounds_that_sweeps_lead_to_two_bodies_obey_coulombs_law() {
    let [coulomb, bounded] = [FrictionModel::Coulomb, FrictionModel::Tresca].map(two_bodies);
    assert!(bounded.observables().residual < 1e-11, "{:e}", bounded.observables().residual);
    for (one, other) in bounded.velocities().iter().zip(coulomb.velocities()) {
        assert!((*one - *other).length() < 1e-10, "{one} and {other}");
    }
}

#[test]
fn a_fixed_disc_holds_by_friction_as_a_grain_does() {
    // Friction at two fixed discs holds a disc between them. Under Coulomb friction this wedge is a possible
    // equilibrium.
    for &model in FrictionModel::ALL {
        let mut scene =
            under_g(parameters(3.0, DT, 0.0, 2.0), vec![Grain::at_rest(DVec2::ZERO, RADIUS)]);
        scene.fixed_discs =
            [-1.0, 1.0].map(|side| fixed(DVec2::new(side * 1.999 * RADIUS, 0.0), RADIUS)).to_vec();
        scene.solver.friction_model = model;
        let run = after(&scene, 100);
        let fallen = -run.place(0).y;
        assert!(fallen.abs() < 1e-12, "{model}: fell by {fallen:e}");
    }
}
