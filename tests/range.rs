//! The law `range` (`contact::range`): one bond by itself against its exact motion, and what holds of
//! any pile.

mod common;

use common::{
    G, LINE, SMOOTH, assert_close, fixed, moving, parameters, pressed_pile, scene, start,
    take_steps, tight,
};
use glam::DVec2;
use slump::scene::{Scene, paper_pile};
use slump::sim::Simulation;
use slump::solver::{Method, SolverSettings, StopTest};
use slump::world::{ContactLaw, Grain, Parameters, Physics};

const RADIUS: f64 = 2.5e-3;
const DISTANCE_IN_DIAMETERS: f64 = 0.01;
const BOND: f64 = 20.0;
/// Two decades about the time that a bond takes to break, which is 0.7 ms at Bond 20.
const TIME_STEPS: [f64; 7] = [5e-5, 1e-4, 2e-4, 5e-4, 1e-3, 2e-3, 5e-3];

fn range(bond: f64, time_step_secs: f64) -> Parameters {
    Parameters {
        law: ContactLaw::Range,
        debonding_distance: DISTANCE_IN_DIAMETERS,
        ..parameters(bond, time_step_secs, 0.0, 0.5)
    }
}

/// A grain at rest against a fixed disc below it, and `acceleration` up; g stays G.
fn pair(time_step_secs: f64, speed: f64, load: f64, physics: Physics) -> Simulation {
    let direction = DVec2::X;
    let grain = moving(2.0 * RADIUS * direction, RADIUS, speed * direction);
    // The norm of gravity gives C₀, so Bond is what makes it BOND·G under any load.
    let (gravity, bond) = if load == 0.0 { (G, BOND) } else { (load, BOND * G / load.abs()) };
    let feels_gravity = load != 0.0;
    start(&Scene {
        fixed_discs: vec![fixed(DVec2::ZERO, RADIUS)],
        solver: tight(),
        ..scene(
            physics,
            gravity * direction,
            range(bond, time_step_secs),
            vec![Grain { feels_gravity, ..grain }],
        )
    })
}

/// v of a grain that has come as far as three bonds are long, or none where it stays at the disc.
fn speed_far_away(mut simulation: Simulation) -> Option<f64> {
    let far = 2.0 * RADIUS * (1.0 + 3.0 * DISTANCE_IN_DIAMETERS);
    let steps = (0.1 / simulation.parameters().time_step_secs) as usize;
    for _ in 0..steps {
        take_steps(&mut simulation, 1);
        if simulation.world().grains.positions[0].x > far {
            return Some(simulation.world().grains.velocities[0].x);
        }
    }
    None
}

/// C₀δ_c/m_ij, m²/s².
fn work() -> f64 {
    BOND * G * DISTANCE_IN_DIAMETERS * 2.0 * RADIUS
}

#[test]
fn a_pair_thrown_apart_parts_above_the_escape_speed_and_has_lost_the_bonds_work() {
    let escape = (2.0 * work()).sqrt();
    for physics in [LINE, SMOOTH, Physics::FULL] {
        for time_step_secs in TIME_STEPS {
            for factor in [1.001, 1.1, 1.5, 3.0, 10.0] {
                let speed = factor * escape;
                let found = speed_far_away(pair(time_step_secs, speed, 0.0, physics))
                    .unwrap_or_else(|| panic!("held at {factor} of it, Δt = {time_step_secs}"));
                let lost = 0.5 * (speed * speed - found * found);
                assert_close(lost, work(), 1e-9, &format!("work at {factor}, {time_step_secs} s"));
            }
            for factor in [0.1, 0.5, 0.9, 0.999] {
                let left = speed_far_away(pair(time_step_secs, factor * escape, 0.0, physics));
                assert_eq!(left, None, "at {factor} of the escape speed, Δt = {time_step_secs}");
            }
        }
    }
}

#[test]
fn the_static_pull_off_force_is_the_cohesion_at_every_time_step() {
    for time_step_secs in TIME_STEPS {
        let cohesion = BOND * G;
        let away = |load| speed_far_away(pair(time_step_secs, 0.0, load, LINE));
        assert_eq!(away(0.999 * cohesion), None, "Δt = {time_step_secs}");
        assert!(away(1.05 * cohesion).is_some(), "Δt = {time_step_secs}");
    }
}

#[test]
fn a_load_that_breaks_a_bond_gives_it_just_its_work() {
    for time_step_secs in TIME_STEPS {
        for factor in [1.1, 2.0, 5.0] {
            let mut simulation = pair(time_step_secs, 0.0, factor * BOND * G, LINE);
            while simulation.world().grains.positions[0].x < 3.0 * RADIUS {
                take_steps(&mut simulation, 1);
            }
            // The bond pulls with C₀ until the pair has opened by δ_c, and no longer.
            let opened = DISTANCE_IN_DIAMETERS * 2.0 * RADIUS;
            let time = (2.0 * opened / ((factor - 1.0) * BOND * G)).sqrt();
            let at = simulation.time_secs();
            let free = factor * BOND * G * at - BOND * G * time;
            let found = simulation.world().grains.velocities[0].x;
            assert_close(found, free, 1e-9, &format!("v at {factor}, Δt = {time_step_secs}"));
        }
    }
}

