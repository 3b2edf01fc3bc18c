//! Tests of sessions, links and saved runs, which open the present state again later or on another machine.

use crate::robot::*;

/// Returns three values for each compared simulation of a window: the displayed step number, the simulated time up to
/// which the run is recorded (s), and the displayed state as bit patterns.
fn shown(robot: &Robot) -> Vec<(u64, f64, Vec<[u64; 6]>)> {
    robot.of_worlds(|world| (world.snapshot.observables.step, world.recorded_secs, bits(world)))
}

/// Opens a window with two compared simulations and an earlier run. The settings were changed during the run, and the
/// displayed time is before the end of the run.
fn two_worlds() -> Robot {
    let mut robot = Robot::open(pile());
    let base = robot.settings();
    robot.take_steps(5);
    let variants = vec![base.over(1e-3), base.over(2e-3)];
    robot.state_mut().run.live.send(Command::Compare(variants));
    robot.take_steps(20);
    robot.state_mut().run.change(0, base.over(1e-3).with_bond(3.0));
    robot.take_steps(20);
    robot.seek(0.06);
    robot
}

#[test]
fn a_session_brings_back_worlds_record_past_and_window() {
    let folder = folder();
    let mut robot = two_worlds();
    robot.state_mut().preferences.theme = egui::ThemePreference::Dark;
    robot.state_mut().preferences.plots = false;
    robot.click("Law, solver");
    let path = robot.save_session(folder.path());
    assert!(path.extension().is_some_and(|ending| ending == "session"));
    let (before, past) = (shown(&robot), robot.state().run.frame.past.len());

    let mut again = Robot::open_saved(&path);
    assert!(again.state().run.frame.refusal.is_none(), "{:?}", again.state().run.frame.refusal);
    assert_eq!(shown(&again), before);
    assert_eq!((again.state().run.frame.past.len(), past), (1, 1), "the run before is there");
    let Preferences { folder, .. } = robot.state().preferences.clone();
    let preferences = Preferences { folder, ..again.state().preferences.clone() };
    assert_eq!(preferences, robot.state().preferences);
    // The panel that was open before is open again, so its contents are visible.
    use egui_kittest::kittest::Queryable;
    for window in [&mut robot, &mut again] {
        window.frames(20);
        assert!(window.harness.query_by_label("Solved").is_some());
    }
    // All recorded states, and the states of further steps, are equal.
    for window in [&mut robot, &mut again] {
        window.seek(0.024);
    }
    assert_eq!(shown(&again), shown(&robot));
    for window in [&mut robot, &mut again] {
        window.seek(1.0);
        window.take_steps(7);
    }
    assert_eq!(shown(&again), shown(&robot));
    assert_ne!(shown(&again), before);
}

#[test]
fn a_lesson_goes_on_at_its_place() {
    let folder = folder();
    let mut robot = Robot::open(Config::default());
    robot.state_mut().visit(2);
    robot.settle();
    let path = robot.save_session(folder.path());
    let mut again = Robot::open_saved(&path);
    assert!(again.state().touring);
    assert_eq!(again.state().preferences.lesson.at, 2);
    assert_eq!(again.state().preferences.speed, robot.state().preferences.speed);
    again.click("Leave");
    assert!(!again.state().touring);
}

