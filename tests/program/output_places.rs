//! Tests of unusual destinations of results: links, pipes, devices, closed streams, and names that are not UTF-8.
#![cfg(unix)]

use std::ffi::{OsStr, OsString};
use std::os::unix::ffi::OsStrExt;
use std::os::unix::fs::{FileTypeExt, PermissionsExt};

use crate::program::*;

const PROBLEM: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/problems/bond_0.json");

/// Runs the program, which solves a contact problem and writes the solution to `out`.
fn solve_to(out: &Path) -> Output {
    run(slump("problem solve --overwrite").arg(PROBLEM).arg("--out").arg(out))
}

const TINY: &str =
    "name = 'tiny'\n[base]\nscene = 'collision'\nduration = 0.01\n[vary]\nbond = [0, 1, 2]\n";

fn is_solution(bytes: &[u8]) -> bool {
    serde_json::from_slice::<serde_json::Value>(bytes).is_ok_and(|it| it["converged"] == true)
}

#[test]
fn a_link_is_followed_and_stays() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    std::fs::create_dir(at("far")).expect("a folder");
    write(at("far/old.json"), "old");
    let link = |to: &str, name: &str| std::os::unix::fs::symlink(to, at(name)).expect("a link");
    link("far/old.json", "to-file");
    link("to-file", "to-link");
    link("far/new.json", "to-nothing");
    for (name, target) in
        [("to-file", "far/old.json"), ("to-link", "far/old.json"), ("to-nothing", "far/new.json")]
    {
        assert!(solve_to(&at(name)).status.success());
        assert!(at(name).symlink_metadata().expect("a link").is_symlink(), "{name} stays a link");
        assert!(is_solution(&bytes(at(target))), "{target}");
        write(at("far/old.json"), "old");
    }
    link("round-b", "round-a");
    link("round-a", "round-b");
    let output = solve_to(&at("round-a"));
    assert_eq!(output.status.code(), Some(2));
    assert!(said(&output).contains("leads back to itself"));
}

#[test]
fn a_pipe_and_a_device_are_written_to_and_stay() {
    let folder = folder();
    let pipe = folder.path().join("pipe");
    assert!(Command::new("mkfifo").arg(&pipe).status().expect("mkfifo").success());
    // If nobody opens the pipe for writing, the time limit ends the reader.
    let reader = Command::new("timeout")
        .args(["20", "cat"])
        .arg(&pipe)
        .stdout(Stdio::piped())
        .spawn()
        .expect("cat");
    let output = solve_to(&pipe);
    assert!(pipe.symlink_metadata().expect("a pipe").file_type().is_fifo(), "it stays a pipe");
    assert!(output.status.success(), "{}", said(&output));
    assert!(is_solution(&reader.wait_with_output().expect("cat").stdout));
    // The test uses a link to `/dev/full`, so that a program that replaced the file would not harm the system.
    let full = folder.path().join("full");
    std::os::unix::fs::symlink("/dev/full", &full).expect("a link");
    let output = solve_to(&full);
    assert_eq!(output.status.code(), Some(2));
    assert!(said(&output).contains("No space left"), "{}", said(&output));
    assert!(full.symlink_metadata().expect("a link").is_symlink());
}

#[test]
fn permissions_follow_the_umask_or_what_was_there() {
    let folder = folder();
    let mode = |path: &Path| path.metadata().expect("a file").permissions().mode() & 0o777;
    for (mask, expected) in [("077", 0o600), ("027", 0o640), ("022", 0o644), ("000", 0o666)] {
        let out = folder.path().join(mask);
        let mut masked = Command::new("sh");
        masked
            .args(["-c", &format!("umask {mask}; exec \"$@\""), "sh"])
            .arg(slump("").get_program());
        masked.args(["problem", "solve", PROBLEM, "--out"]).arg(&out).stdout(Stdio::null());
        assert!(masked.status().expect("sh").success());
        assert_eq!(mode(&out), expected, "umask {mask}");
    }
    let private = folder.path().join("private");
    write(&private, "old");
    std::fs::set_permissions(&private, PermissionsExt::from_mode(0o600)).expect("mode");
    assert!(solve_to(&private).status.success());
    assert_eq!(mode(&private), 0o600);
    assert!(is_solution(&bytes(&private)));
}

