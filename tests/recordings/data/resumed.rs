//! Tests of resumed recordings, and of several recordings that use the same folder.

use std::collections::BTreeMap;

use slump::data::{RunFacts, Times};
use slump::sim::ForceSums;

use super::*;

/// Returns all files of a recording except the manifest (the file that describes the recording): their relative paths
/// and contents.
fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut all = BTreeMap::new();
    for name in names_in(folder) {
        let path = folder.join(&name);
        if path.is_dir() {
            all.extend(files(&path).into_iter().map(|(file, it)| (format!("{name}/{file}"), it)));
        } else {
            all.insert(name, bytes(&path));
        }
    }
    all
}

#[track_caller]
fn assert_same_files(found: &Path, expected: &Path, what: &str) {
    let (found, expected) = (files(found), files(expected));
    assert_eq!(
        found.keys().collect::<Vec<_>>(),
        expected.keys().collect::<Vec<_>>(),
        "the files, {what}"
    );
    for (name, bytes) in &expected {
        assert!(found[name] == *bytes, "{name} differs, {what}");
    }
}

#[test]
fn what_goes_on_is_what_was_never_stopped() {
    let formats = [FormatName::Parquet, FormatName::Csv];
    let pile = scene("pile");
    let folder = folder();
    let expected = folder.path().join("whole");
    recorded(&expected, &formats, &pile, 120, 2);
    // Stops before the first frame, within the first part file, at a frame, between two frames, and at the end.
    for stopped_at in [0, 1, 9, 40, 77, 120] {
        let path = folder.path().join(format!("from-{stopped_at}"));
        let mut simulation = pile.simulation().expect("a scene");
        let mut recording = start(&path, &formats, &pile);
        record(&mut recording, &mut simulation, stopped_at, 2);
        let (saved, sums) = (simulation.clone(), recording.sums().clone());
        let mark = recording.flush().expect("written");
        // The run continues for a while after its checkpoint and is then stopped.
        record(&mut recording, &mut simulation, 120 - stopped_at, 2);
        drop(recording);
        let mut simulation = saved;
        let about = slump::config::scene_facts(&pile).expect("facts");
        let recording = Recording::go_on(&path, &formats, &about, stopped_at, &mark);
        let recording = recording.expect("it goes on");
        let mut recording = recording.with_sums(sums);
        assert_eq!(recording.frames(), stopped_at / 2);
        record(&mut recording, &mut simulation, 120 - stopped_at, 2);
        recording.finish().expect("a recording");
        assert_same_files(&path, &expected, &format!("from step {stopped_at}"));
    }
}

#[test]
fn what_a_kill_tore_is_mended_when_it_goes_on() {
    let formats = [FormatName::Parquet, FormatName::Csv];
    let pile = scene("pile");
    let folder = folder();
    let (expected, torn) = (folder.path().join("whole"), folder.path().join("torn"));
    recorded(&expected, &formats, &pile, 40, 2);
    let mut recording = start(&torn, &formats, &pile);
    let mut simulation = pile.simulation().expect("a scene");
    record(&mut recording, &mut simulation, 25, 2);
    let mark = recording.flush().expect("written");
    record(&mut recording, &mut simulation, 5, 2);
    recording.finish().expect("a recording");
    // Makes incomplete last rows, and a frame that is missing in the list of frames.
    let cut = |file: &str, by: u64| {
        let file = std::fs::OpenOptions::new().write(true).open(torn.join(file)).expect("a file");
        file.set_len(file.metadata().expect("a length").len() - by).expect("cut");
    };
    cut("csv/grains.csv", 7);
    cut("frames.csv", 2);
    let mut simulation = pile.simulation().expect("a scene");
    simulation.take_steps(24).expect("a finite state");
    let mut sums = ForceSums::default();
    sums.follow(&simulation);
    simulation.step().expect("a finite state");
    sums.follow(&simulation);
    let about = slump::config::scene_facts(&pile).expect("facts");
    let recording = Recording::go_on(&torn, &formats, &about, 25, &mark).expect("it goes on");
    let mut recording = recording.with_sums(sums);
    record(&mut recording, &mut simulation, 15, 2);
    recording.finish().expect("a recording");
    assert_same_files(&torn, &expected, "mended");
}

