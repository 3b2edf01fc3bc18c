//! Every parser of a file that a user hands over.

use std::path::Path;

use slump::error::Error;
use slump::interchange::ProblemFile;
use slump::scene::{built_in, parse_discs, read_scene, scene_to_toml};
use slump::study::Study;

use super::fuzz;
use super::texts::{changed, with_corpus};

/// The longest refusal that still is a sentence, bytes.
const LONGEST: usize = 3_200;

/// A refusal is one sentence that can be shown on any terminal.
fn check(refusal: &Error, text: &str) {
    let said = refusal.to_string();
    assert!(!said.contains(char::is_control), "control characters in {said:?} of {text:?}");
    assert!(said.len() <= LONGEST, "{} bytes: {said:?} of {text:?}", said.len());
}

/// Tries the corpus, then texts that are nearly those given.
fn fuzz_texts<T>(name: &str, texts: Vec<String>, parse: impl Fn(&str) -> slump::error::Result<T>) {
    let texts = with_corpus(name, texts);
    let one = |text: &str| {
        if let Err(refusal) = parse(text) {
            check(&refusal, text);
        }
    };
    texts.iter().for_each(|text| one(text));
    fuzz(name, |u| {
        one(&changed(u, &texts)?);
        Ok(())
    });
}

fn file(path: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(path);
    std::fs::read_to_string(path).expect("a file of ours")
}

#[test]
fn scene_files() {
    let mut texts = vec![file("assets/scenes/hourglass.toml")];
    for name in ["cradle", "arch", "moving-walls", "squeeze", "thin-wall"] {
        texts.push(scene_to_toml(&built_in(name).expect("a scene")).expect("TOML"));
    }
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("scene.toml");
    fuzz_texts("scene-files", texts, |text| {
        std::fs::write(&path, text).expect("a file");
        read_scene(&path).and_then(|scene| scene.simulation())
    });
}

#[test]
fn tables_of_discs() {
    let shipped = file("assets/pile_138.csv");
    let short: Vec<&str> = shipped.lines().take(12).collect();
    let texts = vec![short.join("\n"), "x,y,radius,vx,vy,omega\n0,0.01,2e-3,0,0,0\n".into()];
    fuzz_texts("discs", texts, |text| parse_discs(text, "discs.csv".as_ref()));
}

#[test]
fn studies() {
    let names = ["pile", "cradle", "cradle-map", "pile-map", "range"];
    let texts = names.map(|name| file(&format!("assets/studies/{name}.toml"))).into();
    fuzz_texts("studies", texts, |text| Study::parse(text, "study.toml".as_ref(), true));
}

#[test]
fn problem_files() {
    let texts = vec![file("tests/problems/bond_0.json"), file("tests/problems/bond_20.json")];
    fuzz_texts("problem-files", texts, |text| {
        ProblemFile::parse(text).and_then(|problem| problem.delassus())
    });
}

#[test]
fn texts_of_siconos() {
    let published = file("tests/problems/fc2d_granularflowonwall_00667_00000.dat");
    let short: Vec<&str> = published.lines().take(40).collect();
    let small = "2\n2\n2\n0 0 1\n1 1 1\n2\n-1\n0\n1\n0.5\n";
    fuzz_texts("siconos", vec![short.join("\n"), small.into()], ProblemFile::parse);
}
