//! Runs that are stopped, killed, or fill the disk: what they came to stays, and is told.
#![cfg(unix)]

mod folders;
mod scales;

use std::io::Read;
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Output, Stdio};
use std::time::{Duration, Instant};

use tempfile::TempDir;

/// A run that goes on for minutes, with a picture for each 40 steps.
const LONG: [&str; 14] = [
    "--headless",
    "--scene",
    "cradle",
    "--dt",
    "1e-3",
    "--duration",
    "3000",
    "--size",
    "64x18",
    "--renderer",
    "cpu",
    "--solver",
    "nsgs",
    "--frames",
];
/// Longer than any of this takes on a busy machine.
const PATIENCE: Duration = Duration::from_secs(60);

fn slump() -> Command {
    Command::new(assert_cmd::cargo::cargo_bin!("slump"))
}

fn folder() -> TempDir {
    tempfile::tempdir().expect("a temporary folder")
}

fn wait_for(what: &str, mut is_there: impl FnMut() -> bool) {
    let begun = Instant::now();
    while !is_there() {
        assert!(begun.elapsed() < PATIENCE, "{what} did not come");
        std::thread::sleep(Duration::from_millis(5));
    }
}

fn ended(child: &mut Child) -> ExitStatus {
    let mut status = None;
    wait_for("the end", || {
        status = child.try_wait().expect("a child");
        status.is_some()
    });
    status.expect("an end")
}

fn send(signal: &str, child: &Child) {
    let id = child.id().to_string();
    assert!(Command::new("kill").args(["-s", signal, &id]).status().expect("kill").success());
}

/// Starts a long run.
fn start(out: &Path, more: &[&str]) -> Child {
    let mut command = slump();
    command.args(LONG).arg(out).args(more).stdout(Stdio::null()).stderr(Stdio::piped());
    command.spawn().expect("the program starts")
}

/// Starts a long run and lets it come to its fourth picture.
fn start_and_wait(out: &Path) -> Child {
    let child = start(out, &[]);
    wait_for("the fourth picture", || out.join("frame_00003.png").exists());
    child
}

