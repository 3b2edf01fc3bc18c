//! What a sweep makes of folders that were damaged, emptied or left half done, and of runs that went
//! wrong.

use std::path::{Path, PathBuf};
use std::process::Stdio;
use std::time::Duration;

use super::{folder, in_one_go, runs, said, slump, study, sweep};

/// Three short runs with a course each.
const SHORT: &str = "
name = 'short'
[base]
scene = 'cradle'
duration = 0.02
[vary]
start = [7.0, 7.5, 8.0]
[series]
interval = 0.01
grains = [0]
";

fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).expect("a folder");
    let mut paths: Vec<_> = entries.map(|entry| entry.expect("a file").path()).collect();
    paths.sort();
    paths
}

#[test]
fn a_damaged_record_is_named_and_computed_anew() {
    let folder = folder();
    let study = study(folder.path(), SHORT);
    let whole = in_one_go(folder.path(), &study);
    let out = folder.path().join("whole");
    let journal = out.join("runs.jsonl");
    let sound = std::fs::read(&journal).expect("the journal");
    let text = String::from_utf8(sound.clone()).expect("UTF-8");
    assert_eq!(text.lines().count(), 3);
    // A digit of a result, bits all over the file, an end of line that is gone, and one too many.
    let digit = text.find("\"largest_residual\":").expect("a result") + 19;
    let mut damages: Vec<(usize, u8)> =
        (0..10).map(|k| (k * text.len() / 10 + 3, 1 << (k % 8))).collect();
    damages.push((digit, 1));
    damages.push((text.find('\n').expect("a line"), 0x20));
    damages.push((text.find(',').expect("a comma"), b',' ^ b'\n'));
    for (place, bits) in damages {
        let mut bytes = sound.clone();
        bytes[place] ^= bits;
        std::fs::write(&journal, &bytes).expect("the journal");
        std::fs::remove_file(out.join("runs.csv")).expect("the table");
        let output = sweep(&study, &out, &[]);
        assert!(output.status.success(), "byte {place}: {}", said(&output));
        let named = said(&output).matches("runs.jsonl: line ").count();
        assert!((1..=2).contains(&named), "byte {place}: {}", said(&output));
        assert_eq!(runs(&out), whole, "byte {place}");
        let again = sweep(&study, &out, &[]);
        assert!(!said(&again).contains("damaged"), "told of once: {}", said(&again));
    }
}

#[test]
fn a_damaged_state_is_named_and_settled_anew() {
    let folder = folder();
    let text =
        "name = 'pile'\n[base]\ngrains = 20\nbox-width = 6\nduration = 0.01\n[vary]\nseed = [1]\n";
    let study = study(folder.path(), text);
    let whole = in_one_go(folder.path(), &study);
    let out = folder.path().join("whole");
    let state = files(&out.join("states")).remove(0);
    let sound = std::fs::read_to_string(&state).expect("a state");
    let digit = sound.rfind("e-").expect("a number") - 1;
    let mut bytes = sound.clone().into_bytes();
    assert!(bytes[digit].is_ascii_digit());
    bytes[digit] ^= 1;
    std::fs::write(&state, bytes).expect("the state");
    std::fs::remove_file(out.join("runs.jsonl")).expect("the journal");
    let output = sweep(&study, &out, &[]);
    assert!(output.status.success() && said(&output).contains("is damaged"), "{}", said(&output));
    assert!(said(&output).contains("states"), "{}", said(&output));
    assert_eq!((runs(&out), std::fs::read_to_string(&state).expect("a state")), (whole, sound));
}

#[test]
fn deleted_courses_are_made_again() {
    let folder = folder();
    let study = study(folder.path(), SHORT);
    let whole = in_one_go(folder.path(), &study);
    let out = folder.path().join("whole");
    let course = files(&out.join("series")).remove(1);
    let before = std::fs::read(&course).expect("a course");
    std::fs::remove_file(&course).expect("it was there");
    let output = sweep(&study, &out, &[]);
    assert!(said(&output).contains("2 of 3 runs were there"), "{}", said(&output));
    assert_eq!((runs(&out), std::fs::read(&course).ok()), (whole, Some(before)));
}

