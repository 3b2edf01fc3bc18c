//! Files for other programs are written, and not read: a sentence says what is.

use std::path::Path;
use std::process::Command;

use crate::formats::moments::{start, write};

const FORM: &str = "a file of discs (CSV or Parquet), or a folder that --data wrote as either";

#[track_caller]
fn assert_refused(path: &Path, reason: &str) {
    let mut slump = Command::new(assert_cmd::cargo::cargo_bin!("slump"));
    let output = slump.args(["--headless", "--data", "no", "--initial"]).arg(path).output();
    let output = output.expect("the program starts");
    let said = String::from_utf8(output.stderr).expect("UTF-8");
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert_eq!(said, format!("slump: {}: {reason}, but must be {FORM}\n", path.display()));
}

#[test]
fn what_is_written_for_other_programs_is_refused_as_an_initial_state() {
    let folder = tempfile::tempdir().expect("a folder");
    write(&mut start(folder.path()), 0..2);
    for name in ["vtk/grains.pvd", "vtk/grains_000001.vtp"] {
        assert_refused(&folder.path().join(name), "is a file of VTK");
    }
    let bare = folder.path().join("bare.vtp");
    std::fs::write(&bare, "<VTKFile type=\"PolyData\"></VTKFile>").expect("a file");
    assert_refused(&bare, "is a file of VTK");
    assert_refused(&folder.path().join("ovito/grains.dump"), "is a LAMMPS dump");
    assert_refused(folder.path(), "has grains for other programs alone");
}
