//! Tests that the files of a recording are complete at every time: while they grow, and after a kill.

use std::sync::atomic::{AtomicBool, Ordering};

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use slump::data::Recording;

use super::{FORMATS, about, go_on, moment, start, write_frames};
use crate::program::*;

/// Environment variable by which the test tells its child process, which it later kills, the output folder.
const FOLDER: &str = "SLUMP_TEST_FORMATS_FOLDER";
const KILLS: usize = 12;
const MOST_FRAMES: u64 = 100_000;

/// Returns the content of a file that another process may be changing. Reading takes several calls, so the file is read
/// until two results are equal.
fn snapshot_of(path: &Path) -> String {
    let (mut text, mut again) = (read(path), read(path));
    while text != again {
        text = std::mem::replace(&mut again, read(path));
    }
    text
}

/// Returns the simulated times in a VTK series (`.pvd`), s. Checks that the series and the files that it lists are
/// complete.
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
        let bytes = bytes(path.with_file_name(file));
        assert!(bytes.ends_with(b"\n  </AppendedData>\n</VTKFile>\n"), "{file}");
        time.parse().expect("a time")
    });
    times.collect()
}

/// Returns the step numbers of the frames in a LAMMPS dump. Checks that the dump consists of complete frames and at
/// most one incomplete frame at the end.
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
            draft if draft.starts_with("ITEM: D") => break,
            // Dumps of grains have no item `TIME`, because readers expect a fixed number of lines per frame.
            item @ ("ITEM: TIME" | "ITEM: TIMESTEP") => {
                let step = read_frame(&mut lines, item == "ITEM: TIME");
                let left: Vec<&str> = lines.clone().take(8).collect();
                steps.push(step.unwrap_or_else(|| {
                    panic!("{}: a cut frame ahead of {left:?}", path.display())
                }));
            }
            _ => panic!("{}: {line}", path.display()),
        }
    }
    steps
}

/// Returns the step number of a frame of a dump, or `None` if the frame is incomplete.
fn read_frame<'a>(lines: &mut impl Iterator<Item = &'a str>, has_time: bool) -> Option<u64> {
    if has_time {
        lines.next()?.parse::<f64>().ok()?;
        lines.next().filter(|line| *line == "ITEM: TIMESTEP")?;
    }
    let step = lines.next()?.parse().ok()?;
    lines.next().filter(|line| line.starts_with("ITEM: NUMBER OF "))?;
    let count: usize = lines.next()?.parse().ok()?;
    lines.next().filter(|line| line.starts_with("ITEM: BOX BOUNDS"))?;
    for _ in 0..3 {
        assert_eq!(lines.next()?.split(' ').count(), 2);
    }
    let columns = lines.next()?.split(' ').count() - 2;
    for _ in 0..count {
        assert_eq!(lines.next()?.split(' ').count(), columns);
    }
    Some(step)
}

fn check(folder: &Path) -> usize {
    let of_kind = ["grains", "contacts"].map(|kind| {
        let dump = frames_of_dump(&folder.join(format!("ovito/{kind}.dump")));
        assert!(dump.iter().copied().eq((0..dump.len() as u64).map(|number| 10 * number)));
        frames_of_series(&folder.join(format!("vtk/{kind}.pvd"))).len()
    });
    frames_of_series(&folder.join("fields/fields.pvd"));
    of_kind[1]
}

