//! The stepping schemes `tgs-soft` and `dem`: what each must get right by itself.

mod common;

use common::{
    G, LINE, SMOOTH, UNTURNING, assert_close, fixed, moving, parameters, pressed_pile, scene,
    start, take_steps,
};
use glam::DVec2;
use rayon::prelude::*;
use slump::contact::{ContactList, ContactMemory};
use slump::error::{Error, Result};
use slump::scene::{Rain, Scene, paper_pile, pile_of, settle};
use slump::sim::{ProblemVisitor, Pull, Simulation, SpringDashpot};
use slump::solver::{Method, Model, SolveReport, SolverSettings, StepProblem, solve};
use slump::world::{Boundary, FrictionCone, Grain, Physics};

const SCHEMES: [Method; 2] = [Method::TgsSoft, Method::Dem];

fn by(method: Method, substeps: u32, scene: Scene) -> Scene {
    Scene { solver: SolverSettings { method, substeps, ..scene.solver }, ..scene }
}

/// Two unequal discs that are about to meet, tilted against the axes unless they are on a line.
fn meeting(physics: Physics, restitution: f64, dt: f64) -> Scene {
    let direction = if physics.axes == 1 { DVec2::X } else { DVec2::new(0.6, 0.8) };
    let grains = [(0.0, 0.15, 0.7), (0.25 + 1e-9, 0.1, -0.3)].map(|(place, radius, speed)| Grain {
        feels_gravity: false,
        ..moving(place * direction, radius, speed * direction)
    });
    scene(physics, -G * direction, parameters(0.0, dt, restitution, 0.5), grains.into())
}

fn relative_velocity(simulation: &Simulation) -> DVec2 {
    let velocities = &simulation.world().grains.velocities;
    velocities[1] - velocities[0]
}

fn momentum(simulation: &Simulation) -> DVec2 {
    let grains = &simulation.world().grains;
    grains.masses.iter().zip(&grains.velocities).map(|(&mass, &velocity)| mass * velocity).sum()
}

/// m_ij of the first two grains.
fn effective_mass(simulation: &Simulation) -> f64 {
    let masses = &simulation.world().grains.masses;
    1.0 / (1.0 / masses[0] + 1.0 / masses[1])
}

fn springs(simulation: &Simulation) -> SpringDashpot {
    let physics = simulation.physics();
    SpringDashpot::of(simulation.world(), physics.axes, simulation.parameters().restitution)
}

/// Steps until two discs that meet have parted, and gives speed after over speed before.
fn measured_restitution(scene: &Scene) -> f64 {
    let mut simulation = start(scene);
    let (before, carried) = (relative_velocity(&simulation), momentum(&simulation));
    let mut touched = false;
    for _ in 0..1_000_000 {
        simulation.step().expect("a finite state");
        let off = momentum(&simulation).distance(carried);
        assert!(off < 1e-12 * carried.length(), "momentum is kept");
        let now = simulation.observables().contacts > 0;
        if touched && !now {
            return -relative_velocity(&simulation).dot(before) / before.length_squared();
        }
        touched |= now;
    }
    panic!("they never parted");
}

#[test]
fn springs_and_dashpots_give_the_restitution_that_is_asked_for() {
    for physics in [LINE, SMOOTH, Physics::FULL] {
        for (restitution, expected) in
            [(0.0, 0.02), (0.02, 0.02), (0.1, 0.1), (0.3, 0.3), (0.5, 0.5), (0.8, 0.8), (1.0, 1.0)]
        {
            let probe = start(&meeting(physics, restitution, 1e-3));
            let critical = springs(&probe).critical_time_step_secs(effective_mass(&probe), 1.0);
            let mut errors = [200.0, 800.0].map(|parts| {
                let scene = by(Method::Dem, 1, meeting(physics, restitution, critical / parts));
                measured_restitution(&scene) - expected
            });
            println!("ρ {restitution}: off by {errors:?}");
            // First order in h: a quarter of h, about a quarter of the error.
            assert!(errors[0].abs() < 1e-2, "ρ {restitution}: off by {errors:?}");
            errors.iter_mut().for_each(|error| *error = error.abs());
            assert!(errors[1] < 0.3 * errors[0] + 2e-4, "ρ {restitution}: off by {errors:?}");
        }
    }
}

