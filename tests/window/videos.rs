//! Videos that the window makes of its record.

use std::path::PathBuf;

use egui_kittest::kittest::{NodeT, Queryable};
use slump::live::Command;

use crate::animations::{self, open};
use crate::probed::probe;
use crate::recordings::take_steps;
use crate::robot::Robot;

fn made(robot: &mut Robot) -> (PathBuf, String) {
    animations::made(robot, "Save video")
}

#[test]
fn the_record_is_a_video_at_the_pace_of_time() {
    let folder = tempfile::tempdir().expect("a folder");
    // A side that is odd is one pixel longer.
    let mut robot = open(folder.path(), [161, 100]);
    take_steps(&mut robot, 200);
    // Where the timeline stands is no matter.
    robot.state_mut().live.send(Command::Seek(0.05));
    robot.settle();
    let (path, told) = made(&mut robot);
    assert!(told.ends_with(" of 6 pictures"), "0 to 0.2 s at 25 a second: {told}");
    let video = probe(&path);
    assert_eq!((video.pictures, &*video.rate_hz, video.size), (6, "25/1", [162, 100]));
    let lines = video.comment;
    assert!(lines.contains("Command line: slump --headless "), "{lines}");
    assert!(lines.contains("--duration 0.2"), "{lines}");

    // The same record makes the same file, and ten times slower ten times as many pictures.
    let (again, _) = made(&mut robot);
    assert!(std::fs::read(&path).unwrap() == std::fs::read(&again).unwrap());
    for (label, value) in [("Film", 25.0), ("pace ×", 1.0)] {
        let field = robot.harness.get_by_role_and_label(egui::Role::SpinButton, label);
        assert_eq!(field.accesskit_node().numeric_value(), Some(value), "{label}");
    }
    robot.state_mut().preferences.video_rate_hz = 50.0;
    robot.state_mut().preferences.video_speed = 0.1;
    let (slow, _) = made(&mut robot);
    assert_eq!(probe(&slow).pictures, 101);
}

#[test]
fn compared_worlds_stand_side_by_side_in_one_video() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut robot = open(folder.path(), [240, 120]);
    robot.state_mut().preferences.style.colour_by = slump::render::ColourBy::Speed;
    let base = robot.world().controls.settings;
    // The second steps so far that pictures show some of its moments twice.
    robot.state_mut().live.send(Command::Compare(vec![base.over(1e-3), base.over(5e-3)]));
    robot.settle();
    take_steps(&mut robot, 20);
    robot.state_mut().preferences.video_rate_hz = 240.0;
    let (path, _) = made(&mut robot);
    let name = path.file_name().and_then(|name| name.to_str()).expect("a name");
    assert!(name.starts_with("slump-pile-2worlds-"), "{name}");
    assert_eq!(probe(&path).pictures, 25);
}

#[test]
fn a_video_that_is_stopped_leaves_nothing_and_the_run_goes_on_meanwhile() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut robot = open(folder.path(), [640, 400]);
    take_steps(&mut robot, 300);
    robot.state_mut().preferences.video_rate_hz = 240.0;
    robot.state_mut().preferences.video_speed = 0.1;
    robot.click("Save video");
    assert!(robot.harness.query_by_label("Save video").is_none(), "one at a time");
    let before = robot.steps();
    take_steps(&mut robot, 3);
    assert!(robot.state().is_writing() && robot.steps() == before + 3, "the run goes on");
    robot.click("Stop video");
    robot.until("the end", |state| !state.is_writing());
    let told = robot.state().notice().expect("what became of it").0.text.clone();
    assert_eq!(told, "Stopped: there is no video");
    assert_eq!(std::fs::read_dir(folder.path()).expect("a folder").count(), 0);
    assert!(robot.harness.query_by_label("Save video").is_some(), "another can be asked for");
}

#[test]
fn a_place_that_takes_no_video_is_named() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("file");
    std::fs::write(&file, "").expect("a file");
    let mut robot = open(&file.join("below"), [160, 100]);
    robot.click("Save video");
    robot.until("the refusal", |state| !state.is_writing());
    let told = robot.state().notice().expect("a refusal").0.text.clone();
    assert!(told.contains("folder is") && told.contains("can be written to"), "{told}");
}