#[test]
fn a_course_that_was_edited_is_named_and_computed_anew() {
    let folder = folder();
    let study = study(folder.path(), SHORT);
    let whole = in_one_go(folder.path(), &study);
    let out = folder.path().join("whole");
    let courses = files(&out.join("series"));
    let before = courses.iter().map(|path| std::fs::read(path).expect("a course"));
    let before: Vec<_> = before.collect();
    // One digit of the last row, and a last row that is gone.
    let digit = before[0].iter().rposition(u8::is_ascii_digit).expect("a number");
    let mut edited = before[0].clone();
    edited[digit] ^= 1;
    std::fs::write(&courses[0], edited).expect("a course");
    let text = String::from_utf8(before[2].clone()).expect("UTF-8");
    let (shorter, _) = text.trim_end().rsplit_once('\n').expect("rows");
    std::fs::write(&courses[2], format!("{shorter}\n")).expect("a course");
    let output = sweep(&study, &out, &[]);
    assert!(said(&output).contains("1 of 3 runs were there"), "{}", said(&output));
    for (number, course) in courses.iter().enumerate() {
        let named = said(&output).contains(&format!("{}: is damaged", course.display()));
        assert_eq!(named, number != 1, "{}", said(&output));
        assert_eq!(std::fs::read(course).ok().as_ref(), before.get(number), "course {number}");
    }
    assert_eq!(runs(&out), whole);
    let again = sweep(&study, &out, &[]);
    assert!(said(&again).contains("3 of 3 runs were there"), "{}", said(&again));
}