#[test]
fn soft_substeps_part_a_pair_with_the_restitution_that_is_asked_for() {
    for physics in [LINE, SMOOTH, Physics::FULL] {
        for restitution in [0.0, 0.1, 0.5, 1.0] {
            for substeps in [1, 4, 16] {
                let scene = meeting(physics, restitution, 1e-3);
                let mut simulation = start(&by(Method::TgsSoft, substeps, scene));
                let (before, carried) = (relative_velocity(&simulation), momentum(&simulation));
                take_steps(&mut simulation, 2);
                assert_eq!(simulation.observables().contacts, 1, "they met");
                let after = relative_velocity(&simulation);
                let off = (after + restitution * before).length();
                assert!(off < 1e-12, "ρ {restitution}, {substeps} substeps: off by {off:e}");
                assert!(momentum(&simulation).distance(carried) < 1e-12 * carried.length());
            }
        }
    }
}

#[test]
fn a_threshold_of_restitution_holds_for_soft_substeps() {
    // They meet with 1 m/s: 102 g·Δt.
    for (threshold, parts) in [(90.0, true), (110.0, false)] {
        let mut scene = by(Method::TgsSoft, 0, meeting(LINE, 0.5, 1e-3));
        scene.parameters.restitution_threshold = threshold;
        let mut simulation = start(&scene);
        take_steps(&mut simulation, 2);
        assert_eq!(relative_velocity(&simulation).x > 0.1, parts, "threshold {threshold}");
    }
}

/// A disc that gravity pulls off the fixed disc above it, or off a free one.
fn pulled(method: Method, bond: f64, dt: f64, free: bool) -> Scene {
    let (radius, other) = (0.15, 0.1);
    let hanging = Grain::at_rest(DVec2::new(0.0, -(radius + other) * (1.0 - 1e-9)), radius);
    let mut grains = vec![hanging];
    if free {
        grains.push(Grain { feels_gravity: false, ..Grain::at_rest(DVec2::ZERO, other) });
    }
    let fixed_discs = if free { Vec::new() } else { vec![fixed(DVec2::ZERO, other)] };
    let scene = scene(Physics::FULL, -G * DVec2::Y, parameters(bond, dt, 0.2, 0.5), grains);
    by(method, 0, Scene { fixed_discs, ..scene })
}

#[test]
fn the_static_pull_off_force_does_not_depend_on_the_time_step() {
    for method in SCHEMES {
        for (dt, substeps) in [(1e-4, 0), (1e-3, 0), (1e-3, 400), (3e-3, 0), (1e-2, 0), (1e-2, 900)]
        {
            for free in [false, true] {
                let run = |bond: f64| {
                    let mut scene = pulled(method, bond, dt, free);
                    scene.solver.substeps = substeps;
                    let mut simulation = start(&scene);
                    take_steps(&mut simulation, (0.5 / dt) as usize);
                    simulation
                };
                let holds = |bond: f64| run(bond).observables().contacts == 1;
                let (mut opens_at, mut holds_at) = (0.5, 2.0);
                assert!(!holds(opens_at) && holds(holds_at));
                for _ in 0..9 {
                    let bond = 0.5 * (opens_at + holds_at);
                    *(if holds(bond) { &mut holds_at } else { &mut opens_at }) = bond;
                }
                // The pull is m_ij g, C₀ is Bond·m_ij·g.
                let found = 0.5 * (opens_at + holds_at);
                assert!((found - 1.0).abs() < 2e-3, "{method:?}, Δt {dt}: C₀ of {found} weights");

                let held = run(1.5);
                let grains = &held.world().grains;
                let mass = if free { effective_mass(&held) } else { grains.masses[0] };
                let force = held.contacts().impulses()[0].normal / dt;
                assert_close(force, -mass * G, 1e-6, "the force that holds it");
                assert!(held.observables().tensile_contacts == 1);
            }
        }
    }
}

