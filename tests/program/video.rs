//! Tests of videos that the command line writes: their contents, commands that make the same video again, and error
//! messages.

use crate::program::*;

/// Arguments of a run of the scene `cradle` whose pictures are drawn by the processor.
const CRADLE: &str =
    "--headless --scene cradle --dt 1e-3 --duration 0.2 --size 320x90 --renderer cpu";

#[test]
fn what_makes_no_video_is_refused_before_anything_is_written() {
    let folder = folder();
    let video = folder.path().join("a.mp4");
    let path = text(&video);
    let other = ["a.gif", "a.webm", "a.mkv", "a.avi", "a"].map(|name| folder.path().join(name));
    for path in &other {
        let said = sentence(slump(CRADLE).arg("--video").arg(path));
        let expected = "must be a name that ends with .mp4, as the file is written in that format: --gif makes a GIF";
        assert!(said.starts_with("slump: video is ") && said.ends_with(expected), "{said}");
    }
    let cases: [(&[&str], &str); 7] = [
        (&["--gif", path], "a.mp4, but must be a name that ends with .gif"),
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
        let said = failure(slump("--headless --scene cradle").args(more));
        assert!(said.contains(expected), "{more:?}: {said}");
    }
    assert_eq!(names_in(folder.path()).len(), 0);
}

#[test]
fn where_there_is_no_ffmpeg_one_is_told_before_anything_is_written() {
    let folder = folder();
    let frames = folder.path().join("frames");
    let mut command = slump(CRADLE);
    command.env("PATH", "").arg("--frames").arg(&frames);
    let said = failure(command.arg("--video").arg(folder.path().join("a.mp4")));
    let expected = "must be left out where there is no ffmpeg: install it (`apt install ffmpeg`); a GIF and frames need nothing more";
    assert!(said.contains(expected) && said.lines().count() == 1, "{said}");
    assert_eq!(names_in(folder.path()).len(), 0);
    let mut command = slump(CRADLE);
    command.env("PATH", "").arg("--frames").arg(&frames).arg("--gif");
    succeed(command.arg(folder.path().join("a.gif")));
}

#[cfg(unix)]
#[test]
fn what_ffmpeg_says_last_is_told_where_it_fails() {
    use std::os::unix::fs::PermissionsExt;
    let tools = folder();
    let script = tools.path().join("ffmpeg");
    let lists = "case $* in *-encoders*) echo ' V..... libx264 H.264'; exit;; esac";
    // Scripts in place of the encoder `ffmpeg`: one stops at once, the other reads all pictures first.
    for takes in ["", "cat > /dev/null"] {
        let text =
            format!("#!/bin/sh\n{lists}\n{takes}\necho one >&2\necho 'no room' >&2\nexit 1\n");
        write(&script, text);
        std::fs::set_permissions(&script, PermissionsExt::from_mode(0o755)).expect("a script");
        let folder = folder();
        let paths = format!("{}:/usr/bin:/bin", tools.path().display());
        let video = folder.path().join("a.mp4");
        let said = failure(slump(CRADLE).arg("--video").arg(video).env("PATH", paths));
        assert!(said.contains("a.mp4: ffmpeg failed: no room"), "{said}");
        assert_eq!(names_in(folder.path()).len(), 0, "{takes}");
    }
}

mod with_ffmpeg {
    use crate::probed::{Probed, probe};

    use super::*;

    fn made(more: &[&str], video: &Path) -> Probed {
        let output = run(slump(CRADLE).args(more).arg("--video").arg(video));
        assert!(output.status.success(), "{}", said(&output));
        let told = String::from_utf8_lossy(&output.stdout);
        assert!(told.lines().any(|line| line == text(video)), "it says where: {told}");
        probe(video)
    }

    #[test]
    #[ignore = "needs ffmpeg"]
    fn a_video_goes_at_the_pace_of_time_and_can_be_made_again() {
        let folder = folder();
        let first = folder.path().join("first.mp4");
        let told = made(&["--fps", "50", "--show", "forces"], &first);
        // The first picture shows t = 0, the last t = 0.2 s.
        assert_eq!((told.pictures, &*told.rate_hz, told.size), (11, "50/1", [320, 90]));
        assert_eq!(told.key_pictures, [1], "one a second");
        assert_eq!([&*told.codec, &told.pixels, &told.colours], ["h264", "yuv420p", "bt709"]);
        // The command in the comment of the video file makes the same file, bitwise.
        let line = told
            .comment
            .lines()
            .find_map(|line| line.strip_prefix("Command line: "))
            .expect("a command");
        let words = shlex::split(line).expect("words");
        assert_eq!(words[words.len() - 2..], ["--video", "video.mp4"], "{line}");
        let again = folder.path().join("again.mp4");
        let mut words: Vec<&str> = words[1..words.len() - 1].iter().map(String::as_str).collect();
        words.extend([text(&again), "--renderer", "cpu"]);
        succeed(slump("").args(words));
        assert!(bytes(again) == bytes(first), "{line}");
        assert_eq!(names_in(folder.path()).len(), 2, "nothing else is left");
    }

    #[test]
    #[ignore = "needs ffmpeg"]
    fn a_slower_video_has_more_pictures_of_the_same_stretch() {
        let folder = folder();
        let told = made(&["--video-speed", "0.5"], &folder.path().join("slow.mp4"));
        // 25 pictures per second of video are 50 pictures per simulated second.
        assert_eq!((told.pictures, &*told.rate_hz), (11, "25/1"));
        assert!(told.comment.contains("--video-speed 0.5"), "{}", told.comment);
    }

    #[test]
    #[ignore = "needs ffmpeg"]
    fn frames_and_video_show_the_same() {
        let folder = folder();
        let frames = folder.path().join("frames");
        let video = folder.path().join("both.mp4");
        let told = made(&["--colour", "speed", "--frames", text(&frames)], &video);
        let mut pictures = names_in(&frames);
        pictures.retain(|name| name.ends_with(".png"));
        assert_eq!(told.pictures, pictures.len());
        assert_eq!(told.key_pictures, [1]);
        // The video is decoded with the colour matrix and range that its standard (BT.709) demands.
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

    #[cfg(unix)]
    #[test]
    #[ignore = "needs ffmpeg"]
    fn a_run_that_is_stopped_has_a_whole_video_and_leaves_what_it_would_have_left_when_it_goes_on()
    {
        use std::os::unix::process::CommandExt;
        let run = |folder: &Path| {
            let mut command = slump(
                "--headless --bond 20 --dt 1e-3 --duration 0.3 --fps 50 --size 160x100 --renderer cpu \
                 --checkpoint-every 100 --frames",
            );
            command.arg(folder).arg("--video").arg(folder.join("a.mp4"));
            command
        };
        let (whole, stopped) = (folder(), folder());
        succeed(&mut run(whole.path()));
        let whole = whole.path().join("a.mp4");
        assert_eq!(probe(&whole).pictures, 16);
        let whole = bytes(whole);

        let mut child = run(stopped.path()).process_group(0).spawn().expect("the program starts");
        wait_for("pictures", || stopped.path().join("frame_00003.png").exists());
        // The signal goes to the program and to all programs that it has started, as from a terminal.
        send("INT", -i64::from(child.id()));
        assert_eq!(ended(&mut child), Some(130));
        let video = stopped.path().join("a.mp4");
        let part = probe(&video).pictures;
        assert!((4..16).contains(&part), "the pictures so far: {part}");
        succeed(&mut run(stopped.path()));
        assert!(bytes(&video) == whole, "as if it had not been stopped");
    }
}
