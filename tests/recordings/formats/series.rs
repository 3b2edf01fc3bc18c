//! Series and dumps as they grow.

use std::path::Path;

use slump::data::Recording;

use crate::formats::moments::{FORMATS, about, start, write};
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
fn an_earlier_recording_is_removed_with_all_its_files() {
    let folder = tempfile::tempdir().expect("a folder");
    write(&mut start(folder.path()), 0..3);
    assert_eq!(names(folder.path()).len(), 10);
    let kept = folder.path().join("vtk/grains_1.vtp");
    std::fs::write(&kept, "not of a recording").expect("a file");
    drop(Recording::start(folder.path(), FORMATS, &about(), true).expect("a recording"));
    assert_eq!(names(folder.path()), ["vtk/grains_1.vtp"]);
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
