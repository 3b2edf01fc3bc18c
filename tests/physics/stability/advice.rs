//! Tests of warnings under every stepper: Slump raises them in scenes with the problem that they name, and their advice
//! helps: after the recommended change, the scene no longer raises the warning.

use slump::scene::stability::{column, mass_ratio, overlapped, squeeze};

use crate::common::*;

/// Runs `steps` steps, or fewer if a step fails. Returns the warnings that Slump has raised.
fn raised(scene: &Scene, steps: usize) -> Vec<Alarm> {
    let mut run = start(scene);
    for _ in 0..steps {
        if run.step().is_err() {
            break;
        }
    }
    run.alarms().to_vec()
}

fn kinds(scene: &Scene, steps: usize) -> Vec<AlarmKind> {
    raised(scene, steps).iter().map(|alarm| alarm.kind).collect()
}

/// Runs a scene and checks that Slump raises a warning of this kind. Returns the warning and its message.
#[track_caller]
fn alarm_of(kind: AlarmKind, scene: &Scene, steps: usize) -> (Alarm, String) {
    let alarms = raised(scene, steps);
    let alarm = alarms.iter().find(|alarm| alarm.kind == kind);
    let alarm = *alarm.unwrap_or_else(|| panic!("{kind} is not in {alarms:?}"));
    (alarm, alarm.message(&scene.settings()))
}

fn under(stepper: Stepper, mut scene: Scene) -> Scene {
    scene.stepper = stepper;
    scene.solver = SolverSettings::default();
    scene
}

fn at(x: f64, y: f64) -> DVec2 {
    DVec2::new(x, y)
}

const RADIUS: f64 = 0.05;

#[test]
fn overlap_that_grains_were_placed_with_is_no_matter_of_the_time_step() {
    for &stepper in Stepper::ALL {
        let scene = under(stepper, overlapped(0.3));
        let (alarm, words) = alarm_of(AlarmKind::PlacedInOverlap, &scene, 100);
        assert_eq!((alarm.step, alarm.time_secs), (0, 0.0), "{stepper}");
        assert!(!words.contains("time step"), "{stepper}: {words}");
        assert!(!kinds(&scene, 100).contains(&AlarmKind::Overlap), "{stepper}");

        let mut moved = under(Stepper::Moreau, scene.clone());
        moved.remedies.push_out = true;
        assert_eq!(kinds(&moved, 100), [], "{stepper}: pushed out");
        if alarm.advice == Advice::PushOut {
            assert_eq!(stepper, Stepper::Moreau);
            continue;
        }
        assert_eq!(alarm.advice, Advice::PlaceApart, "{stepper}");
        let run = after(&moved, 100);
        let mut apart = scene;
        for (grain, &place) in apart.grains.iter_mut().zip(&run.world().grains.positions) {
            grain.position = place;
        }
        assert_eq!(kinds(&apart, 100), [], "{stepper}: placed apart");
    }
    // The warning is the same if grains are placed in overlap during the run.
    let mut run = start(&under(Stepper::Moreau, overlapped(0.0)));
    take_steps(&mut run, 3);
    let diameter = run.world().mean_diameter;
    let mut places = run.world().grains.positions.clone();
    places[1].y -= 0.3 * diameter;
    run.set_positions(&places).expect("places");
    take_steps(&mut run, 3);
    let placed: Vec<_> = run.alarms().iter().map(|alarm| (alarm.kind, alarm.step)).collect();
    assert_eq!(placed, [(AlarmKind::PlacedInOverlap, 3)]);
}

