//! Tests of the recording that the window keeps of its run: going back and forth in time shows all computed states
//! again, bitwise.

use crate::robot::*;
use slump::live::LiveStart;

fn curve_of(robot: &Robot) -> Vec<Observables> {
    robot.world().curve.rows().copied().collect()
}

#[test]
fn a_run_that_goes_on_from_an_earlier_moment_ends_bitwise_equal() {
    let mut robot = Robot::open(pile());
    for step in 0..90 {
        if step == 30 {
            robot.type_number("Δt, time step", "2");
        }
        if step == 50 {
            robot.type_number("Bond, cohesion", "80");
        }
        robot.state_mut().run.step();
    }
    robot.settle();
    assert_eq!(robot.steps(), 90);
    let uninterrupted = robot.bits();
    let curve = curve_of(&robot);
    // Drags the timeline to a time before both changes, and continues from there.
    let (from, to) = (robot.place("timeline", 0.99, 0.5), robot.place("timeline", 0.1, 0.5));
    robot.drag(from, to);
    robot.button(to, false);
    robot.settle();
    let scrubbed = robot.steps();
    assert!((1..30).contains(&scrubbed), "step {scrubbed}");
    let settings = robot.settings();
    assert_eq!((settings.parameters.bond, settings.parameters.time_step_secs), (20.0, 1e-3));
    assert_eq!(robot.state().run.frame.recorded_secs(), curve[90].time_secs, "nothing is lost yet");
    // Going forward without new steps replays the recording.
    robot.seek(curve[90].time_secs);
    assert_eq!(robot.bits(), uninterrupted);
    let parameters = robot.settings().parameters;
    assert_eq!((parameters.bond, parameters.time_step_secs), (80.0, 2e-3));
    // New steps from step 60 continue the run from there.
    robot.seek(curve[60].time_secs);
    assert_eq!(robot.steps(), 60);
    robot.take_steps(30);
    assert_eq!(robot.bits(), uninterrupted);
    assert_eq!(curve_of(&robot), curve);
}

#[test]
fn a_step_in_the_past_deletes_nothing() {
    let mut robot = Robot::open(pile());
    robot.take_steps(50);
    let (end, until) = (robot.bits(), robot.state().run.frame.recorded_secs());
    robot.seek(0.02);
    assert!(robot.state().run.frame.replaying);
    robot.key(egui::Key::ArrowRight);
    assert_eq!(robot.steps(), 21);
    assert_eq!(robot.state().run.frame.recorded_secs(), until);
    assert_eq!(robot.world().curve.len(), 51);
    robot.take_steps(29);
    assert_eq!(robot.bits(), end);
    assert!(!robot.state().run.frame.replaying && robot.state().run.frame.past.is_empty());
    robot.key(egui::Key::ArrowRight);
    assert_eq!((robot.steps(), robot.world().curve.len()), (51, 52));
}

/// Returns the text in the number field of the time step.
fn typed(robot: &Robot) -> String {
    let field = robot.harness.get_by_role_and_label(egui::Role::TextInput, "Δt, time step");
    field.accesskit_node().value().expect("a text")
}

