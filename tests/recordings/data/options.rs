//! Tests of the options of recordings, and of recordings of the runs of a study (a list of runs).

use super::tables::{metadata, number, parquet, parts, steps};
use super::*;

/// Arguments of a short run: the cradle for 0.1 s, which takes 100 steps.
const BRIEF: [&str; 6] = ["--scene", "cradle", "--dt", "1e-3", "--duration", "0.1"];

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
        let output = run(slump("--headless").args(arguments).args(&more));
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
fn data_alone_needs_no_renderer_and_pictures_may_be_in_the_same_folder() {
    let folder = folder();
    let out = text(folder.path());
    // The program must not look for a renderer, because a machine may not have one.
    let mut alone = slump("--headless --renderer gl --data");
    let alone = run(alone.arg(out).args(BRIEF).env("LIBGL_DRIVERS_PATH", "/nowhere"));
    assert!(alone.status.success(), "{}", said(&alone));
    assert!(!said(&alone).contains("drawing with"), "{}", said(&alone));
    let alone = frames(folder.path());

    let pictures = "--headless --size 64x18 --renderer cpu --overwrite --data";
    succeed(slump(pictures).arg(out).args(["--frames", out]).args(BRIEF));
    assert_eq!(frames(folder.path()), alone);
    for file in ["frame_00002.png", "observables.csv", "manifest.json", "data.json", "frames.csv"] {
        assert!(folder.path().join(file).exists(), "{file}");
    }
    // Pictures are drawn at the times of the frames.
    let manifest = manifest(folder.path());
    let pictures = manifest["pictures"].as_array().expect("pictures");
    let step = |it: &Value| it["shows"][0]["observables"]["step"].as_u64().expect("step");
    assert_eq!(pictures.iter().map(step).collect::<Vec<_>>(), alone);
}

#[test]
fn a_run_is_the_same_with_a_recording_and_without() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    let line =
        "--headless --duration 0.06 --fps 50 --size 64x36 --renderer cpu --overwrite --scene";
    for scene in ["pile", "moving-walls"] {
        let (plain, recorded, data) = (at("plain"), at("recorded"), at("data"));
        succeed(slump(line).arg(scene).arg("--frames").arg(&plain));
        let more = ["--data-every", "0.002", "--frames", text(&recorded)];
        succeed(slump(line).arg(scene).args(more).arg("--data").arg(&data));
        let table = |folder: &Path| bytes(folder.join("observables.csv"));
        assert_eq!(table(&plain), table(&recorded), "{scene}");
        // The table of steps in the recording has the same numbers.
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
    write(&scene, toml);
    succeed(slump("--headless --dt 1e-3 --scene").arg(&scene));
    let out = folder.path().join("out");
    assert_eq!(frames(&out), [0, 20, 40, 60, 80, 100]);
    assert!(out.join("csv/grains.csv").exists());
    let again = |more: &[&str]| {
        let mut command = slump("--headless --dt 1e-3 --scene");
        command.arg(&scene).args(more);
        command
    };
    let said = sentence(&mut again(&[]));
    assert!(said.contains("unless the option overwrite is given"), "{said}");
    succeed(&mut again(&["--overwrite"]));
    // An option on the command line overrides the value in the scene file.
    let other = folder.path().join("other");
    let line = "--headless --dt 1e-3 --data-every 0.05 --data-format parquet --scene";
    succeed(slump(line).arg(&scene).arg("--data").arg(&other));
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
    let data = ["--data", text(&out), "--data-every", "0.01"];
    for option in ["--size 64x36", "--fps 10", "--show forces", "--colour speed", "--theme dark"] {
        let words: Vec<&str> = option.split(' ').collect();
        let name = words[0].trim_start_matches('-');
        let said = refused(&[&data[..], &words].concat());
        let expected = "is given, but must be left out, since no pictures are asked for (";
        assert!(said.starts_with(&format!("{name} {expected}")), "{said}");
    }
    let said = refused(&[]);
    assert!(said.starts_with("frames is missing") && said.contains("--data DIR"), "{said}");
    assert!(!out.exists());

    let file = folder.path().join("file");
    write(&file, "mine");
    let said = refused(&["--data", text(&file)]);
    assert!(said.starts_with("data is ") && said.contains("must be a folder"), "{said}");
    assert_eq!(read(&file), "mine");
}

const STUDY: &str = "
name = 'recorded'
[base]
scene = 'cradle'
dt = 1e-3
duration = 0.1
[vary]
start = [7.0, 7.5]
bond = [0.0, 5.0, 10.0]
[data]
every_secs = 0.02
";