/// Runs the program with these arguments. Fails if it takes longer than 10 s, which is far shorter than the computation
/// would take.
fn at_once(arguments: &[&str], out: &Path) -> Output {
    let mut command = assert_cmd::Command::from_std(slump(""));
    command.args(arguments).arg(out).timeout(Duration::from_secs(10)).output().expect("it starts")
}

#[test]
fn where_nothing_can_be_written_is_told_before_the_work() {
    let folder = folder();
    let kept = folder.path().join("kept");
    write(&kept, "mine");
    std::fs::set_permissions(&kept, PermissionsExt::from_mode(0o444)).expect("mode");
    // Each of these commands would take minutes.
    let works: [&[&str]; 5] = [
        &["generate", "--grains", "5000", "--out"],
        &["problem", "dump", "--at", "1000", "--dt", "1e-4", "--out"],
        &["--headless", "--duration", "1000", "--dt", "1e-4", "--renderer", "cpu", "--gif"],
        &["stability", "--table"],
        &["problem", "solve", PROBLEM, "--repeat", "1000000", "--out"],
    ];
    for work in works {
        let places = [
            (folder.path().to_owned(), "must be a file, and this is a folder"),
            (kept.clone(), "must be a file that can be written to, and this one is read-only"),
            (kept.join("inside"), "must be a file in a folder that can be written to ("),
        ];
        for (place, reason) in places {
            let output = at_once(work, &place);
            let said = said(&output);
            assert_eq!(output.status.code(), Some(2), "{work:?} {}: {said}", place.display());
            assert!(said.contains(reason) && said.lines().count() == 1, "{work:?}: {said}");
            let option = work.last().expect("an option").trim_start_matches('-');
            let named = format!("slump: {option} is {}, but ", place.display());
            assert!(said.starts_with(&named), "{work:?}: {said}");
        }
    }
    let study = concat!(env!("CARGO_MANIFEST_DIR"), "/assets/studies/cradle.toml");
    let works: [&[&str]; 5] = [
        &["--headless", "--duration", "1000", "--renderer", "cpu", "--frames"],
        &["sweep", study, "--out"],
        &["reproduce", "all", "--out"],
        &["chart", "--out"],
        &["stability", "--out"],
    ];
    for work in works {
        for place in [kept.clone(), kept.join("inside")] {
            let output = at_once(work, &place);
            let option = work.last().expect("an option").trim_start_matches('-');
            let sentence = format!(
                "slump: {option} is {}, but must be a folder that can be written to (",
                place.display()
            );
            assert_eq!(output.status.code(), Some(2), "{work:?}");
            assert!(said(&output).starts_with(&sentence), "{work:?}: {}", said(&output));
        }
    }
    assert_eq!(read(&kept), "mine");
}

#[test]
fn a_file_that_is_there_is_kept_unless_it_is_to_be_replaced() {
    let folder = folder();
    let out = folder.path().join("out");
    let run = "run cradle --duration 0.02 --size 64x36 --renderer cpu";
    for line in [
        "run cradle --duration 0.02 --save",
        &format!("{run} --gif"),
        "generate --grains 3 --box-width 4 --out",
        "problem dump --scene pile --at 0 --out",
        &format!("problem solve {PROBLEM} --out"),
    ] {
        write(&out, "mine");
        let option = line.rsplit_once("--").expect("an option").1;
        let said = sentence(slump(line).arg(&out));
        let expected = format!(
            "slump: {option} is {}, but must be a file that is not there yet, unless --overwrite is given to replace it",
            out.display()
        );
        assert_eq!(said, expected);
        assert_eq!((read(&out).as_str(), names_in(folder.path()).len()), ("mine", 1), "{line}");
        succeed(slump(line).arg(&out).arg("--overwrite"));
        assert!(bytes(&out).len() > 40, "{line}");
        // An empty file is replaced, because its replacement loses nothing.
        write(&out, "");
        succeed(slump(line).arg(&out));
        assert!(bytes(&out).len() > 40, "{line}");
    }
}

