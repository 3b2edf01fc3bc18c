//! Tests of runs that are killed or stopped, or that fill the disk: their recordings are complete up to the last frame.

use rand::RngExt;
use rand_pcg::Pcg64;
use rand_pcg::rand_core::SeedableRng;

use super::tables::{csv, parquet, parts, steps};
use super::*;

/// Arguments of a run of several minutes that records a frame every second step.
const LONG: &str = "--headless --duration 1000 --data-every 0.002 --data-format parquet,csv --max-sweeps 20 --data";

fn start(out: &Path) -> Child {
    let mut command = slump(LONG);
    command.arg(out).stdout(Stdio::null()).stderr(Stdio::null());
    command.spawn().expect("the program starts")
}

/// Returns the step numbers of the frames in the recording's list of frames (`frames.csv`). An incomplete last row is
/// omitted.
fn indexed(folder: &Path) -> Vec<u64> {
    let index = std::fs::read_to_string(folder.join("frames.csv")).unwrap_or_default();
    let whole = index.rfind('\n').map_or("", |end| &index[..end]);
    let rows = whole.lines().skip_while(|line| !line.starts_with("step")).skip(1);
    rows.map(|row| row.split(',').next().expect("a step").parse().expect("a number")).collect()
}

/// Checks that every table in every format contains all frames that are in the recording's list of frames
/// (`frames.csv`). Returns the number of these frames.
fn check(folder: &Path) -> usize {
    let frames = indexed(folder);
    assert!(frames.iter().copied().eq((0..frames.len() as u64).map(|frame| 2 * frame)));
    let last = frames.last().copied().unwrap_or(0);
    for table in ["grains", "contacts", "measures", "histograms", "steps"] {
        let found = parquet(folder, table);
        let there = steps(&found);
        let expected: Vec<u64> = match table {
            "steps" => (1..=last).collect(),
            _ => frames.clone(),
        };
        assert!(there.starts_with(&expected), "{table} in Parquet up to {last}: {there:?}");
        // A kill may leave an incomplete last row in a text file.
        let path = folder.join(format!("csv/{table}.csv"));
        let text = read(&path);
        let whole = text.rfind('\n').map_or("", |end| &text[..=end]);
        let copy = folder.join("whole.csv");
        write(&copy, whole);
        let in_text = csv(&copy, &found);
        assert!(steps(&in_text).starts_with(&expected), "{table} in text up to {last}");
        let rows = found["step"].iter().filter(|step| super::tables::whole(step) <= last).count();
        for (name, cells) in &found {
            assert_eq!(in_text[name][..rows], cells[..rows], "{name} of {table}");
        }
    }
    frames.len()
}

/// Returns the names of hidden files in a folder and its subfolders, except lock files.
fn hidden(folder: &Path) -> Vec<String> {
    let mut found = Vec::new();
    for name in names_in(folder) {
        if folder.join(&name).is_dir() {
            found.extend(hidden(&folder.join(name)));
        } else if name.starts_with('.') && !name.ends_with("lock") {
            found.push(name);
        }
    }
    found
}

#[test]
fn what_a_kill_leaves_of_a_file_that_was_whole_is_no_rows_and_goes_with_the_next_run() {
    let folder = folder();
    let out = text(folder.path());
    let first = || {
        let mut command = slump("--headless --data-every 0.01 --duration 0.03 --data");
        command.arg(out);
        command
    };
    succeed(&mut first());
    let rows = |what: &str| {
        let grains = steps(&parquet(folder.path(), "grains"));
        assert!(!grains.is_empty(), "{what}");
        grains
    };
    let expected = rows("before");
    let plant = || {
        let part = folder.path().join("grains/part-00000.parquet");
        for left in ["grains/.part-00000.parquet.41-7.part", ".data.json.41-8.part"] {
            std::fs::copy(&part, folder.path().join(left)).expect("a copy");
        }
        assert_eq!(hidden(folder.path()).len(), 2);
    };
    plant();
    // The program reads the whole folder and ignores the hidden files.
    let beside = crate::program::folder();
    let read = "--headless --duration 0.002 --initial";
    succeed(slump(read).arg(out).arg("--data").arg(beside.path()));
    succeed(first().arg("--overwrite"));
    assert_eq!(hidden(folder.path()), Vec::<String>::new());
    assert_eq!(rows("after"), expected);

    plant();
    let scene = scene("pile");
    let about = slump::config::scene_facts(&scene).expect("facts");
    let formats = [FormatName::Parquet];
    drop(
        Recording::go_on(folder.path(), &formats, &about, 0, &RecordingMark::default())
            .expect("goes on"),
    );
    assert_eq!(hidden(folder.path()), Vec::<String>::new());
}