#[test]
fn a_contact_that_is_found_late_is_no_alarm_and_a_step_that_is_too_long_is() {
    let pile = |bond: f64, time_step_secs: f64| {
        let mut scene = paper_pile().expect("the shipped state");
        scene.solver = SolverSettings::default();
        scene.parameters.time_step_secs = time_step_secs;
        scene.parameters.bond = bond;
        scene
    };
    for (bond, time_step_secs) in
        [(0.0, 1e-3), (20.0, 1e-3), (0.0, 5e-3), (20.0, 5e-3), (100.0, 5e-3)]
    {
        let mut run = start(&pile(bond, time_step_secs));
        let mut deepest = 0f64;
        for _ in 0..(0.15 / time_step_secs) as usize {
            deepest = run.step().expect("a finite state").max_overlap.max(deepest);
        }
        assert!(deepest > 0.05, "Bond {bond}, {time_step_secs} s: {deepest}");
        assert_eq!(run.alarms(), [], "Bond {bond}, {time_step_secs} s");
    }
    assert_eq!(kinds(&pile(20.0, 2e-2), 20)[0], AlarmKind::Overlap);
}

#[test]
fn a_fast_grain_excuses_no_overlap_of_others() {
    let mut scene = mass_ratio(1000.0);
    scene.solver = SolverSettings::to_residual(Method::Nsgs, 1e-6, 10);
    assert!(kinds(&scene, 100).contains(&AlarmKind::Overlap), "the situation");
    let light = scene.grains[0].clone();
    let far = light.position + 1e4 * light.radius * DVec2::Y;
    scene.grains.push(moving(far, light.radius, 4e3 * light.radius * DVec2::Y));
    let run = after(&scene, 100);
    let travel = run.world().grains.velocities[2].length() * scene.parameters.time_step_secs;
    assert!(travel > 1.5 * light.radius, "the situation: {travel}");
    assert!(kinds(&scene, 100).contains(&AlarmKind::Overlap));
}

#[test]
fn a_grain_that_was_placed_in_a_wall_has_not_gone_through_it() {
    let mut scene = column(1);
    let diameter = scene.mean_diameter;
    scene.grains[0].position.y = -1.5 * diameter;
    for &stepper in Stepper::ALL {
        let mut scene = under(stepper, scene.clone());
        assert_eq!(kinds(&scene, 3), [AlarmKind::PlacedInOverlap], "{stepper}");
        scene.grains[0].position.y = 0.5 * diameter;
        assert_eq!(kinds(&scene, 3), [], "{stepper}");
    }
}

/// Returns a scene of a disc that falls on a floor.
fn falling() -> Scene {
    let grains = vec![moving(at(0.0, 0.1), RADIUS, at(0.0, -3.0))];
    let parameters = parameters(0.0, 1e-4, 0.5, 0.5);
    Scene { boundaries: vec![plane(at(0.0, 0.0), at(0.0, 1.0))], ..under_g(parameters, grains) }
}

#[test]
fn springs_that_give_way_ask_for_stiffness_and_not_for_a_smaller_time_step() {
    let scene = under(Stepper::Dem, falling());
    let (alarm, words) = alarm_of(AlarmKind::Overlap, &scene, 1000);
    assert_eq!(alarm.advice, Advice::Stiffness);
    let stiffness = alarm.stiffness.expect("the springs in force");
    assert!(words.contains("stiffness above") && !words.contains("time step"), "{words}");
    let mut slower = scene.clone();
    slower.parameters.time_step_secs = 1e-5;
    assert!(kinds(&slower, 10_000).contains(&AlarmKind::Overlap), "that would be of no use");
    let mut stiffer = scene.clone();
    stiffer.parameters.stiffness = 1e4 * stiffness;
    assert_eq!(kinds(&stiffer, 1000), []);

    // A fast grain passes through a wall because the springs are too soft.
    let mut wall = under(Stepper::Dem, through_a_wall(1e-4, 100.0));
    wall.parameters.restitution = 1.0;
    let (alarm, _) = alarm_of(AlarmKind::GrainLost, &wall, 60);
    assert_eq!(alarm.advice, Advice::Stiffness);
    wall.parameters.stiffness = 1e6 * alarm.stiffness.expect("the springs in force");
    assert_eq!(kinds(&wall, 60), []);

    // The springs are unstable with this few substeps.
    let mut coarse = under(Stepper::Dem, squeeze(1e-2));
    (coarse.parameters.substeps, coarse.parameters.time_step_secs) = (1, 0.02);
    for kind in [AlarmKind::GrainLost, AlarmKind::Overlap, AlarmKind::NotFinite] {
        let (alarm, words) = alarm_of(kind, &coarse, 100);
        assert_eq!(alarm.advice, Advice::StableSubsteps, "{words}");
    }
    coarse.parameters.substeps = 0;
    assert_eq!(kinds(&coarse, 100), []);
}

