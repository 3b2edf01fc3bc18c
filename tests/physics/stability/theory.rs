//! Compares measured errors of the solvers with their theoretical limits, and the effect of friction models on sliding
//! bodies with theory.

use slump::scene::stability::{
    FRICTION_OF_ARCH, WALL_DISTANCE, arch, balls, blow, breaking_bond_of_cantilever, cantilever,
    column_on_line, dilatancy, leaning_column, mass_ratio, thin_wall,
};

use slump::study::stability::contraction_of_column;

use crate::common::*;

/// Number of steps after which the speed of a sinking column is measured. A column sinks if its steps are not solved
/// completely. Its speed approaches a steady value: each step reduces the difference from this value to a tenth or
/// less, so the speed is steady after this number of steps.
const STEADY: usize = 40;

fn cold(sweeps: u32) -> SolverSettings {
    SolverSettings {
        max_sweeps: sweeps,
        tolerance: 1e-14,
        warm_start: false,
        ..SolverSettings::SWEEPS
    }
}

/// Returns the steady speed at which the last grain of a column sinks, in units of g Δt (gravitational acceleration
/// times time step), if each step makes this many sweeps from zero impulses.
fn sinking_speed(mut scene: Scene, sweeps: u32) -> f64 {
    scene.solver = cold(sweeps);
    let run = after(&scene, STEADY);
    let speed = run.grains().velocities.last().expect("a grain").length();
    speed / (scene.gravity.magnitude() * scene.parameters.time_step_secs)
}

fn left(contraction: f64, sweeps: u32) -> f64 {
    let share = contraction.powi(sweeps as i32);
    share / (1.0 - share)
}

#[test]
fn a_column_sinks_less_with_more_sweeps_as_theory_says() {
    for count in [10, 20] {
        let contraction = contraction_of_column(count as f64);
        for sweeps in [(1.5 * (count * count) as f64) as u32, 2 * (count * count) as u32] {
            let found = sinking_speed(column_on_line(count), sweeps);
            let expected = 4.0 / std::f64::consts::PI * left(contraction, sweeps);
            let ratio = found / expected;
            assert!((0.9..1.1).contains(&ratio), "{count} discs, {sweeps} sweeps: {ratio}");
        }
        // The rate of convergence itself, which does not depend on the amplitude of the slowest mode.
        let sweeps = 2 * (count * count) as u32;
        let speeds =
            [sweeps, sweeps + 50].map(|sweeps| sinking_speed(column_on_line(count), sweeps));
        let found = (speeds[0] / speeds[1]).ln();
        let expected = (left(contraction, sweeps) / left(contraction, sweeps + 50)).ln();
        assert!((found / expected - 1.0).abs() < 0.01, "{count} discs: {found} for {expected}");
    }
}

#[test]
fn a_heavy_disc_needs_sweeps_by_the_ratio_of_the_masses() {
    for ratio in [30.0, 300.0] {
        let contraction = ratio / (ratio + 1.0);
        let sweeps = 2 * ratio as u32;
        let speeds = [sweeps, 2 * sweeps].map(|sweeps| sinking_speed(mass_ratio(ratio), sweeps));
        let found = (speeds[0] / speeds[1]).ln();
        let expected = (left(contraction, sweeps) / left(contraction, 2 * sweeps)).ln();
        assert!((found / expected - 1.0).abs() < 0.01, "ratio {ratio}: {found} for {expected}");
    }
}

#[test]
fn a_disc_goes_through_a_wall_in_the_share_of_phases_that_geometry_gives() {
    const PHASES: u32 = 40;
    for travel in [0.3, 0.45, 0.7, 1.0, 2.0, 5.0] {
        let through = (0..PHASES).filter(|phase| {
            let scene = thin_wall(travel, (f64::from(*phase) + 0.5) / f64::from(PHASES));
            let run = after(&scene, ((WALL_DISTANCE + 5.0) / travel) as usize);
            run.place(0).x > WALL_DISTANCE * scene.mean_diameter
        });
        let found = through.count() as f64 / f64::from(PHASES);
        let expected = (1.0f64 - 0.5 / travel).max(0.0);
        let phase = 1.0 / f64::from(PHASES);
        assert!((found - expected).abs() <= phase, "{travel} d a step: {found} for {expected}");
    }
}

