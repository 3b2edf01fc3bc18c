//! Whole command lines: the program is started, and what it says and leaves is read.
//!
//! An input is a text: an argument a line, and after an empty line the file that the word `FILE` stands
//! for among them. `OUT` stands for a folder.

use std::path::Path;
use std::time::Duration;

use arbitrary::{Result, Unstructured};
use assert_cmd::Command;
use slump::config::read_scene;
use slump::interchange::ProblemFile;

use super::parsers::is_legible;
use super::scenes::scene_text;
use super::texts::{NUMBERS, WORDS};
use super::{Target, books};

/// Less than the patience of whoever tries the input.
const PATIENCE: Duration = Duration::from_secs(180);

/// Of options that make a run long: no values but those that are good, or that must be refused.
const REFUSED: [&str; 8] = ["-1", "nan", "inf", "-inf", "1e300", "-1e-300", "much", "0x10"];

/// Options with values that mean something.
const OPTIONS: [(&str, &[&str]); 25] = [
    ("--stepper", &["moreau", "range", "tgs-soft", "avbd", "dem"]),
    ("--bond", &["0", "1", "20", "1000"]),
    ("--rho", &["0", "0.1", "0.9", "1"]),
    ("--mu", &["0", "0.5", "5"]),
    ("--cone", &["shifted", "compressive"]),
    ("--restitution-threshold", &["0", "2"]),
    ("--debonding-distance", &["1e-4", "0.01", "0.1"]),
    (
        "--solver",
        &[
            "nsgs",
            "nsgs-parallel",
            "newton",
            "nncg",
            "apgd",
            "admm",
            "jacobi",
            "interior-point",
            "auto",
        ],
    ),
    ("--ordering", &["interleaved", "detected", "bottom-up", "symmetric", "coloured"]),
    ("--stop", &["residual", "relative-change"]),
    ("--tolerance", &["1e-14", "1e-6", "1e-2"]),
    ("--warm-start", &["true", "false"]),
    ("--friction-model", &["coulomb", "tresca", "associated", "desaxce"]),
    ("--model-solves", &["1", "2", "5"]),
    ("--fallback", &["of-method", "none", "tresca"]),
    ("--push-out", &["true", "false"]),
    ("--max-travel", &["0", "0.25", "1e-3"]),
    ("--calm-unsolved", &["true", "false"]),
    ("--sequential-impacts", &["true", "false"]),
    ("--speculative", &["true", "false"]),
    ("--preset", &["robust"]),
    ("--colour", &["grey", "speed", "coordination", "overlap", "force"]),
    ("--show", &["forces", "angles", "forces,angles"]),
    ("--theme", &["light", "dark"]),
    ("--start", &["6", "6.5", "8"]),
];
/// Options of which a value that is merely large is granted, and takes as long as it takes.
const LONG: [(&str, &[&str]); 6] = [
    ("--substeps", &["0", "1", "7"]),
    ("--stiffness", &["0", "10", "1e4"]),
    ("--damping-ratio", &["0", "0.05", "3"]),
    ("--max-sweeps", &["1", "5", "300"]),
    ("--times", &["0", "0.001", "0,0.001,0.002", "0.002,0.001"]),
    ("--fps", &["25", "1000", "0.1"]),
];
const SCENES: [&str; 9] = [
    "pile",
    "cradle",
    "collision",
    "mass-ratio",
    "squeeze",
    "moving-walls",
    "thin-wall",
    "bounce",
    "newtons-cradle",
];

/// A good value, or now and then another one.
fn value(u: &mut Unstructured<'_>, good: &[&str], long: bool) -> Result<String> {
    if u.ratio(19, 20)? {
        return Ok((*u.choose(good)?).to_owned());
    }
    let bad = match (long, u.arbitrary()?) {
        (true, _) => u.choose(&REFUSED)?,
        (false, true) => u.choose(&NUMBERS)?,
        (false, false) => u.choose(&WORDS)?,
    };
    Ok(bad.replace('\0', "0"))
}

/// Where the scene comes from and how long it runs; whether from a file.
fn origin(u: &mut Unstructured<'_>, arguments: &mut Vec<String>) -> Result<bool> {
    let from_file = u.ratio(1, 3)?;
    if from_file {
        arguments.extend(["--scene", "FILE"].map(str::to_owned));
        return Ok(true);
    }
    if u.ratio(1, 6)? {
        for (name, good) in [("--grains", ["3", "1"]), ("--box-width", ["4", "9.5"])] {
            arguments.extend([name.to_owned(), value(u, &good, true)?]);
        }
    } else {
        arguments.extend(["--scene".to_owned(), value(u, &SCENES, true)?]);
    }
    let time_step_secs = *u.choose(&[1e-4, 1e-3, 5e-3, 0.1])?;
    let steps = f64::from(u.int_in_range(0..=1000)?) / 20.0;
    let duration = format!("{}", steps * time_step_secs);
    let time_step = format!("{time_step_secs}");
    for (name, good) in [("--dt", time_step), ("--duration", duration)] {
        arguments.extend([name.to_owned(), value(u, &[&good], true)?]);
    }
    Ok(false)
}

