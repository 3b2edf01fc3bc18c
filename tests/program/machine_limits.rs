//! Tests of a lack of resources of the machine: threads, and space in files. Each failure is reported in one sentence,
//! and files that are already written remain.
#![cfg(unix)]

use crate::program::*;

const STUDY: &str =
    "name = 'two'\n[base]\nscene = 'cradle'\nduration = 0.1\n[vary]\ndt = [1e-3, 2e-3]\n";

const DRAWN: &str = "--headless --scene cradle --duration 0.1 --renderer cpu --size 16x16";
/// Stack size of a thread, bytes, that is larger than any machine can provide, so that no thread can start.
const NO_ROOM: &str = "70368744177664";

#[test]
fn without_threads_what_needs_them_is_refused_and_what_does_not_runs() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    write(at("study.toml"), STUDY);
    let without_threads = |line: &str, out: &str| {
        let mut command = slump(line);
        command.arg(at(out)).env("RUST_MIN_STACK", NO_ROOM).current_dir(folder.path());
        command
    };
    let said =
        sentence(&mut without_threads("--headless --scene cradle --duration 0.1 --data", "d"));
    assert!(said.contains("data is recorded, but must be left out where no thread"), "{said}");
    for line in ["sweep study.toml --out", "--headless --renderer cpu --frames"] {
        let said = sentence(&mut without_threads(line, "out"));
        assert!(said.contains("the number of threads is too high"), "{line}: {said}");
    }
    for (option, out) in [("--frames", "f"), ("--gif", "a.gif")] {
        succeed(&mut without_threads(&format!("{DRAWN} {option}"), out));
        assert!(at(out).exists(), "{option}");
    }
}

#[test]
fn more_threads_than_any_machine_has_are_refused() {
    let folder = folder();
    write(folder.path().join("study.toml"), STUDY);
    let mut sweep = slump("sweep study.toml --out out");
    let said = sentence(sweep.env("RAYON_NUM_THREADS", "100000").current_dir(folder.path()));
    assert!(said.contains("RAYON_NUM_THREADS is 100000, but must be"), "{said}");
}

/// Returns a command that runs the program under a limit of the shell, such as "-f 8" (the arguments of `ulimit`).
fn limited(limit: &str, line: &str, out: &Path) -> Command {
    let mut command = Command::new("sh");
    command.args(["-c", &format!("ulimit {limit}; exec \"$@\""), "sh"]);
    command.arg(slump("").get_program()).args(line.split(' ')).arg(out);
    command
}

const LONG_DATA: &str = "--headless --scene cradle --duration 50 --data-format csv --data";

#[test]
fn a_stack_that_would_overflow_is_refused() {
    let folder = folder();
    let out = folder.path().join("out");
    for kib in ["512", "192"] {
        let said = sentence(&mut limited(&format!("-s {kib}"), LONG_DATA, &out));
        assert!(said.contains(&format!("the limit on the stack in KiB is {kib}, but")), "{said}");
    }
    assert!(!out.exists());
    succeed(&mut limited("-s 1024", "--headless --scene cradle --duration 0.5 --data", &out));
}

#[test]
fn too_few_descriptors_are_told_and_what_was_whole_stays() {
    let folder = folder();
    let mut refused = 0;
    for count in 4..16 {
        let out = folder.path().join(count.to_string());
        let line = "--headless --scene cradle --duration 0.5 --data-format csv --data";
        let output = limited(&format!("-n {count}"), line, &out).output().expect("a shell");
        let said = String::from_utf8_lossy(&output.stderr);
        if output.status.code() != Some(0) {
            refused += 1;
            assert_eq!(output.status.code(), Some(2), "{count}: {said}");
            assert!(said.contains("Too many open files"), "{said}");
        }
        let names = if out.exists() { names_in(&out) } else { Vec::new() };
        assert!(names.iter().all(|name| !name.contains("tmp")), "{count}: {names:?}");
    }
    assert!((3..12).contains(&refused), "{refused} of 12");
}

#[test]
fn a_limit_on_the_size_of_files_is_told_and_what_fits_stays() {
    let folder = folder();
    let out = folder.path().join("out");
    let said = failure(&mut limited("-f 64", LONG_DATA, &out));
    assert!(said.contains("File too large"), "{said}");
    assert!(out.join("frames.csv").exists());
}

#[test]
fn a_table_that_is_removed_while_it_is_written_is_told() {
    let folder = folder();
    let table = folder.path().join("observables.csv");
    let run =
        "--headless --scene cradle --dt 1e-3 --duration 3000 --size 64x18 --renderer cpu --frames";
    let mut child =
        slump(run).arg(folder.path()).stderr(Stdio::piped()).spawn().expect("the program starts");
    wait_for("rows", || table.metadata().is_ok_and(|rows| rows.len() > 10_000));
    std::fs::remove_file(&table).expect("a table");
    send("INT", child.id().into());
    assert_eq!(ended(&mut child), Some(2));
    let said = std::io::read_to_string(child.stderr.take().expect("stderr")).expect("UTF-8");
    assert!(said.contains("observables.csv: was removed or replaced, but must stay"), "{said}");
}

#[test]
fn a_step_that_is_longer_than_the_run_is_refused() {
    let folder = folder();
    let run = "--headless --scene cradle --dt 2 --duration 0.5 --renderer cpu --frames";
    let said = sentence(slump(run).arg(folder.path().join("out")));
    assert!(said.contains("dt is 2 s where duration is 0.5 s, but must be such that"), "{said}");
    // A refused duration is named in the error message.
    let run = "--headless --scene cradle --duration 1e6 --renderer cpu --frames";
    let said = sentence(slump(run).arg(folder.path().join("out")));
    assert!(said.contains("duration is 1000000, but must be such that its pictures"), "{said}");
}

#[test]
fn substeps_of_very_small_grains_are_told_of_before_they_begin() {
    let folder = folder();
    let mut discs = "x,y,radius\n0,0.02,0.01\n".to_owned();
    discs.push_str("0.1,0.02,3e-6\n");
    let path = folder.path().join("discs.csv");
    write(&path, discs);
    let run =
        "--headless --stepper dem --renderer cpu --duration 5 --size 16x9 --base-width 30 --frames";
    let mut child = slump(run)
        .arg(folder.path().join("out"))
        .arg("--initial")
        .arg(&path)
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    std::thread::sleep(Duration::from_secs(2));
    kill(&mut child);
    let said = std::io::read_to_string(child.stderr.take().expect("stderr")).expect("UTF-8");
    assert!(said.contains("steps, which take long"), "{said}");
}

mod with_ffmpeg {
    use super::*;

    #[test]
    #[ignore = "needs ffmpeg"]
    fn without_threads_a_video_is_made() {
        let folder = folder();
        let video = folder.path().join("v.mp4");
        let mut command = slump(&format!("{DRAWN} --video"));
        succeed(command.arg(&video).env("RUST_MIN_STACK", NO_ROOM));
        assert!(video.exists());
    }
}