/// Returns a scene of a disc that flies at a thin wall with this speed, m/s.
fn through_a_wall(time_step_secs: f64, speed: f64) -> Scene {
    let grains = vec![moving(at(-0.3, 0.0), RADIUS, at(speed, 0.0))];
    let wall = Boundary::Segment { from: at(0.0, -1.0), to: at(0.0, 1.0) };
    let parameters = parameters(0.0, time_step_secs, 0.0, 0.5);
    Scene { boundaries: vec![wall], ..without_g(parameters, grains) }
}

#[test]
fn a_wall_that_a_step_jumps_asks_for_a_smaller_time_step() {
    for &stepper in Stepper::ALL.iter().filter(|&&stepper| stepper != Stepper::Dem) {
        // The disc moves a hundred diameters per step.
        let scene = under(stepper, through_a_wall(1e-2, 1000.0));
        let (alarm, words) = alarm_of(AlarmKind::GrainLost, &scene, 3);
        assert!(words.contains("gone through a wall") && words.contains("below 0.01 s"), "{words}");
        assert_eq!(alarm.advice, Advice::TimeStep);
        let slower = under(stepper, through_a_wall(1e-6, 1000.0));
        assert_eq!(kinds(&slower, 1000), [], "{stepper}");
        // The first step ends with the disc about a fifth of its diameter inside the wall.
        let scene = under(stepper, through_a_wall(1e-2, 27.0));
        if let Some(alarm) = raised(&scene, 3).first() {
            assert_eq!(alarm.advice, Advice::TimeStep, "{stepper}: {alarm:?}");
        }
        assert_eq!(kinds(&under(stepper, through_a_wall(1e-5, 27.0)), 2000), [], "{stepper}");
    }
}

#[test]
fn grains_that_leave_an_open_hopper_have_not_gone_through_a_wall() {
    let side = |x: f64| Boundary::Segment { from: at(x, 0.6), to: at(0.3 * x, 0.0) };
    let grains = [-0.1, 0.0, 0.1].map(|x| Grain::at_rest(at(x, 0.5), 0.04)).to_vec();
    let parameters = parameters(0.0, 1e-3, 0.1, 0.2);
    let hopper = Scene { boundaries: vec![side(0.5), side(-0.5)], ..under_g(parameters, grains) };
    for &stepper in Stepper::ALL {
        let scene = under(stepper, hopper.clone());
        let mut run = start(&scene);
        while run.observables().lost_grains < 3 && run.time_secs() < 3.0 {
            let lost = run.observables().lost_grains;
            assert_eq!(run.observables().slump.is_nan(), lost == 3);
            take_steps(&mut run, 1);
        }
        assert_eq!(run.observables().lost_grains, 3, "{stepper}: all are out");
        assert!(run.observables().slump.is_nan(), "{stepper}: of no grain there is no mean height");
        let alarm = *run.alarms().first().expect("an alarm");
        assert_eq!((alarm.kind, alarm.advice), (AlarmKind::GrainLeft, Advice::Enclose));
        let gone_through = run.alarms().iter().any(|alarm| alarm.kind == AlarmKind::GrainLost);
        assert!(!gone_through, "{stepper}");
        let mut enclosed = scene;
        enclosed.boundaries.push(plane(at(0.0, -0.3), at(0.0, 1.0)));
        let has_left = kinds(&enclosed, 1500).contains(&AlarmKind::GrainLeft);
        assert!(!has_left, "{stepper}: with a floor");
    }
}

