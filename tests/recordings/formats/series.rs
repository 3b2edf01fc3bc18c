//! Series and dumps as they grow, and as they are rolled back.

use std::path::Path;

use slump::data::Recording;

use crate::formats::moments::{FORMATS, about, go_on, start, write};
use crate::formats::whole::{frames_of_dump, frames_of_series};

#[test]
fn a_series_is_whole_after_every_frame_of_many() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut recording = start(folder.path());
    for number in 0..70 {
        write(&mut recording, number..number + 1);
        for kind in ["grains", "contacts"] {
            let series = frames_of_series(&folder.path().join(format!("vtk/{kind}.pvd")));
            let times: Vec<f64> = (0..=number).map(|number| (10 * number) as f64 * 0.1).collect();
            assert_eq!(series, times, "{kind}");
            let dump = frames_of_dump(&folder.path().join(format!("ovito/{kind}.dump")));
            assert_eq!(dump.len() as u64, number + 1, "{kind}");
        }
    }
}

#[test]
fn rolled_back_frames_are_as_if_they_had_never_been() {
    for (written, kept) in [(5, 3), (5, 5), (40, 1), (40, 39)] {
        let [rolled, straight] = [(); 2].map(|()| tempfile::tempdir().expect("a folder"));
        write(&mut start(rolled.path()), 0..written);
        // A step that no frame has: it lies after the last one that stays.
        let mut later = go_on(rolled.path(), 10 * kept - 1);
        assert_eq!(names(rolled.path()).len() as u64, 4 + 2 * kept, "{written}, {kept}");
        write(&mut later, kept..written + 2);
        write(&mut start(straight.path()), 0..written + 2);
        assert_eq!(names(rolled.path()), names(straight.path()), "{written}, {kept}");
        for name in names(straight.path()) {
            let [found, expected] = [&rolled, &straight].map(|folder| said(folder.path(), &name));
            assert!(found == expected, "{name} of {written}, {kept}");
        }
    }
}

#[test]
fn a_frame_that_only_some_formats_have_is_written_again() {
    for kept in [0, 2] {
        let [cut, straight] = [(); 2].map(|()| tempfile::tempdir().expect("a folder"));
        write(&mut start(cut.path()), 0..3);
        // As a kill would leave it between the last frames' files and the list of frames.
        let list = cut.path().join("frames.csv");
        let text = std::fs::read_to_string(&list).expect("a list");
        let lines: Vec<&str> = text.lines().collect();
        let until_kept = lines.len() - 3 + kept;
        std::fs::write(&list, lines[..until_kept].join("\n") + "\n").expect("a list");
        write(&mut go_on(cut.path(), 25), kept as u64..4);
        write(&mut start(straight.path()), 0..4);
        for name in names(straight.path()) {
            let [found, expected] = [&cut, &straight].map(|folder| said(folder.path(), &name));
            assert!(found == expected, "{name} after {kept} frames");
        }
    }
}

#[test]
fn an_earlier_recording_is_removed_with_all_its_files() {
    let folder = tempfile::tempdir().expect("a folder");
    write(&mut start(folder.path()), 0..3);
    assert_eq!(names(folder.path()).len(), 10);
    let kept = folder.path().join("vtk/grains_1.vtp");
    std::fs::write(&kept, "not of a recording").expect("a file");
    drop(Recording::start(folder.path(), FORMATS, &about(), true).expect("a recording"));
    assert_eq!(names(folder.path()), ["vtk/grains_1.vtp"]);
}

/// What a file says; of a series without its blanks, of which there may be more.
fn said(folder: &Path, name: &str) -> Vec<u8> {
    let mut bytes = std::fs::read(folder.join(name)).expect("a file");
    if name.ends_with(".pvd") {
        bytes.retain(|byte| !byte.is_ascii_whitespace());
    }
    bytes
}

/// Files of a recording, sorted.
fn names(folder: &Path) -> Vec<String> {
    let mut names = Vec::new();
    for below in ["vtk", "ovito"] {
        for entry in std::fs::read_dir(folder.join(below)).expect("a folder") {
            let name = entry.expect("an entry").file_name();
            names.push(format!("{below}/{}", name.to_string_lossy()));
        }
    }
    names.sort();
    names
}
