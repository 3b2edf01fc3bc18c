//! Fuzzing of whole command lines: starts the program with random arguments, and checks its messages and files.
//!
//! An input is a text with one argument per line. After an empty line it contains a scene file. In the arguments,
//! `FILE` stands for the path of this file, and `OUT` for an output folder.

use arbitrary::{Result, Unstructured};
use serde_json::json;
use slump::config::read_scene;
use slump::interchange::ProblemFile;
use slump::sim::{Observables, Tally};

use super::Target;
use super::parsers::{NUMBERS, WORDS, is_legible, one_of};
use super::scenes::scene_text;
use crate::program::*;

/// Time limit for a command. It is shorter than the 200 s after which an input counts as a hang, so that a slow command
/// fails with a message of its own.
const SLOWEST: Duration = Duration::from_secs(180);

/// Values that Slump must refuse. For options whose large values make a run long, these values are tried in place of
/// random values.
const REFUSED: &str = "-1 nan inf -inf 1e300 -1e-300 much 0x10";

/// Options of the program, each with meaningful values.
const OPTIONS: [&str; 24] = [
    "--stepper moreau range tgs-soft avbd dem",
    "--bond 0 1 20 1000",
    "--rho 0 0.1 0.9 1",
    "--mu 0 0.5 5",
    "--cone shifted compressive",
    "--restitution-threshold 0 2",
    "--debonding-distance 1e-4 0.01 0.1",
    "--solver nsgs nsgs-parallel newton nncg apgd admm jacobi interior-point auto",
    "--ordering interleaved detected bottom-up symmetric coloured",
    "--stop residual relative-change",
    "--tolerance 1e-14 1e-6 1e-2",
    "--warm-start true false",
    "--friction-model coulomb tresca associated desaxce",
    "--model-solves 1 2 5",
    "--push-out true false",
    "--max-travel 0 0.25 1e-3",
    "--sequential-impacts true false",
    "--speculative true false",
    "--turning-bonds true false",
    "--preset robust",
    "--colour grey speed coordination overlap force",
    "--show forces angles forces,angles",
    "--theme light dark",
    "--start 6 6.5 8",
];
/// Options, each with meaningful values. Slump accepts very large values of them, too, but then a run takes a long
/// time, so these tests do not try random numbers.
const LONG: [&str; 6] = [
    "--substeps 0 1 7",
    "--stiffness 0 10 1e4",
    "--damping-ratio 0 0.05 3",
    "--max-sweeps 1 5 300",
    "--times 0 0.001 0,0.001,0.002 0.002,0.001",
    "--fps 25 1000 0.1",
];
const SCENES: &str =
    "pile cradle collision mass-ratio squeeze moving-walls thin-wall bounce newtons-cradle";

/// Returns one of the meaningful values in `good` or, in rare cases, a random or a wrong value. `long` is true if large
/// values make a run long.
fn value(u: &mut Unstructured<'_>, good: &str, long: bool) -> Result<String> {
    let line = match (u.ratio(19, 20)?, long) {
        (true, _) => good,
        (false, true) => REFUSED,
        (false, false) => *u.choose(&[NUMBERS, WORDS])?,
    };
    Ok(one_of(u, line)?.replace('\0', "0"))
}

/// Adds arguments that choose the scene, the time step and the duration. Returns true if the scene is in a file.
fn origin(u: &mut Unstructured<'_>, arguments: &mut Vec<String>) -> Result<bool> {
    let from_file = u.ratio(1, 3)?;
    if from_file {
        arguments.extend(["--scene", "FILE"].map(str::to_owned));
        return Ok(true);
    }
    if u.ratio(1, 6)? {
        for (name, good) in [("--grains", "3 1"), ("--box-width", "4 9.5")] {
            arguments.extend([name.to_owned(), value(u, good, true)?]);
        }
    } else {
        arguments.extend(["--scene".to_owned(), value(u, SCENES, true)?]);
    }
    let time_step_secs = *u.choose(&[1e-4, 1e-3, 5e-3, 0.1])?;
    // Only a few steps, because each step may be divided into a hundred substeps, and a substep of the pile takes 0.1 s
    // if its solve stalls.
    let steps = f64::from(u.int_in_range(0..=160)?) / 20.0;
    let duration = format!("{}", steps * time_step_secs);
    let time_step = format!("{time_step_secs}");
    for (name, good) in [("--dt", time_step), ("--duration", duration)] {
        arguments.extend([name.to_owned(), value(u, &good, true)?]);
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
        arguments.extend(["--size".to_owned(), value(u, "16x9 1x1 64x36", true)?]);
    } else if command == "dump" {
        arguments.extend(["--at".to_owned(), value(u, "0 0.001 0.003", true)?]);
    }
    for _ in 0..u.int_in_range(0..=6)? {
        let long = u.ratio(1, 6)?;
        let option = if long { *u.choose(&LONG)? } else { *u.choose(&OPTIONS)? };
        let (name, good) = option.split_once(' ').expect("a value");
        if !arguments.iter().any(|known| known == name) || u.ratio(1, 20)? {
            arguments.extend([name.to_owned(), value(u, good, long)?]);
        }
    }
    if u.ratio(1, 30)? {
        arguments.push(one_of(u, WORDS)?.replace('\0', "0"));
    }
    let file = if from_file { scene_text(u)? } else { String::new() };
    Ok(format!("{}\n\n{file}", arguments.join("\n")))
}

