//! Heaps that do not touch: solved island by island, each is what it would be without the others.

use crate::common::*;

use super::methods::SolveTwice;

const DIAMETER: f64 = 5e-3;

/// Heaps of so many grains, far from each other; each is the same whichever others there are.
fn heaps(sizes: &[(usize, usize)]) -> Scene {
    let parts = sizes.iter().map(|&(place, grains)| {
        let mut heap =
            pressed_pile(grains, 0.05, 7 + place as u64, parameters(10.0, 1e-3, 0.1, 0.5));
        let aside = DVec2::new(100.0 * DIAMETER * place as f64, 0.0);
        heap.grains.iter_mut().for_each(|grain| grain.position += aside);
        heap.fixed_discs.iter_mut().for_each(|disc| disc.position += aside);
        heap
    });
    let mut scene = parts
        .reduce(|mut all, heap| {
            all.grains.extend(heap.grains);
            all.fixed_discs.extend(heap.fixed_discs);
            all
        })
        .expect("a heap");
    scene.mean_diameter = DIAMETER;
    scene.parameters.restitution_threshold = 2.0;
    scene
}

/// Grains on a lattice that all overlap with all their neighbours.
fn lattice() -> Scene {
    let place = |k: usize| {
        let (row, column) = ((k / 6) as f64, (k % 6) as f64);
        DVec2::new(column + 0.5 * (row % 2.0), 0.5 + 0.75f64.sqrt() * row)
    };
    let grains = (0..30).map(|k| Grain {
        velocity: 0.05 * DVec2::new((k as f64).sin(), (7.0 * k as f64).cos()),
        ..Grain::at_rest(0.99 * DIAMETER * place(k), 0.5 * DIAMETER)
    });
    let grains = grains.collect();
    under_g(parameters(10.0, 1e-3, 0.1, 0.5), grains)
}

const SIZES: [(usize, usize); 3] = [(0, 30), (1, 8), (2, 20)];

fn island_by_island(method: Method, stop: StopTest) -> SolverSettings {
    SolverSettings {
        method,
        ordering: Ordering::Detected,
        stop,
        tolerance: 1e-6,
        max_sweeps: 2_000,
        fallback: Fallback::None,
        islands: true,
        ..SolverSettings::SWEEPS
    }
}

fn after_steps(scene: &Scene, solver: SolverSettings, steps: usize) -> Simulation {
    after(&Scene { solver, ..scene.clone() }, steps)
}

fn methods() -> impl Iterator<Item = Method> {
    METHODS.iter().map(|info| info.method).filter(|&method| method != Method::NsgsParallel)
}

#[test]
fn each_heap_moves_bitwise_as_it_would_alone() {
    let together = heaps(&SIZES);
    let mut felt = 0;
    for (method, stop) in pairs(methods(), [StopTest::RelativeChange, StopTest::Residual]) {
        let settings = island_by_island(method, stop);
        let all = bits(&after_steps(&together, settings, 40));
        let alone = SIZES.map(|heap| bits(&after_steps(&heaps(&[heap]), settings, 40)));
        assert!(all == alone.concat(), "{method} {stop:?}");
        let whole = SolverSettings { islands: false, ..settings };
        felt += u32::from(bits(&after_steps(&together, whole, 40)) != all);
    }
    assert!(felt >= 12, "heaps felt each other's tests in {felt} of 16 ways that know no islands");
}

#[test]
fn auto_is_told_by_the_largest_island() {
    let settings = |islands| SolverSettings {
        method: Method::Auto,
        islands,
        ..island_by_island(Method::Nsgs, StopTest::Residual)
    };
    let heaps = heaps(&(0..80).map(|place| (place, 100)).collect::<Vec<_>>());
    let [by_islands, whole] =
        [true, false].map(|islands| after_steps(&heaps, settings(islands), 3));
    let [most, all] = [&by_islands, &whole].map(|it| it.contacts_together());
    assert!(all > 10_000 && most < 400, "{most} of {all} contacts");
    assert_eq!(by_islands.picked_method(), Method::Newton);
    assert_eq!(whole.picked_method(), Method::Nncg);
}