/// A disc on a level half-space, under a gravity that leans by `slope` = tanθ.
fn on_slope(method: Method, physics: Physics, slope: f64, bond: f64, cone: FrictionCone) -> Scene {
    let radius = 0.1;
    let grain = Grain::at_rest(DVec2::new(0.0, radius * (1.0 - 1e-10)), radius);
    let gravity = G * DVec2::new(slope, -1.0).normalize();
    let mut parameters = parameters(bond, 1e-3, 0.1, 0.3);
    parameters.cone = cone;
    let level = Boundary::HalfSpace { point: DVec2::ZERO, normal: DVec2::Y };
    let scene = scene(physics, gravity, parameters, vec![grain]);
    by(method, 0, Scene { boundaries: vec![level], ..scene })
}

/// Its velocity and its acceleration once it lies on the slope.
fn slides(scene: &Scene) -> (f64, f64) {
    let mut simulation = start(scene);
    take_steps(&mut simulation, 500);
    let velocity = simulation.world().grains.velocities[0].x;
    take_steps(&mut simulation, 200);
    let later = simulation.world().grains.velocities[0].x;
    assert_eq!(simulation.observables().contacts, 1);
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

#[test]
fn free_fall_is_that_of_symplectic_euler_with_the_substep() {
    let (dt, count, velocity) = (1e-3, 300, DVec2::new(-0.7, 2.0));
    for method in SCHEMES {
        for substeps in [0, 1, 7] {
            let grains = vec![Grain { angular_velocity: 3.0, ..moving(DVec2::X, 0.1, velocity) }];
            let scene = scene(Physics::FULL, -G * DVec2::Y, parameters(20.0, dt, 0.1, 0.5), grains);
            let mut simulation = start(&by(method, substeps, scene));
            take_steps(&mut simulation, count);
            let n = f64::from(simulation.substeps()) * count as f64;
            let time = dt * count as f64;
            let way = time * velocity - DVec2::Y * 0.5 * G * time * time * (1.0 + 1.0 / n);
            let grains = &simulation.world().grains;
            assert!((grains.positions[0] - DVec2::X - way).length() < 1e-11, "{method:?}");
            assert!((grains.velocities[0] - velocity + G * time * DVec2::Y).length() < 1e-11);
            assert!((grains.angles[0] - 3.0 * time).abs() < 1e-11);
        }
    }
}

#[test]
fn every_step_closes_its_energy_budget() {
    for method in SCHEMES {
        for (bond, mu, physics) in [
            (0.0, 0.5, Physics::FULL),
            (50.0, 0.3, Physics::FULL),
            (20.0, 0.5, UNTURNING),
            (20.0, 0.0, SMOOTH),
        ] {
            let pile = pressed_pile(30, 0.1, 3, parameters(bond, 1e-3, 0.3, mu));
            let mut simulation = start(&by(method, 0, Scene { physics, ..pile }));
            simulation.set_pull(Some(Pull { grain: 29, target: DVec2::new(0.02, 0.05) }));
            let mut worked = 0.0;
            for _ in 0..100 {
                let before = simulation.observables().kinetic_energy;
                let after = *simulation.step().expect("a finite state");
                let works = [after.gravity_work, after.normal_work, after.tangential_work];
                let scale = before + works.iter().map(|work| work.abs()).sum::<f64>();
                let off = (after.kinetic_energy - before - works.iter().sum::<f64>()).abs();
                assert!(off <= 1e-10 * scale, "{method:?}, step {}: {off:e}", after.step);
                worked += after.normal_work.abs();
                assert!(after.converged && after.residual.is_finite());
            }
            assert!(worked > 0.0, "contacts worked");
        }
    }
}

/// Whether a pair that rests at its cohesive overlap shakes itself up from a small push.
fn shakes_up(restitution: f64, dt_over_critical: f64) -> bool {
    let probe = start(&meeting(LINE, restitution, 1e-3));
    let (mass, springs) = (effective_mass(&probe), springs(&probe));
    let mut scene = meeting(LINE, restitution, 1e-3);
    scene.parameters.time_step_secs = dt_over_critical * springs.critical_time_step_secs(mass, 1.0);
    scene.parameters.bond = 1.0;
    let overlap = mass * G / springs.stiffness;
    scene.grains[1].position.x = 0.25 - overlap;
    scene.grains[0].velocity.x = 0.0;
    let push = 1e-3 * overlap * (springs.stiffness / mass).sqrt();
    scene.grains[1].velocity.x = push;
    let mut simulation = start(&by(Method::Dem, 1, scene));
    (0..3000).any(|_| {
        simulation.step().expect("a finite state");
        relative_velocity(&simulation).length() > 10.0 * push
    })
}

#[test]
fn a_pair_of_elements_blows_up_above_its_critical_step_and_not_below() {
    for restitution in [0.0, 0.1, 0.5, 1.0] {
        let (mut stable, mut unstable) = (0.5, 2.0);
        assert!(!shakes_up(restitution, stable) && shakes_up(restitution, unstable));
        for _ in 0..8 {
            let middle = 0.5 * (stable + unstable);
            let place = if shakes_up(restitution, middle) { &mut unstable } else { &mut stable };
            *place = middle;
        }
        println!("ρ {restitution}: {stable} to {unstable} of the critical step");
        assert!((stable - 1.0).abs() < 0.02, "ρ {restitution}: {stable} of the critical step");
    }
    // Without damping the critical step is 2/ω.
    let probe = start(&meeting(LINE, 1.0, 1e-3));
    let (mass, springs) = (effective_mass(&probe), springs(&probe));
    let critical = springs.critical_time_step_secs(mass, 1.0);
    assert_close(critical, 2.0 * (mass / springs.stiffness).sqrt(), 1e-12, "2/ω");
}

#[test]
fn a_step_that_blows_up_ends_in_an_error() {
    // Between walls the disc cannot get away from its own energy.
    let mut scene = meeting(LINE, 0.5, 1e-3);
    scene.grains.truncate(1);
    let wall = |x: f64| Boundary::HalfSpace { point: x * DVec2::X, normal: -x * DVec2::X };
    scene.boundaries = vec![wall(-0.1499), wall(0.1499)];
    let critical = by(Method::Dem, 1, scene.clone()).simulation().expect("sound");
    let critical = critical.critical_time_step_secs().expect("springs");
    for (times, blows_up) in [(0.5, false), (3.0, true)] {
        scene.parameters.time_step_secs = times * critical;
        for substeps in [1, 10] {
            scene.parameters.time_step_secs = times * critical * f64::from(substeps);
            let mut simulation = start(&by(Method::Dem, substeps, scene.clone()));
            let failure = (0..2000).find_map(|_| simulation.step().err());
            assert_eq!(matches!(failure, Some(Error::NonFinite { .. })), blows_up, "{failure:?}");
        }
    }
    // A pile blows up too, and comes to an end without a panic, finite or not.
    let mut pile = by(Method::Dem, 1, paper_pile().expect("the shipped state"));
    pile.parameters.time_step_secs = 2e-3;
    let mut simulation = start(&pile);
    let failed = (0..200).any(|_| simulation.step().is_err());
    let Observed { kinetic, potential } = observed(&simulation);
    assert!(failed || kinetic > 10.0 * potential.abs(), "{kinetic} J");
    pile.solver.substeps = 0;
    let mut simulation = start(&pile);
    take_steps(&mut simulation, 100);
    let Observed { kinetic, potential } = observed(&simulation);
    assert!(kinetic < 0.5 * potential, "{kinetic} J of {potential} J");
}

struct Observed {
    kinetic: f64,
    potential: f64,
}

fn observed(simulation: &Simulation) -> Observed {
    let last = simulation.observables();
    Observed { kinetic: last.kinetic_energy, potential: last.potential_energy }
}

#[test]
fn the_substeps_left_to_the_scheme_are_stable_and_counted() {
    let pile = paper_pile().expect("the shipped state");
    let soft = start(&by(Method::TgsSoft, 0, pile.clone()));
    assert_eq!((soft.substeps(), soft.critical_time_step_secs()), (4, None));
    let mut dem = start(&by(Method::Dem, 0, pile.clone()));
    let critical = dem.critical_time_step_secs().expect("springs");
    let substep = 1e-3 / f64::from(dem.substeps());
    assert!((0.45..=0.5).contains(&(substep / critical)), "{substep} of {critical}");
    let substeps = dem.substeps();
    assert_eq!(dem.step().expect("a finite state").sweeps, substeps);
    assert_eq!(start(&pile).substeps(), 1);
}

/// What a visitor of a step's problem finds when it asks a scheme to solve it.
struct Solve(SolverSettings);

impl ProblemVisitor for Solve {
    type Output = Result<SolveReport>;

    fn visit<M: Model>(
        self,
        problem: &mut StepProblem<M::Kinematics>,
        _: &ContactList,
    ) -> Result<SolveReport> {
        solve::<M>(problem, &self.0)
    }
}

#[test]
fn a_scheme_refuses_to_solve_a_problem() {
    let simulation = start(&paper_pile().expect("the shipped state"));
    for method in SCHEMES {
        let settings = SolverSettings { method, ..*simulation.solver() };
        let refusal = simulation.next_problem(Solve(settings)).expect_err("no method").to_string();
        let expected = format!("solver is {}, but must be a method", method.name());
        assert!(refusal.starts_with(&expected), "{refusal}");
        assert!(refusal.contains("nsgs"), "{refusal}");
    }
}

#[test]
fn runs_repeat_bitwise_and_clones_go_on_as_the_original() {
    for method in SCHEMES {
        let mut pile = by(method, 0, paper_pile().expect("the shipped state"));
        pile.parameters = parameters(20.0, 2e-3, 0.1, 0.5);
        let run = || {
            let mut simulation = start(&pile);
            take_steps(&mut simulation, 100);
            simulation
        };
        let (mut one, other) = (run(), run());
        assert!(one.observables().slump > 0.01, "it moves");
        assert_eq!(one.world().grains, other.world().grains);
        assert_eq!(one.observables(), other.observables());
        let mut clone = one.clone();
        take_steps(&mut one, 20);
        take_steps(&mut clone, 20);
        assert_eq!(one.world().grains, clone.world().grains);
    }
}

#[test]
fn what_a_scheme_remembers_is_for_itself_alone() {
    let pile = by(Method::Dem, 0, paper_pile().expect("the shipped state"));
    let mut simulation = start(&pile);
    take_steps(&mut simulation, 5);
    let blank = |memory: &ContactMemory| *memory == ContactMemory::default();
    assert!(!simulation.contacts().memories().iter().all(blank));
    let settings = SolverSettings { method: Method::Nsgs, ..*simulation.solver() };
    simulation.set_solver(settings).expect("sound");
    take_steps(&mut simulation, 1);
    assert!(simulation.contacts().memories().iter().all(blank));
}

/// Mean and standard error.
fn mean(values: &[f64]) -> (f64, f64) {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
    (mean, (squares / (count - 1.0) / count).sqrt())
}

#[test]
fn a_pile_without_cohesion_slumps_as_it_does_in_contact_dynamics() {
    // By Gauss-Seidel to a relative change of 1e-6, Δt = 1e-3 s, from seeds 1 to 4 of the rain.
    let contact_dynamics = [0.454, 0.484, 0.532, 0.475];
    let states: Vec<Scene> = (1..=4)
        .into_par_iter()
        .map(|seed| {
            let rain = Rain { seed, ..Rain::default() };
            let grains = settle(&rain, |_| true).expect("it comes to rest");
            let mut pile = pile_of(grains, rain.box_width_in_diameters);
            pile.parameters.bond = 0.0;
            pile
        })
        .collect();
    for method in SCHEMES {
        let slump = |pile: &Scene| {
            let mut simulation = start(&by(method, 0, pile.clone()));
            take_steps(&mut simulation, 1000);
            simulation.observables().slump
        };
        let slumps: Vec<f64> = states.par_iter().map(slump).collect();
        let pairs = slumps.iter().zip(contact_dynamics);
        let (change, error) = mean(&pairs.map(|(slump, other)| slump - other).collect::<Vec<_>>());
        println!("{method:?}: {slumps:.3?}, more by {change:.3} ± {error:.3}");
        assert!(error < 0.02, "± {error} tells nothing");
        assert!(change.abs() + error < 0.05, "{method:?}: more by {change} ± {error}");
    }
}