fn names_in(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).expect("a folder");
    let mut names: Vec<_> =
        entries.map(|it| it.expect("it").file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

fn manifest(out: &Path) -> serde_json::Value {
    let text = std::fs::read_to_string(out.join("manifest.json")).expect("a manifest");
    serde_json::from_str(&text).expect("JSON")
}

/// Checks that a table has whole rows alone, counted through, and gives their number.
fn rows_of(table: &Path) -> u64 {
    let text = std::fs::read_to_string(table).expect("a table");
    assert!(text.ends_with('\n'), "a half row at the end");
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    let mut rows = 0;
    for row in reader.records() {
        rows += 1;
        assert_eq!(row.expect("a row as wide as the header")[0], rows.to_string());
    }
    rows
}

fn pictures_in(out: &Path) -> usize {
    let names = names_in(out);
    let pictures = names.iter().filter(|name| name.starts_with("frame_"));
    pictures.inspect(|name| drop(image::open(out.join(name)).expect("a picture"))).count()
}

/// Checks that there is nothing but what a finished run leaves.
fn nothing_else_in(out: &Path) {
    let known = |name: &&String| {
        !name.starts_with("frame_") && !["manifest.json", "observables.csv"].contains(&&***name)
    };
    let names = names_in(out);
    assert_eq!(names.iter().find(known), None);
}

#[test]
fn a_signal_ends_a_run_with_all_that_it_came_to() {
    for (signal, code) in [("INT", 130), ("TERM", 143), ("HUP", 129)] {
        for more in [&[][..], &["--show", "forces"]] {
            let folder = folder();
            let mut child = start(folder.path(), more);
            let rows = folder.path().join("observables.csv");
            wait_for("rows", || rows.metadata().is_ok_and(|rows| rows.len() > 100_000));
            // Those with links wait for a common scale.
            assert_eq!(pictures_in(folder.path()) > 0, more.is_empty());
            send(signal, &child);
            assert_eq!(ended(&mut child).code(), Some(code), "{signal} {more:?}");
            let mut said = String::new();
            child.stderr.take().expect("stderr").read_to_string(&mut said).expect("UTF-8");
            assert!(said.contains(&format!("stopped by SIG{signal} at step ")), "{said}");

            let manifest = manifest(folder.path());
            let run = &manifest["runs"][0];
            assert_eq!(run["ended"], "interrupted");
            let steps = rows_of(&folder.path().join("observables.csv"));
            assert!(steps < 3_000_000, "it was stopped on the way");
            assert_eq!(run["step"].as_u64(), Some(steps));
            assert_eq!(run["tally"]["steps"].as_u64(), Some(steps));
            assert!((run["time_secs"].as_f64().expect("s") - steps as f64 * 1e-3).abs() < 1e-6);
            let pictures = 1 + (steps / 40) as usize;
            assert_eq!(pictures_in(folder.path()), pictures);
            assert_eq!(manifest["pictures"].as_array().map(Vec::len), Some(pictures));
            nothing_else_in(folder.path());
        }
    }
}

#[test]
fn a_run_that_is_killed_keeps_its_rows_and_pictures_and_locks_nothing() {
    let folder = folder();
    let mut child = start_and_wait(folder.path());
    assert_eq!(manifest(folder.path())["runs"][0]["ended"], "running");
    let listed = || manifest(folder.path())["pictures"].as_array().cloned().expect("a list");
    wait_for("a list of pictures", || listed().len() > 3);
    child.kill().expect("a child");
    child.wait().expect("an end");
    let pictures = pictures_in(folder.path()) as u64;
    for (number, picture) in listed().iter().enumerate() {
        assert_eq!(picture["file"], format!("frame_{number:05}.png"));
        assert!(folder.path().join(format!("frame_{number:05}.png")).exists(), "{picture}");
    }
    let table = folder.path().join("observables.csv");
    // Seldom, a kill cuts the last row.
    let text = std::fs::read_to_string(&table).expect("a table");
    std::fs::write(&table, &text[..=text.rfind('\n').expect("rows")]).expect("a table");
    let rows = rows_of(&table);
    assert!(rows >= 40 * (pictures - 1), "{rows} rows at picture {pictures}");
    let names = names_in(folder.path());
    assert!(!names.iter().any(|name| name.contains(".tmp")), "{names:?}");
    // A file that takes another's place has a second name for the moment of doing so.
    let hidden = |name: &&String| name.ends_with(".part");
    let left: Vec<_> = names.iter().filter(hidden).collect();
    assert!(left.len() <= 1 && left.iter().all(|name| name.starts_with('.')), "{left:?}");

    let refused = brief_run(folder.path(), &[]);
    assert_eq!(refused.status.code(), Some(2), "the folder holds an earlier run's files");
    let again = brief_run(folder.path(), &["--overwrite"]);
    assert!(again.status.success(), "{}", String::from_utf8_lossy(&again.stderr));
    assert_eq!(pictures_in(folder.path()), 2, "nothing of the killed run is left");
    nothing_else_in(folder.path());
}

#[test]
fn an_ignored_signal_stays_ignored() {
    let folder = folder();
    let mut nohup = Command::new("sh");
    nohup.args(["-c", "trap '' HUP; exec \"$@\"", "sh"]).arg(slump().get_program());
    nohup.args(LONG).arg(folder.path()).stdout(Stdio::null()).stderr(Stdio::null());
    let mut child = nohup.spawn().expect("sh");
    wait_for("a picture", || folder.path().join("frame_00003.png").exists());
    send("HUP", &child);
    let now = pictures_in(folder.path());
    std::thread::sleep(Duration::from_millis(300));
    assert!(child.try_wait().expect("a child").is_none(), "it goes on");
    wait_for("more pictures", || names_in(folder.path()).len() > now + 3);
    send("TERM", &child);
    assert_eq!(ended(&mut child).code(), Some(143));
}

/// Starts a program that can make no file longer than so many blocks of 512 bytes: as on a full disk,
/// the part that fits is written.
fn on_a_small_disk(blocks: u32, arguments: &[&str], out: &Path) -> Output {
    let mut small = Command::new("sh");
    let script = format!("trap '' XFSZ; ulimit -f {blocks}; exec \"$@\"");
    small.args(["-c", &script, "sh"]).arg(slump().get_program()).args(arguments).arg(out);
    small.output().expect("sh")
}

#[test]
fn a_full_disk_leaves_whole_rows_and_pictures_and_the_animation_so_far() {
    let folder = folder();
    let output = on_a_small_disk(128, &LONG, folder.path());
    assert_eq!(output.status.code(), Some(2));
    let said = String::from_utf8(output.stderr).expect("UTF-8");
    assert!(said.contains("observables.csv: File too large"), "{said}");
    let rows = rows_of(&folder.path().join("observables.csv"));
    let room = folder.path().join("observables.csv").metadata().expect("a table").len();
    assert!(
        (40_000..65_536).contains(&room),
        "all but the last rows that would have fitted: {room}"
    );
    let pictures = pictures_in(folder.path()) as u64;
    assert!(pictures > 3 && rows + 64 >= 40 * (pictures - 1), "{pictures} pictures, {rows} rows");
    let manifest = manifest(folder.path());
    assert_eq!(manifest["runs"][0]["ended"], "failed");
    nothing_else_in(folder.path());

    let gif = folder.path().join("cradle.gif");
    let mut arguments = LONG;
    arguments[13] = "--gif";
    let output = on_a_small_disk(128, &arguments, &gif);
    assert_eq!(output.status.code(), Some(2));
    let file = std::io::BufReader::new(std::fs::File::open(&gif).expect("an animation"));
    let decoder = image::codecs::gif::GifDecoder::new(file).expect("a GIF");
    let frames = image::AnimationDecoder::into_frames(decoder).collect_frames();
    assert!(frames.expect("whole pictures to the end").len() > 3);
}

/// A run of 0.05 s with two pictures.
fn brief_run(out: &Path, more: &[&str]) -> Output {
    let mut command = slump();
    command.args(["--headless", "--scene", "cradle", "--dt", "1e-3", "--size", "64x18"]);
    command.args(["--renderer", "cpu", "--duration", "0.05", "--frames"]).arg(out).args(more);
    command.output().expect("the program starts")
}

#[test]
fn a_run_lasts_as_long_as_it_was_asked_to() {
    for (more, steps, pictures) in [
        (&[][..], 50, 2),
        (&["--duration", "0.01"], 10, 1),
        (&["--duration", "0.1", "--times", "0.02"], 100, 1),
    ] {
        let folder = folder();
        let mut command = slump();
        command.args(["--headless", "--scene", "cradle", "--dt", "1e-3", "--size", "64x18"]);
        command.args(["--renderer", "cpu", "--frames"]).arg(folder.path());
        command.args(if more.is_empty() { &["--duration", "0.05"] } else { more });
        assert!(command.status().expect("the program starts").success());
        assert_eq!(rows_of(&folder.path().join("observables.csv")), steps, "{more:?}");
        assert_eq!(pictures_in(folder.path()), pictures);
        let run = &manifest(folder.path())["runs"][0];
        assert_eq!(run["ended"], "complete");
        assert_eq!(run["step"].as_u64(), Some(steps));
    }
}