#[test]
fn a_folder_has_a_name() {
    let folder = folder();
    for option in ["--frames", "--data"] {
        let mut command = slump("run cradle --duration 0.02 --renderer cpu");
        let said = failure(command.current_dir(folder.path()).args([option, ""]));
        assert!(said.contains("must"), "{said}");
    }
    assert_eq!(names_in(folder.path()), [""; 0]);
}

#[test]
fn a_run_that_saves_its_state_alone_has_any_number_of_pictures() {
    let folder = folder();
    let saved = folder.path().join("saved.slump");
    // With 25 pictures per second this run would exceed the limit on the number of pictures.
    let line = "run collision --dt 100 --duration 10000 --save";
    succeed(slump(line).arg(&saved));
    assert!(saved.exists());
    let said =
        sentence(slump(line).arg(&saved).args(["--overwrite", "--frames"]).arg(folder.path()));
    assert!(said.contains("duration is 10000, but must be such that its pictures"), "{said}");
}

#[test]
fn outputs_that_would_take_each_others_place_are_refused_before_the_work() {
    let folder = folder();
    let out = folder.path().join("out");
    std::fs::create_dir(&out).expect("a folder");
    std::os::unix::fs::symlink("out", folder.path().join("link")).expect("a link");
    let line = "run cradle --duration 0.02 --size 64x36 --renderer cpu";
    let with = |files: &[[&str; 2]]| {
        let mut command = slump(line);
        command.current_dir(folder.path()).args(files.as_flattened());
        command
    };
    for (files, reason) in [
        ([["--gif", "out/a"], ["--save", "out/a"]], "save is out/a, but must be another path than"),
        ([["--gif", "out/a"], ["--save", "link/../link/a"]], "save is link/../link/a, but must be"),
        ([["--frames", "out"], ["--save", "link/checkpoint.slump"]], "does not write itself"),
        ([["--frames", "out"], ["--gif", "out/manifest.json"]], "does not write itself"),
        ([["--frames", "out"], ["--gif", "out/frame_00000.png"]], "does not write itself"),
    ] {
        let said = sentence(&mut with(&files));
        assert!(said.contains(reason), "{files:?}: {said}");
        assert_eq!(names_in(&out), [""; 0], "{files:?}");
    }
    let mut without_pictures = slump("run cradle --duration 0.02 --data out/a --save out/a");
    let said = sentence(without_pictures.current_dir(folder.path()));
    assert!(said.contains("data is out/a, but must be another path than"), "{said}");
    succeed(&mut with(&[["--frames", "out"], ["--gif", "out/a"], ["--save", "manifest.json"]]));
    succeed(&mut with(&[["--gif", "/dev/null"], ["--save", "/dev/null"]]));

    let problem = folder.path().join("problem.json");
    std::fs::copy(PROBLEM, &problem).expect("a problem");
    let mut solve = slump("problem solve problem.json --out out/../problem.json");
    let said = sentence(solve.current_dir(folder.path()));
    assert!(said.contains("must be another file than that of the problem"), "{said}");
    assert_eq!(bytes(&problem), bytes(PROBLEM));
}

#[test]
fn any_name_that_a_file_can_have_is_written_and_longer_ones_are_told_before_the_work() {
    let folder = folder();
    for (letter, times) in [("n", 255), ("é", 127)] {
        let name = letter.repeat(times);
        assert!(solve_to(&folder.path().join(&name)).status.success(), "{name}");
        assert_eq!(names_in(folder.path()), [name.as_str()]);
        std::fs::remove_file(folder.path().join(&name)).expect("a file");
    }
    let work = ["problem", "solve", PROBLEM, "--repeat", "1000000", "--out"];
    let output = at_once(&work, &folder.path().join("n".repeat(256)));
    let said = said(&output);
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(said.contains("must be a name that a file can have (File name too long"), "{said}");
}