/// Checks the final velocities of n touching balls in a row of which the first has the speed v, with restitution 1. The
/// contact between the first two balls closes at the speed v, so after the impact it opens at this speed: v₂ − v₁ = v
/// for the final velocities v₁ and v₂ of these balls. All other contacts require zero relative velocity, so all balls
/// except the first move at one velocity u, and v₁ = u − v. Conservation of momentum gives u − v + (n − 1) u = v. So u
/// = 2v/n, and the first ball bounces back if n > 2. Momentum and energy are conserved, but no real Newton's cradle
/// behaves in this way.
#[test]
fn balls_in_a_row_keep_momentum_and_energy_and_leave_together() {
    for count in [2, 3, 5, 20] {
        let scene = balls(count);
        let speed = scene.grains[0].velocity.x;
        let run = after(&scene, 100);
        let velocities: Vec<f64> = run.velocities().iter().map(|v| v.x / speed).collect();
        let shared = 2.0 / count as f64;
        assert!((velocities[0] - (shared - 1.0)).abs() < 1e-4, "{count}: {velocities:?}");
        for velocity in &velocities[1..] {
            assert!((velocity - shared).abs() < 1e-4, "{count}: {velocities:?}");
        }
        let momentum: f64 = velocities.iter().sum();
        let energy: f64 = velocities.iter().map(|v| v * v).sum();
        assert!((momentum - 1.0).abs() < 1e-12 && (energy - 1.0).abs() < 1e-4, "{count}");
    }
}

/// Returns a run of a column under the stepper `dem` (springs) with undivided steps (one substep each). The time step
/// is `part` times the critical time step.
fn springs(part: f64) -> Simulation {
    let mut scene = column_on_line(12);
    scene.parameters.restitution = 0.5;
    scene.stepper = Stepper::Dem;
    scene.parameters.substeps = 1;
    let critical = start(&scene).critical_time_step_secs();
    scene.parameters.time_step_secs = part * critical.expect("springs have a critical step");
    start(&scene)
}

#[test]
fn springs_blow_up_at_their_critical_time_step() {
    let stays_at_rest = |part: f64| {
        let mut run = springs(part);
        for _ in 0..20_000 {
            if run.step().is_err() {
                return false;
            }
        }
        let world = run.world();
        let fastest = world.grains.velocities.iter().map(|v| v.length()).fold(0.0, f64::max);
        fastest < 1e-6 * (world.gravity.magnitude() * world.mean_diameter).sqrt()
    };
    let low = border(0.8, 1.25, 7, stays_at_rest);
    assert!((0.995..1.03).contains(&low), "stable up to {low} of the critical time step");
}

#[test]
fn a_cantilever_without_friction_tears_at_the_bond_number_of_statics_at_every_time_step() {
    for length in [2, 4, 6] {
        let right = breaking_bond_of_cantilever(length);
        for ((part, torn), time_step_secs) in
            pairs([(0.99, true), (1.01, false)], [2e-4, 1e-3, 1e-2])
        {
            let mut scene = cantilever(length);
            scene.parameters.friction = 0.0;
            scene.parameters.bond = part * right;
            scene.parameters.time_step_secs = time_step_secs;
            scene.solver =
                SolverSettings { tolerance: 1e-9, max_sweeps: 20_000, ..SolverSettings::SWEEPS };
            let run = after(&scene, (0.1 / time_step_secs) as usize);
            let bonds = 4 * length as u32;
            let found = run.observables().contacts < bonds;
            assert_eq!(found, torn, "{length} discs, {part} of {right}, {time_step_secs} s");
        }
    }
}

#[test]
fn the_contacts_of_an_arch_carry_what_statics_says() {
    let mut scene = arch();
    scene.solver.tolerance = 1e-12;
    let run = after(&scene, 3);
    let list = run.contacts();
    assert_eq!(list.contacts().len(), 4);
    let spring = (2f64.sqrt() - 1.0) / (2f64.sqrt() + 3.0);
    for (contact, impulse) in list.contacts().iter().zip(list.impulses()) {
        let crown = contact.other < 3;
        let expected = if crown { FRICTION_OF_ARCH } else { spring };
        let found = impulse.tangential.abs() / impulse.normal;
        assert!((found - expected).abs() < 1e-5, "crown {crown}: {found} for {expected}");
    }
}

