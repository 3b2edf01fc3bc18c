//! When frames are made, and what becomes of earlier recordings.

use std::collections::BTreeMap;
use std::path::Path;

use slump::data::{FormatName, Recording, RunFacts, Times};
use slump::scene::Scene;

use super::{folder, record, scene, start};

/// All files of a recording, but for the manifest.
fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut all = BTreeMap::new();
    for entry in std::fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            let name = path.file_name().expect("a name").to_string_lossy().into_owned();
            all.extend(files(&path).into_iter().map(|(file, it)| (format!("{name}/{file}"), it)));
        } else {
            let name = path.file_name().expect("a name").to_string_lossy().into_owned();
            all.insert(name, std::fs::read(&path).expect("a file"));
        }
    }
    all
}

fn whole(folder: &Path, scene: &Scene, formats: &[FormatName], steps: u64) {
    let mut recording = start(folder, formats, scene);
    record(&mut recording, &mut scene.simulation().expect("a scene"), steps, 2);
    recording.finish().expect("a recording");
}

#[test]
fn frames_are_made_where_they_are_due() {
    let pile = scene("pile");
    let folder = folder();
    let about = RunFacts::default();
    let formats = [FormatName::Csv];
    let mut simulation = pile.simulation().expect("a scene");
    let recording = Recording::start(folder.path(), &formats, &about, false);
    let recording = recording.expect("a recording");
    let mut recording = recording.at(Times::Every(0.002));
    recording.add_if_due(&simulation).expect("a frame");
    for _ in 0..7 {
        simulation.step().expect("a finite state");
        recording.add_if_due(&simulation).expect("a frame");
    }
    assert_eq!(recording.frames(), 4);
    simulation.step().expect("a finite state");
    recording.add_if_due(&simulation).expect("a frame");
    assert_eq!(recording.frames(), 5);
    recording.finish().expect("a recording");
    let index = std::fs::read_to_string(folder.path().join("frames.csv")).expect("an index");
    let rows: Vec<_> = index.lines().skip_while(|line| !line.starts_with("step")).collect();
    assert_eq!(rows.len(), 6);
    assert!(rows[5].starts_with("8,") && rows[5].ends_with(",4"), "{rows:?}");
}

#[test]
fn an_earlier_recording_is_refused_or_removed_and_nothing_else_is() {
    let folder = folder();
    let pile = scene("pile");
    let about = RunFacts::default();
    whole(folder.path(), &pile, FormatName::ALL, 8);
    std::fs::write(folder.path().join("note.txt"), "mine").expect("a file");
    std::fs::write(folder.path().join("grains/note.parquet"), "mine").expect("a file");
    let before = files(folder.path());
    let again = Recording::start(folder.path(), &[FormatName::Csv], &about, false);
    let said = again.err().expect("a refusal").to_string();
    assert!(said.starts_with("data is ") && said.contains("--overwrite"), "{said}");
    assert_eq!(files(folder.path()), before);
    // Without its manifest it still is one.
    std::fs::remove_file(folder.path().join("data.json")).expect("gone");
    std::fs::remove_file(folder.path().join("frames.csv")).expect("gone");
    assert!(Recording::start(folder.path(), &[FormatName::Csv], &about, false).is_err());

    let again = Recording::start(folder.path(), &[FormatName::Csv], &about, true);
    again.expect("an empty folder").finish().expect("a recording");
    let mut left = files(folder.path());
    for table in ["contacts", "grains", "histograms", "measures", "steps"] {
        let text = left.remove(&format!("csv/{table}.csv")).expect("a table");
        let rows = text.split(|&byte| byte == b'\n').filter(|line| !line.starts_with(b"#"));
        assert_eq!(rows.count(), 2, "the names of its columns alone");
    }
    assert!(left.keys().eq(["data.json", "grains/note.parquet", "note.txt"]), "{:?}", left.keys());
}

#[test]
fn what_cannot_be_written_ends_the_recording_with_a_sentence_and_leaves_what_was() {
    let folder = folder();
    let pile = scene("pile");
    let mut recording = start(folder.path(), &[FormatName::Parquet, FormatName::Csv], &pile);
    let mut simulation = pile.simulation().expect("a scene");
    record(&mut recording, &mut simulation, 4, 2);
    recording.flush().expect("written");
    let before = files(folder.path());
    let moved = folder.path().join("gone");
    std::fs::rename(folder.path().join("grains"), &moved).expect("moved");
    let mut failure = None;
    for _ in 0..50 {
        let observables = *simulation.step().expect("a finite state");
        let told =
            recording.add_step(&observables).and_then(|()| recording.add(simulation.moment()));
        let told = told.and_then(|()| recording.flush());
        if let Err(error) = told {
            failure = Some(error.to_string());
            break;
        }
    }
    let said = failure.expect("an error");
    assert!(said.contains("part-00000.parquet: cannot be written"), "{said}");
    recording.finish().expect("it is told once");
    std::fs::rename(&moved, folder.path().join("grains")).expect("moved back");
    let after = files(folder.path());
    assert_eq!(after["frames.csv"], before["frames.csv"], "the frame is in not every format");
    assert_eq!(after["grains/part-00000.parquet"], before["grains/part-00000.parquet"]);
}
