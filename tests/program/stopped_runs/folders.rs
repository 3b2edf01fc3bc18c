//! Folders with files of earlier runs.

use super::{brief_run, folder, pictures_in};

#[test]
fn a_folder_with_an_earlier_runs_files_is_refused_or_cleared() {
    let folder = folder();
    assert!(brief_run(folder.path(), &["--fps", "100"]).status.success());
    assert_eq!(pictures_in(folder.path()), 6);
    let note = folder.path().join("note.txt");
    std::fs::write(&note, "mine").expect("a file");
    let before = std::fs::read(folder.path().join("manifest.json")).expect("a manifest");

    let output = brief_run(folder.path(), &[]);
    assert_eq!(output.status.code(), Some(2));
    let said = String::from_utf8(output.stderr).expect("UTF-8");
    assert!(said.contains("a folder without an earlier run's files (frame_00000.png"), "{said}");
    assert!(said.contains("--overwrite") && said.lines().count() == 1, "{said}");
    assert_eq!(std::fs::read(folder.path().join("manifest.json")).expect("a manifest"), before);
    assert_eq!(pictures_in(folder.path()), 6);

    // What is refused for another reason clears nothing.
    let output = brief_run(folder.path(), &["--overwrite", "--bond", "-1"]);
    assert_eq!(output.status.code(), Some(2));
    assert_eq!(pictures_in(folder.path()), 6);

    assert!(brief_run(folder.path(), &["--overwrite"]).status.success());
    assert_eq!(pictures_in(folder.path()), 2);
    assert_eq!(std::fs::read_to_string(&note).expect("a file"), "mine");
}
