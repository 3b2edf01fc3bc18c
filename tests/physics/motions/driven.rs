//! Tests of walls that a force drives: load on contacts, balance of momentum and energy, and walls of any mass.

use super::{saved_and_read, through_a_file};
use crate::common::*;

fn methods() -> impl Iterator<Item = Method> {
    METHODS.iter().filter(|info| info.takes_drives).map(|info| info.method)
}

pub(super) fn by_force(direction: DVec2, force: f64, mass: f64) -> Drive {
    let force = Some(force);
    Drive { direction, force, pressure: None, width: None, mass, damping: 0.0, speed: 0.0 }
}

pub(super) fn driven(boundaries: &[usize], drive: Drive) -> Motion {
    Motion { boundaries: boundaries.to_vec(), drive: Some(drive), ..Motion::default() }
}

pub(super) fn drive_of(scene: &mut Scene) -> &mut Drive {
    scene.motions[0].drive.as_mut().expect("a drive")
}

pub(super) fn drive(run: &Simulation) -> &Drive {
    run.world().motions[0].drive.as_ref().expect("it is driven")
}

fn between(height: f64) -> Vec<Boundary> {
    vec![level(), plane(height * DVec2::Y, DVec2::NEG_Y)]
}

/// Returns five columns of three discs in a periodic cell, under a piston with this mass (kg) and the pressure 40 N/m.
pub(super) fn pressed(mass: f64) -> Scene {
    let (radius, spacing) = (0.01, 0.05);
    let place = |k: i32| DVec2::new(spacing * f64::from(k / 3), 0.01 + 0.02 * f64::from(k % 3));
    let grains = (0..15).map(|k| Grain::at_rest(place(k), radius)).collect();
    let gravity = -9.8 * DVec2::Y;
    let mut scene = scene(Physics::FULL, gravity, parameters(0.0, 1e-3, 0.0, 0.5), grains);
    scene.boundaries = between(0.06);
    // With this tolerance, contacts that exist at the start also exist in the first step.
    scene.gap_tolerance = 1e-8;
    scene.parameters.touch_tolerance = 0.0;
    scene.periodic = Some(Periodic::along_x([-0.025, 0.225]));
    let pressure = Drive { force: None, pressure: Some(40.0), ..by_force(DVec2::NEG_Y, 0.0, mass) };
    scene.motions = vec![driven(&[1], pressure)];
    scene
}

/// Returns the sum of the normal forces of all contacts of the boundary with this index, N.
pub(super) fn carried(run: &Simulation, boundary: u32) -> f64 {
    let contacts = run.moment().contacts.into_iter();
    let of_it = contacts.filter(|contact| contact.other == OtherBody::Boundary(boundary));
    of_it.map(|contact| contact.normal_force).sum()
}

#[test]
fn a_piston_at_rest_carries_its_pressure_however_light_it_is() {
    for method in methods() {
        // A sweep moves only a small part of a light wall's load (its mass fraction) to the next column. So the
        // lightest wall is on one column.
        for (mass_ratio, grains) in [(1e-6, 3), (0.1, 15), (1.0, 15), (1e4, 15)] {
            // Methods that treat all contacts at once converge too slowly if a heavy wall is on light columns.
            let sweeps = [Method::Nsgs, Method::Nncg, Method::Auto].contains(&method);
            if mass_ratio > 1.0 && !sweeps {
                continue;
            }
            let mut scene = pressed(1.0);
            scene.grains.truncate(grains);
            let of_grain = std::f64::consts::PI * 1e-4;
            drive_of(&mut scene).mass = mass_ratio * of_grain;
            (scene.solver.method, scene.solver.tolerance) = (method, 1e-10);
            let run = after(&through_a_file(&scene), 40);
            let what = format!("{method}, {mass_ratio}");
            assert!(run.observables().converged, "{what}: {:?}", run.observables());
            assert_close(carried(&run, 1), 40.0 * 0.25, 1e-8, &what);
            let weight = grains as f64 * of_grain * 9.8;
            assert_close(carried(&run, 0), 40.0 * 0.25 + weight, 1e-8, &what);
            // The remaining speed is the solver's tolerance times F Δt/M (F: force on the wall, M: mass of the wall).
            let left = 1e-10 * 10.0 * 1e-3 / (mass_ratio * of_grain);
            assert!(drive(&run).speed.abs() < 1e-9 + left, "{what}: {:?}", drive(&run));
        }
    }
}

