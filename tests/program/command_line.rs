//! The program as a user starts it: what it writes, and what it says of bad input.

use std::path::Path;

use assert_cmd::Command;
use tempfile::TempDir;

fn slump() -> Command {
    Command::new(crate::tested::program())
}

fn folder() -> TempDir {
    tempfile::tempdir().expect("a temporary folder")
}

/// Runs the program, checks that it refuses with code 2 and one line, and gives the line.
fn refusal(arguments: &[&str]) -> String {
    let output = slump().args(arguments).output().expect("the program starts");
    assert_eq!(output.status.code(), Some(2), "{arguments:?} must be refused");
    let said = String::from_utf8(output.stderr).expect("UTF-8");
    assert_eq!(
        said.trim_end().lines().count(),
        1,
        "{arguments:?} said more than a sentence: {said}"
    );
    assert!(!said.contains("panicked"), "{said}");
    said
}

fn names_in(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).expect("a folder");
    let mut names: Vec<_> = entries
        .map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    names
}

#[test]
fn a_value_outside_its_range_is_named_with_its_range_and_nothing_is_written() {
    let cases: [(&[&str], &str, &str); 28] = [
        (&["--bond", "-1"], "bond is -1", "≥ 0"),
        (&["--dt", "0"], "dt is 0", "> 0"),
        (&["--dt", "nan"], "dt is NaN", "> 0"),
        (&["--dt", "-0.001"], "dt is -0.001", "> 0"),
        (&["--rho", "1.5"], "rho is 1.5", "between 0 and 1"),
        (&["--rho", "nan"], "rho is NaN", "between 0 and 1"),
        (&["--mu", "-0.1"], "mu is -0.1", "≥ 0"),
        (&["--duration", "0"], "duration is 0", "> 0"),
        (&["--tolerance", "0"], "tolerance is 0", "> 0"),
        (&["--max-sweeps", "0"], "max-sweeps is 0", "at least 1"),
        (&["--scene", "heap"], "scene is heap", "pile, cradle, collision"),
        (&["--max-travel", "-1"], "max-travel is -1", "0 never cuts a step"),
        (&["--stepper", "range", "--push-out", "true"], "push-out is given", "it goes with moreau"),
        (
            &["--stepper", "range", "--calm-unsolved", "true"],
            "calm-unsolved is given",
            "stepper is range",
        ),
        (
            &["--stepper", "range", "--sequential-impacts", "true"],
            "sequential-imp",
            "stepper is range",
        ),
        (&["--scene", "none.toml"], "none.toml", "No such file"),
        (&["--initial", "none.csv"], "none.csv", "No such file"),
        (&["--solver", "magic"], "magic", "nsgs"),
        (&["--size", "0x0"], "size is 0x0", "at least 1"),
        (&["--size", "ten"], "size is ten", "WIDTHxHEIGHT"),
        (&["--size", "999999x10"], "size is 999999x10", "between 1x1"),
        (&["--times", "5"], "times is 5", "between 0 and the duration"),
        (&["--fps", "0"], "fps is 0", "> 0"),
        (&["--grains", "0"], "grains is 0", "between 1 and"),
        (&["--box-width", "nan"], "box-width is NaN", "between 1.3"),
        (&["--scene", "cradle", "--seed", "3"], "scene is cradle", "pile"),
        (&["--bond", "much"], "much", "--bond"),
        (&["--renderer", "brush"], "brush", "vulkan, gl, cpu"),
    ];
    let folder = folder();
    let out = folder.path().join("out");
    for (arguments, field, allowed) in cases {
        let mut all = vec!["--headless", "--frames", out.to_str().expect("UTF-8")];
        all.extend(arguments);
        let said = refusal(&all);
        assert!(said.contains(field) && said.contains(allowed), "{arguments:?}: {said}");
        assert!(!out.exists(), "{arguments:?} was refused, but {} is there", out.display());
    }
}

#[test]
fn an_unknown_challenge_is_told_of_with_those_there_are() {
    let said = refusal(&["stability", "heap"]);
    assert!(said.contains("scene is heap, but must be one of column, sag, mass-ratio"), "{said}");
}

#[test]
fn a_folder_that_cannot_be_written_is_named() {
    let folder = folder();
    let file = folder.path().join("file");
    std::fs::write(&file, "kept").expect("a file");
    let said =
        refusal(&["--headless", "--scene", "cradle", "--frames", file.to_str().expect("UTF-8")]);
    let sentence = format!("slump: frames is {}, but must be a folder that can", file.display());
    assert!(said.starts_with(&sentence), "{said}");
    assert_eq!(std::fs::read_to_string(&file).expect("the file"), "kept");
    assert!(refusal(&["--headless"]).contains("frames is missing"));
}

