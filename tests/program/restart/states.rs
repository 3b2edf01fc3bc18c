//! Tests of states that are saved and read in memory, for all scenes, steppers, methods and remedies (optional
//! corrections of a step).

use rayon::prelude::*;
use slump::setting::{Group, Kind, Value};

use super::{bytes_of, read_back};
use crate::common::*;

/// Number of steps before a state is saved. The same number of steps is then compared between the original and the copy
/// that was read.
const STEPS: usize = 4;

/// Takes a step in each of two runs and checks that the runs are equal after it, even if the state is then no longer
/// finite.
#[track_caller]
fn step_both(scene: &Scene, one: &mut Simulation, other: &mut Simulation, what: &str) {
    let ends = [&mut *one, other].map(|simulation| format!("{:?}", simulation.step().err()));
    assert_eq!(ends[0], ends[1], "{what}");
    let shown = [&*one, other].map(|simulation| format!("{:?}", simulation.observables()));
    assert_eq!(shown[0], shown[1], "{what}");
    let step = one.observables().step;
    assert!(
        bytes_of(scene, one) == bytes_of(scene, other),
        "{what}: another state after step {step}"
    );
}

/// Saves a run, reads it back, applies `change` to the original and to the copy, and compares `steps` further steps of
/// the two.
#[track_caller]
fn goes_on_with(
    scene: &Scene,
    simulation: &Simulation,
    steps: usize,
    what: &str,
    change: impl Fn(&mut Simulation),
) -> Simulation {
    let saved = bytes_of(scene, simulation);
    let mut state = read_back(&saved);
    assert!(state.to_bytes().expect("bytes") == saved, "{what}: saved again it is another file");
    assert_eq!(
        format!("{:?}", state.simulation.snapshot()),
        format!("{:?}", simulation.snapshot())
    );
    let mut original = simulation.clone();
    change(&mut original);
    change(&mut state.simulation);
    for _ in 0..steps {
        step_both(scene, &mut original, &mut state.simulation, what);
    }
    original
}

#[track_caller]
fn goes_on(scene: &Scene, simulation: &Simulation, steps: usize, what: &str) -> Simulation {
    goes_on_with(scene, simulation, steps, what, |_| {})
}

/// Returns settings with one remedy (an optional correction of the simulation, such as `push_out`) switched on.
fn with(remedy: &Remedy) -> Remedies {
    let mut remedies = Remedies::default();
    let about = Remedies::ABOUT.iter().find(|about| about.name == remedy.name).expect("a setting");
    let value = match about.kind {
        Kind::Number => Value::Number(0.1),
        _ => Value::Switch(true),
    };
    assert!(remedies.set(remedy.name, value), "{}", remedy.name);
    remedies
}

/// Returns settings with every combination of stepper and method, with every friction model, and with every remedy
/// (optional correction of a step).
fn ways(scene: &Scene) -> Vec<Settings> {
    let mut base = scene.settings();
    base.solver.max_sweeps = base.solver.max_sweeps.min(40);
    let mut ways: Vec<Settings> = every_way()
        .into_iter()
        .map(|(stepper, method)| {
            let mut way = Settings { stepper, ..base };
            way.solver.method = method;
            way.with_only_what_is_taken()
        })
        .collect();
    for &friction_model in FrictionModel::ALL {
        let mut way = Settings { stepper: Stepper::Moreau, ..base };
        let model_solves = if friction_model == FrictionModel::Tresca { 2 } else { 1 };
        way.solver =
            SolverSettings { method: Method::Nsgs, friction_model, model_solves, ..way.solver };
        ways.push(way.with_only_what_is_taken());
    }
    let mut rolling = Settings { stepper: Stepper::Moreau, ..base };
    rolling.solver.method = Method::Nsgs;
    rolling.parameters.rolling_friction = 0.2;
    ways.push(rolling.with_only_what_is_taken());
    for remedy in &REMEDIES {
        let of = |&stepper: &Stepper| Settings { stepper, remedies: with(remedy), ..base };
        ways.extend(remedy.taken_by.iter().map(of));
    }
    ways
}