fn command_line(u: &mut Unstructured<'_>) -> Result<String> {
    let mut arguments: Vec<String> = Vec::new();
    let command = *u.choose(&["run", "run", "run", "scene", "dump"])?;
    let before: &[&str] = match command {
        "run" => &["--headless", "--renderer", "cpu", "--frames", "OUT"],
        "scene" => &["scene"],
        _ => &["problem", "dump", "--out", "OUT/problem.json"],
    };
    arguments.extend(before.iter().map(|&word| word.to_owned()));
    let from_file = origin(u, &mut arguments)?;
    if command == "run" {
        arguments.extend(["--size".to_owned(), value(u, &["16x9", "1x1", "64x36"], true)?]);
    } else if command == "dump" {
        arguments.extend(["--at".to_owned(), value(u, &["0", "0.001", "0.003"], true)?]);
    }
    for _ in 0..u.int_in_range(0..=6)? {
        let long = u.ratio(1, 6)?;
        let (name, good) = if long { u.choose(&LONG)? } else { u.choose(&OPTIONS)? };
        if !arguments.iter().any(|known| known == name) || u.ratio(1, 20)? {
            arguments.extend([(*name).to_owned(), value(u, good, long)?]);
        }
    }
    if u.ratio(1, 30)? {
        arguments.push((*u.choose(&WORDS)?).replace('\0', "0"));
    }
    let file = if from_file { scene_text(u)? } else { String::new() };
    Ok(format!("{}\n\n{file}", arguments.join("\n")))
}

/// What has to hold of any command line; whether it was granted.
fn check(input: &str) -> bool {
    let (arguments, file) = input.split_once("\n\n").expect("arguments, and a file or none");
    let folder = tempfile::tempdir().expect("a folder");
    let scene = folder.path().join("scene.toml");
    std::fs::write(&scene, file).expect("a file");
    let out = folder.path().join("out");
    let [scene_name, out_name] = [&scene, &out].map(|path| path.to_str().expect("UTF-8"));
    let arguments: Vec<String> = arguments
        .lines()
        .map(|word| word.replace("FILE", scene_name).replace("OUT", out_name))
        .collect();
    let is_run = arguments.iter().any(|word| word == "--headless");
    if !is_run {
        std::fs::create_dir(&out).expect("a folder");
    }
    let mut command = Command::new(assert_cmd::cargo::cargo_bin!("slump"));
    let output = command.args(&arguments).timeout(PATIENCE).output().expect("it starts");
    let said = String::from_utf8(output.stderr).expect("UTF-8");
    let code = output.status.code().unwrap_or_else(|| panic!("{}: {said}", output.status));

    assert!(matches!(code, 0 | 2), "exit code {code}: {said}");
    assert!(said.lines().all(is_legible), "illegible: {said:?}");
    assert!(!said.contains("panicked"), "{said:?}");
    if code == 2 {
        let last = said.lines().last().unwrap_or_default();
        let finite = !last.contains("no longer finite");
        assert!(last.starts_with("slump: "), "{said}");
        assert!(!finite || last.contains("must "), "{said}");
    }
    if !is_run {
        check_other(&arguments, code, &output.stdout, &out);
    } else if out.join("manifest.json").exists() {
        books::check(&out, code, &said);
    } else {
        assert_eq!(code, 2, "nothing was done, and nothing was wrong: {said}");
        let left = std::fs::read_dir(&out).map_or(0, Iterator::count);
        assert_eq!(left, 0, "refused, but {} has files", out.display());
    }
    code == 0
}

/// What the commands write that draw nothing reads back, or is not there.
fn check_other(arguments: &[String], code: i32, stdout: &[u8], out: &Path) {
    if arguments.first().is_some_and(|word| word == "scene") && code == 0 {
        let path = out.join("scene.toml");
        std::fs::write(&path, stdout).expect("a file");
        read_scene(&path).expect("a scene that is printed can be read");
    }
    let problem = out.join("problem.json");
    if problem.exists() {
        assert_eq!(code, 0, "refused, but there is a problem");
        ProblemFile::read(&problem).expect("a problem that is written can be read");
    }
}

#[test]
fn command_lines_and_what_they_leave() {
    let target = Target { name: "command-lines", ending: "txt" };
    target.fuzz(&target.corpus(), |u, _| command_line(u), |text, _| check(text));
}