#[test]
fn a_file_that_is_no_whole_session_is_refused_in_a_sentence() {
    let folder = folder();
    let mut robot = Robot::open(Config::of_scene("cradle"));
    robot.take_steps(3);
    robot.state_mut().preferences.folder = folder.path().to_owned();
    robot.clicks(&["Save", "Save session"]);
    let path = robot.saved();
    let bytes = bytes(&path);
    let mut flipped = bytes.clone();
    flipped[bytes.len() / 2] ^= 1;
    let cases: [(&str, &[u8], &str); 4] = [
        ("cut", &bytes[..bytes.len() / 2], "has been cut"),
        ("flipped", &flipped, "is damaged"),
        ("text", b"x,y,radius\n", "holds no session, but must be a session that the window saved"),
        ("empty", b"", "holds no session"),
    ];
    for (name, bytes, expected) in cases {
        let file = folder.path().join(format!("{name}.session"));
        write(&file, bytes);
        robot.state_mut().load_saved(&file);
        robot.settle();
        let notice = robot.notice();
        assert!(notice.contains(expected), "{name}: {notice}");
        assert_eq!(robot.steps(), 3, "the run before is still there");
        // The program reports the same error if the file is given on the command line.
        let output = run(slump("--session").arg(&file));
        assert_eq!((output.status.code(), said(&output)), (Some(2), format!("slump: {notice}\n")));
    }
}