/// Checks that Gauss–Seidel sweeps and the interior-point method move a wall alike if friction is bounded.
#[test]
fn sweeps_and_the_interior_point_move_a_wall_alike_within_bounds_of_friction() {
    let of_grain = std::f64::consts::PI * 1e-4;
    for (mass_ratio, restitution, damping) in
        [(1e-2, 0.0, 0.0), (0.1, 0.5, 0.3), (1.0, 0.9, 0.0), (30.0, 0.1, 5.0)]
    {
        let mut scene = pressed(1.0);
        scene.parameters.restitution = restitution;
        let lid = by_force(DVec2::new(0.6, -0.8), 1.0, mass_ratio * of_grain);
        *drive_of(&mut scene) = Drive { damping, ..lid };
        for (grain, number) in scene.grains.iter_mut().zip(1..) {
            let turn = 2.4 * f64::from(number);
            grain.velocity = 0.2 * DVec2::new(turn.sin(), turn.cos());
        }
        let begun = after(&scene, 1);
        let solved = [Method::Nsgs, Method::InteriorPoint].map(|method| {
            let mut run = begun.clone();
            let tight = SolverSettings { max_sweeps: 1_000_000, ..solved_by(method, 1e-11) };
            run.set_solver(SolverSettings { friction_model: FrictionModel::Tresca, ..tight })
                .expect("both take it");
            let row = *run.step().expect("a finite state");
            assert!(row.converged, "{method}, {mass_ratio}: {row:?}");
            assert!(carried(&run, 1) > 0.01, "{method}, {mass_ratio}: grains push the wall");
            run
        });
        let [by_sweeps, by_path] = &solved;
        let what = format!("{mass_ratio}, {restitution}, {damping}");
        let changed = (drive(by_path).speed - drive(&begun).speed).abs();
        assert!(changed > 1e-5, "{what}: the wall's speed changes, by {changed:e}");
        let apart = (drive(by_path).speed - drive(by_sweeps).speed).abs();
        assert!(apart < 1e-3 * changed, "{what}: the wall goes {apart:e} m/s apart");
        for grain in 0..scene.grains.len() {
            let apart = (by_path.velocity(grain) - by_sweeps.velocity(grain)).length();
            assert!(apart < 1e-7, "{what}, grain {grain}: {apart:e} m/s");
        }
    }
}

#[test]
fn a_wall_that_nothing_holds_goes_as_its_force_and_its_damping_say() {
    let grain = Grain::at_rest(-10.0 * DVec2::Y, 0.1);
    let mut scene = without_g(parameters(0.0, 1e-3, 0.0, 0.5), vec![grain]);
    scene.boundaries = vec![plane(DVec2::ZERO, DVec2::NEG_Y)];
    scene.motions = vec![driven(&[0], by_force(DVec2::Y, 3.0, 2.0))];
    let run = after(&scene, 100);
    assert_close(drive(&run).speed, 0.15, 1e-12, "F t/M");
    let Boundary::HalfSpace { point, .. } = run.world().boundaries[0] else {
        panic!("it stays one")
    };
    // The path is Σ Δt V over all steps. In the first step the force F and the mass M give the speed V = FΔt/M.
    assert_close(point.y, 0.5 * 1.5 * 0.1 * 0.101, 1e-12, "the way");
    drive_of(&mut scene).damping = 60.0;
    assert_close(drive(&after(&scene, 1000)).speed, 3.0 / 60.0, 1e-9, "F/c");
}