#[test]
fn a_run_that_goes_on_differently_leaves_the_old_one_to_be_gone_back_to() {
    let mut robot = Robot::open(pile());
    robot.take_steps(50);
    let curve = curve_of(&robot);
    robot.seek(0.02);
    robot.type_number("Δt, time step", "5");
    assert!(robot.state().run.frame.branching);
    robot.key(egui::Key::ArrowRight);
    assert_eq!(robot.steps(), 21);
    assert_eq!(robot.world().curve.len(), 22);
    assert!((robot.state().run.frame.recorded_secs() - 0.025).abs() < 1e-12);
    let past = robot.state().run.frame.past.clone();
    assert_eq!(past.len(), 1);
    let of_past = past[0].worlds[0].controls.settings.parameters.time_step_secs;
    assert_eq!(of_past, 1e-3, "the run before is told of with its own time step");
    assert_eq!(typed(&robot), "5");
    robot.click("Compare");
    assert!(robot.shows("↶ Bond 20, Δt 1 ms, ρ 0.1, μ 0.5, slump 0.0"), "and listed so");

    robot.command_key(egui::Key::Z);
    robot.settle();
    assert_eq!(curve_of(&robot), curve);
    robot.frames(2);
    assert_eq!(typed(&robot), "1", "and so does its slider");
    assert!(robot.shows("↷ Bond 20, Δt 5 ms, ρ 0.1, μ 0.5, slump 0.0"));
    let past = robot.state().run.frame.past.clone();
    assert_eq!(past[0].worlds[0].controls.settings.parameters.time_step_secs, 5e-3);
    // An undone change can be made again any number of times.
    let slump = past[0].worlds[0].curve.rows().last().expect("a row").slump;
    robot.click(&format!("↷ Bond 20, Δt 5 ms, ρ 0.1, μ 0.5, slump {slump:.3}"));
    assert_eq!(robot.world().curve.len(), 22);
}

#[test]
fn a_reset_keeps_the_run_and_undo_and_redo_go_through_all_of_them() {
    let mut robot = Robot::open(pile());
    for round in 1..=6 {
        robot.take_steps(3 * round);
        robot.key(egui::Key::R);
        assert_eq!(robot.steps(), 0);
        assert_eq!(robot.state().run.frame.past.len() as u64, round);
    }
    // A reset without recorded steps does not keep a run.
    robot.key(egui::Key::R);
    let lengths: Vec<usize> =
        robot.state().run.frame.past.iter().map(|run| run.worlds[0].curve.len()).collect();
    assert_eq!(lengths, [4, 7, 10, 13, 16, 19]);
    let go = |robot: &mut Robot, keys: &[(egui::Modifiers, egui::Key)]| {
        let mut steps = Vec::new();
        for &(modifiers, key) in keys {
            robot.harness.key_press_modifiers(modifiers, key);
            robot.harness.step();
            robot.settle();
            steps.push(robot.steps());
        }
        steps
    };
    let command = egui::Modifiers::COMMAND;
    let undo = (command, egui::Key::Z);
    let redo = [(command, egui::Key::Y), (command | egui::Modifiers::SHIFT, egui::Key::Z)];
    assert_eq!(go(&mut robot, &[undo; 7]), [18, 15, 12, 9, 6, 3, 3]);
    assert_eq!(go(&mut robot, &[redo[0], redo[1], redo[0]]), [6, 9, 12]);
    assert_eq!(go(&mut robot, &[undo, redo[1]]), [9, 12]);
    // After a reset, a new run does not replace any of the earlier runs.
    robot.key(egui::Key::R);
    robot.take_steps(1);
    let past = robot.state().run.frame.past.clone();
    assert!(past.len() == 6 && past.iter().all(|run| !run.is_undone));
    assert_eq!(go(&mut robot, &[undo, redo[0]]), [12, 1]);
    robot.load(pile());
    assert!(robot.state().run.frame.past.is_empty(), "they are of another start");
}

#[test]
fn little_memory_is_enough_to_get_anywhere() {
    let scene = pile().scene(|_| true).unwrap();
    let simulation = scene.simulation().unwrap();
    let mut expected = simulation.clone();
    let mut moments = Vec::new();
    for _ in 0..200 {
        expected.step().unwrap();
        moments.push(expected.snapshot().grains);
    }
    let options = LiveOptions { recording_bytes: 300_000, ..LiveOptions::default() };
    let mut live = Live::spawn(options).unwrap();
    live.send(Command::Load(Box::new(LiveStart {
        scene,
        config: Config::of_scene("pile"),
        window: None,
        simulation,
        tally: Tally::default(),
        held_by: Vec::new(),
        view: [DVec2::ZERO, DVec2::ONE],
        slumps: true,
        worlds: Vec::new(),
        history: None,
    })));
    for _ in 0..200 {
        live.send(Command::Step);
    }
    for step in [3usize, 150, 64, 199, 1] {
        let number = live.send(Command::Seek(step as f64 * 1e-3));
        let start = std::time::Instant::now();
        loop {
            let frame = live.latest();
            if frame.acknowledged == number && !frame.seeking {
                assert_eq!(frame.worlds[0].snapshot.grains, moments[step - 1], "step {step}");
                break;
            }
            assert!(start.elapsed().as_secs() < 30, "waited in vain for step {step}");
            std::thread::sleep(std::time::Duration::from_millis(1));
        }
    }
}