fn copied(robot: &mut Robot) -> String {
    let context = robot.harness.ctx.clone();
    robot.state_mut().copy_link(&context);
    for _ in 0..200 {
        robot.harness.step();
        for command in &robot.harness.output().platform_output.commands {
            if let egui::OutputCommand::CopyText(text) = command {
                return text.clone();
            }
        }
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    panic!("nothing is copied: {:?}", robot.state().notice().map(|(notice, _)| &notice.text));
}

#[test]
fn a_link_opens_the_moment_that_it_was_copied_at() {
    let mut robot = two_worlds();
    let mut settings = robot.state().run.frame.worlds[1].controls.settings;
    settings.stepper = Stepper::Range;
    robot.change(1, settings);
    let text = copied(&mut robot);
    assert!(text.starts_with("slump://run?") && !text.contains(' '), "{text}");
    let places = |robot: &Robot| -> Vec<_> {
        shown(robot).into_iter().map(|(step, _, bits)| (step, bits)).collect()
    };
    let mut again = Robot::open(Config::of_scene("cradle"));
    again.paste(format!(" {text}\n"));
    assert!(again.state().run.frame.refusal.is_none(), "{:?}", again.state().run.frame.refusal);
    assert_eq!(places(&again), places(&robot), "{text}");
    let settings = |robot: &Robot| robot.of_worlds(|world| world.controls.settings);
    assert_eq!(settings(&again), settings(&robot));
    // The run of a link is an ordinary run: a link made from it is equal, and further steps are equal.
    assert_eq!(copied(&mut again), text);
    for window in [&mut robot, &mut again] {
        window.take_steps(3);
    }
    assert_eq!(places(&again), places(&robot));
}

#[test]
fn a_link_says_what_it_leaves_out_and_what_is_none_is_refused() {
    let mut robot = Robot::open(pile());
    let pull = Pull { grain: 100, target: DVec2::new(0.0, 0.1) };
    robot.state_mut().run.live.send(Command::SetPull(0, Some(pull)));
    robot.take_steps(3);
    copied(&mut robot);
    assert!(robot.notice().contains("pulled by hand"));
    robot.paste("slump://run?scene=no-such&to=3");
    let said = robot.notice();
    assert!(said.contains("no-such"), "{said}");
    robot.paste("slump://walk");
    let said = robot.notice();
    assert!(said.starts_with("link is slump://walk, but must be"), "{said}");
    assert_eq!(robot.steps(), 3);
}

#[test]
fn a_saved_run_goes_on_in_the_window_as_it_would_have_without() {
    let scene = built_in("moving-walls").expect("a scene");
    let mut simulation = scene.simulation().expect("a sound scene");
    simulation.take_steps(40).expect("finite states");
    let saved = SavedState::new(scene, simulation.clone(), Tally::default());
    let saved = SavedState::from_bytes(&saved.to_bytes().expect("bytes"), "a.slump");

    let mut robot = Robot::open(pile());
    robot.state_mut().load_run(saved.expect("a sound state"));
    robot.until("the saved run", |state| {
        state.run.world().is_some_and(|world| world.snapshot.observables.step == 40)
    });
    assert_eq!(robot.state().run.frame.time_secs(), simulation.time_secs());
    robot.take_steps(20);
    simulation.take_steps(20).expect("finite states");
    assert_eq!(robot.steps(), 60);
    let positions = |place: [u64; 6]| [place[0], place[1]].map(f64::from_bits);
    let shown: Vec<_> = robot.bits().into_iter().map(positions).collect();
    let expected = simulation.world().grains.positions.iter().map(|place| place.to_array());
    assert!(shown.into_iter().eq(expected));
}

fn save(robot: &mut Robot) -> String {
    robot.click("Save state");
    robot.written()
}

fn saved(robot: &mut Robot) -> PathBuf {
    robot.click("Save state");
    robot.saved()
}

/// Runs the program without a window. Returns the text that it wrote to stderr.
fn headless(arguments: &[&str], out: &Path) -> String {
    said(&run(slump("--headless").args(arguments).arg("--save").arg(out)))
}

#[test]
fn the_window_saves_what_save_writes() {
    let ways =
        [("pile", Stepper::Moreau), ("thin-wall", Stepper::Moreau), ("pile", Stepper::Range)];
    for (scene, stepper) in ways {
        let folder = folder();
        let mut config = Config::of_scene(scene);
        config.source.duration = Some(0.04);
        config.parameters.time_step_secs = Some(1e-3);
        config.stepper = Some(stepper);
        let mut robot = Robot::open_in(folder.path(), config);
        robot.take_steps(40);
        let found = saved(&mut robot);
        let bond = robot.settings().parameters.bond;
        let name = format!("slump-{scene}-bond{bond}-dt1e-3-0.0400s.slump");
        assert_eq!(found.file_name().and_then(|name| name.to_str()), Some(&*name));

        let written = folder.path().join("headless.slump");
        let line = robot.state().run.command_line().expect("a command line");
        let options: Vec<&str> = line.split(' ').skip(2).collect();
        headless(&options, &written);
        assert!(bytes(&found) == bytes(&written), "{scene}, {stepper:?}");
    }
}

#[test]
fn an_earlier_moment_is_saved_as_it_was() {
    let folder = folder();
    let mut robot = Robot::open_in(folder.path(), pile());
    robot.take_steps(30);
    robot.type_number("Δt, time step", "2");
    robot.take_steps(20);
    let then = saved(&mut robot);
    let at_secs = robot.state().run.frame.time_secs();
    let mut settings = robot.settings();
    settings.parameters.bond = 80.0;
    robot.take_steps(5);
    robot.state_mut().run.change(0, settings);
    robot.take_steps(60);
    let end = saved(&mut robot);
    robot.state_mut().run.live.send(Command::Seek(at_secs));
    // The save is requested while the window may still be going back in time.
    let again = saved(&mut robot);
    assert!(again != then && then != end, "no file replaces another");
    assert!(bytes(&again) == bytes(&then));
    // The saved run continues like the original run, also without a window.
    let state = SavedState::open(&again).expect("a state");
    assert_eq!(state.scene.parameters.time_step_secs, 2e-3);
    let mut simulation = state.simulation;
    simulation.take_steps(5).expect("finite states");
    simulation.change(settings).expect("sound settings");
    simulation.take_steps(60).expect("finite states");
    let expected = SavedState::open(&end).expect("a state").simulation;
    assert_eq!(simulation.world().grains.positions, expected.world().grains.positions);
}

#[test]
fn a_hand_that_pulls_is_not_saved() {
    let folder = folder();
    let mut robot = Robot::open_in(folder.path(), pile());
    let pull = Pull { grain: 100, target: DVec2::new(0.0, 0.1) };
    robot.state_mut().run.live.send(Command::SetPull(0, Some(pull)));
    robot.take_steps(3);
    assert!(robot.world().controls.pull.is_some());
    assert_eq!(SavedState::open(&saved(&mut robot)).expect("a state").simulation.pull(), None);
}

#[test]
fn a_state_that_is_saved_can_be_opened_and_is_a_run_of_its_own() {
    let folder = folder();
    let mut robot = Robot::open_in(folder.path(), pile());
    robot.take_steps(25);
    let before = robot.bits();
    saved(&mut robot);
    robot.take_steps(10);
    let end = robot.bits();
    // The panel offers the file that has just been saved.
    robot.click("Open");
    assert_eq!((robot.steps(), robot.bits()), (25, before.clone()));
    assert_eq!(robot.world().recorded_from_secs, robot.state().run.frame.time_secs());
    robot.take_steps(10);
    assert_eq!(robot.bits(), end);
    robot.key(egui::Key::R);
    assert_eq!((robot.steps(), robot.bits()), (25, before), "reset goes back to the file");
    // The sums over all steps since t = 0 are a part of the saved run.
    robot.take_steps(1);
    assert_eq!(SavedState::open(&saved(&mut robot)).expect("a state").tally.steps, 26);
}

#[test]
fn a_dropped_run_is_opened_and_a_damaged_one_is_told_of_as_restart_does() {
    let folder = folder();
    let mut robot = Robot::open_in(folder.path(), Config::of_scene("cradle"));
    robot.take_steps(7);
    let path = saved(&mut robot);
    let mut robot = Robot::open_in(folder.path(), pile());
    robot.drop(&path);
    assert_eq!(robot.steps(), 7);
    let settings = robot.settings();
    let opens_it_again = Config::of_scene("cradle").with_settings(&settings);
    assert_eq!(robot.state().preferences.scene, opens_it_again);

    let mut bytes = bytes(&path);
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    write(&path, bytes);
    robot.drop(&path);
    let said = robot.notice();
    let options = ["--duration", "1", "--restart", text(&path)];
    assert_eq!(format!("slump: {said}\n"), headless(&options, &folder.path().join("new")));
    assert!(said.contains("is damaged"), "{said}");
    assert_eq!(robot.steps(), 7, "the run before is still there");
}

#[test]
fn what_cannot_be_saved_is_told_of() {
    let folder = folder();
    let file = folder.path().join("file");
    write(&file, "");
    let mut robot = Robot::open_in(&file, pile());
    let said = save(&mut robot);
    assert!(said.contains("but must be a folder that can be written to"), "{said}");
    robot.state_mut().preferences.folder = folder.path().to_owned();
    robot.take_steps(1);
    robot.set(|settings| settings.parameters.time_step_secs = 1e200);
    robot.take_steps(3);
    assert!(robot.world().failure.is_some());
    let said = save(&mut robot);
    let expected = "state is no longer finite, but must be an earlier one: drag the timeline back";
    assert_eq!(said, expected);
    let shown = robot.harness.query_all_by_label(expected).count();
    assert_eq!(shown, 1, "a run that cannot go on hides no answer");
}

#[test]
fn a_session_that_is_saved_in_the_middle_of_a_step_opens_and_goes_on() {
    let files = folder();
    let mut robot = Robot::open(pile());
    let base = robot.settings();
    robot.send(Command::Compare(vec![base.over(1e-7), base.over(2e-3)]));
    robot.state_mut().run.step();
    robot.until("the middle of the step", |state| {
        state.run.frame.seeking && state.run.frame.worlds[0].snapshot.observables.step > 100
    });
    let path = robot.save_session(files.path());
    let mut opened = Robot::open_saved(&path);
    let rows = opened.of_worlds(|world| world.snapshot.observables);
    assert!(rows[0].step > 100 && rows[0].step < 20_000, "{}", rows[0].step);
    opened.take_steps(1);
    let rows = opened.of_worlds(|world| world.snapshot.observables);
    assert!((rows[0].time_secs - rows[1].time_secs).abs() < 1e-9);
}