#[test]
fn files_are_whole_while_they_grow() {
    let folder = folder();
    let mut recording = start(folder.path());
    write_frames(&mut recording, 0..1);
    let done = AtomicBool::new(false);
    std::thread::scope(|scope| {
        scope.spawn(|| {
            write_frames(&mut recording, 1..300);
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
        let folder = folder();
        let mut child = Command::new(std::env::current_exe().expect("this program"))
            .args(["--exact", "formats::whole::writes_until_it_is_killed", "--ignored"])
            .env(FOLDER, folder.path())
            .stdout(Stdio::null())
            .spawn()
            .expect("a process");
        wait_for("a dump", || folder.path().join("ovito/contacts.dump").exists());
        std::thread::sleep(Duration::from_micros(random.random_range(0..60_000)));
        kill(&mut child);
        let frames = check(folder.path());
        most = most.max(frames);
        // The recording can be resumed after the kill. The last frames may exist in only one of the formats.
        let mut later = go_on(folder.path(), 10 * frames as u64);
        let kept = later.frames();
        write_frames(&mut later, kept..kept + 2);
        assert_eq!(check(folder.path()) as u64, kept + 2);
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

#[test]
fn a_series_is_whole_after_every_frame_of_many() {
    let folder = folder();
    let mut recording = start(folder.path());
    for number in 0..70 {
        write_frames(&mut recording, number..number + 1);
        for kind in ["grains", "contacts"] {
            let series = frames_of_series(&folder.path().join(format!("vtk/{kind}.pvd")));
            let times: Vec<f64> = (0..=number).map(|number| (10 * number) as f64 * 0.1).collect();
            assert_eq!(series, times, "{kind}");
            let dump = frames_of_dump(&folder.path().join(format!("ovito/{kind}.dump")));
            assert_eq!(dump.len() as u64, number + 1, "{kind}");
        }
    }
}

#[test]
fn rolled_back_frames_are_as_if_they_had_never_been() {
    for (written, kept) in [(5, 3), (5, 5), (40, 1), (40, 39)] {
        let [rolled, straight] = [(); 2].map(|()| folder());
        write_frames(&mut start(rolled.path()), 0..written);
        // The run resumes at a step that has no frame, after the last frame that is kept.
        let mut later = go_on(rolled.path(), 10 * kept - 1);
        assert_eq!(names(rolled.path()).len() as u64, 6 + 3 * kept, "{written}, {kept}");
        write_frames(&mut later, kept..written + 2);
        write_frames(&mut start(straight.path()), 0..written + 2);
        assert_eq!(names(rolled.path()), names(straight.path()), "{written}, {kept}");
        for name in names(straight.path()) {
            let [found, expected] = [&rolled, &straight].map(|it| bytes(it.path().join(&name)));
            assert!(found == expected, "{name} of {written}, {kept}");
        }
    }
}

#[test]
fn a_frame_that_only_some_formats_have_is_written_again() {
    for kept in [0, 2] {
        let [cut, straight] = [(); 2].map(|()| folder());
        write_frames(&mut start(cut.path()), 0..3);
        // The list of frames as it is after a kill between writing the last frames and writing the list.
        let list = cut.path().join("frames.csv");
        let text = read(&list);
        let lines: Vec<&str> = text.lines().collect();
        let until_kept = lines.len() - 3 + kept;
        write(&list, lines[..until_kept].join("\n") + "\n");
        write_frames(&mut go_on(cut.path(), 25), kept as u64..4);
        write_frames(&mut start(straight.path()), 0..4);
        for name in names(straight.path()) {
            let [found, expected] = [&cut, &straight].map(|it| bytes(it.path().join(&name)));
            assert!(found == expected, "{name} after {kept} frames");
        }
    }
}

#[test]
fn an_earlier_recording_is_removed_with_all_its_files() {
    let folder = folder();
    write_frames(&mut start(folder.path()), 0..3);
    assert_eq!(names(folder.path()).len(), 15);
    write(folder.path().join("vtk/grains_1.vtp"), "not of a recording");
    drop(Recording::start(folder.path(), FORMATS, &about(), true).expect("a recording"));
    assert_eq!(names(folder.path()), ["vtk/grains_1.vtp"]);
}

fn names(folder: &Path) -> Vec<String> {
    let of = |below: &str| {
        let names = names_in(&folder.join(below)).into_iter();
        names.map(|name| format!("{below}/{name}")).collect::<Vec<_>>()
    };
    [of("fields"), of("ovito"), of("vtk")].concat()
}
