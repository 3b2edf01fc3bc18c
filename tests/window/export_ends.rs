//! How exports end: while the run goes on, stopped, refused, and where a run blew up.

use egui_kittest::kittest::Queryable;
use slump::config::Config;
use slump::data::{FormatName, read_grains};
use slump::live::Command as Live;

use crate::recordings::{export, facts, headless, open, said_in, take_steps};
use crate::robot::pile;
use crate::tables::{parquet, steps};

#[test]
fn a_run_goes_on_while_it_is_exported() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut robot = open(pile(), folder.path(), &[FormatName::Csv]);
    robot.state_mut().preferences.full_speed = true;
    robot.key(egui::Key::Space);
    robot.until("some steps", |state| state.world().unwrap().snapshot.observables.step >= 40);
    robot.click("Export data");
    let asked = robot.steps();
    robot.until("the export", |state| !state.is_writing());
    assert!(robot.state().frame.playing && robot.steps() > asked);
    let mut scene = pile().scene(|_| true).expect("a scene");
    // The window solves steps that are not solved otherwise, and how many steps there are is the machine's affair.
    scene.set_settings(robot.world().controls.settings);
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
    let folder = tempfile::tempdir().expect("a folder");
    let mut robot = open(pile(), folder.path(), FormatName::ALL);
    take_steps(&mut robot, 400);
    robot.click("Export data");
    let index = folder.path().join("frames.csv");
    let has_frames = || std::fs::read_to_string(&index).is_ok_and(|it| it.lines().count() > 10);
    robot.until("frames", |_| has_frames());
    robot.click("Stop export");
    robot.until("the end", |state| !state.is_writing());
    let told = robot.state().notice().expect("what became of it").0.text.clone();
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
    let folder = tempfile::tempdir().expect("a folder");
    let there = folder.path().join("there");
    let mut robot = open(Config::of_scene("cradle"), &there, &[FormatName::Csv]);
    take_steps(&mut robot, 3);
    assert!(export(&mut robot).starts_with("4 frames of data"));
    let before = std::fs::read(there.join("csv/grains.csv")).expect("a table");

    // An earlier recording, and a place that no folder can be made at.
    take_steps(&mut robot, 2);
    let file = folder.path().join("file");
    std::fs::write(&file, "").expect("a file");
    for place in [there.clone(), file.join("below")] {
        robot.state_mut().preferences.data.folder.clone_from(&place);
        let refused = headless(&["--scene", "cradle", "--duration", "0.01"], &place);
        assert_eq!(format!("slump: {}\n", export(&mut robot)), refused);
        assert!(refused.contains("but must be a folder"), "{refused}");
    }
    assert_eq!(std::fs::read(there.join("csv/grains.csv")).expect("a table"), before);

    // As --overwrite does, once.
    robot.state_mut().preferences.data.folder = there;
    robot.click("Overwrite");
    assert!(export(&mut robot).starts_with("6 frames of data"));
    assert!(export(&mut robot).contains("without an earlier recording"));
    let shown = robot.harness.query_all_by_label_contains("without an earlier recording");
    assert_eq!(shown.count(), 2, "in the status bar and beside the button");

    // Where nothing is chosen to be written, there is nothing to be asked for.
    robot.click("Text (CSV)");
    robot.click("Export data");
    assert!(!robot.state().is_writing());
}

#[test]
fn a_run_that_blew_up_is_exported_up_to_its_last_finite_state() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut robot = open(pile(), folder.path(), &[FormatName::Csv]);
    take_steps(&mut robot, 2);
    robot.type_number("Δt, time step", "1e200");
    take_steps(&mut robot, 3);
    assert!(robot.world().failure.is_some());
    let told = export(&mut robot);
    let last = robot.steps() - 1;
    assert!(told.starts_with(&format!("{} frames of data in", last + 1)), "{told}");
    assert!(told.ends_with("up to the last step with a finite state"), "{told}");
}

#[test]
fn of_compared_worlds_the_selected_one_is_exported() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut robot = open(pile(), folder.path(), &[FormatName::Csv]);
    let same = robot.world().controls.settings;
    let mut other = same;
    other.parameters.bond = 0.0;
    robot.state_mut().live.send(Live::Compare(vec![other, same]));
    robot.settle();
    take_steps(&mut robot, 2);
    let title = robot.harness.query_by_label_contains("Data of world 1");
    assert!(title.is_some(), "the panel says which");
    export(&mut robot);
    assert_eq!(facts(folder.path())["parameters.bond"], "0.0");
}
