//! Tests of videos and animations of the window's recorded run.

use std::io::BufReader;

use image::codecs::gif::GifDecoder;
use image::{AnimationDecoder, Frame, RgbaImage};

use crate::robot::*;

fn film(robot: &mut Robot) -> (PathBuf, String) {
    made(robot, "Save video")
}

/// Opens a window that writes pictures of this size (pixels) into a folder.
pub(crate) fn open(folder: &Path, size: [u32; 2]) -> Robot {
    let preferences = Preferences {
        folder: folder.to_owned(),
        picture_size: size,
        speed: 1.0,
        ..Preferences::default()
    };
    let mut robot = Robot::open_with_gpu(pile(), preferences);
    robot.click("Save");
    robot
}

/// Presses a button that lets the window write a video or an animation. Returns the path of the file and the window's
/// notice about it.
pub(crate) fn made(robot: &mut Robot, button: &str) -> (PathBuf, String) {
    robot.click(button);
    let told = robot.written();
    let path = told.strip_prefix("Saved ").and_then(|rest| rest.split(" of ").next());
    (path.unwrap_or_else(|| panic!("{told}")).into(), told)
}

fn animation(robot: &mut Robot) -> PathBuf {
    made(robot, "Save GIF").0
}

fn pictures(path: &Path) -> Vec<Frame> {
    let file = BufReader::new(std::fs::File::open(path).expect("an animation"));
    let decoder = GifDecoder::new(file).expect("a GIF");
    decoder.into_frames().collect_frames().expect("pictures")
}

fn shown_ms(frame: &Frame) -> f64 {
    let (numerator, denominator) = frame.delay().numer_denom_ms();
    f64::from(numerator) / f64::from(denominator)
}

/// Returns the mean difference of all colour channels of two pictures, from 0 to 255.
fn difference(one: &RgbaImage, other: &RgbaImage) -> f64 {
    let differences = one.as_raw().iter().zip(other.as_raw());
    let sum: u64 = differences.map(|(a, b)| u64::from(a.abs_diff(*b))).sum();
    sum as f64 / one.as_raw().len() as f64
}

/// Returns the first comment in a GIF file. The file stores a comment in blocks of at most 255 bytes, each preceded by
/// its length.
fn comment(gif: &[u8]) -> String {
    let begin = gif.windows(2).position(|two| two == [0x21, 0xfe]).expect("a comment") + 2;
    let (mut rest, mut words) = (&gif[begin..], Vec::new());
    while let [length, more @ ..] = rest
        && *length > 0
    {
        let (block, after) = more.split_at(usize::from(*length));
        words.extend(block);
        rest = after;
    }
    String::from_utf8(words).expect("a text")
}

#[test]
#[ignore = "needs a graphics driver"]
fn the_record_is_an_animation_at_the_pace_of_time() {
    let folder = folder();
    let mut robot = open(folder.path(), [161, 100]);
    robot.take_steps(200);
    let path = animation(&mut robot);
    let frames = pictures(&path);
    assert_eq!(frames.len(), 6, "0 to 0.2 s at 25 a second");
    for frame in &frames {
        assert_eq!(shown_ms(frame), 40.0);
        assert_eq!(frame.buffer().dimensions(), (161, 100));
    }
    assert!(difference(frames[0].buffer(), frames[5].buffer()) > 0.5, "the pile moves");
    // The file contains the facts about its origin, and the same recorded run gives the same file.
    let bytes = bytes(&path);
    let said = comment(&bytes);
    assert!(said.contains("Command line: slump --headless "), "{said}");
    assert!(bytes == std::fs::read(animation(&mut robot)).unwrap());
}

/// Checks that an animation shows time at the chosen speed, even if its frame rate is impossible. The duration of a
/// picture in a GIF is a multiple of 10 ms and at least 20 ms, so another rate needs another number of pictures.
#[test]
#[ignore = "needs a graphics driver"]
fn an_animation_keeps_its_pace_where_it_cannot_have_the_pictures_asked_for() {
    let folder = folder();
    let mut robot = open(folder.path(), [161, 100]);
    robot.take_steps(200);
    for (rate_hz, pictures_made, each_ms) in [(240.0, 11, 20.0), (60.0, 11, 20.0), (30.0, 7, 30.0)]
    {
        robot.state_mut().preferences.video_rate_hz = rate_hz;
        let frames = pictures(&animation(&mut robot));
        assert_eq!(frames.len(), pictures_made, "{rate_hz}");
        assert!(frames.iter().all(|frame| shown_ms(frame) == each_ms), "{rate_hz}");
    }
}