#[test]
fn a_grain_that_hits_a_wall_of_a_mass_gets_the_impulse_of_both_masses() {
    let (radius, mass) = (0.1, 0.7);
    let of_grain = std::f64::consts::PI * radius * radius;
    for (method, restitution) in pairs(methods(), [0.0, 0.5, 1.0]) {
        let parameters = parameters(0.0, 1e-4, restitution, 0.0);
        let grain = moving(DVec2::new(0.0, 0.10001), radius, -2.0 * DVec2::Y);
        let mut scene = without_g(parameters, vec![grain]);
        scene.solver.method = method;
        // The grain hits a driven disc obliquely. The disc moves along y only; its guide takes the impulse along x.
        let normal = DVec2::new(0.6, 0.8);
        scene.fixed_discs = vec![fixed(scene.grains[0].position - 0.2 * normal, 0.1)];
        let disc = by_force(DVec2::Y, 0.0, mass);
        scene.motions =
            vec![Motion { fixed_discs: vec![0], drive: Some(disc), ..Motion::default() }];
        let run = after(&scene, 3);
        // With the masses m (grain) and M (disc), 1/m_eff = 1/m + n_y²/M (n: normal). The approach speed is 2 n_y.
        let effective = 1.0 / (1.0 / of_grain + 0.64 / mass);
        let impulse = (1.0 + restitution) * effective * 1.6;
        let what = format!("{method}, {restitution}");
        let expected = -2.0 * DVec2::Y + impulse / of_grain * normal;
        let found = run.velocity(0);
        // The movement of the disc in the first step turns the normal slightly.
        assert!(found.distance(expected) < 1e-2, "{what}: {found} {expected}");
        let momentum = of_grain * found.y + mass * drive(&run).speed;
        assert_close(momentum, -2.0 * of_grain, 1e-12, &what);
        let energy = 0.5 * of_grain * found.length_squared() + drive(&run).kinetic_energy();
        if restitution == 1.0 {
            assert_close(energy, 2.0 * of_grain, 1e-12, &what);
        }
    }
}

#[test]
fn on_a_line_a_driven_wall_is_as_good_as_a_bead_of_its_mass() {
    let radius = 0.1;
    let mass = std::f64::consts::PI * radius * radius;
    let beads = |count: i32| -> Vec<Grain> {
        let mut beads: Vec<Grain> =
            (0..count).map(|k| Grain::at_rest(0.21 * f64::from(k) * DVec2::X, radius)).collect();
        beads[0].velocity = DVec2::X;
        beads
    };
    for method in methods() {
        let of = |grains| {
            let mut scene = scene(LINE, DVec2::ZERO, parameters(0.0, 1e-3, 0.7, 0.0), grains);
            scene.solver.method = method;
            scene
        };
        let mut all = start(&of(beads(5)));
        let mut walled = of(beads(4));
        let point = (0.84 - radius) * DVec2::X;
        walled.boundaries = vec![Boundary::HalfSpace { point, normal: DVec2::NEG_X }];
        walled.motions = vec![driven(&[0], by_force(DVec2::X, 0.0, mass))];
        let mut walled = start(&walled);
        take_steps(&mut all, 400);
        take_steps(&mut walled, 400);
        let speeds = all.velocities();
        assert!(speeds[4].x > 0.1, "{speeds:?}");
        assert_close(drive(&walled).speed, speeds[4].x, 1e-9, &format!("{method}"));
        for (one, other) in speeds.iter().zip(walled.velocities()) {
            assert!((one.x - other.x).abs() < 1e-9, "{method}: {one} {other}");
        }
    }
}

/// Returns a scene of grains between a floor and a rough plate. A force presses the plate down while it moves along x.
fn sheared(mass: f64) -> Scene {
    let grains = (0..24).map(|k| {
        let place = DVec2::new(0.011 * f64::from(k % 6), 0.0051 + 0.0101 * f64::from(k / 6));
        Grain::at_rest(place, 0.005 * (0.9 + 0.1 * (0.618 * f64::from(k)).fract()))
    });
    let mut scene = under_g(parameters(0.0, 5e-4, 0.3, 0.5), grains.collect());
    scene.boundaries = vec![level()];
    scene.fixed_discs =
        (0..6).map(|k| fixed(DVec2::new(0.011 * f64::from(k), 0.046), 0.005)).collect();
    scene.periodic = Some(Periodic::along_x([-0.0055, 0.0605]));
    let drive = Drive { damping: 0.2, ..by_force(DVec2::NEG_Y, 2.0, mass) };
    let course = Some(straight(0.1 * DVec2::X));
    scene.motions = vec![Motion {
        fixed_discs: (0..6).collect(),
        course,
        drive: Some(drive),
        ..Motion::default()
    }];
    scene
}

