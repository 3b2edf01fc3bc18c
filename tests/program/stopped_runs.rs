//! Tests of runs that are stopped or killed, or that fill the disk: their results remain and are reported.
#![cfg(unix)]

use std::io::{BufRead, BufReader};

use crate::program::*;

/// Arguments of a run that takes several minutes and draws a picture every 40 steps. Each test adds the option for the
/// output folder.
const LONG: &str =
    "--headless --scene cradle --dt 1e-3 --duration 3000 --size 64x18 --renderer cpu --solver nsgs";

fn start(out: &Path, more: &[&str]) -> Child {
    let mut command = slump(LONG);
    command.arg("--frames").arg(out).args(more).stdout(Stdio::null()).stderr(Stdio::piped());
    command.spawn().expect("the program starts")
}

/// Starts a run with the arguments [`LONG`] and waits until its fourth picture exists.
fn start_and_wait(out: &Path, more: &[&str]) -> Child {
    let child = start(out, more);
    wait_for("the fourth picture", || out.join("frame_00003.png").exists());
    child
}

/// Checks that a table contains only whole rows with consecutive numbers. Returns the number of rows.
fn rows_of(table: &Path) -> u64 {
    let text = read(table);
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

/// Checks that a folder contains only the files of a finished run.
fn nothing_else_in(out: &Path) {
    let known = |name: &&String| {
        !name.starts_with("frame_") && !["manifest.json", "observables.csv"].contains(&&***name)
    };
    assert_eq!(names_in(out).iter().find(known), None);
}

#[test]
fn a_signal_ends_a_run_with_all_that_it_came_to() {
    for (signal, code) in [("INT", 130), ("TERM", 143), ("HUP", 129)] {
        for more in [&[][..], &["--show", "forces"]] {
            let folder = folder();
            let mut child = start(folder.path(), more);
            let rows = folder.path().join("observables.csv");
            wait_for("rows", || rows.metadata().is_ok_and(|rows| rows.len() > 100_000));
            // Pictures that show forces wait for a common scale, so none has been written yet.
            assert_eq!(pictures_in(folder.path()) > 0, more.is_empty());
            send(signal, child.id().into());
            assert_eq!(ended(&mut child), Some(code), "{signal} {more:?}");
            let said =
                std::io::read_to_string(child.stderr.take().expect("stderr")).expect("UTF-8");
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
    let mut child = start_and_wait(folder.path(), &[]);
    assert_eq!(manifest(folder.path())["runs"][0]["ended"], "running");
    let listed = || manifest(folder.path())["pictures"].as_array().cloned().expect("a list");
    wait_for("a list of pictures", || listed().len() > 3);
    kill(&mut child);
    let pictures = pictures_in(folder.path()) as u64;
    for (number, picture) in listed().iter().enumerate() {
        assert_eq!(picture["file"], format!("frame_{number:05}.png"));
        assert!(folder.path().join(format!("frame_{number:05}.png")).exists(), "{picture}");
    }
    let table = folder.path().join("observables.csv");
    // A kill may leave an incomplete last row.
    let text = read(&table);
    write(&table, &text[..=text.rfind('\n').expect("rows")]);
    let rows = rows_of(&table);
    assert!(rows >= 40 * (pictures - 1), "{rows} rows at picture {pictures}");
    let names = names_in(folder.path());
    assert!(!names.iter().any(|name| name.contains(".tmp")), "{names:?}");
    // While a file replaces another file, it briefly has a second name.
    let hidden = |name: &&String| name.ends_with(".part");
    let left: Vec<_> = names.iter().filter(hidden).collect();
    assert!(left.len() <= 1 && left.iter().all(|name| name.starts_with('.')), "{left:?}");

    failure(&mut brief_run(folder.path(), &[]));
    succeed(&mut brief_run(folder.path(), &["--overwrite"]));
    assert_eq!(pictures_in(folder.path()), 2, "nothing of the killed run is left");
    nothing_else_in(folder.path());
}

#[test]
fn an_ignored_signal_stays_ignored() {
    let folder = folder();
    let mut nohup = Command::new("sh");
    nohup.args(["-c", "trap '' HUP; exec \"$@\"", "sh"]).arg(slump("").get_program());
    nohup
        .args(LONG.split(' '))
        .arg("--frames")
        .arg(folder.path())
        .stdout(Stdio::null())
        .stderr(Stdio::null());
    let mut child = nohup.spawn().expect("sh");
    wait_for("a picture", || folder.path().join("frame_00003.png").exists());
    send("HUP", child.id().into());
    let now = pictures_in(folder.path());
    std::thread::sleep(Duration::from_millis(300));
    assert!(child.try_wait().expect("a child").is_none(), "it goes on");
    wait_for("more pictures", || names_in(folder.path()).len() > now + 3);
    send("TERM", child.id().into());
    assert_eq!(ended(&mut child), Some(143));
}

/// Runs the program with the arguments [`LONG`] while its files are limited to `blocks` blocks of 512 bytes. As on a
/// full disk, the part of a file that fits is written. Returns the error output.
fn on_a_small_disk(blocks: u32, option: &str, out: &Path) -> String {
    let mut small = Command::new("sh");
    let script = format!("ulimit -f {blocks}; exec \"$@\"");
    small.args(["-c", &script, "sh"]).arg(slump("").get_program()).args(LONG.split(' '));
    failure(small.arg(option).arg(out))
}

#[test]
fn a_full_disk_leaves_whole_rows_and_pictures_and_the_animation_so_far() {
    let folder = folder();
    let said = on_a_small_disk(128, "--frames", folder.path());
    assert!(said.contains("observables.csv: File too large"), "{said}");
    let rows = rows_of(&folder.path().join("observables.csv"));
    let room = folder.path().join("observables.csv").metadata().expect("a table").len();
    assert!(
        (40_000..65_536).contains(&room),
        "all but the last rows that would have fitted: {room}"
    );
    let pictures = pictures_in(folder.path()) as u64;
    assert!(pictures > 3 && rows + 64 >= 40 * (pictures - 1), "{pictures} pictures, {rows} rows");
    assert_eq!(manifest(folder.path())["runs"][0]["ended"], "failed");
    nothing_else_in(folder.path());

    let gif = folder.path().join("cradle.gif");
    on_a_small_disk(128, "--gif", &gif);
    let file = std::io::BufReader::new(std::fs::File::open(&gif).expect("an animation"));
    let decoder = image::codecs::gif::GifDecoder::new(file).expect("a GIF");
    let frames = image::AnimationDecoder::into_frames(decoder).collect_frames();
    assert!(frames.expect("whole pictures to the end").len() > 3);
}

/// Returns the command of a short run with these additional arguments.
fn short_run(out: &Path, more: &[&str]) -> Command {
    let mut command =
        slump("--headless --scene cradle --dt 1e-3 --size 64x18 --renderer cpu --frames");
    command.arg(out).args(more);
    command
}

/// Returns the command of a run of 0.05 s with two pictures.
fn brief_run(out: &Path, more: &[&str]) -> Command {
    short_run(out, &[&["--duration", "0.05"], more].concat())
}

#[test]
fn a_run_lasts_as_long_as_it_was_asked_to() {
    for (more, steps, pictures) in [
        (&["--duration", "0.05"][..], 50, 2),
        (&["--duration", "0.01"], 10, 1),
        (&["--duration", "0.1", "--times", "0.02"], 100, 1),
    ] {
        let folder = folder();
        succeed(&mut short_run(folder.path(), more));
        assert_eq!(rows_of(&folder.path().join("observables.csv")), steps, "{more:?}");
        assert_eq!(pictures_in(folder.path()), pictures);
        let run = &manifest(folder.path())["runs"][0];
        assert_eq!(run["ended"], "complete");
        assert_eq!(run["step"].as_u64(), Some(steps));
    }
}

#[test]
fn a_folder_with_an_earlier_runs_files_is_refused_or_cleared() {
    let folder = folder();
    succeed(&mut brief_run(folder.path(), &["--fps", "100"]));
    assert_eq!(pictures_in(folder.path()), 6);
    let note = folder.path().join("note.txt");
    write(&note, "mine");
    let before = bytes(folder.path().join("manifest.json"));

    let said = sentence(&mut brief_run(folder.path(), &[]));
    assert!(said.contains("a folder without an earlier run's files (frame_00000.png"), "{said}");
    assert!(said.contains("--overwrite"), "{said}");
    assert_eq!(bytes(folder.path().join("manifest.json")), before);
    assert_eq!(pictures_in(folder.path()), 6);
    // A command that is refused for another reason removes no files.
    failure(&mut brief_run(folder.path(), &["--overwrite", "--bond", "-1"]));
    assert_eq!(pictures_in(folder.path()), 6);

    succeed(&mut brief_run(folder.path(), &["--overwrite"]));
    assert_eq!(pictures_in(folder.path()), 2);
    assert_eq!(read(&note), "mine");
}

#[test]
fn one_run_at_a_time_in_a_folder() {
    let folder = folder();
    let mut first = start_and_wait(folder.path(), &[]);
    for more in [&[][..], &["--overwrite"]] {
        let said = failure(&mut brief_run(folder.path(), more));
        assert!(said.contains("is being written by another run"), "{said}");
    }
    send("TERM", first.id().into());
    assert_eq!(ended(&mut first), Some(143), "the first was not disturbed");
    let steps = rows_of(&folder.path().join("observables.csv"));
    assert_eq!(manifest(folder.path())["runs"][0]["step"].as_u64(), Some(steps));
}

#[test]
fn pictures_whose_scale_is_given_are_there_when_a_run_is_killed() {
    let scaled =
        ["--show", "forces", "--force-scale", "10", "--colour", "speed", "--colour-scale", "0,2.5"];
    let folder = folder();
    kill(&mut start_and_wait(folder.path(), &scaled));
    assert!(pictures_in(folder.path()) > 3);
}

#[test]
fn a_scale_that_is_none_or_of_nothing_is_refused() {
    let folder = folder();
    for (more, expected) in [
        (&["--colour", "speed", "--colour-scale", "1"][..], "colour-scale is 1, but must be LOW,"),
        (&["--colour", "speed", "--colour-scale", "2,1"], "colour-scale is 2,1, but must be LOW,"),
        (&["--colour", "speed", "--colour-scale", "0,inf"], "colour-scale is 0,inf, but must be"),
        (&["--colour-scale", "0,1"], "left out where --colour is not speed"),
        (&["--force-scale", "1"], "left out where --show forces is not given"),
        (&["--show", "forces", "--force-scale", "0"], "force-scale is 0, but must be a finite"),
    ] {
        let said = failure(&mut brief_run(&folder.path().join("out"), more));
        assert!(said.contains(expected), "{more:?}: {said}");
    }
    assert!(!folder.path().join("out").exists());
}

/// Writes a contact problem to a file: a chain of frictionless contacts, each of which pushes the next. Each sweep
/// passes a push on by one contact, so a long chain needs millions of sweeps.
fn chain(contacts: usize, path: &Path) {
    let (mut row, mut col, mut val) = (Vec::new(), Vec::new(), Vec::new());
    let mut add = |at: [usize; 2], value: f64| {
        row.push(at[0]);
        col.push(at[1]);
        val.push(value);
    };
    for contact in 0..contacts {
        add([2 * contact; 2], 2.0);
        add([2 * contact + 1; 2], 6.0);
        if contact > 0 {
            add([2 * contact, 2 * contact - 2], -1.0);
            add([2 * contact - 2, 2 * contact], -1.0);
        }
    }
    let mut q = vec![0.0; 2 * contacts];
    q[0] = -1.0;
    let entries = serde_json::json!({ "row": row, "col": col, "val": val });
    let problem = serde_json::json!({ "nc": contacts, "mu": 0.0, "q": q, "W": entries });
    write(path, problem.to_string());
}

#[test]
fn a_long_solve_says_how_far_it_is_and_whether_its_budget_ended_it() {
    let folder = folder();
    let problem = folder.path().join("chain.json");
    chain(300, &problem);
    let solved = |sweeps: &str| {
        let output =
            run(slump("problem solve --method nsgs").arg(&problem).args(["--max-sweeps", sweeps]));
        assert!(output.status.success(), "{}", said(&output));
        let told = |bytes: Vec<u8>| String::from_utf8(bytes).expect("text");
        (told(output.stdout), told(output.stderr))
    };
    let (stdout, stderr) = solved("5000");
    assert!(stdout.contains("no: all 5000 sweeps were used; --max-sweeps allows more"), "{stdout}");
    assert_eq!(stderr.lines().count(), 1, "{stderr}");
    assert!(stderr.starts_with("slump: after 4096 sweeps the residual is "), "{stderr}");
    // The number of sweeps that the error message recommends.
    let (stdout, stderr) = solved("1000000");
    assert!(stdout.contains("converged       yes"), "{stdout}");
    assert!(stderr.lines().count() > 1, "{stderr}");
    let (_, short) = solved("100");
    assert_eq!(short, "", "a short solve says nothing on the way");
}

#[test]
fn a_signal_ends_a_long_solve_with_the_impulses_that_it_had() {
    let folder = folder();
    let [problem, out] = ["chain.json", "solution.json"].map(|name| folder.path().join(name));
    chain(20_000, &problem);
    let mut command = slump("problem solve --method nsgs");
    command.arg(&problem).arg("--out").arg(&out).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().expect("the program starts");
    let mut stderr = BufReader::new(child.stderr.take().expect("stderr"));
    let mut line = String::new();
    stderr.read_line(&mut line).expect("a line");
    assert!(line.contains("after 4096 sweeps"), "{line}");
    send("INT", child.id().into());
    assert_eq!(ended(&mut child), Some(130));
    let stdout = std::io::read_to_string(child.stdout.take().expect("stdout")).expect("UTF-8");
    assert!(stdout.contains("converged       no: stopped by SIGINT"), "{stdout}");
    let said = std::io::read_to_string(stderr).expect("UTF-8");
    assert!(said.contains("slump: stopped by SIGINT after "), "{said}");
    assert_eq!(json(&out)["r"].as_array().map(Vec::len), Some(40_000));
}
