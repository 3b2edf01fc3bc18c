//! Sweeps on many threads, colour by colour, against sweeps on one.

use crate::common::*;

/// Sweeps, impulses and grains after three steps on so many threads.
fn three_steps(scene: &Scene, threads: usize) -> ([u32; 3], Vec<Impulse>, Grains) {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    pool.expect("threads").install(|| {
        let mut run = start(&scene);
        let sweeps = [(); 3].map(|()| run.step().expect("a finite state").sweeps);
        (sweeps, run.contacts().impulses().to_vec(), run.grains().clone())
    })
}

/// One after the other, in the order of the colours, it is a sweep like any other.
fn assert_a_sweep_like_any_other(mut scene: Scene) {
    (scene.solver.method, scene.solver.stop) = (Method::NsgsParallel, StopTest::Residual);
    let parallel = three_steps(&scene, 2);
    scene.solver.method = Method::Nsgs;
    assert!(three_steps(&scene, 1) != parallel, "another order");
    scene.solver.ordering = Ordering::Coloured;
    assert!(three_steps(&scene, 1) == parallel, "{:?}", scene.physics);
}

#[test]
fn colours_on_any_number_of_threads_give_bitwise_the_sweeps_of_one() {
    let parameters = parameters(20.0, 1e-3, 0.3, 0.5);
    let mut scene = pressed_pile(40_000, 0.1, 5, parameters);
    scene.solver = SolverSettings {
        method: Method::NsgsParallel,
        stop: StopTest::RelativeChange,
        tolerance: 1e-3,
        max_sweeps: 60,
        ..SolverSettings::default()
    };
    let alone = three_steps(&scene, 1);
    assert!(alone.0[0] > 10 && alone.1.len() > 40_000, "{:?} sweeps", alone.0);
    for threads in [2, 4] {
        assert!(three_steps(&scene, threads) == alone, "{threads} threads");
    }
    scene.solver.tolerance = 1e-2;
    assert_a_sweep_like_any_other(scene);
}

#[test]
fn colours_give_bitwise_the_sweeps_of_one_in_every_model() {
    for physics in [SMOOTH, UNTURNING, Physics::FULL] {
        for (cone, stepper) in [
            (FrictionCone::Shifted, Stepper::Moreau),
            (FrictionCone::Compressive, Stepper::Moreau),
            (FrictionCone::Shifted, Stepper::Range),
        ] {
            let mut parameters = parameters(20.0, 1e-3, 0.3, 0.5);
            parameters.cone = cone;
            let mut scene = pressed_pile(300, 0.1, 7, parameters);
            (scene.physics, scene.stepper) = (physics, stepper);
            (scene.solver.tolerance, scene.solver.max_sweeps) = (1e-6, 200);
            assert_a_sweep_like_any_other(scene);
        }
    }
}
