//! Tests of data that the window exports from a recorded run.

use std::collections::BTreeMap;

use crate::recordings::{assert_same, export, facts, headless, open, said_in};
use crate::robot::*;
use crate::tables::{Cell, Columns, number, parquet, steps, whole};

#[test]
fn the_window_exports_what_data_writes() {
    // The first scene has rough ground and cohesion, the second loses a grain, and the third has moving walls.
    for (scene, duration_secs) in [("pile", 0.03), ("thin-wall", 0.04), ("moving-walls", 0.03)] {
        let folder = folder();
        let (exported, written) = (folder.path().join("window"), folder.path().join("headless"));
        let mut config = Config::of_scene(scene);
        config.source.duration = Some(duration_secs);
        config.parameters.time_step_secs = Some(1e-3);
        let formats: Vec<_> = FormatName::ALL
            .iter()
            .copied()
            .filter(|format| slump::data::check_format(*format).is_ok())
            .collect();
        let mut robot = open(config, &exported, &formats);
        let steps = (duration_secs * 1e3).round() as u64;
        robot.take_steps(steps);
        // The export must not depend on the position of the timeline.
        robot.seek(0.01);
        let told = export(&mut robot);
        assert_eq!(told, format!("{} frames of data in {}", steps + 1, exported.display()));

        let names: Vec<_> = formats.iter().map(|format| format.name()).collect();
        let names = names.join(",");
        let line = robot.state().run.command_line().expect("a command line");
        let options: Vec<&str> = line.split(' ').skip(2).collect();
        headless(
            &[&options[..], &["--data-every", "1e-9", "--data-format", &names]].concat(),
            &written,
        );
        assert_same(&exported, &written);
        if scene == "thin-wall" {
            let kinds = said_in(&exported.join("csv/grains.csv"));
            assert!(kinds.iter().any(|line| line.contains(",lost,")), "a grain is lost");
        }
    }
}

#[test]
fn frames_are_at_the_times_that_data_has_them_at() {
    let folder = folder();
    let (exported, written) = (folder.path().join("window"), folder.path().join("headless"));
    let mut config = Config::of_scene("cradle");
    config.source.duration = Some(0.05);
    config.parameters.time_step_secs = Some(1e-3);
    let mut robot = open(config, &exported, &[slump::data::DEFAULT_FORMAT]);
    robot.state_mut().preferences.data.each_step = false;
    robot.state_mut().preferences.data.every_secs = 0.0073;
    robot.take_steps(50);
    export(&mut robot);
    let options = ["--scene", "cradle", "--dt", "1e-3", "--duration", "0.05"];
    headless(&[&options[..], &["--data-every", "0.0073"]].concat(), &written);
    assert_same(&exported, &written);
}

/// Returns for each step number in a table the positions (bit patterns) of all grains after that step.
fn places(grains: &Columns) -> BTreeMap<u64, Vec<[u64; 2]>> {
    let mut places = BTreeMap::<u64, Vec<_>>::new();
    for (row, step) in grains["step"].iter().enumerate() {
        if grains["kind"][row] == Cell::Word("grain".into()) {
            let place = ["x", "y"].map(|name| number(&grains[name][row]).to_bits());
            places.entry(whole(step)).or_default().push(place);
        }
    }
    places
}

fn place_of(simulation: &Simulation) -> Vec<[u64; 2]> {
    let places = simulation.world().grains.positions.iter();
    places.map(|place| place.to_array().map(f64::to_bits)).collect()
}

/// Runs 80 steps with changes of settings and a pulled grain, in the window and in a second simulation without a
/// window. Returns the times of all steps (s), and the positions of the second simulation after each step.
fn changed_run(robot: &mut Robot) -> (Vec<f64>, BTreeMap<u64, Vec<[u64; 2]>>) {
    let scene = pile().scene(|_| true).expect("a scene");
    let mut simulation = scene.simulation().expect("a sound scene");
    let mut settings = *simulation.settings();
    let pull = Pull { grain: 100, target: DVec2::new(0.0, 0.1) };
    let (mut times, mut moments) = (vec![0.0], BTreeMap::new());
    for step in 0..80 {
        match step {
            10 => settings.parameters.friction = 0.3,
            40 => settings.parameters.time_step_secs = 2e-3,
            50 => settings.parameters.bond = 80.0,
            _ => {}
        }
        let pull = (45..55).contains(&step).then_some(pull);
        robot.state_mut().run.live.send(Command::Change(0, settings));
        robot.state_mut().run.live.send(Command::SetPull(0, pull));
        robot.state_mut().run.step();
        simulation.change(settings).expect("sound settings");
        simulation.set_pull(pull);
        times.push(simulation.step().expect("a finite state").time_secs);
        moments.insert(simulation.observables().step, place_of(&simulation));
    }
    robot.settle();
    (times, moments)
}

