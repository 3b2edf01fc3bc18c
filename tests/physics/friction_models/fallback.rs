//! What becomes of a step that is not solved under Coulomb's law.

use crate::common::*;

/// A pile that slumps, as `fallback` says, with too few sweeps a step to solve most of them.
fn pile(method: Method, fallback: Fallback, cone: FrictionCone) -> Simulation {
    let mut scene = built_in("pile").expect("a scene");
    scene.parameters.bond = 20.0;
    scene.parameters.time_step_secs = 1e-3;
    scene.parameters.cone = cone;
    scene.solver = SolverSettings {
        method,
        fallback,
        stop: StopTest::Residual,
        tolerance: 1e-9,
        max_sweeps: 60,
        ..SolverSettings::default()
    };
    start(&scene)
}

#[test]
fn a_step_that_is_not_solved_falls_back_on_one_that_is_and_says_so() {
    for cone in FrictionCone::ALL {
        for method in [Method::Nsgs, Method::Nncg, Method::Newton, Method::InteriorPoint] {
            let what = format!("{method}, {cone}");
            let mut run = pile(method, Fallback::Tresca, *cone);
            let (mut fell_back, mut solved) = (0, 0);
            for _ in 0..60 {
                let row = *run.step().expect("a finite state");
                let told = row.fell_back.expect("it could fall back");
                let of_model = row.model_residual.expect("a residual of what was solved");
                let gap = row.duality_gap.expect("a gap");
                if told {
                    fell_back += 1;
                    assert!(!row.converged && of_model <= 1e-8, "{what}: {of_model:e}");
                    assert!((-1e-14..1e-3).contains(&gap), "{what}: {gap:e}");
                    assert!(row.factorisations > 0, "{what}");
                } else {
                    solved += 1;
                    assert!(row.converged, "{what}: neither");
                    assert_eq!((of_model, gap), (row.residual, f64::INFINITY), "{what}");
                }
            }
            assert!(fell_back > 10, "{what}: {fell_back} fell back, {solved} were solved");
        }
    }
}

#[test]
fn auto_falls_back_unless_told_not_to_and_others_do_where_told() {
    let told = |method, fallback| {
        let mut run = pile(method, fallback, FrictionCone::Shifted);
        take_steps(&mut run, 30);
        let places: Vec<_> = run
            .world()
            .grains
            .positions
            .iter()
            .map(|place| place.to_array().map(f64::to_bits))
            .collect();
        (run.observables().fell_back.is_some(), places)
    };
    let auto = told(Method::Auto, Fallback::OfMethod);
    assert!(auto.0);
    assert_eq!(auto, told(Method::Auto, Fallback::Tresca));
    let without = told(Method::Auto, Fallback::None);
    assert!(!without.0 && without.1 != auto.1);
    assert_eq!(without, told(Method::Newton, Fallback::OfMethod), "auto takes newton here");
}

/// Remedies and the law `range` solve a problem several times; one of the earlier solves may have fallen back.
#[test]
fn a_problem_is_solved_again_after_it_fell_back() {
    let plain = Remedies::default();
    for (stepper, remedies, bond) in [
        (Stepper::Moreau, Remedies { calm_unsolved: true, ..plain }, 20.0),
        (Stepper::Moreau, Remedies { sequential_impacts: true, ..plain }, 0.0),
        (Stepper::Range, plain, 20.0),
    ] {
        let mut scene = built_in("pile").expect("a scene");
        (scene.stepper, scene.remedies, scene.parameters.bond) = (stepper, remedies, bond);
        (scene.parameters.time_step_secs, scene.parameters.restitution) = (1e-3, 0.5);
        scene.solver = SolverSettings {
            fallback: Fallback::Tresca,
            stop: StopTest::Residual,
            tolerance: 1e-9,
            max_sweeps: 40,
            ..SolverSettings::default()
        };
        let mut run = start(&scene);
        let mut fell_back = 0;
        for _ in 0..40 {
            let row = *run.step().expect("a finite state");
            fell_back += u32::from(row.fell_back == Some(true));
            assert!(row.model_residual.is_some() && row.residual.is_finite());
        }
        assert!(fell_back > 10, "{stepper}, {remedies:?}: {fell_back}");
    }
}
