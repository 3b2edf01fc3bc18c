//! Recordings: what is in their files, what of them stays when a run ends in any way, and what is read back.

mod columns;
mod expected;
mod folders;
mod initial;
mod options;
mod refusals;
mod studies;
mod tables;
#[cfg(unix)]
mod torn;

use std::path::Path;
use std::process::{Command, Output};

use slump::data::{FormatName, Recording};
use slump::scene::{Scene, built_in};
use slump::sim::Simulation;
use tempfile::TempDir;

fn folder() -> TempDir {
    tempfile::tempdir().expect("a temporary folder")
}

fn slump() -> Command {
    Command::new(assert_cmd::cargo::cargo_bin!("slump"))
}

/// Runs the program without a window.
fn run(arguments: &[&str]) -> Output {
    slump().arg("--headless").args(arguments).output().expect("the program starts")
}

fn said(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).expect("UTF-8")
}

/// Runs the program, which is to refuse, and gives its one sentence.
fn refusal(arguments: &[&str]) -> String {
    let output = run(arguments);
    let said = said(&output);
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {said}");
    let sentence = said.strip_prefix("slump: ").unwrap_or_else(|| panic!("{said}"));
    assert!(sentence.trim_end().lines().count() == 1, "one sentence: {said}");
    sentence.trim_end().to_owned()
}

fn text(path: &Path) -> &str {
    path.to_str().expect("UTF-8")
}

fn scene(name: &str) -> Scene {
    built_in(name).expect("a built-in scene")
}

/// Starts a recording of a scene.
fn start(folder: &Path, formats: &[FormatName], scene: &Scene) -> Recording {
    let about = slump::config::scene_facts(scene).expect("facts");
    Recording::start(folder, formats, &about, false).expect("a recording")
}

/// Takes steps, and records each of them and a frame after each `every`.
fn record(recording: &mut Recording, simulation: &mut Simulation, steps: u64, every: u64) {
    for _ in 0..steps {
        let observables = *simulation.step().expect("a finite state");
        recording.add_step(&observables).expect("a row");
        if observables.step.is_multiple_of(every) {
            recording.add(simulation.moment()).expect("a frame");
        }
    }
}