#[test]
fn a_table_that_is_asked_for_is_there_whatever_becomes_of_the_pictures() {
    let folder = folder();
    let (table, out) = (folder.path().join("t.csv"), folder.path().join("out"));
    std::fs::create_dir_all(out.join("table.png")).expect("a folder where a picture is to be");
    let mut command = slump("stability thin-wall --quick --table");
    failure(command.arg(&table).arg("--out").arg(&out));
    assert!(read(&table).lines().count() > 1);
}

#[test]
fn a_full_or_closed_stdout_is_no_panic() {
    let printing: [&[&str]; 5] = [
        &["--help"],
        &["list"],
        &["scene", "--scene", "cradle"],
        &["problem", "solve", PROBLEM],
        &["sweep", "count", "assets/studies/cradle.toml"],
    ];
    for arguments in printing {
        let run = |stdout: Stdio| {
            let mut command = slump("");
            command.args(arguments).current_dir(env!("CARGO_MANIFEST_DIR"));
            command.stdout(stdout).stderr(Stdio::piped());
            command.spawn().and_then(std::process::Child::wait_with_output).expect("it starts")
        };
        let full = std::fs::OpenOptions::new().write(true).open("/dev/full").expect("a device");
        let output = run(full.into());
        let words = said(&output);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {words}");
        assert!(words.contains("stdout") && words.contains("No space left"), "{words}");

        let (reader, writer) = std::io::pipe().expect("a pipe");
        drop(reader);
        let output = run(writer.into());
        assert_eq!(said(&output), "", "{arguments:?}");
        assert!(output.status.success(), "{arguments:?}: a reader that left is no failure");
    }
}

#[test]
fn work_goes_on_when_stderr_goes_away() {
    let folder = folder();
    let study = folder.path().join("tiny.toml");
    write(&study, TINY);
    let out = folder.path().join("out");
    let sweep = |shard: &[&str]| {
        let (reader, writer) = std::io::pipe().expect("a pipe");
        drop(reader);
        let mut command = slump("sweep");
        command.arg(&study).arg("--out").arg(&out).args(shard).stderr(writer);
        command.stdout(Stdio::null()).status().expect("it starts")
    };
    assert!(sweep(&["--shard", "1/2"]).success());
    // In this call, stderr reports that some runs were already there.
    assert!(sweep(&[]).success());
    assert_eq!(read(out.join("runs.csv")).lines().count(), 1 + 3);
}

#[test]
fn names_that_are_not_utf8_work() {
    let folder = folder();
    let odd = |ending: &str| -> PathBuf {
        let mut name = OsString::from(OsStr::from_bytes(b"caf\xe9 \xff"));
        name.push(ending);
        folder.path().join(name)
    };
    let out = odd(".out");
    let made = |arguments: &[&str], path: &Path, more: &[&OsStr]| {
        succeed(slump("").args(arguments).arg(path).args(more));
    };
    let line = "--headless --scene collision --times 0 --renderer cpu --frames";
    let frames: Vec<&str> = line.split(' ').collect();
    made(&frames, &out, &[OsStr::new("--gif"), odd(".gif").as_os_str()]);
    let manifest = read(out.join("manifest.json"));
    assert!(manifest.contains("\"ended\": \"complete\""), "{manifest}");
    assert!(odd(".gif").exists() && out.join("frame_00000.png").exists());
    made(&["generate", "--grains", "10", "--out"], &odd(".csv"), &[]);
    made(&["scene", "--initial"], &odd(".csv"), &[]);
    made(&["problem", "solve", PROBLEM, "--out"], &odd(".json"), &[]);
    let study = odd(".toml");
    write(&study, TINY);
    made(&["sweep"], &study, &[OsStr::new("--out"), odd(".sweep").as_os_str()]);
}