#[test]
fn redo_works_on_what_cannot_be_read() {
    let folder = folder();
    let study = study(folder.path(), SHORT);
    let whole = in_one_go(folder.path(), &study);
    let out = folder.path().join("whole");
    for name in ["study.json", "runs.jsonl"] {
        std::fs::write(out.join(name), b"\xff\x00{\"checksum\"\n\n").expect("a file");
    }
    let refused = sweep(&study, &out, &[]);
    assert_eq!(refused.status.code(), Some(2), "{}", said(&refused));
    let redone = sweep(&study, &out, &["--redo"]);
    assert!(redone.status.success(), "{}", said(&redone));
    assert_eq!(runs(&out), whole);
    // Two sound records that say different things of one run.
    let journal = out.join("runs.jsonl");
    let text = std::fs::read_to_string(&journal).expect("the journal");
    let line = text.lines().next().expect("a record");
    let (_, record) = line.split_once("\"record\":").expect("a record");
    let record = record[..record.len() - 1].replacen("\"sweeps\":", "\"sweeps\":1", 1);
    let checksum = &blake3::hash(record.as_bytes()).to_hex()[..16];
    let other = format!("{{\"checksum\":\"{checksum}\",\"record\":{record}}}\n");
    std::fs::write(&journal, text.clone() + &other).expect("the journal");
    let refused = sweep(&study, &out, &[]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(said(&refused).contains("came out otherwise before"), "{}", said(&refused));
    let redone = sweep(&study, &out, &["--redo"]);
    assert!(redone.status.success(), "{}", said(&redone));
    assert_eq!(runs(&out), whole);
}

#[test]
fn a_redo_that_is_killed_leaves_one_study_and_never_a_mixture() {
    let folder = folder();
    let places = ["old", "new"].map(|name| folder.path().join(name));
    let texts = [SHORT.to_owned(), SHORT.replace("short", "other").replace("0.02", "2.0")];
    let [old, new] = [0, 1].map(|k| {
        std::fs::create_dir(&places[k]).expect("a folder");
        let file = study(&places[k], &texts[k]);
        let table = in_one_go(&places[k], &file);
        (file, table)
    });
    let out = folder.path().join("out");
    let mut found = [0, 0];
    for round in 0..12u64 {
        assert!(sweep(&old.0, &out, &["--redo"]).status.success());
        let mut redo = slump();
        redo.arg("sweep").arg(&new.0).arg("--out").arg(&out).arg("--redo");
        let mut child =
            redo.stderr(Stdio::null()).stdout(Stdio::null()).spawn().expect("it starts");
        std::thread::sleep(Duration::from_millis(round * round));
        // It may have ended by itself.
        let _ = child.kill();
        child.wait().expect("it ended");
        let label = std::fs::read_to_string(out.join("study.json")).expect("a label");
        let is_new = label.contains("\"other\"");
        found[usize::from(is_new)] += 1;
        let (file, table) = if is_new { &new } else { &old };
        if let Ok(left) = std::fs::read_to_string(out.join("runs.csv")) {
            assert_eq!(&left, table, "round {round}: the other study's table");
        }
        assert!(sweep(file, &out, &[]).status.success(), "round {round}");
        assert_eq!(&runs(&out), table, "round {round}");
    }
    assert!(found[0] > 0 && found[1] > 0, "killed before and after the change: {found:?}");
}

#[test]
fn a_redo_takes_the_folder_over_only_once_the_old_table_is_gone() {
    let folder = folder();
    let old = study(folder.path(), SHORT);
    in_one_go(folder.path(), &old);
    let out = folder.path().join("whole");
    let label = || std::fs::read_to_string(out.join("study.json")).expect("a label");
    let before = label();
    // What cannot be removed stops it where a kill would have to come at the right moment.
    std::fs::remove_file(out.join("runs.csv")).expect("a table");
    std::fs::create_dir(out.join("runs.csv")).expect("a folder in its place");
    let new = study(folder.path(), &SHORT.replace("short", "other"));
    let stopped = sweep(&new, &out, &["--redo"]);
    assert_eq!(stopped.status.code(), Some(2), "{}", said(&stopped));
    assert_eq!(label(), before, "the new study's label beside the old one's table");
    std::fs::remove_dir(out.join("runs.csv")).expect("a folder");
    assert!(sweep(&new, &out, &["--redo"]).status.success());
    assert!(label().contains("\"other\""));
}

#[test]
fn runs_that_went_wrong_say_so_in_the_table_and_are_read_back_as_they_were() {
    let folder = folder();
    // Springs far beyond what one substep can follow: the first run's residual overflows, the second's
    // state does.
    let text = "
name = 'wrong'
[base]
scene = 'cradle'
stepper = 'dem'
substeps = 1
[vary]
'dt duration' = [[1e100, 2e102], [1e200, 2e202]]
";
    let study = study(folder.path(), text);
    let out = folder.path().join("out");
    let first = sweep(&study, &out, &[]);
    assert!(first.status.success(), "{}", said(&first));
    assert!(said(&first).contains("2 of 2 runs raised alarms ("), "{}", said(&first));
    let table = runs(&out);
    let mut lines = table.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let header = lines.next().expect("a header");
    let column = |name: &str| header.iter().position(|column| *column == name).expect("a column");
    let rows: Vec<_> = lines.collect();
    let [status, alarms] = ["status", "alarms"].map(column);
    let told = [0, 1].map(|run| (rows[run][status], rows[run][alarms].contains("not-finite")));
    assert_eq!(told, [("done", false), ("not-finite", true)], "{table}");
    let residual: f64 = rows[0][column("largest_residual")].parse().expect("a number");
    assert!(!residual.is_finite(), "{table}");
    for row in &rows {
        assert_ne!(row[column("unconverged_steps")], "0", "{table}");
        assert_eq!(row[column("lost_grains")], "0", "{table}");
    }
    let again = sweep(&study, &out, &[]);
    assert!(again.status.success(), "{}", said(&again));
    assert!(said(&again).contains("2 of 2 runs were there"), "{}", said(&again));
    assert_eq!(runs(&out), table);
}