#[test]
fn energy_and_momentum_of_a_driven_wall_balance_in_every_step() {
    for (method, mass) in pairs(methods(), [1e-4, 0.05]) {
        let mut scene = sheared(mass);
        (scene.solver.method, scene.solver.tolerance) = (method, 1e-6);
        scene.solver.max_sweeps = 500;
        // The floor does no work. The plate's work along x is done by its course, not by the drive.
        let mut run = start(&scene);
        let (mut turned, mut moved) = (0.0, 0f64);
        for step in 0..120 {
            let before = drive(&run).clone();
            take_steps(&mut run, 1);
            let (now, observables) = (drive(&run), run.observables());
            let secs = scene.parameters.time_step_secs;
            let mut push = DVec2::ZERO;
            for contact in &run.moment().contacts {
                if matches!(contact.other, OtherBody::FixedDisc(_)) {
                    push -= contact.force;
                }
            }
            let along = push.dot(DVec2::NEG_Y);
            let what = format!("{method}, {mass} kg, step {step}");
            let change = mass * (now.speed - before.speed);
            let found = secs * (2.0 - 0.2 * now.speed + along);
            assert!((change - found).abs() < 1e-12, "{what}: {change} {found} N s");
            let mean = 0.5 * (now.speed + before.speed);
            let by_walls = -secs * (along * mean + push.x * 0.1);
            let off = (observables.wall_work - by_walls).abs();
            assert!(off < 1e-12, "{what}: {off} J of {by_walls}");
            let energy = now.kinetic_energy() - before.kinetic_energy();
            let given = secs * (2.0 - 0.2 * now.speed) * mean + secs * along * mean;
            assert!((energy - given).abs() < 1e-12, "{what}: {energy} {given} J");
            turned += by_walls.abs();
            moved = moved.max(now.speed.abs());
        }
        assert!(turned > 1e-4 && moved > 1e-2, "{method}: {turned} J, {moved} m/s");
    }
}

#[test]
fn a_run_with_a_driven_wall_goes_on_from_a_file_bit_for_bit() {
    let scene = through_a_file(&sheared(0.01));
    let mut run = after(&scene, 50);
    let read = saved_and_read(&scene, &run);
    assert_eq!(read.as_start().motions, run.world().motions, "a new start takes its speed along");
    let mut read = read.simulation;
    take_steps(&mut run, 50);
    take_steps(&mut read, 50);
    assert_eq!(run.world(), read.world());
    assert!(drive(&run).speed != 0.0);
}

#[test]
fn a_motion_of_another_wall_stays_what_it_was() {
    // A driven wall without contacts must not change any bit of the grains' state.
    let grain = |x: f64| moving(DVec2::new(x, 0.02), 0.01, DVec2::new(0.3, -0.2));
    let mut scene = under_g(parameters(0.0, 1e-3, 0.4, 0.5), vec![grain(0.0), grain(0.021)]);
    scene.solver = tight();
    scene.boundaries = between(5.0);
    scene.motions = vec![goes(&[0], straight(DVec2::new(0.1, 0.02)))];
    let mut alone = start(&scene);
    scene.motions.push(driven(&[1], by_force(DVec2::Y, 1.0, 1.0)));
    let mut with = start(&scene);
    take_steps(&mut alone, 200);
    take_steps(&mut with, 200);
    assert_eq!(alone.world().grains, with.world().grains);
}

/// Returns the steppers and methods that support walls driven by a force, in all combinations.
fn ways() -> impl Iterator<Item = (Stepper, Method)> {
    let methods = |stepper: Stepper| {
        let takes = METHODS.iter().filter(|info| info.takes_drives);
        takes.take(if stepper.uses_method() { METHODS.len() } else { 1 })
    };
    let steppers = Stepper::ALL.iter().copied().filter(|stepper| stepper.info().takes_drives);
    steppers.flat_map(move |stepper| methods(stepper).map(move |info| (stepper, info.method)))
}

/// Returns a scene of jumping grains below a damped piston of this mass (kg) and beside a piston of three times this
/// mass.
fn jumping(mass: f64) -> Scene {
    let mut scene = pressed(mass);
    for (k, grain) in (0..).zip(&mut scene.grains) {
        grain.velocity = 0.3 * DVec2::from_angle(2.4 * f64::from(k));
    }
    let damped = Drive { damping: 0.3, speed: 0.2, ..by_force(DVec2::NEG_Y, 2.0, mass) };
    scene.periodic = None;
    scene.boundaries.push(plane(-0.02 * DVec2::X, DVec2::X));
    scene.boundaries.push(plane(0.22 * DVec2::X, DVec2::NEG_X));
    scene.motions =
        vec![driven(&[1], damped), driven(&[2], by_force(DVec2::new(1.0, 0.1), 1.0, 3.0 * mass))];
    scene.parameters.restitution = 0.4;
    scene
}