#[test]
fn broken_files_are_refused_with_their_line() {
    let folder = folder();
    let write = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).expect("a file");
        path.to_str().expect("UTF-8").to_owned()
    };
    let csv = write("discs.csv", "x,y,radius\n0,0.01,0.0025\n0,much,0.0025\n");
    let said = refusal(&["--headless", "--frames", "unused", "--initial", &csv]);
    assert!(said.contains("line 3") && said.contains('y'), "{said}");
    let toml = write("scene.toml", "name = \"a\"\nmean_diameter = \n");
    let said = refusal(&["--headless", "--frames", "unused", "--scene", &toml]);
    assert!(said.contains("line 2"), "{said}");
}

#[test]
fn frames_observables_manifest_and_animation_of_a_scene() {
    let folder = folder();
    let out = folder.path().join("deep/out");
    let gif = folder.path().join("cradle.gif");
    slump()
        .args(["--headless", "--scene", "cradle", "--dt", "1e-3", "--duration", "0.2"])
        .args(["--fps", "20", "--size", "320x90", "--show", "forces", "--colour", "speed"])
        .arg("--frames")
        .arg(&out)
        .arg("--gif")
        .arg(&gif)
        .assert()
        .success();
    let mut expected: Vec<_> = (0..=4).map(|number| format!("frame_{number:05}.png")).collect();
    expected.extend(["manifest.json".to_owned(), "observables.csv".to_owned()]);
    assert_eq!(names_in(&out), expected);
    let frame = image::open(out.join("frame_00004.png")).expect("a PNG");
    assert_eq!((frame.width(), frame.height()), (320, 90));

    let rows = std::fs::read_to_string(out.join("observables.csv")).expect("observables");
    assert_eq!(rows.lines().count(), 1 + 200, "a header and a row a step");
    let manifest = std::fs::read_to_string(out.join("manifest.json")).expect("a manifest");
    let manifest: serde_json::Value = serde_json::from_str(&manifest).expect("JSON");
    assert_eq!(manifest["runs"][0]["scene"]["parameters"]["time_step_secs"], 1e-3);
    assert_eq!(manifest["runs"][0]["tally"]["steps"], 200);
    assert_eq!(manifest["pictures"].as_array().map(Vec::len), Some(5));
    let bytes = std::fs::read(&gif).expect("an animation");
    assert_eq!(&bytes[..6], b"GIF89a");
    assert_eq!(bytes.last(), Some(&0x3b), "the animation has its end");
    let has = |text: &[u8]| bytes.windows(text.len()).any(|part| part == text);
    assert!(has(b"Software: slump "), "the animation says what it is");
}

#[test]
fn a_frame_carries_the_command_that_draws_it_bit_for_bit() {
    let folder = folder();
    let out = folder.path().join("out");
    slump()
        .args(["--headless", "--scene", "cradle", "--dt", "1e-3", "--duration", "0.2"])
        .args(["--fps", "20", "--size", "320x90", "--show", "forces", "--colour", "speed"])
        .args(["--renderer", "cpu", "--frames"])
        .arg(&out)
        .assert()
        .success();
    let frame = out.join("frame_00003.png");
    let file = std::io::BufReader::new(std::fs::File::open(&frame).expect("a picture"));
    let mut reader = png::Decoder::new(file).read_info().expect("a picture");
    reader.finish().expect("a whole picture");
    let texts = &reader.info().uncompressed_latin1_text;
    let told = texts.iter().find(|text| text.keyword == "Command line").expect("a command");
    let words = shlex::split(&told.text).expect("words");
    assert!(words.contains(&"0.15".to_owned()), "{words:?}");
    let again =
        slump().current_dir(folder.path()).args(&words[1..]).args(["--renderer", "cpu"]).assert();
    again.success();
    let bytes = |path: &Path| std::fs::read(path).expect("a picture");
    assert!(bytes(&folder.path().join("frames/frame_00000.png")) == bytes(&frame));
}

#[test]
#[ignore = "SLUMP_PROGRAM is to name a program built with --no-default-features"]
fn a_build_without_window_says_which_feature_brings_it() {
    assert!(refusal(&[]).contains("no window: build it with the feature window"));
}