#[test]
fn two_free_grains_part_by_the_energy_of_their_relative_motion() {
    let escape = (2.0 * work()).sqrt();
    for time_step_secs in TIME_STEPS {
        for factor in [0.8, 1.3] {
            let second = DVec2::new(2.0 * RADIUS, 0.0);
            let grains = [
                moving(DVec2::ZERO, RADIUS, DVec2::ZERO),
                moving(second, RADIUS, DVec2::new(factor * escape, 0.0)),
            ];
            let weightless = |grain| Grain { feels_gravity: false, ..grain };
            let grains = grains.into_iter().map(weightless).collect();
            let parameters = range(BOND, time_step_secs);
            let mut simulation = start(&scene(LINE, DVec2::new(G, 0.0), parameters, grains));
            take_steps(&mut simulation, (0.1 / time_step_secs) as usize);
            let velocities = &simulation.world().grains.velocities;
            let found = velocities[1].x - velocities[0].x;
            let expected = escape * (factor * factor - 1.0f64).max(0.0).sqrt();
            assert!((found - expected).abs() < 1e-9, "{factor}, Δt = {time_step_secs}: {found}");
        }
    }
}

#[test]
fn overlap_is_pushed_out_and_moves_nothing() {
    let grains = vec![
        Grain { feels_gravity: false, ..Grain::at_rest(DVec2::ZERO, RADIUS) },
        Grain { feels_gravity: false, ..Grain::at_rest(DVec2::new(1.8 * RADIUS, 0.0), RADIUS) },
    ];
    for bond in [0.0, BOND] {
        let scene = scene(LINE, DVec2::new(G, 0.0), range(bond, 1e-3), grains.clone());
        let mut simulation = start(&scene);
        take_steps(&mut simulation, 60);
        assert_eq!(simulation.observables().kinetic_energy, 0.0);
        let gap = simulation.world().grains.positions[1].x - 2.0 * RADIUS;
        let first = simulation.world().grains.positions[0].x;
        assert!((gap - first).abs() < 1e-9, "gap {:e}", gap - first);
    }
}

/// A pile that falls together and bonds.
fn pile(bond: f64, time_step_secs: f64, method: Method) -> Scene {
    let parameters =
        Parameters { restitution: 0.1, restitution_threshold: 2.0, ..range(bond, time_step_secs) };
    Scene {
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
fn a_bond_gives_back_what_it_took_or_keeps_all_of_it() {
    for time_step_secs in TIME_STEPS {
        for factor in [0.5, 0.9, 1.1, 3.0] {
            let speed = factor * (2.0 * work()).sqrt();
            let mut simulation = pair(time_step_secs, speed, 0.0, Physics::FULL);
            let mass = simulation.world().grains.masses[0];
            let begun = simulation.observables().kinetic_energy;
            let (mut of_bonds, mut of_pushes, mut most) = (0.0, 0.0, 0f64);
            for _ in 0..(0.1 / time_step_secs) as u32 {
                let now = *simulation.step().expect("finite");
                let [of_step, stored, broken] =
                    [now.bond_work, now.bond_energy, now.broken_bond_energy].map(Option::unwrap);
                of_bonds += of_step;
                of_pushes += now.normal_work - of_step;
                most = most.max(stored);
                let what = format!("{factor} of the escape speed, Δt = {time_step_secs}");
                assert!((of_bonds + stored + broken).abs() <= 1e-9 * begun, "{what}");
                let sum = now.kinetic_energy - of_bonds - of_pushes;
                assert_close(sum, begun, 1e-9, &what);
                assert!(of_pushes <= 1e-9 * begun, "{what}: pushes gave {of_pushes} J");
            }
            let broken = simulation.observables().broken_bond_energy.unwrap();
            let kept = if factor > 1.0 { mass * work() } else { 0.0 };
            assert_close(broken, kept, 1e-9, "kept by the bond");
            assert_eq!(simulation.observables().bond_energy, Some(0.0));
            // At short steps the way out is seen.
            let bond_time = (2.0 * DISTANCE_IN_DIAMETERS * 2.0 * RADIUS / (BOND * G)).sqrt();
            if factor < 1.0 && time_step_secs < 0.2 * bond_time {
                assert!(most > 0.8 * begun, "stored {most} of {begun} J");
            }
        }
    }
}

#[test]
fn the_paper_s_law_tells_nothing_of_bonds() {
    let mut scene = pile(10.0, 1e-3, Method::Newton);
    scene.parameters.law = ContactLaw::Moreau;
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
    let mut agreeing = [0; 3];
    const MOMENTS: u32 = 12;
    for _ in 0..MOMENTS {
        take_steps(&mut simulation, 10);
        let next = |method| {
            let mut copy = simulation.clone();
            copy.set_solver(SolverSettings { method, ..scene.solver }).expect("fine");
            take_steps(&mut copy, 1);
            copy.world().grains.velocities.clone()
        };
        let reference = next(Method::Newton);
        for (count, method) in agreeing.iter_mut().zip(methods) {
            let found = next(method);
            let off = found.iter().zip(&reference).map(|(a, b)| (*a - *b).length());
            *count += u32::from(off.fold(0.0, f64::max) < 1e-5);
        }
    }
    // With friction a step can have more than one solution.
    assert!(agreeing.iter().all(|&count| count >= MOMENTS - 3), "{agreeing:?} of {MOMENTS}");
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
