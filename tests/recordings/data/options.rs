//! What a user asks of recordings.

use std::path::Path;

use super::tables::{number, parquet, steps};
use super::{folder, refusal, run, said, text};

/// The cradle for a tenth of a second, 100 steps.
const BRIEF: [&str; 6] = ["--scene", "cradle", "--dt", "1e-3", "--duration", "0.1"];

fn brief(more: &[&str]) {
    let output = run(&[&BRIEF, more].concat());
    assert!(output.status.success(), "{more:?}: {}", said(&output));
}

fn frames(folder: &Path) -> Vec<u64> {
    steps(&parquet(folder, "grains"))
}

#[test]
fn frames_are_at_the_times_of_the_pictures_or_at_their_own() {
    for (more, expected) in [
        (&[][..], vec![0, 40, 80]),
        (&["--fps", "50"], vec![0, 20, 40, 60, 80, 100]),
        (&["--times", "0.05,0.02"], vec![20, 50]),
        (&["--data-every", "0.025"], vec![0, 25, 50, 75, 100]),
        (&["--data-every", "0.0333"], vec![0, 33, 67, 100]),
        (&["--data-every", "0.07", "--times", "0.03"], vec![0]),
        (&["--data-every", "1e-9", "--duration", "0.003"], vec![0, 1, 2, 3]),
    ] {
        let folder = folder();
        let more = [&["--data", text(folder.path())], more].concat();
        let mut arguments = BRIEF.to_vec();
        if more.contains(&"--times") || more.contains(&"--duration") {
            arguments.truncate(4);
        }
        let output = run(&[arguments, more.clone()].concat());
        assert!(output.status.success(), "{}", said(&output));
        assert_eq!(frames(folder.path()), expected, "{more:?}");
        let told = String::from_utf8(output.stdout).expect("UTF-8");
        let expected = match expected.len() {
            1 => format!("1 frame of data in {}\n", text(folder.path())),
            count => format!("{count} frames of data in {}\n", text(folder.path())),
        };
        assert_eq!(told, expected);
    }
}

#[test]
fn data_alone_needs_no_pictures_and_pictures_may_be_in_the_same_folder() {
    let folder = folder();
    let out = text(folder.path());
    brief(&["--data", out]);
    let alone = frames(folder.path());

    let pictures = ["--frames", out, "--size", "64x18", "--renderer", "cpu"];
    brief(&[&["--data", out, "--overwrite"], &pictures[..]].concat());
    assert_eq!(frames(folder.path()), alone);
    for file in ["frame_00002.png", "observables.csv", "manifest.json", "data.json", "frames.csv"] {
        assert!(folder.path().join(file).exists(), "{file}");
    }
    // Those of the pictures are at the times of the frames.
    let manifest = std::fs::read(folder.path().join("manifest.json")).expect("a manifest");
    let manifest: serde_json::Value = serde_json::from_slice(&manifest).expect("JSON");
    let pictures = manifest["pictures"].as_array().expect("pictures");
    let step =
        |it: &serde_json::Value| it["shows"][0]["observables"]["step"].as_u64().expect("step");
    assert_eq!(pictures.iter().map(step).collect::<Vec<_>>(), alone);
}

#[test]
fn a_run_is_the_same_with_a_recording_and_without() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    let common = ["--duration", "0.06", "--fps", "50", "--size", "64x36", "--renderer", "cpu"];
    for scene in ["pile", "moving-walls"] {
        let (plain, recorded, data) = (at("plain"), at("recorded"), at("data"));
        let arguments = [&["--scene", scene, "--overwrite"], &common[..]].concat();
        let output = run(&[&arguments[..], &["--frames", text(&plain)]].concat());
        assert!(output.status.success(), "{}", said(&output));
        let more = ["--frames", text(&recorded), "--data", text(&data), "--data-every", "0.002"];
        let output = run(&[&arguments[..], &more].concat());
        assert!(output.status.success(), "{}", said(&output));
        let table = |folder: &Path| std::fs::read(folder.join("observables.csv")).expect("a table");
        assert_eq!(table(&plain), table(&recorded), "{scene}");
        // The recording's own table has the same numbers.
        let mut rows = csv::Reader::from_path(plain.join("observables.csv")).expect("a table");
        let names = rows.headers().expect("names").clone();
        let energy = names.iter().position(|name| name == "kinetic_energy").expect("a column");
        let expected: Vec<f64> =
            rows.records().map(|row| row.expect("a row")[energy].parse().expect("J")).collect();
        let found = parquet(&data, "steps");
        assert_eq!(found["kinetic_energy"].iter().map(number).collect::<Vec<_>>(), expected);
    }
}

#[test]
fn scene_files_ask_for_recordings() {
    let folder = folder();
    let scene = folder.path().join("scene.toml");
    let mut cradle = super::scene("cradle");
    cradle.duration_secs = 0.1;
    cradle.data = Some(slump::data::DataSettings {
        folder: Some("out".into()),
        every_secs: Some(0.02),
        formats: vec![slump::data::FormatName::Parquet, slump::data::FormatName::Csv],
    });
    let toml = slump::config::scene_to_toml(&cradle).expect("TOML");
    assert!(toml.contains("[data]\nfolder = \"out\"\nevery_secs = 0.02\n"), "{toml}");
    std::fs::write(&scene, toml).expect("a file");
    let output = run(&["--scene", text(&scene), "--dt", "1e-3"]);
    assert!(output.status.success(), "{}", said(&output));
    let out = folder.path().join("out");
    assert_eq!(frames(&out), [0, 20, 40, 60, 80, 100]);
    assert!(out.join("csv/grains.csv").exists());
    // The command line goes first.
    let other = folder.path().join("other");
    let more = ["--data", text(&other), "--data-every", "0.05", "--data-format", "parquet"];
    let output = run(&[&["--scene", text(&scene), "--dt", "1e-3"], &more[..]].concat());
    assert!(output.status.success(), "{}", said(&output));
    assert_eq!(frames(&other), [0, 50, 100]);
    assert!(!other.join("csv").exists());
}

#[test]
fn what_is_asked_wrongly_is_refused_before_anything_is_written() {
    let folder = folder();
    let out = folder.path().join("out");
    let refused = |more: &[&str]| refusal(&[&BRIEF, more].concat());
    for every in ["0", "-1", "nan", "inf"] {
        let said = refused(&["--data", text(&out), "--data-every", every]);
        assert!(said.starts_with("data-every is "), "{said}");
        assert!(said.ends_with("but must be a finite number of seconds > 0"), "{said}");
    }
    let said = refused(&["--data", text(&out), "--data-format", "xml"]);
    assert!(said.contains("xml") && said.contains("parquet"), "{said}");
    let said = refused(&["--frames", text(&out), "--data-every", "1"]);
    assert_eq!(said, "data-every is given, but must be given with --data DIR");
    let said = refused(&["--frames", text(&out), "--data-format", "csv"]);
    assert_eq!(said, "data-format is given, but must be given with --data DIR");
    let said = refused(&["--overwrite", "--gif", text(&folder.path().join("a.gif"))]);
    assert!(said.starts_with("overwrite is given, but must be"), "{said}");
    let said = refused(&[]);
    assert!(said.starts_with("frames is missing") && said.contains("--data DIR"), "{said}");
    assert!(!out.exists());

    let file = folder.path().join("file");
    std::fs::write(&file, "mine").expect("a file");
    let said = refused(&["--data", text(&file)]);
    assert!(said.starts_with("data is ") && said.contains("must be a folder"), "{said}");
    assert_eq!(std::fs::read_to_string(&file).expect("a file"), "mine");
}
