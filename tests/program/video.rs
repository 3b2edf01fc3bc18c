//! Videos of the command line: what is in them, that they can be made again, and what is refused.

use std::path::Path;
use std::process::{Command, Output};

use crate::probed::{Probed, probe};
use crate::tested::program;

/// A cradle on its way, drawn by the processor.
const CRADLE: [&str; 11] = [
    "--headless",
    "--scene",
    "cradle",
    "--dt",
    "1e-3",
    "--duration",
    "0.2",
    "--size",
    "320x90",
    "--renderer",
    "cpu",
];

fn slump(arguments: &[&str]) -> Output {
    Command::new(program()).args(arguments).output().expect("the program starts")
}

/// Makes a video, and tells what is in it.
fn made(more: &[&str], video: &Path) -> Probed {
    let path = video.to_str().expect("UTF-8");
    let output = slump(&[&CRADLE[..], more, &["--video", path]].concat());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let said = String::from_utf8_lossy(&output.stdout);
    assert!(said.lines().any(|line| line == path), "it says where: {said}");
    probe(video)
}

/// Names of what is in a folder.
fn names(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).expect("a folder");
    entries.map(|it| it.expect("an entry").file_name().into_string().expect("UTF-8")).collect()
}

#[test]
fn a_video_goes_at_the_pace_of_time_and_can_be_made_again() {
    let folder = tempfile::tempdir().expect("a folder");
    let first = folder.path().join("first.mp4");
    let told = made(&["--fps", "50", "--show", "forces"], &first);
    // The first picture at 0 and the last at 0.2 s.
    assert_eq!((told.pictures, &*told.rate_hz, told.size), (11, "50/1", [320, 90]));
    assert_eq!(told.key_pictures, [1], "one a second");
    assert_eq!([&*told.codec, &told.pixels, &told.colours], ["h264", "yuv420p", "bt709"]);
    // The command that it carries makes the same file, to the last bit.
    let line = told
        .comment
        .lines()
        .find_map(|line| line.strip_prefix("Command line: "))
        .expect("a command");
    let words = shlex::split(line).expect("words");
    assert_eq!(words[words.len() - 2..], ["--video", "video.mp4"], "{line}");
    let again = folder.path().join("again.mp4");
    let mut words: Vec<&str> = words[1..words.len() - 1].iter().map(String::as_str).collect();
    words.extend([again.to_str().expect("UTF-8"), "--renderer", "cpu"]);
    let output = slump(&words);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let read = |path| std::fs::read(path).expect("a video");
    assert!(read(again) == read(first), "{line}");
    assert_eq!(names(folder.path()).len(), 2, "nothing else is left");
}

#[test]
fn a_slower_video_has_more_pictures_of_the_same_stretch() {
    let folder = tempfile::tempdir().expect("a folder");
    let told = made(&["--video-speed", "0.5"], &folder.path().join("slow.mp4"));
    // 25 a second of the video, 50 per simulated second.
    assert_eq!((told.pictures, &*told.rate_hz), (11, "25/1"));
    assert!(told.comment.contains("--video-speed 0.5"), "{}", told.comment);
}

#[test]
fn frames_and_video_show_the_same() {
    let folder = tempfile::tempdir().expect("a folder");
    let frames = folder.path().join("frames");
    let video = folder.path().join("both.mp4");
    let told = made(&["--colour", "speed", "--frames", frames.to_str().expect("UTF-8")], &video);
    let mut pictures = names(&frames);
    pictures.retain(|name| name.ends_with(".png"));
    pictures.sort();
    assert_eq!(told.pictures, pictures.len());
    assert_eq!(told.key_pictures, [1]);

    // Decoded as the standard says.
    let mut decoder = Command::new("ffmpeg");
    decoder.args(["-v", "error", "-i"]).arg(&video);
    decoder.args(["-vf", "scale=in_color_matrix=bt709:in_range=tv,format=rgb24"]);
    let decoded = decoder.args(["-f", "rawvideo", "-"]).output().expect("ffmpeg").stdout;
    assert_eq!(decoded.len(), told.pictures * 320 * 90 * 3);
    for (name, decoded) in pictures.iter().zip(decoded.chunks(320 * 90 * 3)) {
        let frame = image::open(frames.join(name)).expect("a picture").into_rgb8();
        let apart = frame.iter().zip(decoded).map(|(a, b)| f64::from(a.abs_diff(*b)).powi(2));
        let mean = apart.sum::<f64>() / decoded.len() as f64;
        assert!(mean < 20.0, "{name}: {mean} is a PSNR below 35 dB");
    }
}