#[test]
fn a_grain_that_jumps_over_fixed_discs_asks_for_a_smaller_time_step() {
    // The disc is 0.02 m above a row of fixed discs after three steps, and 0.02 m below the row after four steps.
    let fall = |x: f64, dt: f64| {
        let grains = vec![Grain::at_rest(at(x, 0.5), 0.05)];
        let row = (-5..=5).map(|k| fixed(at(0.1 * f64::from(k), 0.0), 0.05));
        let parameters = parameters(0.0, dt, 0.0, 0.5);
        start(&Scene { fixed_discs: row.collect(), ..under_g(parameters, grains) })
    };
    let mut run = fall(0.05, 0.08);
    take_steps(&mut run, 15);
    let alarm = run.alarms().iter().find(|alarm| alarm.kind == AlarmKind::GrainLeft);
    let alarm = alarm.expect("the grain goes through the row");
    assert_eq!(alarm.advice, Advice::TimeStep);
    let longest = alarm.longest_time_step_secs.expect("a time step");
    assert!((0.01..0.04).contains(&longest), "{longest} s");
    let mut run = fall(0.05, 0.5 * longest);
    take_steps(&mut run, 200);
    assert!(run.alarms().iter().all(|alarm| alarm.kind != AlarmKind::GrainLeft));
    // Next to the row, no time step can stop the disc.
    let mut run = fall(0.7, 0.08);
    take_steps(&mut run, 15);
    let alarm = run.alarms().iter().find(|alarm| alarm.kind == AlarmKind::GrainLeft);
    assert_eq!(alarm.expect("it falls past the row").advice, Advice::Enclose);
}

#[test]
fn a_small_grain_is_as_deep_as_its_own_size_says() {
    // The centre of the small disc sinks 3.3 of its radii below the floor. Compared with the large disc this is little:
    // about 0.03 of its diameter.
    let parameters = parameters(0.0, 0.02, 0.0, 0.5);
    let small = Grain::at_rest(at(2.0, 0.5), 0.01);
    let grains = vec![Grain::at_rest(at(0.0, 0.5), 0.5), small];
    let floor = vec![plane(at(0.0, 0.0), at(0.0, 1.0))];
    let mut scene = Scene { boundaries: floor, ..under_g(parameters, grains) };
    let run = after(&scene, 50);
    assert!(run.place(1).y < -0.02, "the situation: {}", run.place(1));
    assert!(run.observables().max_overlap < 0.05, "of the large one's diameter");
    let kinds_of_run: Vec<_> = run.alarms().iter().map(|alarm| alarm.kind).collect();
    assert_eq!(kinds_of_run, [AlarmKind::GrainLost, AlarmKind::Overlap]);
    assert_eq!(run.observables().lost_grains, 1);
    scene.parameters.time_step_secs = 1e-4;
    assert_eq!(kinds(&scene, 10_000), []);
    // The small disc falls by half of its diameter in a step. An overlap of a quarter of its diameter then only means
    // that the contact was detected late.
    scene.parameters.time_step_secs = 1e-2;
    scene.grains[1].velocity = at(0.0, -1.0);
    scene.grains[1].position.y = 0.0149;
    let run = after(&scene, 1);
    assert!((0.003..0.006).contains(&run.place(1).y), "the situation: {}", run.place(1));
    assert_eq!(kinds(&scene, 3), []);
}

