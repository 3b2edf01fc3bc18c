//! Saved runs in the window.

use std::path::{Path, PathBuf};
use std::process::Command;

use egui_kittest::kittest::Queryable;
use slump::config::{Config, SavedState};
use slump::live::Command as Live;
use slump::scene::built_in;
use slump::sim::{Stepper, Tally};

use crate::recordings::take_steps;
use crate::robot::{File, Robot, bits, pile};

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
        state.world().is_some_and(|world| world.snapshot.observables.step == 40)
    });
    assert_eq!(robot.state().frame.time_secs(), simulation.time_secs());
    for _ in 0..20 {
        robot.state_mut().step();
    }
    robot.settle();
    simulation.take_steps(20).expect("finite states");
    assert_eq!(robot.steps(), 60);
    let positions = |place: [u64; 6]| [place[0], place[1]].map(f64::from_bits);
    let shown: Vec<_> = bits(robot.world()).into_iter().map(positions).collect();
    let expected = simulation.world().grains.positions.iter().map(|place| place.to_array());
    assert!(shown.into_iter().eq(expected));
}

/// A window with the panel open that saves into a folder.
fn open(config: Config, folder: &Path) -> Robot {
    let mut robot = Robot::open(config);
    robot.state_mut().preferences.folder = folder.to_owned();
    robot.click("Data");
    robot
}

/// Saves, and gives what is told of it.
fn save(robot: &mut Robot) -> String {
    robot.click("Save state");
    robot.until("the file", |state| !state.is_writing());
    robot.state().notice().expect("what became of it").0.text.clone()
}

/// Saves, and gives the file.
fn saved(robot: &mut Robot) -> PathBuf {
    let told = save(robot);
    told.strip_prefix("Saved ").unwrap_or_else(|| panic!("{told}")).into()
}

/// Runs the program without a window and gives what it says on stderr.
fn headless(arguments: &[&str], out: &Path) -> String {
    let mut command = Command::new(assert_cmd::cargo::cargo_bin!("slump"));
    let output = command.arg("--headless").args(arguments).arg("--save").arg(out).output();
    String::from_utf8(output.expect("the program starts").stderr).expect("UTF-8")
}

#[test]
fn the_window_saves_what_save_writes() {
    let ways =
        [("pile", Stepper::Moreau), ("thin-wall", Stepper::Moreau), ("pile", Stepper::Range)];
    for (scene, stepper) in ways {
        let folder = tempfile::tempdir().expect("a folder");
        let mut config = Config::of_scene(scene);
        config.source.duration = Some(0.04);
        config.parameters.time_step_secs = Some(1e-3);
        config.stepper = Some(stepper);
        let mut robot = open(config, folder.path());
        take_steps(&mut robot, 40);
        let found = saved(&mut robot);
        let bond = robot.world().controls.settings.parameters.bond;
        let name = format!("slump-{scene}-bond{bond}-dt1e-3-0.0400s.slump");
        assert_eq!(found.file_name().and_then(|name| name.to_str()), Some(&*name));

        let written = folder.path().join("headless.slump");
        let line = robot.state().command_line().expect("a command line");
        let options: Vec<&str> = line.split(' ').skip(2).collect();
        headless(&options, &written);
        let bytes = |path: &Path| std::fs::read(path).expect("a file");
        assert!(bytes(&found) == bytes(&written), "{scene}, {stepper:?}");
    }
}