#[test]
fn every_scene_goes_on_in_every_way_from_its_start_and_from_any_step() {
    let runs: Vec<(Scene, Settings)> = SCENES
        .iter()
        .map(|info| built_in(info.name).expect("a scene"))
        .flat_map(|scene| ways(&scene).into_iter().map(move |way| (scene.clone(), way)))
        .collect();
    assert!(runs.len() > 400, "{} runs", runs.len());
    runs.into_par_iter().for_each(|(mut scene, way)| {
        scene.set_settings(way);
        let what = format!("{}: {way:?}", scene.name);
        // A scene that lacks something that the stepper needs is refused before the first step.
        let Ok(simulation) = scene.simulation() else { return };
        goes_on(&scene, &goes_on(&scene, &simulation, STEPS, &what), STEPS, &what);
    });
}

#[test]
fn what_a_way_to_step_remembers_is_lost_or_kept_as_without_the_file() {
    let scene = pressed_pile(40, 0.3, 5, parameters(20.0, 1e-3, 0.3, 0.5));
    for (from, _) in every_way() {
        let mut simulation = start(&Scene { stepper: from, ..scene.clone() });
        simulation.take_steps(6).expect("finite states");
        for (&to, method) in pairs(Stepper::ALL, [Method::Newton, Method::NsgsParallel]) {
            goes_on_with(&scene, &simulation, STEPS, &format!("{from} to {to}"), |simulation| {
                let mut settings = Settings { stepper: to, ..*simulation.settings() };
                settings.parameters.bond = 50.0;
                settings.parameters.time_step_secs = 7e-4;
                settings.solver.method = method;
                simulation.change(settings).expect("sound settings");
            });
        }
    }
}

#[test]
fn a_pile_that_collapses_goes_on_for_long() {
    let mut scene = built_in("pile").expect("a scene");
    for (stepper, bond, dt) in [
        (Stepper::Moreau, 20.0, 2e-3),
        (Stepper::Range, 20.0, 2e-3),
        (Stepper::Avbd, 20.0, 2e-3),
        (Stepper::Dem, 0.0, 1e-3),
    ] {
        scene.stepper = stepper;
        scene.parameters = parameters(bond, dt, 0.1, 0.5);
        scene.solver.tolerance = 1e-3;
        let mut simulation = start(&scene);
        simulation.take_steps(57).expect("finite states");
        let end = goes_on(&scene, &simulation, 60, stepper.name());
        assert!(end.observables().slump > 0.01, "{stepper}: {:?}", end.observables());
    }
}

#[test]
fn body_forces_go_on() {
    let scene = built_in("pile").expect("a scene");
    for &stepper in Stepper::ALL {
        let mut simulation = start(&Scene { stepper, ..scene.clone() });
        let masses = simulation.world().grains.masses.clone();
        let forces: Vec<DVec2> = masses.iter().map(|mass| DVec2::new(20.0 * mass, 0.0)).collect();
        simulation.set_body_forces(&forces).expect("sound forces");
        simulation.take_steps(5).expect("finite states");
        let end = goes_on(&scene, &simulation, 10, stepper.name());
        assert_eq!(end.body_forces(), forces, "{stepper}");
    }
}

#[test]
fn a_spring_that_pulls_and_walls_that_move_go_on() {
    let scene = built_in("moving-walls").expect("a scene");
    let mut simulation = start(&scene);
    let surroundings = simulation.snapshot().surroundings;
    simulation.set_pull(Some(Pull { grain: 3, target: DVec2::new(0.1, 0.2) }));
    simulation.take_steps(20).expect("finite states");
    assert_ne!(*simulation.snapshot().surroundings, *surroundings, "the walls have moved");
    let pulled = simulation.observables().gravity_work;
    assert!(pulled != 0.0, "the spring works");
    assert_eq!(goes_on(&scene, &simulation, 20, "pulled").pull(), simulation.pull());
}