#[test]
fn unsolved_steps_are_told_what_solves_them() {
    const STEPS: usize = 115;
    let limit = |scene: &Scene| {
        let (alarm, words) = alarm_of(AlarmKind::SweepLimit, scene, STEPS);
        println!("{words}");
        alarm.advice
    };
    let solved = |scene: &Scene, what: &str| {
        assert!(!kinds(scene, STEPS).contains(&AlarmKind::SweepLimit), "{what}");
    };
    let mut few = mass_ratio(1e3);
    few.solver = SolverSettings { max_sweeps: 2, tolerance: 1e-9, ..SolverSettings::default() };
    assert_eq!(limit(&few), Advice::Sweeps);
    few.solver.max_sweeps = 5000;
    solved(&few, "more sweeps");

    let mut heavy = mass_ratio(1e3);
    let from_zero = SolverSettings { warm_start: false, ..solved_by(Method::Nsgs, 1e-9) };
    heavy.solver = SolverSettings { max_sweeps: 5000, ..from_zero };
    assert_eq!(limit(&heavy), Advice::Newton);
    heavy.solver.method = Method::Newton;
    solved(&heavy, "newton");

    let mut strict = paper_pile().expect("the shipped state");
    strict.parameters.restitution_threshold = 0.0;
    let stop = StopTest::Residual;
    strict.solver = SolverSettings { stop, tolerance: 1e-18, ..SolverSettings::default() };
    assert_eq!(limit(&strict), Advice::Tolerance);
    strict.solver.tolerance = 1e-6;
    solved(&strict, "a larger tolerance");

    let mut bouncing = wedged();
    bouncing.physics = UNTURNING;
    bouncing.grains[0].velocity = at(0.0, -1.0);
    (bouncing.parameters.restitution, bouncing.parameters.friction) = (0.9, 2.0);
    bouncing.parameters.restitution_threshold = 0.0;
    bouncing.solver = solved_by(Method::Nsgs, 1e-8);
    let (alarm, _) = alarm_of(AlarmKind::SweepLimit, &bouncing, 300);
    assert_eq!(alarm.advice, Advice::RestitutionThreshold);
    bouncing.parameters.restitution_threshold = 2.0;
    assert!(!kinds(&bouncing, 300).contains(&AlarmKind::SweepLimit), "a restitution threshold");

    let mut squeezed = wedged();
    let inwards = |disc: usize, x: f64| Motion {
        fixed_discs: vec![disc],
        course: Some(straight(at(x, 0.0))),
        ..Motion::default()
    };
    squeezed.motions = vec![inwards(0, 0.02), inwards(1, -0.02)];
    squeezed.solver =
        SolverSettings { friction_model: FrictionModel::Coulomb, ..SolverSettings::default() };
    squeezed.solver.method = Method::Newton;
    assert_eq!(limit(&squeezed), Advice::BoundedFriction);
    squeezed.solver.method = Method::Auto;
    squeezed.solver.friction_model = FrictionModel::Tresca;
    solved(&squeezed, "bounded friction");
}

/// Returns a scene of a disc that is wedged between two discs at rest, so that friction prevents it from separating and
/// from sliding.
fn wedged() -> Scene {
    let angle = 75f64.to_radians();
    let touching = 2.0 * RADIUS * (1.0 - 1e-9);
    let beside = |side: f64| fixed(touching * at(side * angle.sin(), -angle.cos()), RADIUS);
    let parameters = parameters(0.0, 1e-3, 0.0, 0.9);
    let fixed_discs = vec![beside(-1.0), beside(1.0)];
    Scene { fixed_discs, ..under_g(parameters, vec![Grain::at_rest(DVec2::ZERO, RADIUS)]) }
}

#[test]
fn a_disc_that_unsolved_steps_let_sink_asks_for_what_solves_them() {
    let mut scene = mass_ratio(1e3);
    scene.solver = SolverSettings { max_sweeps: 10, ..solved_by(Method::Nsgs, 1e-6) };
    let (alarm, _) = alarm_of(AlarmKind::Overlap, &scene, 200);
    assert_eq!(alarm.advice, Advice::Sweeps);
    scene.solver.max_sweeps = 100_000;
    assert_eq!(kinds(&scene, 200), []);
}

#[test]
fn schemes_have_no_tolerance_that_they_could_miss() {
    for stepper in [Stepper::Dem, Stepper::TgsSoft, Stepper::Avbd] {
        // The discs touch at rest, so every impulse is an error, and the residual is infinite.
        let grains =
            vec![Grain::at_rest(at(0.0, 0.0), RADIUS), Grain::at_rest(at(0.0998, 0.0), RADIUS)];
        let mut scene = under(stepper, without_g(parameters(0.0, 1e-3, 0.5, 0.5), grains));
        scene.solver.tolerance = 1e-300;
        let mut run = start(&scene);
        let mut largest = 0f64;
        for _ in 0..20 {
            let step = run.step().expect("a finite state");
            assert!(step.converged, "{stepper}: {step:?}");
            largest = largest.max(step.residual);
        }
        let is_met = stepper != Stepper::Dem || largest == f64::INFINITY;
        assert!(is_met, "{stepper}: the situation, {largest}");
    }
}