#[test]
fn a_run_that_is_killed_at_any_moment_leaves_every_frame_that_it_told_of() {
    let mut random = Pcg64::seed_from_u64(5);
    let mut most = 0;
    for _ in 0..6 {
        let folder = folder();
        let mut child = start(folder.path());
        wait_for("the first frames", || indexed(folder.path()).len() > 1);
        std::thread::sleep(Duration::from_micros(random.random_range(0..400_000)));
        kill(&mut child);
        most = most.max(check(folder.path()));
        let is_whole = |part: &PathBuf| part.extension().is_some_and(|it| it == "parquet");
        assert!(parts(folder.path(), "grains").iter().all(is_whole));
        // While a file replaces another file, it briefly has a second name.
        let left = hidden(folder.path());
        assert!(left.len() <= 1, "{left:?}");
        // The remaining files must not prevent the next run.
        let again = "--headless --overwrite --duration 0.01 --data";
        succeed(slump(again).arg(folder.path()));
        assert_eq!(hidden(folder.path()), Vec::<String>::new());
    }
    assert!(most > 10, "some went on for a while: {most}");
}

#[test]
fn a_reader_may_look_at_a_recording_that_grows() {
    let folder = folder();
    let mut child = start(folder.path());
    let mut seen = 0;
    wait_for("several parts", || {
        let frames = indexed(folder.path()).len();
        let grains = steps(&parquet(folder.path(), "grains"));
        assert!(grains.len() >= frames && frames >= seen);
        seen = frames;
        parts(folder.path(), "grains").len() > 3
    });
    kill(&mut child);
    check(folder.path());
}

#[test]
fn a_signal_ends_a_recording_whole() {
    for (signal, code) in [("INT", 130), ("TERM", 143)] {
        let folder = folder();
        let mut child = start(folder.path());
        wait_for("frames", || indexed(folder.path()).len() > 5);
        send(signal, child.id().into());
        assert_eq!(ended(&mut child), Some(code));
        let frames = check(folder.path()) as u64;
        let grains = steps(&parquet(folder.path(), "grains"));
        assert_eq!(grains.len() as u64, frames, "no frame that the index does not tell of");
        // Each step has its row in the table of steps, also after the last frame.
        let taken = *steps(&parquet(folder.path(), "steps")).last().expect("rows");
        assert!((2 * (frames - 1)..2 * frames).contains(&taken), "{taken} steps, {frames} frames");
    }
}

#[test]
fn a_full_disk_ends_the_run_with_a_sentence_and_leaves_whole_frames() {
    let folder = folder();
    // The limit on the length of files has the effect of a full disk. Text files reach the limit first.
    let script = "trap '' XFSZ; ulimit -f 1024; exec \"$@\"";
    let mut small = Command::new("sh");
    small.args(["-c", script, "sh"]).arg(slump("").get_program()).args(LONG.split(' '));
    let said = failure(small.arg(folder.path()));
    assert!(said.contains("csv: File too large"), "{said}");
    let frames = check(folder.path());
    assert!(frames > 3, "{frames}");
}

/// Returns the resident memory of a process, kB.
#[cfg(target_os = "linux")]
fn memory(child: &Child) -> u64 {
    let status = read(format!("/proc/{}/status", child.id()));
    let line = status.lines().find(|line| line.starts_with("VmRSS:")).expect("a line");
    line.split_whitespace().nth(1).expect("a number").parse().expect("a number")
}

#[test]
#[cfg(target_os = "linux")]
fn memory_does_not_grow_with_the_run() {
    let folder = folder();
    let mut child = start(folder.path());
    let bytes = || -> u64 {
        parts(folder.path(), "contacts")
            .iter()
            .filter_map(|part| part.metadata().ok())
            .map(|about| about.len())
            .sum()
    };
    wait_for("a first part", || parts(folder.path(), "contacts").len() > 3);
    let (first, written) = (memory(&child), bytes());
    wait_for("many parts", || bytes() > written + (8 << 20));
    let later = memory(&child);
    kill(&mut child);
    assert!(later < first + (4 << 10), "{first} kB, and {later} kB after 8 MB more");
}
