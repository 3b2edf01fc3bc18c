//! The recording gives back what was computed, bit for bit.

use slump::live::{Command, Live, LiveOptions, LiveStart, Pace};
use slump::sim::{Pull, Tally};
use slump::sim::{Settings, Stepper};

use crate::robot::{Robot, bits, pile};

#[test]
fn a_run_that_goes_on_from_an_earlier_moment_ends_bitwise_equal() {
    let mut robot = Robot::open(pile());
    for step in 0..90 {
        if step == 30 {
            robot.click("2e-3");
        }
        if step == 50 {
            robot.type_number("Bond", "80");
        }
        robot.state_mut().step();
    }
    robot.settle();
    assert_eq!(robot.steps(), 90);
    let uninterrupted = bits(robot.world());
    let curve: Vec<_> = robot.world().curve.rows().copied().collect();

    // Drag the timeline to a moment before both changes, and go on.
    let (from, to) = (robot.place("timeline", 0.99, 0.5), robot.place("timeline", 0.1, 0.5));
    robot.drag(from, to);
    robot.button(to, false);
    robot.settle();
    let scrubbed = robot.steps();
    assert!((1..30).contains(&scrubbed), "step {scrubbed}");
    let settings = robot.world().controls.settings;
    assert_eq!((settings.parameters.bond, settings.parameters.time_step_secs), (20.0, 1e-3));
    assert_eq!(robot.state().frame.recorded_secs(), curve[90].time_secs, "nothing is lost yet");

    // To the end again, without stepping: a replay of the recording.
    robot.state_mut().live.send(Command::Seek(curve[90].time_secs));
    robot.settle();
    assert_eq!(bits(robot.world()), uninterrupted);
    let parameters = robot.world().controls.settings.parameters;
    assert_eq!((parameters.bond, parameters.time_step_secs), (80.0, 2e-3));

    // From step 60 on, stepping: a continuation.
    robot.state_mut().live.send(Command::Seek(curve[60].time_secs));
    robot.settle();
    assert_eq!(robot.steps(), 60);
    for _ in 60..90 {
        robot.state_mut().step();
    }
    robot.settle();
    assert_eq!(bits(robot.world()), uninterrupted);
    let again: Vec<_> = robot.world().curve.rows().copied().collect();
    assert_eq!(again, curve);
}

#[test]
fn a_step_in_the_past_deletes_nothing() {
    let mut robot = Robot::open(pile());
    for _ in 0..50 {
        robot.state_mut().step();
    }
    robot.settle();
    let (end, until) = (bits(robot.world()), robot.state().frame.recorded_secs());
    robot.state_mut().live.send(Command::Seek(0.02));
    robot.settle();
    assert!(robot.state().frame.replaying);
    robot.key(egui::Key::ArrowRight);
    assert_eq!(robot.steps(), 21);
    assert_eq!(robot.state().frame.recorded_secs(), until);
    assert_eq!(robot.world().curve.len(), 51);
    for _ in 21..50 {
        robot.state_mut().step();
    }
    robot.settle();
    assert_eq!(bits(robot.world()), end);
    assert!(!robot.state().frame.replaying && robot.state().frame.past.is_empty());
    robot.key(egui::Key::ArrowRight);
    assert_eq!((robot.steps(), robot.world().curve.len()), (51, 52));
}

#[test]
fn a_run_that_goes_on_differently_leaves_the_old_one_to_be_gone_back_to() {
    let mut robot = Robot::open(pile());
    for _ in 0..50 {
        robot.state_mut().step();
    }
    robot.settle();
    let curve: Vec<_> = robot.world().curve.rows().copied().collect();
    robot.state_mut().live.send(Command::Seek(0.02));
    robot.settle();
    robot.click("5e-3");
    assert!(robot.state().frame.branching);
    robot.click("Step");
    assert_eq!(robot.steps(), 21);
    assert_eq!(robot.world().curve.len(), 22);
    assert!((robot.state().frame.recorded_secs() - 0.025).abs() < 1e-12);
    assert_eq!(robot.state().frame.past.len(), 1);

    robot.harness.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::Z);
    robot.harness.step();
    robot.settle();
    let again: Vec<_> = robot.world().curve.rows().copied().collect();
    assert_eq!(again, curve);
    let past = robot.state().frame.past.clone();
    assert_eq!(past[0].worlds[0].controls.settings.parameters.time_step_secs, 5e-3);

    // What is undone can be done again, as often as one likes.
    robot.state_mut().live.send(Command::Return(past[0].number));
    robot.settle();
    assert_eq!(robot.world().curve.len(), 22);
}