#[test]
fn a_bond_number_that_makes_no_cohesion_is_told() {
    let pair = || {
        vec![Grain::at_rest(at(0.0, 0.0), RADIUS), moving(at(0.0999, 0.0), RADIUS, at(1e-3, 0.0))]
    };
    for &stepper in Stepper::ALL {
        let mut scene = under(stepper, without_g(parameters(20.0, 1e-3, 0.0, 0.5), pair()));
        let (alarm, words) = alarm_of(AlarmKind::NoCohesion, &scene, 1);
        assert_eq!(alarm.advice, Advice::BondAcceleration);
        assert!(words.contains("bond-acceleration above 0"), "{words}");
        scene.parameters.bond_acceleration = G;
        assert_eq!(kinds(&scene, 1), [], "{stepper}");
        scene.physics.cohesion = false;
        assert_eq!(alarm_of(AlarmKind::NoCohesion, &scene, 1).0.advice, Advice::Cohesion);
        scene.parameters.bond = 0.0;
        assert_eq!(kinds(&scene, 1), [], "{stepper}");
    }
}

/// Returns a scene of six discs in two rows that fall on a floor at the same time.
fn six_discs() -> Scene {
    let place = |k: u32| at(0.505 * f64::from(k), 3.5 + 0.75f64.sqrt() * f64::from(k % 2));
    let grains = (0..6).map(|k| Grain::at_rest(place(k), 0.5)).collect();
    let parameters = parameters(0.0, 1e-3, 1.0, 0.5);
    Scene { boundaries: vec![plane(at(0.0, 0.0), at(0.0, 1.0))], ..under_g(parameters, grains) }
}

#[test]
fn energy_that_restitution_and_friction_create_is_told() {
    const STEPS: usize = 900;
    let most = |scene: &Scene| {
        let mut run = start(scene);
        let energy = |row: &Observables| row.kinetic_energy + row.potential_energy;
        let before = energy(run.observables());
        let mut most = 1f64;
        for _ in 0..STEPS {
            most = most.max(energy(run.step().expect("a finite state")) / before);
        }
        most
    };
    for (stepper, restitution) in
        [(Stepper::Moreau, 1.0), (Stepper::Moreau, 0.9), (Stepper::TgsSoft, 1.0)]
    {
        let mut scene = under(stepper, six_discs());
        scene.parameters.restitution = restitution;
        let created = most(&scene);
        assert!(created > 1.02, "{stepper}, ρ {restitution}: the situation, {created}");
        let (alarm, words) = alarm_of(AlarmKind::EnergyCreated, &scene, STEPS);
        println!("{stepper}, ρ {restitution}: {created} times the energy; {words}");
        assert_eq!(alarm.advice, Advice::NoRestitution);
        let mut mended = vec![Parameters { restitution: 0.0, ..scene.parameters }];
        if stepper == Stepper::Moreau {
            mended.push(Parameters { friction: 0.0, ..scene.parameters });
        }
        for parameters in mended {
            let mended = Scene { parameters, ..scene.clone() };
            let created = most(&mended);
            assert!(created < 1.0 + 1e-2, "{stepper}: {created}");
            assert!(!kinds(&mended, STEPS).contains(&AlarmKind::EnergyCreated), "{stepper}");
        }
    }
}

#[test]
fn piles_that_fall_and_rest_create_no_energy() {
    let pile = paper_pile().expect("the shipped state");
    for &stepper in Stepper::ALL {
        for bond in [0.0, 50.0] {
            let mut scene = under(stepper, pile.clone());
            scene.parameters.bond = bond;
            let created = kinds(&scene, 300).contains(&AlarmKind::EnergyCreated);
            assert!(!created, "{stepper}, Bond {bond}");
        }
    }
    let mut squeezed = squeeze(1e-2);
    squeezed.parameters.friction = 0.0;
    assert!(!kinds(&squeezed, 100).contains(&AlarmKind::EnergyCreated), "without friction");
}
