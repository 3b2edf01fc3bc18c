//! The rules of the house, kept by reading the sources: nothing uses what uses it, folders use only
//! those below them, and files and functions stay small enough to hold in the head.

mod circles;
mod floors;
mod made_up;
mod modules;
mod rooms;
mod sizes;
mod sources;
mod uses;

use circles::Circles;
use modules::House;

/// Files whose uses are not counted yet, by the beginning of their path below `src/`.
const BEING_REBUILT: &[&str] = &[];

fn house() -> House {
    House::build(&sources::below("src"))
}

fn being_rebuilt(path: &str) -> bool {
    BEING_REBUILT.iter().any(|start| path.starts_with(start))
}

#[test]
fn no_file_uses_what_uses_it() {
    let uses = uses::between_files(&house(), being_rebuilt);
    let circles = Circles::of(&uses);
    assert!(circles.is_empty(), "\n{circles}");
}

#[test]
fn folders_use_only_those_on_floors_below() {
    let complaints = floors::complaints(&uses::between_files(&house(), being_rebuilt));
    assert!(complaints.is_empty(), "\n{}", complaints.join("\n"));
}

#[test]
fn every_file_is_compiled_and_every_scene_is_listed() {
    let sources = sources::below("src");
    assert_eq!(rooms::without_a_door(&sources), [""; 0], "no `mod` names them");
    let unlisted = rooms::without_a_row(&sources, "scene/stability/", "scene/registry.rs");
    assert_eq!(unlisted, [""; 0], "scenes that no row of the registry makes");
}

#[test]
fn files_and_functions_are_small() {
    let mut complaints = Vec::new();
    for folder in ["src", "tests", "benches", "python/src"] {
        for (path, text) in sources::below(folder) {
            if !being_rebuilt(&path) {
                complaints.extend(sizes::complaints(&format!("{folder}/{path}"), &text));
            }
        }
    }
    assert!(complaints.is_empty(), "\n{}", complaints.join("\n"));
}