#[test]
fn stepping_schemes_and_a_pull_are_played_back_bitwise() {
    let mut robot = Robot::open(pile());
    let settings = robot.settings();
    let pull = Pull { grain: 100, target: DVec2::new(0.0, 0.1) };
    for (stepper, steps) in [(Stepper::Dem, 40), (Stepper::TgsSoft, 20), (Stepper::Dem, 20)] {
        robot.state_mut().run.live.send(Command::Change(0, Settings { stepper, ..settings }));
        robot.state_mut().run.live.send(Command::SetPull(0, Some(pull)));
        for _ in 0..steps {
            robot.state_mut().run.step();
        }
    }
    robot.settle();
    let (uninterrupted, end_secs) = (robot.bits(), robot.state().run.frame.time_secs());
    for time_secs in [0.015, 0.05] {
        robot.seek(time_secs);
        assert_ne!(robot.bits(), uninterrupted);
        robot.seek(end_secs);
        assert_eq!(robot.bits(), uninterrupted, "from {time_secs} s on");
    }
}

#[test]
fn play_shows_stored_moments_and_computes_where_they_end() {
    let mut robot = Robot::open(pile());
    let steps = 60;
    let mut recorded = vec![robot.bits()];
    for step in 1..=steps {
        if step == 30 {
            robot.type_number("Bond, cohesion", "80");
        }
        robot.key(egui::Key::ArrowRight);
        recorded.push(robot.bits());
    }
    let at = |robot: &Robot| robot.steps() as usize;
    robot.seek(0.0);
    // The replay is slow, so that the test can observe it.
    robot.state_mut().run.live.send(Command::SetPace(Pace::RealTime(0.02)));
    robot.state_mut().run.live.send(Command::Play);
    robot.until("stored moments", |state| {
        state.run.frame.stored && state.run.world().expect("a world").snapshot.observables.step >= 5
    });
    let shown = at(&robot);
    assert_eq!(robot.bits(), recorded[shown]);
    assert!(robot.state().run.frame.playing && robot.state().run.frame.replaying);
    // If the user stops the replay, the run can continue from the shown state.
    robot.key(egui::Key::Space);
    let stopped = at(&robot);
    assert!(!robot.state().run.frame.stored && (shown..30).contains(&stopped), "step {stopped}");
    assert_eq!(robot.bits(), recorded[stopped]);
    robot.key(egui::Key::ArrowRight);
    assert_eq!(robot.bits(), recorded[stopped + 1]);
    // After the replay, a change of settings starts a branch at the shown time.
    robot.state_mut().run.live.send(Command::SetPace(Pace::RealTime(0.5)));
    robot.state_mut().run.live.send(Command::Play);
    robot.until("its end, and more", |state| {
        state.run.world().expect("a world").snapshot.observables.step > steps as u64 + 3
    });
    robot.key(egui::Key::Space);
    assert!(robot.state().run.frame.past.is_empty(), "a replay is no branch");
    robot.seek(0.06);
    assert_eq!(robot.bits(), recorded[steps]);
    robot.state_mut().run.live.send(Command::Seek(0.01));
    robot.state_mut().run.live.send(Command::SetPace(Pace::RealTime(0.02)));
    robot.state_mut().run.live.send(Command::Play);
    robot.until("stored moments", |state| state.run.frame.stored);
    robot.set(|settings| settings.parameters.bond = 5.0);
    assert_eq!(robot.settings().parameters.bond, 5.0);
    robot.until("a branch", |state| !state.run.frame.past.is_empty());
    assert!(!robot.state().run.frame.stored);
}