#[test]
fn a_printed_scene_is_a_scene_file_that_gives_the_same_run() {
    let folder = folder();
    let printed = slump().args(["scene", "--scene", "cradle", "--dt", "1e-3"]).output();
    let file = folder.path().join("mine.toml");
    std::fs::write(&file, printed.expect("the program starts").stdout).expect("a file");
    let observables = |scene: &str, extra: &[&str]| {
        let out = folder.path().join(Path::new(scene).file_name().expect("a name"));
        let out = out.with_extension("out");
        slump()
            .args(["--headless", "--times", "1.6", "--scene", scene, "--frames"])
            .arg(&out)
            .args(extra)
            .assert()
            .success();
        std::fs::read_to_string(out.join("observables.csv")).expect("observables")
    };
    let from_file = observables(file.to_str().expect("UTF-8"), &[]);
    assert!(from_file.lines().count() > 1600);
    assert_eq!(from_file, observables("cradle", &["--dt", "1e-3"]));
}

#[test]
fn the_shipped_initial_state_is_reproduced_bit_for_bit() {
    let folder = folder();
    let out = folder.path().join("pile.csv");
    slump().args(["generate", "--out"]).arg(&out).assert().success();
    let shipped = concat!(env!("CARGO_MANIFEST_DIR"), "/assets/pile_138.csv");
    let read = |path: &Path| std::fs::read_to_string(path).expect("a file");
    assert_eq!(read(&out), read(shipped.as_ref()));
}

#[test]
fn a_run_that_blows_up_leaves_its_frames_and_says_so_in_its_manifest() {
    let folder = folder();
    // Springs in a box, with a substep far beyond the critical one.
    let output = slump()
        .args(["--headless", "--scene", "squeeze", "--stepper", "dem", "--substeps", "1"])
        .args(["--dt", "0.02", "--duration", "20", "--times", "0,0.02,0.04,20"])
        .args(["--size", "100x100", "--renderer", "cpu", "--frames"])
        .arg(folder.path())
        .output()
        .expect("the program starts");
    assert_eq!(output.status.code(), Some(2));
    let said = String::from_utf8(output.stderr).expect("UTF-8");
    assert!(said.contains("the state is no longer finite at step "), "{said}");
    assert!(!said.contains("panicked"), "{said}");

    let mut expected: Vec<_> = (0..3).map(|number| format!("frame_{number:05}.png")).collect();
    expected.extend(["manifest.json".to_owned(), "observables.csv".to_owned()]);
    assert_eq!(names_in(folder.path()), expected);
    let read = |name: &str| std::fs::read_to_string(folder.path().join(name)).expect("a file");
    let manifest: serde_json::Value = serde_json::from_str(&read("manifest.json")).expect("JSON");
    assert_eq!(manifest["pictures"].as_array().map(Vec::len), Some(3));
    let run = &manifest["runs"][0];
    let alarms = run["alarms"].as_array().expect("a list");
    let alarm = alarms.iter().find(|alarm| alarm["kind"] == "not-finite").expect("the alarm");
    let message = alarm["message"].as_str().expect("words");
    assert!(message.contains("more than 1 substeps"), "{message}");
    // The step that blew up is the last row, counted like all before it.
    let steps = run["tally"]["steps"].as_u64().expect("a number");
    assert!((3..1000).contains(&steps), "it blows up on the way: {steps} steps");
    assert_eq!(alarm["step"].as_u64(), Some(steps));
    assert_eq!(read("observables.csv").lines().count() as u64, 1 + steps);
}

#[test]
fn waiting_for_a_common_scale_changes_no_picture() {
    // All states at once against one at a time with the last state's scale: the last frame's own.
    let (all, last) = (folder(), folder());
    let style = ["--show", "forces,angles", "--colour", "overlap"];
    let run = |out: &Path, times: &str| {
        let mut command = slump();
        command.args(["--headless", "--size", "160x120", "--renderer", "cpu", "--dt", "1e-3"]);
        command.args(style).args(["--times", times, "--frames"]).arg(out).assert().success();
    };
    run(all.path(), "0.02,0.02");
    run(last.path(), "0.02");
    let read = |path: &Path| std::fs::read(path).expect("a picture");
    let one = read(&last.path().join("frame_00000.png"));
    for name in ["frame_00000.png", "frame_00001.png"] {
        assert_eq!(read(&all.path().join(name)), one);
    }
}