/// Selects the interval of simulated times (s) that the window exports.
fn choose(robot: &mut Robot, stretch: [f64; 2]) {
    for (label, secs) in ["From here", "To here"].into_iter().zip(stretch) {
        robot.seek(secs);
        robot.click(label);
    }
}

#[test]
fn a_stretch_has_its_own_moments_and_tells_what_was_changed_in_it() {
    let folder = folder();
    let mut robot = open(pile(), folder.path(), &[FormatName::Parquet]);
    let (times, mut moments) = changed_run(&mut robot);
    robot.click("The whole recording");
    choose(&mut robot, [times[33], times[60]]);
    let told = export(&mut robot);
    assert!(told.starts_with("28 frames of data in"), "{told}");
    moments.retain(|step, _| (33..=60).contains(step));
    assert_eq!(places(&parquet(folder.path(), "grains")), moments);
    let rows = parquet(folder.path(), "steps");
    assert_eq!(steps(&rows), (33..=60).collect::<Vec<_>>());
    let time_steps: Vec<f64> = rows["time_step"].iter().map(number).collect();
    assert_eq!([time_steps[7], time_steps[8]], [1e-3, 2e-3], "of steps 40 and 41");

    let about = facts(folder.path());
    // A change before the interval belongs to the initial settings, not to the list of changes.
    assert_eq!(about["parameters.friction"], "0.3");
    assert_eq!(about["parameters.bond"], "20.0");
    let changes: serde_json::Value = serde_json::from_str(&about["changes"]).expect("JSON");
    let expected = serde_json::json!([
        { "after_step": 40, "time": times[40], "parameters.time_step_secs": 2e-3 },
        { "after_step": 50, "time": times[50], "parameters.bond": 80.0 },
    ]);
    assert_eq!(changes, expected);
    assert_eq!(about["pulled_by_hand"], "grain 100 in steps 46 to 55");
    assert_eq!(about["exported"], format!("from the window, from step 33 to {} s", times[60]));
    // A change after the interval is not in the list of changes, even if the interval ends at the change.
    choose(&mut robot, [times[20], times[40]]);
    robot.click("Overwrite");
    let told = export(&mut robot);
    assert!(told.starts_with("21 frames of data in"), "{told}");
    let about = facts(folder.path());
    assert_eq!(about.get("changes"), None);
    assert_eq!(about.get("pulled_by_hand"), None);
    // An empty interval leaves existing files unchanged.
    choose(&mut robot, [times[41], times[40]]);
    robot.click("Overwrite");
    let told = export(&mut robot);
    assert!(told.starts_with("to is 40 ms, but must be 42 ms, the beginning, or later"), "{told}");
    assert_eq!(steps(&parquet(folder.path(), "grains")), (20..=40).collect::<Vec<_>>());
}

#[test]
fn a_run_that_has_not_begun_is_one_frame() {
    let folder = folder();
    let mut robot = open(pile(), folder.path(), &[FormatName::Csv]);
    let told = export(&mut robot);
    assert!(told.starts_with("1 frame of data in"), "{told}");
}

#[test]
fn a_run_goes_on_while_it_is_exported() {
    let folder = folder();
    let mut robot = open(pile(), folder.path(), &[FormatName::Csv]);
    robot.state_mut().preferences.full_speed = true;
    robot.key(egui::Key::Space);
    robot.until("some steps", |state| state.run.world().unwrap().snapshot.observables.step >= 40);
    robot.click("Export data");
    let asked = robot.steps();
    robot.until("the export", |state| !state.is_writing());
    assert!(robot.state().run.frame.playing && robot.steps() > asked);
    let mut scene = pile().scene(|_| true).expect("a scene");
    // The window has other solver settings than the scene, and the number of steps depends on the machine.
    scene.set_settings(robot.settings());
    let mut simulation = scene.simulation().expect("a sound scene");
    let text = said_in(&folder.path().join("csv/grains.csv"));
    let last = text.last().and_then(|row| row.split(',').next()?.parse().ok()).expect("a step");
    assert!(last >= 40, "step {last}");
    simulation.take_steps(last).expect("finite states");
    let found = read_grains(folder.path(), None).expect("grains").grains;
    assert!(found.iter().map(|it| it.position).eq(simulation.world().grains.positions.clone()));
}