#[test]
fn an_earlier_moment_is_saved_as_it_was() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut robot = open(pile(), folder.path());
    take_steps(&mut robot, 30);
    robot.click("2e-3");
    take_steps(&mut robot, 20);
    let then = saved(&mut robot);
    let at_secs = robot.state().frame.time_secs();
    let mut settings = robot.world().controls.settings;
    settings.parameters.bond = 80.0;
    take_steps(&mut robot, 5);
    robot.state_mut().change(0, settings);
    take_steps(&mut robot, 60);
    let end = saved(&mut robot);
    robot.state_mut().live.send(Live::Seek(at_secs));
    // The seek may still be going on when this is asked for.
    let again = saved(&mut robot);
    assert!(again != then && then != end, "no file replaces another");
    let bytes = |path: &Path| std::fs::read(path).expect("a file");
    assert!(bytes(&again) == bytes(&then));

    // And it goes on as the run did, without a window as well.
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
    let folder = tempfile::tempdir().expect("a folder");
    let mut robot = open(pile(), folder.path());
    let pull = slump::sim::Pull { grain: 100, target: glam::DVec2::new(0.0, 0.1) };
    robot.state_mut().live.send(Live::SetPull(0, Some(pull)));
    take_steps(&mut robot, 3);
    assert!(robot.world().controls.pull.is_some());
    let state = SavedState::open(&saved(&mut robot)).expect("a state");
    assert_eq!(state.simulation.pull(), None);
}

#[test]
fn a_state_that_is_saved_can_be_opened_and_is_a_run_of_its_own() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut robot = open(pile(), folder.path());
    take_steps(&mut robot, 25);
    let before = bits(robot.world());
    saved(&mut robot);
    take_steps(&mut robot, 10);
    let end = bits(robot.world());
    // The file that was just saved is the one that the panel offers.
    robot.click("Open");
    assert_eq!((robot.steps(), bits(robot.world())), (25, before.clone()));
    assert_eq!(robot.world().recorded_from_secs, robot.state().frame.time_secs());
    take_steps(&mut robot, 10);
    assert_eq!(bits(robot.world()), end);
    robot.key(egui::Key::R);
    assert_eq!((robot.steps(), bits(robot.world())), (25, before), "reset goes back to the file");
    // Sums over all steps since t = 0 go along.
    take_steps(&mut robot, 1);
    let state = SavedState::open(&saved(&mut robot)).expect("a state");
    assert_eq!(state.tally.steps, 26);
}

#[test]
fn a_dropped_run_is_opened_and_a_damaged_one_is_told_of_as_restart_does() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut robot = open(Config::of_scene("cradle"), folder.path());
    take_steps(&mut robot, 7);
    let path = saved(&mut robot);
    let mut robot = open(pile(), folder.path());
    let drop = |robot: &mut Robot, path: &Path| {
        let file = std::sync::Arc::new(File(path.to_owned()));
        robot.harness.input_mut().dropped_files.push(file);
        robot.harness.step();
        robot.settle();
    };
    drop(&mut robot, &path);
    assert_eq!(robot.steps(), 7);
    let settings = robot.world().controls.settings;
    let opens_it_again = Config::of_scene("cradle").with_settings(&settings);
    assert_eq!(robot.state().preferences.scene, opens_it_again);

    let mut bytes = std::fs::read(&path).expect("a file");
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    std::fs::write(&path, bytes).expect("a file");
    drop(&mut robot, &path);
    let said = robot.state().notice().expect("a complaint").0.text.clone();
    let options = ["--duration", "1", "--restart", path.to_str().expect("UTF-8")];
    assert_eq!(format!("slump: {said}\n"), headless(&options, &folder.path().join("new")));
    assert!(said.contains("is damaged"), "{said}");
    assert_eq!(robot.steps(), 7, "the run before is still there");
}

#[test]
fn what_cannot_be_saved_is_told_of() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("file");
    std::fs::write(&file, "").expect("a file");
    let mut robot = open(pile(), &file);
    let said = save(&mut robot);
    assert!(said.contains("but must be a folder that can be written to"), "{said}");
    robot.state_mut().preferences.folder = folder.path().to_owned();
    take_steps(&mut robot, 1);
    robot.type_number("Δt, time step", "1e200");
    take_steps(&mut robot, 3);
    assert!(robot.world().failure.is_some());
    let said = save(&mut robot);
    let expected = "state is no longer finite, but must be an earlier one: drag the timeline back";
    assert_eq!(said, expected);
    let shown = robot.harness.query_all_by_label(expected).count();
    assert_eq!(shown, 1, "a run that cannot go on hides no answer");
}
