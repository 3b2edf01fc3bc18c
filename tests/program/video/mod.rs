//! Videos of the command line: what is in them, that they can be made again, and what is refused.

use std::path::Path;
use std::process::{Command, Output};

use mp4_atom::{Decode, Ftyp, Ilst, Moov, StszSamples};

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
    let mut program = Command::new(assert_cmd::cargo::cargo_bin!("slump"));
    program.args(arguments).output().expect("the program starts")
}

/// Makes a video, and gives the file's bytes.
fn made(more: &[&str], video: &Path) -> Vec<u8> {
    let path = video.to_str().expect("UTF-8");
    let output = slump(&[&CRADLE[..], more, &["--video", path]].concat());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let said = String::from_utf8_lossy(&output.stdout);
    assert!(said.lines().any(|line| line == path), "it says where: {said}");
    std::fs::read(video).expect("a video")
}

/// The head of a video.
fn head(bytes: &[u8]) -> Moov {
    let mut rest = bytes;
    Ftyp::decode(&mut rest).expect("a kind of file");
    Moov::decode(&mut rest).expect("a head")
}

/// How many pictures there are, how many ticks each is shown, and what the file says of itself.
fn told(bytes: &[u8]) -> (usize, u32, String) {
    let moov = head(bytes);
    let table = &moov.trak[0].mdia.minf.stbl;
    let StszSamples::Different { sizes } = &table.stsz.samples else { panic!("{table:?}") };
    let said = moov.udta.and_then(|said| said.meta).expect("metadata");
    let lines = said.get::<Ilst>().and_then(|list| list.desc.as_ref()).expect("a description");
    (sizes.len(), table.stts.entries[0].sample_delta, lines.text.clone())
}

#[test]
fn a_video_goes_at_the_pace_of_time_and_can_be_made_again() {
    let folder = tempfile::tempdir().expect("a folder");
    let first = made(&["--fps", "50", "--show", "forces"], &folder.path().join("first.mp4"));
    let (pictures, ticks, said) = told(&first);
    // Eleven pictures at 50 a second, the first at 0 and the last at 0.2 s; a second has 90,000 ticks.
    assert_eq!((pictures, ticks), (11, 1_800));
    // The command that it carries makes the same file, to the last bit.
    let line =
        said.lines().find_map(|line| line.strip_prefix("Command line: ")).expect("a command");
    let words = shlex::split(line).expect("words");
    assert_eq!(words[words.len() - 2..], ["--video", "video.mp4"], "{line}");
    let again = folder.path().join("again.mp4");
    let mut words: Vec<&str> = words[1..words.len() - 1].iter().map(String::as_str).collect();
    words.extend([again.to_str().expect("UTF-8"), "--renderer", "cpu"]);
    let output = slump(&words);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(std::fs::read(again).expect("a video") == first, "{line}");
}

#[test]
fn a_slower_video_has_more_pictures_of_the_same_stretch() {
    let folder = tempfile::tempdir().expect("a folder");
    let video = made(&["--video-speed", "0.5"], &folder.path().join("slow.mp4"));
    // 25 a second of the video, 50 per simulated second.
    let (pictures, ticks, said) = told(&video);
    assert_eq!((pictures, ticks), (11, 3_600));
    assert!(said.contains("--video-speed 0.5"), "{said}");
}

#[test]
fn frames_and_video_come_of_one_run() {
    let folder = tempfile::tempdir().expect("a folder");
    let frames = folder.path().join("frames");
    let video = folder.path().join("both.mp4");
    let bytes = made(&["--frames", frames.to_str().expect("UTF-8")], &video);
    let names = std::fs::read_dir(&frames).expect("a folder");
    let drawn = names.filter(|name| {
        name.as_ref().is_ok_and(|name| name.path().extension().is_some_and(|it| it == "png"))
    });
    assert_eq!(told(&bytes).0, drawn.count());
    let moov = head(&bytes);
    let key_pictures = moov.trak[0].mdia.minf.stbl.stss.as_ref().expect("key pictures");
    assert_eq!(key_pictures.entries, [1]);
}

#[test]
fn what_makes_no_video_is_refused_before_anything_is_written() {
    let folder = tempfile::tempdir().expect("a folder");
    let video = folder.path().join("a.mp4");
    let path = video.to_str().expect("UTF-8");
    let cases: [(&[&str], &str); 6] = [
        (&["--video", path, "--size", "321x90"], "size is 321x90, but must be even"),
        (&["--video", path, "--size", "14x90"], "from 16 to 65534 pixels"),
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
    assert_eq!(std::fs::read_dir(folder.path()).expect("a folder").count(), 0);
}

#[cfg(unix)]
#[test]
fn a_run_that_is_stopped_has_a_whole_video_and_leaves_what_it_would_have_left_when_it_goes_on() {
    use std::time::{Duration, Instant};
    let run = |folder: &Path| {
        let mut program = Command::new(assert_cmd::cargo::cargo_bin!("slump"));
        program.args(["--headless", "--bond", "20", "--dt", "1e-3", "--duration", "0.3"]);
        program.args(["--fps", "50", "--size", "160x100", "--renderer", "cpu"]);
        program.args(["--checkpoint-every", "100", "--frames"]).arg(folder);
        program.arg("--video").arg(folder.join("a.mp4"));
        program
    };
    let (whole, stopped) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    assert!(run(whole.path()).output().expect("the program starts").status.success());
    let whole = std::fs::read(whole.path().join("a.mp4")).expect("a video");
    assert_eq!(told(&whole).0, 16);

    let mut child = run(stopped.path()).spawn().expect("the program starts");
    let begun = Instant::now();
    while !stopped.path().join("frame_00003.png").exists() {
        assert!(begun.elapsed() < Duration::from_secs(60), "no pictures");
        std::thread::sleep(Duration::from_millis(5));
    }
    let id = child.id().to_string();
    assert!(Command::new("kill").args(["-s", "TERM", &id]).status().expect("kill").success());
    assert_eq!(child.wait().expect("an end").code(), Some(143));
    let video = stopped.path().join("a.mp4");
    let part = told(&std::fs::read(&video).expect("a video")).0;
    assert!((4..16).contains(&part), "the pictures so far: {part}");
    assert!(run(stopped.path()).output().expect("the program starts").status.success());
    assert!(std::fs::read(&video).expect("a video") == whole, "as if it had not been stopped");
}