#[test]
fn energy_of_grains_and_driven_walls_changes_by_what_contacts_took_and_forces_gave() {
    for ((stepper, method), mass) in pairs(ways(), [0.003, 0.1]) {
        let mut scene = jumping(mass);
        (scene.stepper, scene.solver.method, scene.solver.tolerance) = (stepper, method, 1e-6);
        scene.solver.max_sweeps = 300;
        let mut run = start(&scene);
        let of = |run: &Simulation| {
            let now = run.observables();
            now.kinetic_energy + now.drive_energy.expect("walls are driven")
        };
        let (first, mut given) = (of(&run), 0.0);
        assert_close(run.observables().drive_energy.expect("driven"), 0.02 * mass, 1e-12, "½MV²");
        for step in 0..150 {
            let before = of(&run);
            take_steps(&mut run, 1);
            let now = run.observables();
            let of_drives = now.drive_work.expect("walls are driven");
            let works = now.normal_work + now.tangential_work - now.wall_work;
            let off = of(&run) - before - works - now.gravity_work - of_drives;
            assert!(off.abs() < 1e-13 + 1e-12 * first, "{stepper} {method} {mass} {step}: {off} J");
            given += of_drives.abs();
        }
        assert!(given > 0.05 * first, "{stepper} {method}: {given} J of {first} J");
    }
}

#[test]
fn a_piston_carries_its_pressure_and_catches_what_hits_it_under_other_laws() {
    for (stepper, rests, exact, gap, restitution) in
        [(Stepper::Range, 60, 1e-6, 1.2e-3, 0.0), (Stepper::TgsSoft, 1500, 1e-3, 1e-4, 0.5)]
    {
        for mass_ratio in [0.01, 0.1, 1.0, 10.0, 100.0] {
            let what = format!("{stepper}, a piston of {mass_ratio}");
            let mass = mass_ratio * std::f64::consts::PI * 1e-4;
            let mut scene = Scene { stepper, ..pressed(mass) };
            let mut run = after(&scene, rests);
            let mut mean = 0.0;
            for _ in 0..100 {
                take_steps(&mut run, 1);
                mean += carried(&run, 1) / 100.0;
            }
            assert_close(mean, 10.0, exact, &what);
            // The wall vibrates with less than the speed that gravity gives in one step, 9.8e-3 m/s.
            assert!(drive(&run).speed.abs() < 9.8e-3, "{what}: {:?}", drive(&run));
            scene.parameters.restitution = 0.5;
            scene.grains.truncate(1);
            scene.grains[0].feels_gravity = false;
            scene.grains[0].velocity = DVec2::Y;
            scene.grains[0].position.y = 0.05 - gap;
            scene.motions = vec![driven(&[1], by_force(DVec2::NEG_Y, 0.0, mass))];
            let run = after(&scene, 4);
            let (grain, wall) = (run.velocity(0).y, -drive(&run).speed);
            assert_close(grain + mass_ratio * wall, 1.0, 1e-12, &what);
            // Under `range` the restitution is 0: bodies that do not separate within the step move on together.
            assert!((wall - grain - restitution).abs() < 1e-6, "{what}: {grain} {wall}");
        }
    }
}

/// Returns the scene of [`pressed`] with the stepper `dem` and stiff springs.
fn on_springs(mass: f64) -> Scene {
    let mut scene = pressed(mass);
    scene.stepper = Stepper::Dem;
    (scene.parameters.stiffness, scene.parameters.damping_ratio) = (2e4, 0.3);
    scene
}

#[test]
fn a_piston_on_springs_carries_its_pressure_and_its_energy_balances() {
    let scene = on_springs(0.01);
    let mut run = start(&scene);
    let substep = scene.parameters.time_step_secs / f64::from(run.substeps());
    let height = |run: &Simulation| match run.world().boundaries[1] {
        Boundary::HalfSpace { point, .. } => point.y,
        _ => panic!("it stays one"),
    };
    for step in 0..1500 {
        let (before, from) = (drive(&run).clone(), height(&run));
        take_steps(&mut run, 1);
        let now = drive(&run);
        // Each substep moves the wall with its final speed, but the work uses the mean speed.
        let way = from - height(&run) - 0.5 * substep * (now.speed - before.speed);
        let change = now.kinetic_energy() - before.kinetic_energy();
        let found = 10.0 * way - run.observables().wall_work;
        assert!((change - found).abs() < 1e-12, "step {step}: {change} {found} J");
    }
    assert_close(carried(&run, 1), 10.0, 1e-6, "the force");
    assert!(drive(&run).speed.abs() < 1e-7, "{:?}", drive(&run));
}