/// Returns a scene of a pile on a shaken base, next to a plate that swings, a wall that follows a table of positions
/// over time, a belt, and a wall that is about to reach the end of its motion.
fn among_motions() -> Scene {
    let mut scene = pressed_pile(40, 0.3, 5, parameters(5.0, 1e-3, 0.3, 0.5));
    let at = DVec2::new;
    scene.boundaries = vec![
        Boundary::Segment { from: at(-0.021, 0.0), to: at(-0.023, 0.04) },
        Boundary::HalfSpace { point: at(0.02, 0.0), normal: at(-1.0, 0.1) },
        Boundary::ConvexPolygon { points: vec![at(0.0, 0.04), at(0.01, 0.05), at(-0.01, 0.05)] },
        Boundary::HalfSpace { point: at(0.0, -0.004), normal: at(0.0, 1.0) },
    ];
    let discs = 0..scene.fixed_discs.len();
    let amplitude = at(5e-4, 3e-4);
    let shaken = MotionCourse::Sine { amplitude, frequency_hz: 30.0, phase: 0.2 };
    let pivot = at(-0.021, 0.0);
    let swing = MotionCourse::Swing { pivot, amplitude: 0.2, frequency_hz: 10.0, phase: 0.0 };
    let table = MotionCourse::Table {
        times_secs: vec![0.01, 0.02, 0.05],
        offsets: vec![at(0.0, 0.0), at(-1e-3, 0.0), at(0.0, 1e-3)],
    };
    let turning = MotionCourse::Rotation { pivot: at(0.0, 0.045), rate: 20.0, travel: Some(0.5) };
    let moved = |boundary: usize, course: MotionCourse| Motion {
        boundaries: vec![boundary],
        course: Some(course),
        ..Motion::default()
    };
    scene.motions = vec![
        Motion { fixed_discs: discs.collect(), course: Some(shaken), ..Motion::default() },
        moved(0, swing),
        moved(1, table),
        moved(2, turning),
        Motion { boundaries: vec![3], surface_speed: 0.3, ..Motion::default() },
    ];
    let course = TurnCourse::Rate { rate: 2.0 };
    scene.gravity_turn = Some(GravityTurn { course, elapsed_secs: 0.0 });
    scene.solver.max_sweeps = 60;
    scene
}

#[test]
fn bodies_on_their_way_go_on() {
    for (stepper, method) in every_way() {
        let mut scene = Scene { stepper, ..among_motions() };
        scene.solver.method = method;
        let mut simulation = start(&scene);
        simulation.take_steps(17).expect("finite states");
        let what = format!("{stepper}, {method}");
        assert_ne!(simulation.world().boundaries, scene.boundaries, "{what}: they have moved");
        let end = goes_on(&scene, &simulation, 20, &what);
        let worlds = [simulation.world(), end.world()];
        assert_ne!(worlds[0].fixed_discs, worlds[1].fixed_discs, "{what}: and go on moving");
        // The file contains the remaining path of each wall, and an initial state made from the file moves the walls
        // along the whole remaining path.
        let mut anew = start(&read_back(&bytes_of(&scene, &simulation)).as_start());
        let begin = anew.world().boundaries.clone();
        anew.take_steps(20).expect("finite states");
        assert_eq!(begin, simulation.world().boundaries, "{what}");
        // Under `range` a new run divides its steps differently, and so the walls move slightly differently.
        if stepper != Stepper::Range {
            assert_eq!(anew.world().boundaries, end.world().boundaries, "{what}");
            assert_eq!(anew.world().gravity, end.world().gravity, "{what}");
        }
    }
}

