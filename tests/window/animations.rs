//! Animations that the window makes of its record.

use std::fs::File;
use std::io::BufReader;
use std::path::{Path, PathBuf};

use image::codecs::gif::GifDecoder;
use image::{AnimationDecoder, Frame, RgbaImage};
use slump::app::Preferences;

use crate::recordings::take_steps;
use crate::robot::{Robot, pile};

/// A window whose pictures are so large.
pub(crate) fn open(folder: &Path, size: [u32; 2]) -> Robot {
    let preferences =
        Preferences { folder: folder.to_owned(), picture_size: size, ..Preferences::default() };
    let mut robot = Robot::open_with_gpu(pile(), preferences);
    robot.click("See");
    robot
}

/// Has a button make a file of moving pictures, and gives it and what is told of it.
pub(crate) fn made(robot: &mut Robot, button: &str) -> (PathBuf, String) {
    robot.click(button);
    robot.until("the file", |state| !state.is_writing());
    let told = robot.state().notice().expect("what became of it").0.text.clone();
    let path = told.strip_prefix("Saved ").and_then(|rest| rest.split(" of ").next());
    (path.unwrap_or_else(|| panic!("{told}")).into(), told)
}

/// Has an animation made, and gives its file.
fn animation(robot: &mut Robot) -> PathBuf {
    made(robot, "Save GIF").0
}

fn pictures(path: &Path) -> Vec<Frame> {
    let file = BufReader::new(File::open(path).expect("an animation"));
    let decoder = GifDecoder::new(file).expect("a GIF");
    decoder.into_frames().collect_frames().expect("pictures")
}

/// Milliseconds that a picture is shown.
fn shown_ms(frame: &Frame) -> f64 {
    let (numerator, denominator) = frame.delay().numer_denom_ms();
    f64::from(numerator) / f64::from(denominator)
}

/// Mean difference of the channels of two pictures, 0 … 255.
fn difference(one: &RgbaImage, other: &RgbaImage) -> f64 {
    let differences = one.as_raw().iter().zip(other.as_raw());
    let sum: u64 = differences.map(|(a, b)| u64::from(a.abs_diff(*b))).sum();
    sum as f64 / one.as_raw().len() as f64
}

#[test]
fn the_record_is_an_animation_at_the_pace_of_time() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut robot = open(folder.path(), [161, 100]);
    take_steps(&mut robot, 200);
    let path = animation(&mut robot);
    let frames = pictures(&path);
    assert_eq!(frames.len(), 6, "0 to 0.2 s at 25 a second");
    for frame in &frames {
        assert_eq!(shown_ms(frame), 40.0);
        assert_eq!(frame.buffer().dimensions(), (161, 100));
    }
    assert!(difference(frames[0].buffer(), frames[5].buffer()) > 0.5, "the pile moves");

    // It says what it is of, and the same record makes the same file.
    let bytes = std::fs::read(&path).expect("an animation");
    let said = String::from_utf8_lossy(&bytes);
    assert!(said.contains("Command line: slump --headless "), "no command line");
    assert!(bytes == std::fs::read(animation(&mut robot)).unwrap());
}

/// What a file cannot say is not asked of it: pictures follow each other by whole hundredths of a second, and by no
/// fewer than two; the pace of time stays that which was asked for.
#[test]
fn an_animation_keeps_its_pace_where_it_cannot_have_the_pictures_asked_for() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut robot = open(folder.path(), [161, 100]);
    take_steps(&mut robot, 200);
    for (rate_hz, pictures_made, each_ms) in [(240.0, 11, 20.0), (60.0, 11, 20.0), (30.0, 7, 30.0)]
    {
        robot.state_mut().preferences.video_rate_hz = rate_hz;
        let frames = pictures(&animation(&mut robot));
        assert_eq!(frames.len(), pictures_made, "{rate_hz}");
        assert!(frames.iter().all(|frame| shown_ms(frame) == each_ms), "{rate_hz}");
    }
}

#[test]
fn an_animation_that_is_stopped_leaves_nothing() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut robot = open(folder.path(), [640, 400]);
    take_steps(&mut robot, 300);
    robot.state_mut().preferences.video_speed = 0.01;
    robot.click("Save GIF");
    robot.click("Stop GIF");
    robot.until("the end", |state| !state.is_writing());
    let told = robot.state().notice().expect("what became of it").0.text.clone();
    assert_eq!(told, "Stopped: there is no GIF");
    assert_eq!(std::fs::read_dir(folder.path()).expect("a folder").count(), 0);
}
