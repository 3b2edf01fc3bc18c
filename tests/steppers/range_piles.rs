//! The law `range` (`contact::range`): what holds of any pile.

use crate::common::{G, pressed_pile, range, start, take_steps, tight};
use slump::scene::{Scene, paper_pile};
use slump::sim::Stepper;
use slump::solver::{Method, SolverSettings, StopTest};
use slump::world::Parameters;

/// A pile that falls together and bonds.
fn pile(bond: f64, time_step_secs: f64, method: Method) -> Scene {
    let parameters =
        Parameters { restitution: 0.1, restitution_threshold: 2.0, ..range(bond, time_step_secs) };
    Scene {
        stepper: Stepper::Range,
        solver: SolverSettings { method, max_sweeps: 20_000, tolerance: 1e-8, ..tight() },
        ..pressed_pile(60, 0.3, 5, parameters)
    }
}

#[test]
fn the_energy_budget_of_a_pile_closes_and_overlap_goes() {
    for bond in [0.0, 10.0, 100.0] {
        for time_step_secs in [2e-4, 2e-3] {
            let mut simulation = start(&pile(bond, time_step_secs, Method::Newton));
            let mass: f64 = simulation.world().grains.masses.iter().sum();
            let mut energy = simulation.observables().kinetic_energy;
            let steps = (0.1 / time_step_secs) as usize;
            for _ in 0..steps {
                let now = *simulation.step().expect("finite");
                let work = now.normal_work + now.tangential_work + now.gravity_work;
                let scale = energy
                    + now.normal_work.abs()
                    + now.tangential_work.abs()
                    + mass * (G * time_step_secs).powi(2);
                assert!((now.kinetic_energy - energy - work).abs() <= 1e-10 * scale);
                energy = now.kinetic_energy;
            }
            let overlap = simulation.observables().mean_overlap;
            assert!(overlap < 1e-3, "Bond {bond}, Δt = {time_step_secs}: {overlap}");
        }
    }
}

#[test]
fn bonds_of_a_collapsing_pile_keep_their_books_and_pushes_give_nothing() {
    for time_step_secs in [5e-3, 1e-3] {
        let mut scene = paper_pile().expect("the shipped state");
        scene.stepper = Stepper::Range;
        scene.parameters = Parameters { restitution: 0.1, ..range(10.0, time_step_secs) };
        scene.solver = SolverSettings {
            method: Method::Newton,
            stop: StopTest::Residual,
            tolerance: 1e-6,
            ..scene.solver
        };
        let mut simulation = start(&scene);
        let (mut of_bonds, mut lost, mut raised) = (0.0, 0.0, 0.0);
        for _ in 0..(0.2 / time_step_secs) as u32 {
            let now = *simulation.step().expect("finite");
            let of_step = now.bond_work.expect("bonds");
            of_bonds += of_step;
            let of_pushes = now.normal_work - of_step;
            lost -= of_pushes.min(0.0);
            raised += of_pushes.max(0.0);
        }
        let now = simulation.observables();
        let (stored, broken) = (now.bond_energy.unwrap(), now.broken_bond_energy.unwrap());
        assert!(
            (of_bonds + stored + broken).abs() <= 1e-9 * broken,
            "{of_bonds}, {stored}, {broken}"
        );
        assert!(broken > 0.02 * lost, "bonds broke: {broken} of {lost} J");
        assert!(raised < 1e-3 * lost, "pushes gave {raised} and took {lost} J");
    }
}

#[test]
fn the_paper_s_law_tells_nothing_of_bonds() {
    let mut scene = pile(10.0, 1e-3, Method::Newton);
    scene.stepper = Stepper::Moreau;
    let mut simulation = start(&scene);
    take_steps(&mut simulation, 2);
    let now = simulation.observables();
    assert_eq!((now.bond_work, now.bond_energy, now.broken_bond_energy), (None, None, None));
    assert!(!serde_json::to_string(now).expect("numbers").contains("bond_"));
}

#[test]
fn methods_agree_on_steps_with_bonds() {
    let mut scene = pile(20.0, 2e-4, Method::Newton);
    scene.solver.tolerance = 1e-9;
    let mut simulation = start(&scene);
    let methods = [Method::Nsgs, Method::Nncg, Method::NsgsParallel];
    let mut solved = [0; 3];
    const MOMENTS: u32 = 12;
    for _ in 0..MOMENTS {
        take_steps(&mut simulation, 10);
        let next = |method| {
            let mut copy = simulation.clone();
            copy.set_solver(SolverSettings { method, ..scene.solver }).expect("fine");
            take_steps(&mut copy, 1);
            copy
        };
        let reference = next(Method::Newton);
        for (count, method) in solved.iter_mut().zip(methods) {
            let found = next(method);
            if !(found.observables().converged && reference.observables().converged) {
                continue;
            }
            *count += 1;
            let [found, reference] =
                [&found, &reference].map(|simulation| &simulation.world().grains.velocities);
            let off = found.iter().zip(reference).map(|(a, b)| (*a - *b).length());
            let off = off.fold(0.0, f64::max);
            assert!(off < 1e-5, "{method:?}: {off} m/s off, and both have solved it");
        }
    }
    // What is left unsolved within the sweeps allowed tells nothing of agreement.
    assert!(solved.iter().all(|&count| 2 * count > MOMENTS), "{solved:?} of {MOMENTS}");
}

#[test]
fn a_clone_and_a_second_run_go_on_bit_for_bit() {
    let scene = pile(20.0, 1e-3, Method::Newton);
    let mut first = start(&scene);
    take_steps(&mut first, 30);
    let mut clone = first.clone();
    let mut second = start(&scene);
    take_steps(&mut second, 60);
    take_steps(&mut first, 30);
    take_steps(&mut clone, 30);
    assert_eq!(first.world(), second.world());
    assert_eq!(clone.world(), second.world());
}