#[test]
fn a_recording_that_lacks_frames_of_its_run_is_refused_and_keeps_what_it_has() {
    let pile = scene("pile");
    let folder = folder();
    let formats = [FormatName::Csv];
    recorded(folder.path(), &formats, &pile, 30, 2);
    let [index, grains] = ["frames.csv", "csv/grains.csv"].map(|file| folder.path().join(file));
    let text = read(&index);
    let end = text.trim_end().rmatch_indices('\n').nth(2).expect("more than three rows").0;
    write(&index, &text[..=end]);
    let before = bytes(&grains);
    let about = slump::config::scene_facts(&pile).expect("facts");
    let mark = RecordingMark { frames: 15, ..RecordingMark::default() };
    let there = Recording::go_on(folder.path(), &formats, &about, 30, &mark);
    let said = there.map(|_| ()).expect_err("three frames are missing").to_string();
    assert!(said.contains("frames of the recording is 12, but must be all 15"), "{said}");
    assert_eq!(bytes(&grains), before);
}

/// Checks that Slump refuses to resume a recording from which rows or files are missing, and does not change the
/// recording. A power failure may lose written rows, and users may delete files.
#[test]
fn a_recording_that_lost_rows_is_refused_and_keeps_what_it_has_in_every_format() {
    let pile = scene("pile");
    let about = slump::config::scene_facts(&pile).expect("facts");
    for format in FormatName::ALL {
        let folder = folder();
        let mut recording = start(folder.path(), &[*format], &pile);
        let mut simulation = pile.simulation().expect("a scene");
        record(&mut recording, &mut simulation, 12, 3);
        let mark = recording.flush().expect("written");
        // The run continues after the mark at which it will be resumed.
        record(&mut recording, &mut simulation, 6, 3);
        recording.finish().expect("a recording");
        let before = files(folder.path());
        let go_on = || Recording::go_on(folder.path(), &[*format], &about, 12, &mark).map(drop);
        let later =
            |name: &String| ["_000004", "_000005", "part-00001"].iter().any(|it| name.contains(it));
        let is_data =
            |name: &&String| name.contains('/') && !name.ends_with(".pvd") && !later(name);
        let mut tried = 0;
        for name in before.keys().filter(is_data) {
            let (path, whole) = (folder.path().join(name), &before[name]);
            for part in [0, 1, 2, 3] {
                match part {
                    0 => std::fs::remove_file(&path).expect("a file"),
                    // The file keeps a part of its length. Two of the six frames may be missing, because they are later
                    // than the mark.
                    part => write(&path, &whole[..whole.len() * part / 6]),
                }
                let damaged = files(folder.path());
                let said = go_on().expect_err("rows are lost").to_string();
                assert!(said.contains(" must ") && !said.contains('\n'), "{name}: {said}");
                assert_eq!(files(folder.path()), damaged, "{name}, {part} of 6: {said}");
                tried += 1;
            }
            write(&path, whole);
        }
        assert!(tried >= 12, "{format:?}: {tried}");
        go_on().expect("it is as it was");
        assert_ne!(files(folder.path()), before, "rows after the mark are gone");
    }
}

#[test]
fn frames_that_are_there_are_not_made_again() {
    let pile = scene("pile");
    let folder = folder();
    let about = RunFacts::default();
    let formats = [FormatName::Csv];
    let mut simulation = pile.simulation().expect("a scene");
    let recording = Recording::start(folder.path(), &formats, &about, false);
    let recording = recording.expect("a recording");
    let mut recording = recording.at(Times::Every(0.002), &simulation);
    recording.add_if_due(&simulation).expect("a frame");
    for _ in 0..7 {
        simulation.step().expect("a finite state");
        recording.add_if_due(&simulation).expect("a frame");
    }
    assert_eq!(recording.frames(), 4);
    let mark = recording.flush().expect("written");
    recording.finish().expect("a recording");
    let recording =
        Recording::go_on(folder.path(), &formats, &about, 7, &mark).expect("it goes on");
    let mut recording = recording.at(Times::Every(0.002), &simulation);
    // A resumed run calls this function before its first step. It must not add the same frame again.
    recording.add_if_due(&simulation).expect("a frame");
    assert_eq!(recording.frames(), 4);
    simulation.step().expect("a finite state");
    recording.add_if_due(&simulation).expect("a frame");
    assert_eq!(recording.frames(), 5);
    recording.finish().expect("a recording");
    let index = read(folder.path().join("frames.csv"));
    let rows: Vec<_> = index.lines().skip_while(|line| !line.starts_with("step")).collect();
    assert_eq!(rows.len(), 6);
    assert!(rows[5].starts_with("8,") && rows[5].ends_with(",4"), "{rows:?}");
}