#[test]
fn a_reset_and_other_worlds_keep_the_run_and_four_are_kept() {
    let mut robot = Robot::open(pile());
    for round in 1..=6 {
        for _ in 0..3 * round {
            robot.state_mut().step();
        }
        robot.settle();
        robot.key(egui::Key::R);
        assert_eq!(robot.steps(), 0);
        assert_eq!(robot.state().frame.past.len(), round.min(4));
    }
    // A reset of nothing keeps nothing.
    robot.key(egui::Key::R);
    let lengths: Vec<usize> =
        robot.state().frame.past.iter().map(|run| run.worlds[0].curve.len()).collect();
    assert_eq!(lengths, [10, 13, 16, 19]);
    robot.state_mut().load(pile());
    robot.settle();
    assert!(robot.state().frame.past.is_empty(), "they are of another start");
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
    live.send(Command::Load(Box::new(move |_| {
        Ok(LiveStart {
            name: "pile".into(),
            simulation,
            tally: Tally::default(),
            duration_secs: 1.0,
            held_by: Vec::new(),
            view: [glam::DVec2::ZERO, glam::DVec2::ONE],
            slumps: true,
            worlds: Vec::new(),
            history: None,
        })
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
    let settings = robot.world().controls.settings;
    let pull = Pull { grain: 100, target: glam::DVec2::new(0.0, 0.1) };
    for (stepper, steps) in [(Stepper::Dem, 40), (Stepper::TgsSoft, 20), (Stepper::Dem, 20)] {
        robot.state_mut().live.send(Command::Change(0, Settings { stepper, ..settings }));
        robot.state_mut().live.send(Command::SetPull(0, Some(pull)));
        for _ in 0..steps {
            robot.state_mut().step();
        }
    }
    robot.settle();
    let (uninterrupted, end_secs) = (bits(robot.world()), robot.state().frame.time_secs());
    for time_secs in [0.015, 0.05] {
        robot.state_mut().live.send(Command::Seek(time_secs));
        robot.settle();
        assert_ne!(bits(robot.world()), uninterrupted);
        robot.state_mut().live.send(Command::Seek(end_secs));
        robot.settle();
        assert_eq!(bits(robot.world()), uninterrupted, "from {time_secs} s on");
    }
}

#[test]
fn play_shows_stored_moments_and_computes_where_they_end() {
    let mut robot = Robot::open(pile());
    let steps = 60;
    let mut recorded = vec![bits(robot.world())];
    for step in 1..=steps {
        if step == 30 {
            robot.type_number("Bond", "80");
        }
        robot.key(egui::Key::ArrowRight);
        recorded.push(bits(robot.world()));
    }
    let at = |robot: &Robot| robot.steps() as usize;
    robot.state_mut().live.send(Command::Seek(0.0));
    robot.settle();
    // Slowly, so that there is time to look.
    robot.state_mut().live.send(Command::SetPace(Pace::RealTime(0.02)));
    robot.state_mut().live.send(Command::Play);
    robot.until("stored moments", |state| {
        state.frame.stored && state.world().expect("a world").snapshot.observables.step >= 5
    });
    let shown = at(&robot);
    assert_eq!(bits(robot.world()), recorded[shown]);
    assert!(robot.state().frame.playing && robot.state().frame.replaying);
    // Stopped on the way, that moment is there to go on from.
    robot.key(egui::Key::Space);
    let stopped = at(&robot);
    assert!(!robot.state().frame.stored && (shown..30).contains(&stopped), "step {stopped}");
    assert_eq!(bits(robot.world()), recorded[stopped]);
    robot.key(egui::Key::ArrowRight);
    assert_eq!(bits(robot.world()), recorded[stopped + 1]);

    // Played again, a change branches off at the moment that is shown.
    robot.state_mut().live.send(Command::SetPace(Pace::RealTime(0.5)));
    robot.state_mut().live.send(Command::Play);
    robot.until("its end, and more", |state| {
        state.world().expect("a world").snapshot.observables.step > steps as u64 + 3
    });
    robot.key(egui::Key::Space);
    assert!(robot.state().frame.past.is_empty(), "a replay is no branch");
    robot.state_mut().live.send(Command::Seek(0.06));
    robot.settle();
    assert_eq!(bits(robot.world()), recorded[steps]);
    robot.state_mut().live.send(Command::Seek(0.01));
    robot.state_mut().live.send(Command::SetPace(Pace::RealTime(0.02)));
    robot.state_mut().live.send(Command::Play);
    robot.until("stored moments", |state| state.frame.stored);
    let mut settings = robot.world().controls.settings;
    settings.parameters.bond = 5.0;
    robot.state_mut().change(0, settings);
    robot.settle();
    assert_eq!(robot.world().controls.settings.parameters.bond, 5.0);
    robot.until("a branch", |state| !state.frame.past.is_empty());
    assert!(!robot.state().frame.stored);
}

#[test]
fn runs_have_the_names_that_they_are_given() {
    let mut robot = Robot::open(pile());
    let steps = |robot: &mut Robot, count: u32| {
        (0..count).for_each(|_| robot.state_mut().step());
        robot.settle();
    };
    steps(&mut robot, 3);
    robot.key(egui::Key::R);
    steps(&mut robot, 2);
    robot.click("Physics");
    let number = robot.state().frame.past[0].number;
    robot.type_number(&format!("Name of run {number}"), "first try");
    robot.type_number("Name of this run", "second");
    assert_eq!(robot.state().frame.past[0].name, "first try");
    assert_eq!(robot.state().frame.name, "second");
    robot.click("↶ first try, 0.003 s");
    assert_eq!((robot.steps(), &*robot.state().frame.name), (3, "first try"));
    assert_eq!(robot.state().frame.past[0].name, "second");
    // What branches off is another run.
    robot.state_mut().live.send(Command::Seek(0.001));
    robot.settle();
    let mut settings = robot.world().controls.settings;
    settings.parameters.bond = 3.0;
    robot.state_mut().change(0, settings);
    steps(&mut robot, 1);
    let names: Vec<_> = robot.state().frame.past.iter().map(|run| &*run.name).collect();
    assert_eq!((names, &*robot.state().frame.name), (vec!["second", "first try"], ""));
}