#[test]
fn one_island_is_the_whole_to_the_last_bit() {
    let scene = lattice();
    for method in methods() {
        let settings = island_by_island(method, StopTest::Residual);
        let whole = SolverSettings { islands: false, ..settings };
        let runs = [settings, whole].map(|solver| bits(&after_steps(&scene, solver, 3)));
        assert!(runs[0] == runs[1], "{method}");
    }
}

#[test]
fn where_each_island_passes_a_test_the_whole_does() {
    for stop in StopTest::ALL {
        let settings = SolverSettings { tolerance: 1e-4, ..island_by_island(Method::Nsgs, *stop) };
        let mut run = start(&Scene { solver: settings, ..heaps(&SIZES) });
        let mut solved = 0;
        for _ in 0..20 {
            let one_sweep = SolverSettings { islands: false, max_sweeps: 1, ..settings };
            let [by_islands, sweep] = run.next_problem(SolveTwice(settings, one_sweep));
            if by_islands.converged && by_islands.sweeps > 3 {
                solved += 1;
                assert!(sweep.converged, "{stop:?} {sweep:?} after {by_islands:?}");
            }
            take_steps(&mut run, 1);
        }
        assert!(solved >= 5, "{stop:?}: {solved} of 20 steps to be asked about");
    }
}

#[test]
fn models_of_friction_are_solved_island_by_island() {
    for (model, method) in pairs(
        [FrictionModel::Tresca, FrictionModel::Associated, FrictionModel::Desaxce],
        [Method::InteriorPoint, Method::Nsgs],
    ) {
        let settings = SolverSettings {
            friction_model: model,
            model_solves: if model == FrictionModel::Associated { 1 } else { 3 },
            tolerance: if method == Method::Nsgs { 1e-4 } else { 1e-6 },
            max_sweeps: 20_000,
            ..island_by_island(method, StopTest::Residual)
        };
        let all = after_steps(&heaps(&SIZES), settings, 20);
        let alone = SIZES.map(|heap| bits(&after_steps(&heaps(&[heap]), settings, 20)));
        assert!(bits(&all) == alone.concat(), "{model} {method}");
        let step = all.observables();
        let left = step.model_residual.expect("a residual of the model");
        assert!(step.converged && left <= settings.tolerance, "{model} {method}: {step:?}");
        assert!(step.velocity_error < 1e-3, "{model} {method}: {step:?}");
    }
}

#[test]
fn an_island_that_is_not_solved_falls_back_alone() {
    let settings = SolverSettings {
        max_sweeps: 12,
        fallback: Fallback::Tresca,
        ..island_by_island(Method::Newton, StopTest::Residual)
    };
    let sizes = [(0, 30), (1, 2), (2, 20)];
    let together = heaps(&sizes);
    // Before anything is there to start from, two grains take less than the others.
    let step = |scene: &Scene| {
        let run = after_steps(scene, settings, 1);
        (*run.observables(), bits(&run))
    };
    let (all, moved) = step(&together);
    let alone = sizes.map(|heap| step(&heaps(&[heap])));
    let fell = alone.each_ref().map(|(of_heap, _)| of_heap.fell_back == Some(true));
    assert!(fell.contains(&true) && fell.contains(&false), "{fell:?}");
    assert_eq!(all.fell_back, Some(true), "{all:?}");
    assert!(moved == alone.each_ref().map(|(_, moved)| moved.clone()).concat());
    // What was solved under Coulomb's law is so under the bounds that it came to, and certified with the rest.
    assert!(all.model_residual.is_some_and(|left| left <= 1e-6), "{all:?}");
    let whole = SolverSettings { islands: false, ..settings };
    let as_one = after_steps(&together, whole, 1);
    assert_eq!(as_one.observables().fell_back, Some(true), "all fall back together else");
    let kept = 30..32;
    assert!(!fell[1] && bits(&as_one)[kept.clone()] != moved[kept], "and the heap that was solved");
}