#[test]
fn an_export_that_is_stopped_leaves_whole_frames() {
    let folder = folder();
    let mut robot = open(pile(), folder.path(), FormatName::ALL);
    robot.take_steps(400);
    robot.click("Export data");
    let index = folder.path().join("frames.csv");
    let is_row = |line: &&str| line.starts_with(|first: char| first.is_ascii_digit());
    let rows = || std::fs::read_to_string(&index).map_or(0, |it| it.lines().filter(is_row).count());
    // While the program writes, the last row may be incomplete.
    robot.until("frames", |_| rows() > 10);
    robot.click("Stop export");
    let told = robot.written();
    let frames: u64 = told
        .strip_prefix("Stopped with ")
        .and_then(|rest| rest.split(' ').next()?.parse().ok())
        .unwrap_or_else(|| panic!("{told}"));
    assert!((10..400).contains(&frames), "{told}");
    for table in ["grains", "contacts", "measures"] {
        let found = steps(&parquet(folder.path(), table));
        assert_eq!(found, (0..frames).collect::<Vec<_>>(), "{table}");
    }
    assert!(robot.harness.query_by_label("Export data").is_some(), "another can be asked for");
}

#[test]
fn what_cannot_be_exported_is_refused_as_data_refuses_it() {
    let folder = folder();
    let there = folder.path().join("there");
    let mut robot = open(Config::of_scene("cradle"), &there, &[FormatName::Csv]);
    robot.take_steps(3);
    assert!(export(&mut robot).starts_with("4 frames of data"));
    let before = bytes(there.join("csv/grains.csv"));
    // Two refused folders: one with an earlier recording, and one that cannot be created.
    robot.take_steps(2);
    let file = folder.path().join("file");
    write(&file, "");
    for place in [there.clone(), file.join("below")] {
        robot.state_mut().preferences.data.folder.clone_from(&place);
        let refused = headless(&["--scene", "cradle", "--duration", "0.01"], &place);
        assert_eq!(format!("slump: {}\n", export(&mut robot)), refused);
        assert!(refused.contains("but must be a folder"), "{refused}");
    }
    assert_eq!(bytes(there.join("csv/grains.csv")), before);
    // The button has the effect of the option `--overwrite`, but only for one export.
    robot.state_mut().preferences.data.folder = there;
    robot.click("Overwrite");
    assert!(export(&mut robot).starts_with("6 frames of data"));
    assert!(export(&mut robot).contains("without an earlier recording"));
    let shown = robot.harness.query_all_by_label_contains("without an earlier recording");
    assert_eq!(shown.count(), 2, "in the status bar and beside the button");
    // Without a selected format, nothing can be exported.
    robot.clicks(&["csv", "Export data"]);
    assert!(!robot.state().is_writing());
}

#[test]
fn a_run_that_blew_up_is_exported_up_to_its_last_finite_state() {
    let folder = folder();
    let mut robot = open(pile(), folder.path(), &[FormatName::Csv]);
    robot.take_steps(2);
    robot.set(|settings| settings.parameters.time_step_secs = 1e200);
    robot.take_steps(3);
    assert!(robot.world().failure.is_some());
    let told = export(&mut robot);
    let last = robot.steps() - 1;
    assert!(told.starts_with(&format!("{} frames of data in", last + 1)), "{told}");
    assert!(told.ends_with("up to the last step with a finite state"), "{told}");
}

#[test]
fn of_compared_worlds_the_selected_one_is_exported() {
    let folder = folder();
    let mut robot = open(pile(), folder.path(), &[FormatName::Csv]);
    let same = robot.settings();
    let mut other = same;
    other.parameters.bond = 0.0;
    robot.send(Command::Compare(vec![other, same]));
    robot.take_steps(2);
    let title = robot.harness.query_by_label_contains("For world 1");
    assert!(title.is_some(), "the panel says which");
    export(&mut robot);
    assert_eq!(facts(folder.path())["parameters.bond"], "0.0");
}