#[test]
fn a_leaning_column_holds_above_a_rolling_friction_of_1_and_rolls_aside_below() {
    for count in [1, 5, 20] {
        for (rolling_friction, holds) in [(1.02, true), (0.98, false)] {
            let mut scene = leaning_column(count);
            scene.parameters.rolling_friction = rolling_friction;
            let run = after(&scene, 200);
            let top = count - 1;
            let moved = run.place(top).distance(scene.grains[top].position) / scene.mean_diameter;
            assert_eq!(moved < 1e-4, holds, "{count} discs at {rolling_friction}: {moved} d");
        }
    }
}

fn settings(method: Method, friction_model: FrictionModel, model_solves: u32) -> SolverSettings {
    SolverSettings { friction_model, model_solves, ..solved_by(method, 1e-13) }
}

fn sliding(time_step_secs: f64, solver: SolverSettings) -> Simulation {
    let mut scene = dilatancy();
    scene.parameters.time_step_secs = time_step_secs;
    scene.solver = solver;
    start(&scene)
}

/// Returns four numbers of the scene `dilatancy`: the initial speed v₀ (m/s), the friction coefficient μ, gravity g
/// (m/s²) and the diameter d (m).
fn numbers() -> [f64; 4] {
    let scene = dilatancy();
    let speed = scene.grains[0].velocity.x;
    [speed, scene.parameters.friction, scene.gravity.magnitude(), scene.mean_diameter]
}

/// Runs until the sliding disc has stopped. Returns its displacement from the initial position, m.
fn way(run: &mut Simulation) -> glam::DVec2 {
    let [speed, friction, gravity, _] = numbers();
    let start = run.place(0);
    while run.time_secs() < 1.5 * speed / (friction * gravity) {
        run.step().expect("a finite state");
    }
    assert!(run.velocity(0).length() < 1e-9, "it has stopped");
    run.place(0) - start
}

/// Short and long time steps, s. At some of them the disc stops within a step, at others at the end of a step.
const TIME_STEPS_SECS: [f64; 4] = [2e-4, 1e-3, 5e-3, 1.7e-2];

#[test]
fn what_slides_keeps_its_level_and_stops_where_the_sum_of_its_steps_says() {
    let [speed, friction, gravity, diameter] = numbers();
    let ways = [
        (Method::Nsgs, FrictionModel::Coulomb),
        (Method::Newton, FrictionModel::Coulomb),
        (Method::InteriorPoint, FrictionModel::Coulomb),
        (Method::Nsgs, FrictionModel::Tresca),
        (Method::InteriorPoint, FrictionModel::Tresca),
    ];
    for ((method, model), time_step_secs) in pairs(ways, TIME_STEPS_SECS) {
        let what = format!("{method}, {model}, {time_step_secs} s");
        let found = way(&mut sliding(time_step_secs, settings(method, model, 1)));
        let slowing = friction * gravity * time_step_secs;
        let steps = (speed / slowing).floor();
        let sum = time_step_secs * (steps * speed - 0.5 * slowing * steps * (steps + 1.0));
        assert!((found.x / sum - 1.0).abs() < 1e-9, "{what}: {} for {sum}", found.x);
        assert!(found.y.abs() < 1e-11 * diameter, "{what}: lifted by {:e}", found.y);
        let short = speed * speed / (2.0 * friction * gravity) - sum;
        assert!((0.0..=0.5 * speed * time_step_secs).contains(&short), "{what}: {short}");
    }
}

#[test]
fn associated_throws_what_slides_to_the_same_height_at_every_time_step() {
    let [speed, friction, gravity, diameter] = numbers();
    for time_step_secs in TIME_STEPS_SECS {
        let solver = settings(Method::InteriorPoint, FrictionModel::Associated, 1);
        let mut run = sliding(time_step_secs, solver);
        let level = run.place(0).y;
        run.step().expect("a finite state");
        let after = run.velocity(0);
        let along = (speed - friction * gravity * time_step_secs) / (1.0 + friction * friction);
        let right = glam::DVec2::new(along, friction * along);
        assert!((after - right).length() < 1e-9 * speed, "{after} for {right}");
        let lift = run.place(0).y - level;
        assert!((lift / (time_step_secs * friction * along) - 1.0).abs() < 1e-6, "{lift:e}");

        let (mut highest, mut expected, mut rising) = (lift, lift, after.y);
        while rising > 0.0 {
            rising -= gravity * time_step_secs;
            expected += (time_step_secs * rising).max(0.0);
            run.step().expect("a finite state");
            highest = highest.max(run.place(0).y - level);
        }
        assert!((highest / expected - 1.0).abs() < 1e-9, "{highest} for {expected}");
        assert!(highest > 0.6 * diameter, "{time_step_secs} s: {highest:e}");
    }
}