#[test]
#[ignore = "needs a graphics driver"]
fn an_animation_that_is_stopped_leaves_nothing() {
    let folder = folder();
    let mut robot = open(folder.path(), [640, 400]);
    robot.take_steps(300);
    robot.state_mut().preferences.speed = 0.01;
    robot.clicks(&["Save GIF", "Stop GIF"]);
    assert_eq!(robot.written(), "Stopped: no GIF is saved");
    assert_eq!(std::fs::read_dir(folder.path()).expect("a folder").count(), 0);
}

mod with_ffmpeg {
    use crate::probed::probe;

    use super::*;

    #[test]
    #[ignore = "needs ffmpeg and a graphics driver"]
    fn the_record_is_a_video_at_the_pace_of_time() {
        let folder = folder();
        // An odd side becomes one pixel longer.
        let mut robot = open(folder.path(), [161, 100]);
        robot.take_steps(200);
        // The video must not depend on the position of the timeline.
        robot.seek(0.05);
        let (path, told) = film(&mut robot);
        assert!(told.ends_with(" of 6 pictures"), "0 to 0.2 s at 25 a second: {told}");
        let video = probe(&path);
        assert_eq!((video.pictures, &*video.rate_hz, video.size), (6, "25/1", [162, 100]));
        let lines = video.comment;
        assert!(lines.contains("Command line: slump --headless "), "{lines}");
        assert!(lines.contains("--duration 0.2"), "{lines}");
        // The same recorded run gives the same file. Ten times slower, it has ten times as many pictures.
        let (again, _) = film(&mut robot);
        assert!(std::fs::read(&path).unwrap() == std::fs::read(&again).unwrap());
        let field = robot.harness.get_by_role_and_label(egui::Role::SpinButton, "Film");
        assert_eq!(field.accesskit_node().numeric_value(), Some(25.0));
        assert!(robot.shows("at the pace of the window, 1×"));
        robot.state_mut().preferences.video_rate_hz = 50.0;
        robot.state_mut().preferences.speed = 0.1;
        let (slow, _) = film(&mut robot);
        assert_eq!(probe(&slow).pictures, 101);
    }

    #[test]
    #[ignore = "needs ffmpeg and a graphics driver"]
    fn compared_worlds_stand_side_by_side_in_one_video() {
        let folder = folder();
        let mut robot = open(folder.path(), [240, 120]);
        robot.state_mut().preferences.style.colour_by = slump::render::ColourBy::Speed;
        let base = robot.settings();
        // The steps of the second simulation are so long that two consecutive pictures can show the same state.
        robot.send(Command::Compare(vec![base.over(1e-3), base.over(5e-3)]));
        robot.take_steps(20);
        robot.state_mut().preferences.video_rate_hz = 240.0;
        let (path, _) = film(&mut robot);
        let name = path.file_name().and_then(|name| name.to_str()).expect("a name");
        assert!(name.starts_with("slump-pile-2worlds-"), "{name}");
        assert_eq!(probe(&path).pictures, 25);
    }

    #[test]
    #[ignore = "needs ffmpeg and a graphics driver"]
    fn a_video_that_is_stopped_leaves_nothing_and_the_run_goes_on_meanwhile() {
        let folder = folder();
        let mut robot = open(folder.path(), [640, 400]);
        robot.take_steps(300);
        robot.state_mut().preferences.video_rate_hz = 240.0;
        robot.state_mut().preferences.speed = 0.1;
        robot.click("Save video");
        assert!(robot.harness.query_by_label("Save video").is_none(), "one at a time");
        let before = robot.steps();
        robot.take_steps(3);
        assert!(robot.state().is_writing() && robot.steps() == before + 3, "the run goes on");
        robot.click("Stop video");
        assert_eq!(robot.written(), "Stopped: no video is saved");
        assert_eq!(std::fs::read_dir(folder.path()).expect("a folder").count(), 0);
        assert!(robot.harness.query_by_label("Save video").is_some(), "another can be asked for");
    }

    #[test]
    #[ignore = "needs ffmpeg and a graphics driver"]
    fn a_place_that_takes_no_video_is_named() {
        let folder = folder();
        let file = folder.path().join("file");
        write(&file, "");
        let mut robot = open(&file.join("below"), [160, 100]);
        robot.click("Save video");
        let told = robot.written();
        assert!(told.contains("folder is") && told.contains("can be written to"), "{told}");
    }
}

#[test]
#[ignore = "needs a graphics driver"]
fn one_click_makes_a_gif_that_lasts_five_seconds() {
    let folder = folder();
    let mut robot = open(folder.path(), [160, 100]);
    robot.take_steps(40);
    let (path, _) = made(&mut robot, "GIF of 5 s");
    let shown: f64 = pictures(&path).iter().map(shown_ms).sum();
    assert!((5000.0..5100.0).contains(&shown), "{shown} ms");
}