#[test]
fn what_makes_no_video_is_refused_before_anything_is_written() {
    let folder = tempfile::tempdir().expect("a folder");
    let video = folder.path().join("a.mp4");
    let path = video.to_str().expect("UTF-8");
    let cases: [(&[&str], &str); 6] = [
        (&["--video", path, "--size", "321x90"], "size is 321x90, but must be even"),
        (&["--video", path, "--size", "14x90"], "from 16 to 16384 pixels"),
        (&["--video", path, "--fps", "1000"], "fps is 1000 at --video-speed 1, but must be such"),
        (
            &["--video", path, "--video-speed", "0"],
            "video-speed is 0, but must be a finite number > 0",
        ),
        (&["--gif", path, "--video-speed", "2"], "left out where --video is not given"),
        (&["--video", path, "--times", "0.1"], "must be left out where --times is"),
    ];
    for (more, expected) in cases {
        let output = slump(&[&["--headless", "--scene", "cradle"], more].concat());
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{more:?}: {said}");
        assert!(said.contains(expected), "{more:?}: {said}");
    }
    assert_eq!(names(folder.path()).len(), 0);
}

#[test]
fn where_there_is_no_ffmpeg_one_is_told_before_anything_is_written() {
    let folder = tempfile::tempdir().expect("a folder");
    let frames = folder.path().join("frames");
    let mut command = Command::new(program());
    command.args(CRADLE).arg("--frames").arg(&frames);
    let run = |program: &mut Command| program.env("PATH", "").output().expect("the program starts");
    let output = run(command.arg("--video").arg(folder.path().join("a.mp4")));
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{said}");
    let sentence = "must be left out where there is no ffmpeg: install it (`apt install ffmpeg`); a GIF and frames need nothing more";
    assert!(said.contains(sentence) && said.lines().count() == 1, "{said}");
    assert_eq!(names(folder.path()).len(), 0);
    let mut command = Command::new(program());
    command.args(CRADLE).arg("--frames").arg(&frames).arg("--gif");
    assert!(run(command.arg(folder.path().join("a.gif"))).status.success());
}

#[cfg(unix)]
#[test]
fn what_ffmpeg_says_last_is_told_where_it_fails() {
    use std::os::unix::fs::PermissionsExt;
    let tools = tempfile::tempdir().expect("a folder");
    let script = tools.path().join("ffmpeg");
    let lists = "case $* in *-encoders*) echo ' V..... libx264 H.264'; exit;; esac";
    // One that stops at once, and one that takes all pictures first.
    for takes in ["", "cat > /dev/null"] {
        let text =
            format!("#!/bin/sh\n{lists}\n{takes}\necho one >&2\necho 'no room' >&2\nexit 1\n");
        std::fs::write(&script, text).expect("a script");
        std::fs::set_permissions(&script, PermissionsExt::from_mode(0o755)).expect("a script");
        let folder = tempfile::tempdir().expect("a folder");
        let mut command = Command::new(program());
        command.args(CRADLE).arg("--video").arg(folder.path().join("a.mp4"));
        let paths = format!("{}:/usr/bin:/bin", tools.path().display());
        let output = command.env("PATH", paths).output().expect("the program starts");
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{said}");
        assert!(said.contains("a.mp4: ffmpeg failed: no room"), "{said}");
        assert_eq!(names(folder.path()).len(), 0, "{takes}");
    }
}

#[cfg(unix)]
#[test]
fn a_run_that_is_stopped_has_a_whole_video() {
    use std::os::unix::process::CommandExt;
    use std::time::{Duration, Instant};
    let run = |folder: &Path| {
        let mut command = Command::new(program());
        command.args(["--headless", "--bond", "20", "--dt", "1e-3", "--duration", "0.3"]);
        command.args(["--fps", "50", "--size", "160x100", "--renderer", "cpu"]);
        command.arg("--frames").arg(folder);
        command.arg("--video").arg(folder.join("a.mp4"));
        command
    };
    let stopped = tempfile::tempdir().unwrap();
    let mut child = run(stopped.path()).process_group(0).spawn().expect("the program starts");
    let begun = Instant::now();
    while !stopped.path().join("frame_00003.png").exists() {
        assert!(begun.elapsed() < Duration::from_secs(60), "no pictures");
        std::thread::sleep(Duration::from_millis(5));
    }
    // As a terminal does: to the program and to all that it has started.
    let group = format!("-{}", child.id());
    assert!(
        Command::new("kill").args(["-s", "INT", "--", &group]).status().expect("kill").success()
    );
    assert_eq!(child.wait().expect("an end").code(), Some(130));
    let part = probe(&stopped.path().join("a.mp4")).pictures;
    assert!((4..16).contains(&part), "the pictures so far: {part}");
}