#[test]
fn lost_grains_alarms_and_steps_in_a_row_at_the_limit_are_remembered() {
    let mut scene = built_in("thin-wall").expect("a scene");
    scene.parameters.time_step_secs = 5e-2;
    let mut simulation = start(&scene);
    while simulation.observables().lost_grains == 0 && simulation.observables().step < 200 {
        simulation.take_steps(1).expect("a finite state");
    }
    assert_eq!(simulation.alarms().first().map(|alarm| alarm.kind), Some(AlarmKind::GrainLost));
    let end = goes_on(&scene, &simulation, STEPS, "lost");
    assert_eq!(end.alarms(), simulation.alarms());

    let mut scene = pressed_pile(30, 0.5, 3, parameters(50.0, 1e-3, 0.9, 0.5));
    scene.solver.max_sweeps = 2;
    let mut simulation = start(&scene);
    simulation.take_steps(60).expect("finite states");
    let unfinished = |simulation: &Simulation| {
        simulation.alarms().iter().any(|alarm| alarm.kind == AlarmKind::SweepLimit)
    };
    assert!(!unfinished(&simulation), "a hundred steps in a row are not there yet");
    let end = goes_on(&scene, &simulation, 60, "unfinished");
    assert!(unfinished(&end), "{:?}", end.alarms());
}

#[test]
fn a_state_that_is_no_longer_finite_is_what_it_was() {
    let mut scene = pressed_pile(4, 0.5, 3, parameters(0.0, 1e-3, 0.3, 0.5));
    scene.grains[1].velocity.x = f64::MAX;
    let mut simulation = start(&scene);
    while simulation.step().is_ok() {}
    let kinds = simulation.alarms().iter().map(|alarm| alarm.kind);
    assert!(kinds.clone().any(|kind| kind == AlarmKind::NotFinite), "{:?}", simulation.alarms());
    let shown = format!("{:?}{:?}", simulation.world().grains, simulation.observables());
    assert!(shown.contains("inf") || shown.contains("NaN"), "{shown}");
    goes_on(&scene, &simulation, 1, "not finite");
}

#[test]
fn pictures_come_at_the_steps_that_they_would_have_come_at() {
    let scene = pressed_pile(4, 0.1, 3, parameters(0.0, 1e-3, 0.3, 0.5));
    let mut simulation = start(&scene);
    assert_eq!(simulation.step_at(0.0105), 11);
    simulation.take_steps(10).expect("finite states");
    let mut settings = *simulation.settings();
    settings.parameters.time_step_secs = 4e-3;
    simulation.change(settings).expect("sound settings");
    assert_eq!([0.0, 0.010, 0.018, 0.022].map(|secs| simulation.step_at(secs)), [10, 10, 12, 13]);
    simulation.take_steps(1).expect("a finite state");
    let read = read_back(&bytes_of(&scene, &simulation)).simulation;
    assert_eq!(read.step_at(0.0225), simulation.step_at(0.0225));
}

#[test]
fn materials_and_masses_go_on_and_a_new_start_has_them() {
    let mut scene = pressed_pile(30, 0.3, 5, parameters(20.0, 1e-3, 0.3, 0.5));
    scene.grains.iter_mut().step_by(3).for_each(|grain| grain.material = Some("other".into()));
    scene.grains[1].mass = Some(1e-3);
    let named = |name: &str| Material { name: name.into(), ..Material::default() };
    let other = Material { areal_density: Some(4.0), fixed_discs: vec![0, 1], ..named("other") };
    scene.materials = vec![named("one"), other];
    scene.pairs = vec![MaterialPair {
        between: ["one", "other"].map(str::to_owned),
        friction: Some(0.1),
        cohesion_force: Some(1e-3),
        ..MaterialPair::default()
    }];
    let mut simulation = start(&scene);
    simulation.take_steps(10).expect("finite states");
    goes_on(&scene, &simulation, 10, "materials");
    let anew = read_back(&bytes_of(&scene, &simulation)).as_start();
    let is_given = |grain: &Grain| grain.mass.is_some();
    assert_eq!(anew.grains.iter().position(is_given), Some(1));
    assert_eq!(anew.grains.iter().filter(|grain| is_given(grain)).count(), 1);
    let [now, begin] = [&simulation, &start(&anew)].map(|run| run.world().grains.clone());
    assert_eq!((now.masses, now.materials), (begin.masses, begin.materials));
}
