//! Recordings of a study's runs.

use std::path::{Path, PathBuf};
use std::process::Output;

use super::tables::{metadata, parquet, parts, steps};
use super::{folder, said, slump};

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

fn sweep(study: &Path, out: &Path, more: &[&str]) -> Output {
    let mut command = slump();
    command.arg("sweep").arg(study).arg("--out").arg(out).args(more);
    command.output().expect("the program starts")
}

fn write(folder: &Path, study: &str) -> PathBuf {
    let path = folder.join("study.toml");
    std::fs::write(&path, study).expect("a file");
    path
}

/// Key and Bond number of each run.
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
    let study = write(folder.path(), STUDY);
    let out = folder.path().join("out");
    for shard in ["2/2", "1/2"] {
        let output = sweep(&study, &out, &["--shard", shard]);
        assert!(output.status.success(), "{}", said(&output));
    }
    let output = sweep(&study, &out, &[]);
    assert!(said(&output).contains("6 of 6 runs were there"), "{}", said(&output));
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
    // A recording that is gone is made again, and so is one that a kill left half.
    std::fs::remove_dir_all(out.join("data").join(&runs[1].0)).expect("gone");
    let output = sweep(&study, &out, &[]);
    assert!(said(&output).contains("5 of 6 runs were there"), "{}", said(&output));
    assert_eq!(steps(&parquet(&out.join("data").join(&runs[1].0), "grains")).len(), 6);
}

#[test]
fn results_are_the_same_with_recordings_and_without() {
    let folder = folder();
    let with = write(folder.path(), STUDY);
    assert!(sweep(&with, &folder.path().join("with"), &[]).status.success());
    let without = write(folder.path(), STUDY.split("[data]").next().expect("a study"));
    assert!(sweep(&without, &folder.path().join("without"), &[]).status.success());
    assert!(!folder.path().join("without/data").exists());
    let rows = |out: &str| {
        let table = folder.path().join(out).join("runs.csv");
        let table = std::fs::read_to_string(table).expect("a table");
        // The second cell is the run's key, which tells what is kept of it.
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
        let study = write(folder.path(), &STUDY.replace("every_secs = 0.02", said_there));
        let output = sweep(&study, &folder.path().join("out"), &[]);
        assert_eq!(output.status.code(), Some(2));
        assert!(said(&output).contains(expected), "{}", said(&output));
    }
}
