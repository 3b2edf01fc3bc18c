//! Helpers that compare recordings exported by the window with recordings that the program writes without a window.

use crate::robot::*;
use std::collections::{BTreeMap, BTreeSet};

use slump::app::DataChoices;

use crate::tables::parquet;

pub const TABLES: [&str; 5] = ["grains", "contacts", "steps", "measures", "histograms"];

/// Opens a window with the panel that exports data. Every step is exported into this folder, in these formats.
pub fn open(config: Config, folder: &Path, formats: &[FormatName]) -> Robot {
    let mut robot = Robot::open(config);
    let data = DataChoices { folder: folder.to_owned(), each_step: true, ..DataChoices::default() };
    robot.state_mut().preferences.data = DataChoices { formats: formats.to_vec(), ..data };
    robot.click("Save");
    robot
}

pub fn export(robot: &mut Robot) -> String {
    robot.click("Export data");
    robot.written()
}

/// Runs the program without a window and records into this folder. Returns the text that it wrote to stderr.
pub fn headless(arguments: &[&str], folder: &Path) -> String {
    let mut command = slump("--headless");
    said(&run(command.args(arguments).arg("--data").arg(folder)))
}

/// Returns the relative paths of all files of a recording.
pub fn files(folder: &Path) -> BTreeSet<PathBuf> {
    let mut found = BTreeSet::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(next) = folders.pop() {
        for entry in std::fs::read_dir(next).expect("a folder") {
            let path = entry.expect("an entry").path();
            if path.is_dir() {
                folders.push(path);
            } else {
                found.insert(path.strip_prefix(folder).expect("a path in it").to_owned());
            }
        }
    }
    found
}

/// Returns the lines of a text file without those that say with which command or by which program it was written.
pub fn said_in(path: &Path) -> Vec<String> {
    let text = read(path);
    let is_origin = |said: &str| {
        let fact = said.trim_start_matches("# ");
        fact.starts_with("command: ") || fact.starts_with("exported: ")
    };
    let said = text.lines().flat_map(|line| line.split("; "));
    said.filter(|said| !is_origin(said)).map(str::to_owned).collect()
}

/// Returns the facts about the run in the manifest of a recording, such as the settings of the scene.
pub fn facts(folder: &Path) -> BTreeMap<String, String> {
    let manifest = json(folder.join("data.json"));
    serde_json::from_value(manifest["about"].clone()).expect("words by words")
}

/// Returns the arrays of a `.vtp` file by name, without the array of facts about the run.
fn arrays(path: &Path) -> BTreeMap<String, Vec<u8>> {
    let bytes = bytes(path);
    let start = bytes.windows(2).position(|two| two == b" _").expect("the arrays") + 2;
    let xml = String::from_utf8_lossy(&bytes[..start]);
    let offset = |line: &str| line.split_once("offset=\"")?.1.split('"').next()?.parse().ok();
    let array = |line: &str| {
        let name = line.split_once(" Name=\"")?.1.split('"').next()?.to_owned();
        let Some(offset) = offset(line).map(|offset: usize| start + offset) else {
            return Some((name, line.as_bytes().to_vec()));
        };
        let length = bytes[offset..].first_chunk().map(|length| u64::from_le_bytes(*length))?;
        Some((name, bytes[offset + 8..][..length as usize].to_vec()))
    };
    xml.lines().filter_map(array).filter(|(name, _)| name != "about").collect()
}

#[track_caller]
pub fn assert_same(exported: &Path, written: &Path) {
    assert_eq!(files(exported), files(written));
    for file in files(written) {
        let (one, other) = (exported.join(&file), written.join(&file));
        match file.extension().and_then(|ending| ending.to_str()) {
            Some("csv" | "dump") => assert!(said_in(&one) == said_in(&other), "{}", file.display()),
            Some("vtp") => assert!(arrays(&one) == arrays(&other), "{}", file.display()),
            _ => {}
        }
    }
    for table in TABLES {
        let (one, other) = (parquet(exported, table), parquet(written, table));
        assert!(!other.is_empty(), "{table}");
        assert!(one == other, "{table}");
    }
    let (mut one, mut other) = (facts(exported), facts(written));
    assert!(one.remove("exported").is_some_and(|said| said.starts_with("from the window")));
    assert!(other.remove("command").is_some());
    assert_eq!(one, other);
}