#[test]
fn one_recording_at_a_time_in_a_folder() {
    let folder = folder();
    let pile = scene("pile");
    let about = RunFacts::default();
    let first = start(folder.path(), &[FormatName::Csv], &pile);
    for overwrite in [false, true] {
        let second = Recording::start(folder.path(), &[FormatName::Csv], &about, overwrite);
        let said = second.err().expect("a refusal").to_string();
        assert!(said.contains("is being written by another run"), "{said}");
    }
    let none = RecordingMark::default();
    let second = Recording::go_on(folder.path(), &[FormatName::Csv], &about, 0, &none);
    assert!(second.is_err_and(|error| error.to_string().contains("another run")));
    first.finish().expect("a recording");
    let second = Recording::start(folder.path(), &[FormatName::Csv], &about, true);
    second.expect("the folder is free").finish().expect("a recording");
}

#[test]
fn an_earlier_recording_is_refused_or_removed_and_nothing_else_is() {
    let folder = folder();
    let pile = scene("pile");
    let about = RunFacts::default();
    recorded(folder.path(), FormatName::ALL, &pile, 8, 2);
    write(folder.path().join("note.txt"), "mine");
    write(folder.path().join("grains/note.parquet"), "mine");
    let before = files(folder.path());
    let again = Recording::start(folder.path(), &[FormatName::Csv], &about, false);
    let said = again.err().expect("a refusal").to_string();
    assert!(said.starts_with("data is ") && said.contains("the option overwrite"), "{said}");
    assert_eq!(files(folder.path()), before);
    // Slump recognises a folder as a recording even if the manifest is missing.
    std::fs::remove_file(folder.path().join("data.json")).expect("gone");
    std::fs::remove_file(folder.path().join("frames.csv")).expect("gone");
    assert!(Recording::start(folder.path(), &[FormatName::Csv], &about, false).is_err());

    let again = Recording::start(folder.path(), &[FormatName::Csv], &about, true);
    again.expect("an empty folder").finish().expect("a recording");
    let mut left = files(folder.path());
    for table in ["contacts", "grains", "histograms", "measures", "pairs", "steps", "walls"] {
        let text = left.remove(&format!("csv/{table}.csv")).expect("a table");
        let rows = text.split(|&byte| byte == b'\n').filter(|line| !line.starts_with(b"#"));
        assert_eq!(rows.count(), 2, "the names of its columns alone");
    }
    assert!(left.keys().eq(["data.json", "grains/note.parquet", "note.txt"]), "{:?}", left.keys());
}

#[test]
fn a_recording_goes_on_in_its_own_formats_alone() {
    let folder = folder();
    recorded(folder.path(), &[FormatName::Csv], &scene("pile"), 8, 2);
    let about = RunFacts::default();
    let none = RecordingMark::default();
    let other = Recording::go_on(folder.path(), &[FormatName::Parquet], &about, 4, &none);
    let said = other.err().expect("a refusal").to_string();
    assert!(said.starts_with("data-format is parquet, but must be as "), "{said}");
    // A table of another version is neither continued nor changed.
    let table = folder.path().join("csv/contacts.csv");
    let text = read(&table).replace("normal_force", "force");
    write(&table, &text);
    let changed = Recording::go_on(folder.path(), &[FormatName::Csv], &about, 4, &none);
    let said = changed.err().expect("a refusal").to_string();
    assert!(said.contains("contacts.csv: line ") && said.contains("normal_force"), "{said}");
    assert_eq!(read(&table), text);
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
    let told = (0..50).find_map(|_| {
        let observables = *simulation.step().expect("a finite state");
        let added = recording.add_step(&observables);
        let added = added.and_then(|()| recording.add(simulation.moment()));
        added.and_then(|()| recording.flush()).err()
    });
    let said = told.expect("an error").to_string();
    assert!(said.contains("part-00000.parquet: cannot be written"), "{said}");
    recording.finish().expect("it is told once");
    std::fs::rename(&moved, folder.path().join("grains")).expect("moved back");
    let after = files(folder.path());
    assert_eq!(after["frames.csv"], before["frames.csv"], "the frame is in not every format");
    assert_eq!(after["grains/part-00000.parquet"], before["grains/part-00000.parquet"]);
}