fn sweep(study: &Path, out: &Path, more: &[&str]) -> Command {
    let mut command = slump("sweep");
    command.arg(study).arg("--out").arg(out).args(more);
    command
}

fn written(folder: &Path, study: &str) -> PathBuf {
    let path = folder.join("study.toml");
    write(&path, study);
    path
}

/// Returns the key (the name that the study gives to a run) and the Bond number of each run of a study (a list of
/// runs).
fn runs(out: &Path) -> Vec<(String, String)> {
    let mut table = csv::Reader::from_path(out.join("runs.csv")).expect("a table");
    let names = table.headers().expect("names").clone();
    let [key, bond] =
        ["key", "bond"].map(|it| names.iter().position(|name| name == it).expect("a column"));
    let rows = table.records().map(|row| row.expect("a row"));
    rows.map(|row| (row[key].to_owned(), row[bond].to_owned())).collect()
}

#[test]
fn every_run_has_its_recording_by_its_key_whichever_part_it_ran_in() {
    let folder = folder();
    let study = written(folder.path(), STUDY);
    let out = folder.path().join("out");
    for shard in ["2/2", "1/2"] {
        succeed(&mut sweep(&study, &out, &["--shard", shard]));
    }
    let output = said(&run(&mut sweep(&study, &out, &[])));
    assert!(output.contains("6 of 6 runs were there"), "{output}");
    let runs = runs(&out);
    assert_eq!(runs.len(), 6);
    for (key, bond) in &runs {
        let data = out.join("data").join(key);
        assert_eq!(steps(&parquet(&data, "grains")), [0, 20, 40, 60, 80, 100]);
        assert_eq!(steps(&parquet(&data, "steps")).len(), 100);
        let about = metadata(&parts(&data, "grains")[0]);
        let said: f64 = about["parameters.bond"].parse().expect("a number");
        assert_eq!(said, bond.parse::<f64>().expect("a number"));
    }
    // A missing recording is computed again. A recording that is incomplete after a kill is computed again, too.
    std::fs::remove_dir_all(out.join("data").join(&runs[1].0)).expect("gone");
    let output = said(&run(&mut sweep(&study, &out, &[])));
    assert!(output.contains("5 of 6 runs were there"), "{output}");
    assert_eq!(steps(&parquet(&out.join("data").join(&runs[1].0), "grains")).len(), 6);
}

#[test]
fn results_are_the_same_with_recordings_and_without() {
    let folder = folder();
    let with = written(folder.path(), STUDY);
    succeed(&mut sweep(&with, &folder.path().join("with"), &[]));
    let without = written(folder.path(), STUDY.split("[data]").next().expect("a study"));
    succeed(&mut sweep(&without, &folder.path().join("without"), &[]));
    assert!(!folder.path().join("without/data").exists());
    let rows = |out: &str| {
        let table = folder.path().join(out).join("runs.csv");
        let table = read(table);
        // The second cell of a row is omitted: it is the key of the run, which depends on the options of the recording.
        let row = |line: &str| line.splitn(3, ',').nth(2).map(str::to_owned);
        table.lines().map(row).collect::<Vec<_>>()
    };
    assert_eq!(rows("with"), rows("without"));
}

#[test]
fn a_study_says_no_folder_and_no_senseless_time() {
    let folder = folder();
    for (said_there, expected) in [
        ("folder = 'here'", "data.folder is here, but must be left out in a study"),
        ("every_secs = 0.0", "data.every_secs is 0, but must be a finite number of seconds > 0"),
        ("every = 0.1", "unknown field"),
        ("formats = ['xml']", "xml"),
    ] {
        let study = written(folder.path(), &STUDY.replace("every_secs = 0.02", said_there));
        let output = failure(&mut sweep(&study, &folder.path().join("out"), &[]));
        assert!(output.contains(expected), "{output}");
    }
}

#[test]
fn frames_more_often_than_steps_are_told_of() {
    let folder = folder();
    let told = succeed(slump("--headless --data-every 3e-4 --data").arg(folder.path()).args(BRIEF));
    let sentence =
        "data-every is 0.0003 s, below the time step of 0.001 s: there is a frame a step";
    assert!(told.contains(sentence), "{told}");
}

#[test]
fn a_method_is_told_of_where_one_is_used() {
    for (stepper, is_told) in [("moreau", true), ("dem", false)] {
        let folder = folder();
        let mut command = slump("--headless --solver auto --data");
        let told = succeed(command.arg(folder.path()).args(BRIEF).args(["--stepper", stepper]));
        assert_eq!(told.contains("auto took"), is_told, "{stepper}: {told}");
    }
}