#[test]
fn a_wall_on_springs_that_is_lighter_than_its_grains_may_swing_up() {
    // The wall (mass M) is on five springs of stiffness k = 2e4 N/m. It is stable if the substep is below 2 √(M/5k).
    let fastest = |part: f64| {
        let mut scene = on_springs(0.01);
        scene.parameters.damping_ratio = 1e-9;
        let substep = scene.parameters.time_step_secs / f64::from(start(&scene).substeps());
        let mass = 5.0 * 2e4 * (0.5 * substep / part).powi(2);
        scene.motions[0].drive.as_mut().expect("a drive").mass = mass;
        let mut run = start(&scene);
        let mut fastest = 0f64;
        for _ in 0..100 {
            let _ = run.step();
            fastest = fastest.max(drive(&run).speed.abs());
        }
        (fastest, mass)
    };
    let ((calm, heavy), (wild, light)) = (fastest(0.3), fastest(3.0));
    // The wall starts in contact, so if it is stable its speed is that of an oscillation under its load.
    assert!(calm < 10.0 / (5.0 * 2e4 * heavy).sqrt() * 10.0, "{calm} m/s of {heavy} kg");
    assert!(wild > 10.0 * calm * (heavy / light).sqrt(), "{wild} m/s of {light} kg, {calm} m/s");
}

/// Force that drives each wall, N.
const FORCE: f64 = 0.03;

/// Returns a scene of 36 separate discs of different sizes between a floor and three walls driven by [`FORCE`].
fn pressed_together(seed: u64) -> Scene {
    let mut random = random(seed);
    let grain = |k: i32| {
        let place = 0.025 * DVec2::new(f64::from(k % 6), f64::from(k / 6));
        Grain::at_rest(place, random.random_range(0.008..0.012))
    };
    let grains = (0..36).map(grain).collect();
    let mut scene = without_g(parameters(0.0, 1e-3, 0.0, 0.3), grains);
    let wall =
        |x: f64, y: f64, normal: DVec2| Boundary::HalfSpace { point: DVec2::new(x, y), normal };
    scene.boundaries = vec![
        wall(0.0, -0.013, DVec2::Y),
        wall(-0.013, 0.0, DVec2::X),
        wall(0.138, 0.0, DVec2::NEG_X),
        wall(0.0, 0.138, DVec2::NEG_Y),
    ];
    let walls = [(1, DVec2::X), (2, DVec2::NEG_X), (3, DVec2::NEG_Y)];
    scene.motions =
        walls.map(|(wall, direction)| driven(&[wall], by_force(direction, FORCE, 0.01))).into();
    (scene.solver.method, scene.solver.tolerance) = (Method::Nsgs, 1e-12);
    scene.solver.max_sweeps = 20_000;
    scene
}

#[test]
fn walls_that_press_a_packing_at_rest_carry_each_its_force() {
    for seed in [1, 2] {
        let run = after(&pressed_together(seed), 2500);
        // Grains that carry nothing may float. If the walls are at rest, the grains that carry the walls rest, too.
        for motion in &run.world().motions {
            let speed = motion.drive.as_ref().expect("a drive").speed;
            assert!(speed.abs() < 1e-9, "{speed} m/s, seed {seed}: {:?}", run.observables());
        }
        // Each wall carries its force. The floor may carry less, because friction at the side walls carries the rest.
        for wall in 1..4 {
            assert_close(carried(&run, wall), FORCE, 1e-8, &format!("wall {wall}, seed {seed}"));
        }
    }
}

fn stress_ratio(run: &Simulation) -> f64 {
    let pile = slump::granular::measure(&run.moment()).pile;
    pile.stress_yy / pile.stress_xx
}

#[test]
fn the_shipped_test_compresses_and_bears_more_along_than_across() {
    let mut run = start(&built_in("biaxial").expect("a scene"));
    let mut ratios = Vec::new();
    while run.time_secs() < 1.2 {
        take_steps(&mut run, 20);
        if run.time_secs() > 0.6 {
            ratios.push(stress_ratio(&run));
        }
    }
    // A single ratio is wrong by up to a fifth, the mean of forty ratios by some hundredths.
    let mean = ratios.iter().sum::<f64>() / ratios.len() as f64;
    assert!(ratios.len() > 40 && (1.4..2.6).contains(&mean), "{mean} of {}", ratios.len());
    assert_eq!(run.observables().lost_grains, 0);
}
