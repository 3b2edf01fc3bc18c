//! The program, and the folders that it leaves.

use std::collections::BTreeMap;
use std::path::Path;
use std::process::{Command, Output};
use std::time::{Duration, Instant};

use tempfile::TempDir;

/// Longer than any of this takes on a busy machine.
pub const PATIENCE: Duration = Duration::from_secs(120);

pub fn slump(arguments: &[&str], out: &Path) -> Command {
    let mut command = Command::new(crate::tested::program());
    command.args(["--headless", "--size", "64x36", "--renderer", "cpu"]).args(arguments);
    command.arg("--frames").arg(out);
    command
}

pub fn folder() -> TempDir {
    tempfile::tempdir().expect("a temporary folder")
}

pub fn run(command: &mut Command) -> Output {
    command.output().expect("the program starts")
}

#[track_caller]
pub fn succeed(command: &mut Command) -> String {
    let output = run(command);
    let said = String::from_utf8(output.stderr).expect("UTF-8");
    assert!(output.status.success(), "{said}");
    said
}

#[track_caller]
pub fn refusal(command: &mut Command) -> String {
    let output = run(command);
    let said = String::from_utf8(output.stderr).expect("UTF-8");
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(said.lines().last().is_some_and(|last| last.contains("must")), "{said}");
    said
}

/// Every file of a folder; of the manifest what does not tell how the run came about.
pub fn contents(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let entries =
        std::fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry"));
    let content = |path: &Path| std::fs::read(path).expect("a file");
    let mut files: BTreeMap<_, _> = entries
        .map(|entry| (entry.file_name().to_string_lossy().into_owned(), content(&entry.path())))
        .collect();
    let manifest = files.get_mut("manifest.json").expect("a manifest");
    let mut said: serde_json::Value = serde_json::from_slice(manifest).expect("JSON");
    let said_of = said.as_object_mut().expect("a table");
    said_of.remove("command");
    let run = said_of["runs"][0].as_object_mut().expect("a run");
    run.remove("restarted_from");
    *manifest = serde_json::to_vec(&said).expect("JSON");
    files
}

pub fn manifest(folder: &Path) -> serde_json::Value {
    let text = std::fs::read_to_string(folder.join("manifest.json")).expect("a manifest");
    serde_json::from_str(&text).expect("JSON")
}

pub fn wait_for(path: &Path) {
    let begun = Instant::now();
    while !path.exists() {
        assert!(begun.elapsed() < PATIENCE, "{} did not come", path.display());
        std::thread::sleep(Duration::from_millis(1));
    }
}