/// Runs the program with an input and checks the properties that all runs must have. Returns true if the command
/// succeeded.
fn check(input: &str) -> bool {
    let (arguments, file) = input.split_once("\n\n").expect("arguments, and a file or none");
    let folder = folder();
    let scene = folder.path().join("scene.toml");
    write(&scene, file);
    let out = folder.path().join("out");
    let [scene_name, out_name] = [&scene, &out].map(|path| text(path));
    let arguments: Vec<String> = arguments
        .lines()
        .map(|word| word.replace("FILE", scene_name).replace("OUT", out_name))
        .collect();
    let is_run = arguments.iter().any(|word| word == "--headless");
    if !is_run {
        std::fs::create_dir(&out).expect("a folder");
    }
    let mut command = assert_cmd::Command::from_std(slump(""));
    let output = command.args(&arguments).timeout(SLOWEST).output().expect("it starts");
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
        check_books(&out, code, &said);
    } else {
        assert_eq!(code, 2, "nothing was done, and nothing was wrong: {said}");
        let left = std::fs::read_dir(&out).map_or(0, Iterator::count);
        assert_eq!(left, 0, "refused, but {} has files", out.display());
    }
    code == 0
}

/// Checks the outputs of commands that draw no pictures: an output can be read back, or does not exist.
fn check_other(arguments: &[String], code: i32, stdout: &[u8], out: &Path) {
    if arguments.first().is_some_and(|word| word == "scene") && code == 0 {
        let path = out.join("scene.toml");
        write(&path, stdout);
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
    let target = Target { name: "command-lines", ending: "txt", inputs: 40 };
    target.fuzz(&target.corpus(), command_line, |text, _| check(text));
}

/// Checks that three outputs in the folder of a run agree: the table `observables.csv` with one row per step, the
/// manifest (`manifest.json`, which describes the run), and the pictures. The run was not killed; it ended with the
/// exit code `code` and wrote `stderr`.
pub fn check_books(folder: &Path, code: i32, stderr: &str) {
    let rows = rows_of(&folder.join("observables.csv"));
    let manifest = manifest(folder);
    let run = &manifest["runs"][0];
    let mut tally = Tally::default();
    let is_scheme = ["dem", "tgs-soft", "avbd"].iter().any(|name| run["scene"]["stepper"] == *name);
    for (row, number) in rows.iter().zip(1..) {
        assert_eq!(row.step, number, "a row a step");
        assert!(!row.converged || row.residual.is_finite() || is_scheme, "{row:?}");
        tally.add(row);
    }
    assert_eq!(run["tally"], json!(tally), "the tally is that of the table");
    let end = rows.last().copied().unwrap_or_default();
    assert_eq!(run["step"], json!(end.step));
    assert_eq!(run["time_secs"], json!(end.time_secs));
    assert_eq!(run["ended"], if code == 0 { "complete" } else { "not-finite" });

    alarms(run, &rows, stderr);
    let told = stderr.contains("did not reach tolerance");
    let is_to_be_told = tally.unconverged_steps > 0 && !is_scheme;
    assert_eq!(told, is_to_be_told, "steps that were not solved: {stderr}");
    pictures(folder, &manifest, &rows);
}

/// Checks that the manifest of a run (`manifest.json`, which describes it) has a warning for each problem in `rows`,
/// the measured quantities of all steps, and that stderr contains each warning.
fn alarms(run: &Value, rows: &[Observables], stderr: &str) {
    let alarms = run["alarms"].as_array().expect("a list");
    let has = |kind: &str| alarms.iter().any(|alarm| alarm["kind"] == kind);
    let finite = |row: &Observables| {
        let Observables { kinetic_energy, potential_energy, max_overlap, slump, .. } = row;
        [kinetic_energy, potential_energy, max_overlap, slump].into_iter().all(|x| x.is_finite())
    };
    assert!(rows.iter().all(finite) || !alarms.is_empty(), "not finite in silence");
    assert_eq!(run["ended"] == "not-finite", has("not-finite"), "{run}");
    let any = |wrong: fn(&Observables) -> bool| rows.iter().any(wrong);
    let is_told = ["grain-lost", "grain-left", "placed-in-overlap"].into_iter().any(has);
    assert!(!any(|row| row.lost_grains > 0) || is_told, "{run}");
    // The table has overlaps in mean diameters, but the warning uses diameters of the smaller disc.
    assert!(!has("overlap") || any(|row| row.max_overlap > 0.0), "{run}");
    for alarm in alarms.iter().filter(|alarm| alarm["kind"] != "not-finite") {
        let message = alarm["message"].as_str().expect("a sentence");
        assert!(stderr.contains(message), "{message} is not in {stderr}");
    }
    if has("not-finite") {
        assert!(stderr.contains("no longer finite"), "{stderr}");
    }
}

/// Checks that the folder has exactly the pictures that the manifest (`manifest.json`) names, and that the numbers in
/// each picture are those of one step in `rows`, the measured quantities of all steps.
fn pictures(folder: &Path, manifest: &Value, rows: &[Observables]) {
    let listed = manifest["pictures"].as_array().expect("a list");
    for picture in listed {
        let shown = &picture["shows"][0]["observables"];
        let step = shown["step"].as_u64().expect("a step") as usize;
        if step > 0 {
            assert_eq!(*shown, json!(rows[step - 1]), "a picture shows a row");
        }
    }
    let mut named: Vec<&str> = listed.iter().filter_map(|it| it["file"].as_str()).collect();
    named.extend(["manifest.json", "observables.csv"]);
    named.sort_unstable();
    let entries = std::fs::read_dir(folder).expect("a folder");
    let mut there: Vec<String> =
        entries.flatten().map(|it| it.file_name().to_string_lossy().into_owned()).collect();
    there.sort_unstable();
    assert_eq!(there, named, "what is there and what the manifest names");
}

fn rows_of(table: &Path) -> Vec<Observables> {
    let text = read(table);
    assert!(text.is_empty() || text.ends_with('\n'), "a half row at the end");
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    reader.deserialize().map(|row| row.expect("a row")).collect()
}
