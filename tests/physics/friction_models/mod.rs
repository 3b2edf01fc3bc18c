//! The models of friction beside Coulomb's law: what each does to one contact, exactly, and that the problem it
//! puts in the place of Coulomb's has one solution, which is found.

mod certificates;
mod fallback;
mod one_contact;
mod piles;

use crate::common::*;

const RADIUS: f64 = 0.1;
const MU: f64 = 0.3;
const DT: f64 = 1e-3;

/// A disc that cannot turn on the level y = 0, under a gravity that leans by `slope` = tanθ, with a speed along.
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
    let refusal = |spoil: &dyn Fn(&mut Scene)| {
        let mut scene = good.clone();
        spoil(&mut scene);
        scene.simulation().expect_err("it does not go together").to_string()
    };
    let newton = refusal(&|scene| scene.solver.method = Method::Newton);
    assert_eq!(
        newton,
        "friction-model is tresca, but must be coulomb where solver is newton: other models go with nsgs and interior-point"
    );
    let range = refusal(&|scene| scene.stepper = Stepper::Range);
    assert_eq!(
        range,
        "friction-model is tresca, but must be coulomb where stepper is range: other models go with moreau"
    );
    let cone = refusal(&|scene| {
        scene.parameters.cone = FrictionCone::Compressive;
        scene.solver.friction_model = FrictionModel::Associated;
    });
    assert!(cone.starts_with("cone is compressive, but must be shifted where friction-model is"));
    let never = refusal(&|scene| scene.solver.model_solves = 0);
    assert_eq!(never, "model-solves is 0, but must be between 1 and 1000");
    for model in [FrictionModel::Coulomb, FrictionModel::Associated] {
        let again = refusal(&|scene| {
            scene.solver.friction_model = model;
            scene.solver.model_solves = 2;
        });
        assert!(again.starts_with("model-solves is 2, but must be 1 where friction-model is"));
    }
    assert!(
        SolverSettings { friction_model: FrictionModel::Tresca, ..good.solver }
            .by(Method::Newton)
            .friction_model
            == FrictionModel::Coulomb
    );
}
