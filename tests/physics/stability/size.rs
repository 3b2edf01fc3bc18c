//! Many contacts: that the scenes are what they say, and at rest.

use crate::common::*;
use slump::scene::stability::{heap_of, lattice};

/// Speed that is left after a few certified steps, in √(g d).
const STILL: f64 = 1e-7;

fn certified(mut scene: Scene) -> Simulation {
    scene.solver = SolverSettings {
        method: Method::InteriorPoint,
        stop: StopTest::Residual,
        tolerance: 1e-8,
        friction_model: FrictionModel::Tresca,
        ..SolverSettings::default()
    };
    start(&scene)
}

/// Steps, each of them certified, to rest without a contact lost.
fn stays(mut run: Simulation, what: &str) {
    let contacts = {
        let row = *run.step().expect("a finite state");
        assert!(row.converged && row.duality_gap.is_some(), "{what}");
        row.contacts
    };
    for _ in 0..5 {
        let row = *run.step().expect("a finite state");
        assert!(row.converged, "{what}");
        assert_eq!(row.contacts, contacts, "{what}");
    }
    let world = run.world();
    let fastest = world.grains.velocities.iter().map(|v| v.length()).fold(0.0, f64::max);
    let scale = (world.gravity.magnitude() * world.mean_diameter).sqrt();
    assert!(fastest < STILL * scale, "{what}: {fastest:e} m/s");
}

#[test]
fn the_lattice_is_hyperstatic_and_at_rest_however_little_its_normals_are_off() {
    for perturbation in [1e-6, 1e-4, 1e-2] {
        let scene = lattice(37, 36, perturbation);
        let mut first = start(&scene);
        let contacts = first.step().expect("a finite state").contacts;
        assert_eq!(scene.grains.len(), 1314);
        // Pairs in long and in short rows, 72 in each of 35 gaps between rows, the floor, and two walls.
        let beside = 18 * 36 + 18 * 35;
        assert_eq!(contacts, beside + 35 * 72 + 37 + 2 * 18, "{perturbation}");
        stays(certified(scene), &format!("displaced by {perturbation} d"));
    }
}

#[test]
fn heaps_of_any_size_are_at_rest() {
    for (count, grains) in [(1, 1), (5, 3), (138, 136), (500, 496), (2000, 1953)] {
        let scene = heap_of(count);
        assert_eq!(scene.grains.len(), grains);
        stays(certified(scene), &format!("{count} grains"));
    }
    assert_eq!(heap_of(10_000).grains.len(), 9870);
}