#[test]
fn desaxce_sinks_what_slides_by_the_way_of_a_step_times_friction() {
    let [speed, friction, ..] = numbers();
    for time_step_secs in TIME_STEPS_SECS {
        let sunk = |solves| {
            let solver = settings(Method::InteriorPoint, FrictionModel::Desaxce, solves);
            -way(&mut sliding(time_step_secs, solver)).y
        };
        let right = friction * speed * time_step_secs;
        let once = sunk(1);
        assert!((once / right - 1.0).abs() < 1e-6, "{time_step_secs} s: {once} for {right}");
        // Each solve reduces the error to μ²/(1 + μ²), which is a fifth.
        let fourth = sunk(4);
        assert!((0.0..0.02 * right).contains(&fourth), "{time_step_secs} s: {fourth} of {right}");
    }
}

/// Returns three results for two discs that slide on a floor: their mean speed along the floor (weighted by mass, m/s),
/// their mean position along it (m), and true if the upper disc has already hit the lower disc.
fn along_the_floor(run: &Simulation) -> (f64, f64, bool) {
    let grains = run.grains();
    let mass: f64 = grains.masses.iter().sum();
    let mean = |of: &[glam::DVec2]| {
        of.iter().zip(&grains.masses).map(|(of, mass)| *mass * *of).sum::<glam::DVec2>() / mass
    };
    let velocity = mean(&grains.velocities);
    (velocity.x, mean(&grains.positions).x, velocity.y.abs() < 1e-9)
}

#[test]
fn a_blow_on_what_slides_takes_speed_by_impulse_balance() {
    let scene = blow();
    let [light, heavy] = [0, 1].map(|k| scene.grains[k].radius.powi(2));
    let fall = -scene.grains[1].velocity.y;
    let taken = scene.parameters.friction * heavy * fall / (light + heavy);
    let before = scene.grains[0].velocity.x;
    assert!(taken > 0.1 * before && taken < 0.9 * before, "it is seen, and they go on sliding");
    let ways = [
        (Method::Newton, FrictionModel::Coulomb, 1e-8),
        // With bounded friction, fifty sweeps estimate the pressing force, so the final speed is wrong by up to 1 % of
        // the lost speed. Forces of the previous step would not help, because they do not include the blow.
        (Method::InteriorPoint, FrictionModel::Tresca, 0.01 * taken),
        (Method::Nsgs, FrictionModel::Tresca, 0.01 * taken),
    ];
    for (time_step_secs, (method, model, off)) in pairs([1e-4, 1e-3, 5e-3], ways) {
        let what = format!("{method}, {model}, {time_step_secs} s");
        let mut scene = scene.clone();
        scene.parameters.time_step_secs = time_step_secs;
        scene.solver = settings(method, model, 1);
        let mut run = start(&scene);
        let mut steps = 0.0;
        let start = along_the_floor(&run).1;
        while !along_the_floor(&run).2 {
            run.step().expect("a finite state");
            steps += 1.0;
            assert!(steps < 100.0, "{what}: the blow has come");
        }
        assert!(steps > 1.0, "{what}: the floor's contact was there before the blow");
        let at_the_blow = along_the_floor(&run).0;
        let expected = before - taken;
        assert!((at_the_blow - expected).abs() < off, "{what}: {at_the_blow} for {expected}");
        take_steps(&mut run, 10);
        let (after, place, _) = along_the_floor(&run);
        assert!((after - (before - taken)).abs() < off, "{what}: {after}");
        let way = time_step_secs * ((steps + 10.0) * before - 11.0 * taken);
        let off = (11.0 * time_step_secs * off).max(1e-9);
        assert!((place - start - way).abs() < off, "{what}: {} for {way}", place - start);
    }
}
