//! Whole files at every moment: while they grow, and after a kill.

use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use crate::formats::moments::{moment, start, write};

/// Tells the process that is to be killed where to write.
const FOLDER: &str = "SLUMP_TEST_FORMATS_FOLDER";
const KILLS: usize = 12;
const MOST_FRAMES: u64 = 100_000;

/// What a file says at one moment: reading takes several calls, between which it may change.
fn snapshot_of(path: &Path) -> String {
    let read = || std::fs::read_to_string(path).expect("text");
    let (mut text, mut again) = (read(), read());
    while text != again {
        text = std::mem::replace(&mut again, read());
    }
    text
}

/// The times of a series, which must be whole, and whose files must be.
pub fn frames_of_series(path: &Path) -> Vec<f64> {
    let text = snapshot_of(path);
    let body = text.strip_prefix("<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\"");
    let body = body.and_then(|text| text.strip_suffix("</Collection>\n</VTKFile>\n"));
    let body = body.unwrap_or_else(|| panic!("{} is not whole:\n{text}", path.display()));
    let entries = body.lines().skip(2).filter(|line| !line.trim().is_empty());
    let times = entries.map(|entry| {
        let parts: Vec<&str> = entry.trim_end().split('"').collect();
        let ["<DataSet timestep=", time, " file=", file, "/>"] = parts[..] else {
            panic!("{}: {entry}", path.display())
        };
        let bytes = std::fs::read(path.with_file_name(file)).expect("a file of the series");
        assert!(bytes.ends_with(b"\n  </AppendedData>\n</VTKFile>\n"), "{file}");
        time.parse().expect("a time")
    });
    times.collect()
}

/// The steps of a dump, which must have whole frames, but for the last one where a kill came in the moment of writing.
pub fn frames_of_dump(path: &Path) -> Vec<u64> {
    let text = snapshot_of(path);
    let mut lines = text.lines().peekable();
    let mut steps = Vec::new();
    while let Some(line) = lines.next() {
        match line.trim_end() {
            "ITEM: UNITS" => assert_eq!(lines.next(), Some("si")),
            "ITEM: PARAMETERS" => {
                while lines.next_if(|line| !line.starts_with("ITEM:")).is_some() {}
            }
            "ITEM: TIME" => {
                let Some(step) = read_frame(&mut lines) else {
                    assert_eq!(lines.next(), None, "{}: a cut frame", path.display());
                    break;
                };
                steps.push(step);
            }
            _ => panic!("{}: {line}", path.display()),
        }
    }
    steps
}

/// The step of a frame; none where something is missing.
fn read_frame<'a>(lines: &mut impl Iterator<Item = &'a str>) -> Option<u64> {
    lines.next()?.parse::<f64>().ok()?;
    lines.next().filter(|line| *line == "ITEM: TIMESTEP")?;
    let step = lines.next()?.parse().ok()?;
    lines.next().filter(|line| line.starts_with("ITEM: NUMBER OF "))?;
    let count: usize = lines.next()?.parse().ok()?;
    lines.next().filter(|line| line.starts_with("ITEM: BOX BOUNDS"))?;
    for _ in 0..3 {
        lines.next().filter(|line| line.split(' ').count() == 2)?;
    }
    let columns = lines.next()?.split(' ').count() - 2;
    for _ in 0..count {
        lines.next().filter(|line| line.split(' ').count() == columns)?;
    }
    Some(step)
}

fn check(folder: &Path) -> usize {
    let of_kind = ["grains", "contacts"].map(|kind| {
        let dump = frames_of_dump(&folder.join(format!("ovito/{kind}.dump")));
        assert!(dump.iter().copied().eq((0..dump.len() as u64).map(|number| 10 * number)));
        frames_of_series(&folder.join(format!("vtk/{kind}.pvd"))).len()
    });
    of_kind[1]
}

#[test]
fn files_are_whole_while_they_grow() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut recording = start(folder.path());
    write(&mut recording, 0..1);
    let done = AtomicBool::new(false);
    std::thread::scope(|scope| {
        scope.spawn(|| {
            write(&mut recording, 1..300);
            done.store(true, Ordering::Relaxed);
        });
        let mut seen = std::collections::BTreeSet::new();
        while !done.load(Ordering::Relaxed) {
            seen.insert(check(folder.path()));
        }
        assert!(seen.len() > 3, "the situation: {seen:?}");
    });
    assert_eq!(check(folder.path()), 300);
}

#[test]
fn files_are_whole_after_a_kill() {
    let mut random = Pcg64::seed_from_u64(14);
    let mut most = 0;
    for _ in 0..KILLS {
        let folder = tempfile::tempdir().expect("a folder");
        let mut child = Command::new(std::env::current_exe().expect("this program"))
            .args(["--exact", "formats::whole::writes_until_it_is_killed", "--ignored"])
            .env(FOLDER, folder.path())
            .stdout(Stdio::null())
            .spawn()
            .expect("a process");
        while !folder.path().join("ovito/contacts.dump").exists() {
            std::thread::sleep(Duration::from_millis(1));
        }
        std::thread::sleep(Duration::from_micros(random.random_range(0..60_000)));
        child.kill().expect("a kill");
        child.wait().expect("its end");
        most = most.max(check(folder.path()));
    }
    assert!(most > 3, "the situation: at most {most} frames");
}

#[test]
#[ignore = "for the test above alone"]
fn writes_until_it_is_killed() {
    if let Some(folder) = std::env::var_os(FOLDER) {
        let mut recording = start(Path::new(&folder));
        (0..MOST_FRAMES).for_each(|number| recording.add(moment(10 * number)).expect("a frame"));
    }
}
