//! Sweeps as a user starts them: results, resuming, parts, and what is said of a bad study file.

mod damage;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use tempfile::TempDir;

/// Twenty-four runs of the cradle, long enough to be killed in the middle.
const CRADLES: &str = "
name = 'cradles'
[base]
scene = 'cradle'
duration = 6.0
[vary]
start = [7.0, 7.5, 8.0]
dt = { from = 2e-5, to = 1e-3, count = 8, scale = 'log' }
";

fn slump() -> Command {
    Command::new(crate::tested::program())
}

fn folder() -> TempDir {
    tempfile::tempdir().expect("a temporary folder")
}

fn study(folder: &Path, text: &str) -> PathBuf {
    let path = folder.join("study.toml");
    std::fs::write(&path, text).expect("a study file");
    path
}

fn sweep(study: &Path, out: &Path, more: &[&str]) -> std::process::Output {
    let mut command = slump();
    command.arg("sweep").arg(study).arg("--out").arg(out).args(more);
    command.output().expect("the program starts")
}

fn runs(out: &Path) -> String {
    std::fs::read_to_string(out.join("runs.csv")).expect("runs.csv")
}

fn said(output: &std::process::Output) -> String {
    String::from_utf8(output.stderr.clone()).expect("UTF-8")
}

/// The whole study in one go.
fn in_one_go(folder: &Path, study: &Path) -> String {
    let out = folder.join("whole");
    assert!(sweep(study, &out, &[]).status.success());
    runs(&out)
}

#[test]
fn a_killed_sweep_goes_on_where_it_stopped_and_comes_to_the_same() {
    let folder = folder();
    let study = study(folder.path(), CRADLES);
    let out = folder.path().join("killed");
    let mut child = slump()
        .arg("sweep")
        .arg(&study)
        .arg("--out")
        .arg(&out)
        .stderr(Stdio::null())
        .spawn()
        .expect("the program starts");
    let journal = out.join("runs.jsonl");
    let lines = || std::fs::read_to_string(&journal).unwrap_or_default().lines().count();
    let started = Instant::now();
    while lines() < 3 && started.elapsed() < Duration::from_secs(60) {
        std::thread::sleep(Duration::from_millis(1));
    }
    child.kill().expect("kill -9");
    child.wait().expect("it ended");
    let kept = lines();
    assert!((3..24).contains(&kept), "{kept} of 24 runs had ended: not killed half way");
    assert!(!out.join("runs.csv").exists(), "a table of a half study");
    // As a kill in the middle of a line leaves it.
    let mut bytes = std::fs::read(&journal).expect("the journal");
    bytes.extend(b"{\"key\":\"0123");
    std::fs::write(&journal, bytes).expect("the journal");

    let again = sweep(&study, &out, &[]);
    assert!(again.status.success(), "{}", said(&again));
    assert!(said(&again).contains(&format!("{kept} of 24 runs were there")), "{}", said(&again));
    assert_eq!(lines(), 24, "no run twice, no half line");
    assert_eq!(runs(&out), in_one_go(folder.path(), &study));
}

#[test]
fn parts_in_any_order_join_to_the_whole_bit_for_bit() {
    let folder = folder();
    let study = study(folder.path(), &CRADLES.replace("2e-5", "2e-4"));
    let (one, other) = (folder.path().join("one"), folder.path().join("other"));
    let merge = |parts: &[&Path]| {
        let mut command = slump();
        command.args(["sweep", "merge"]).arg(&study).args(parts).output().expect("it starts")
    };
    assert!(sweep(&study, &one, &["--shard", "3/3"]).status.success());
    assert!(sweep(&study, &other, &["--shard", "1/3"]).status.success());
    let early = merge(&[&one, &other]);
    assert_eq!(early.status.code(), Some(2));
    assert!(said(&early).contains("16 of 24 runs"), "{}", said(&early));
    assert!(sweep(&study, &one, &["--shard", "2/3"]).status.success());
    // A repeated part harms nothing.
    assert!(sweep(&study, &one, &["--shard", "3/3"]).status.success());
    let merged = merge(&[&one, &other]);
    assert!(merged.status.success(), "{}", said(&merged));
    assert_eq!(runs(&one), in_one_go(folder.path(), &study));
    let header = runs(&one).lines().next().expect("a header").to_owned();
    for column in ["run", "key", "start", "bond", "dt", "tolerance", "slump", "first_gap"] {
        assert!(header.split(',').any(|name| name == column), "{column} in {header}");
    }
}

#[test]
fn another_study_is_refused_and_redone_only_when_asked() {
    let folder = folder();
    let small = CRADLES.replace("2e-5", "5e-4");
    let first = study(folder.path(), &small);
    let out = folder.path().join("out");
    assert!(sweep(&first, &out, &[]).status.success());
    let before = runs(&out);
    let changed = study(folder.path(), &small.replace("7.5", "7.6"));
    let refused = sweep(&changed, &out, &[]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(said(&refused).contains("holds 24 runs of study cradles"), "{}", said(&refused));
    assert_eq!(runs(&out), before, "a refusal changes nothing");
    assert!(sweep(&changed, &out, &["--redo"]).status.success());
    assert_ne!(runs(&out), before);
    assert_eq!(runs(&out), in_one_go(folder.path(), &changed));
}

#[test]
fn initial_states_are_settled_once_and_runs_do_not_hang_on_where_they_come_from() {
    let folder = folder();
    let text = "
name = 'piles'
[base]
grains = 20
box-width = 6
duration = 0.05
[vary]
seed = { from = 1, to = 2 }
bond = [0, 20]
[series]
interval = 0.01
grains = [0]
";
    let study = study(folder.path(), text);
    let whole = in_one_go(folder.path(), &study);
    let out = folder.path().join("whole");
    let count = |name: &str| std::fs::read_dir(out.join(name)).expect("a folder").count();
    assert_eq!((count("states"), count("series")), (2, 4));
    let course = std::fs::read_dir(out.join("series")).expect("a folder").next().expect("a file");
    let course = std::fs::read_to_string(course.expect("a file").path()).expect("a course");
    assert!(course.starts_with("step,time_secs,") && course.contains(",x0,y0\n"), "{course}");
    assert_eq!(course.lines().count(), 1 + 6, "a row at 0, 0.01, … 0.05 s");

    // The states lie there now: the second pass reads what the first one settled.
    std::fs::remove_file(out.join("runs.jsonl")).expect("the journal");
    assert!(sweep(&study, &out, &[]).status.success());
    assert_eq!(runs(&out), whole);
}

#[test]
fn a_bad_study_file_is_refused_in_a_sentence_that_names_the_field() {
    let folder = folder();
    let out = folder.path().join("out");
    let with = |table: &str, line: &str| format!("name = 'a'\n[{table}]\n{line}\n");
    let cases = [
        (with("base", "bnd = 3"), "base.bnd is 3, but must be one of"),
        (with("vary", "colour = [1]"), "vary.colour is 1, but must be one of"),
        (with("base", "bond = 'much'"), "base.bond is \"much\""),
        (with("base", "bond = -1"), "bond is -1, but must be a finite number ≥ 0"),
        (with("vary", "bond = []"), "vary.bond is empty"),
        (with("vary", "bond = [3, 4, 3.0]"), "vary.bond is 3.0 twice"),
        (with("vary", "seed = { from = 5, to = 4 }"), "vary.seed.to is 4"),
        (with("vary", "dt = { from = 1e-4, to = 1e-3 }"), "vary.dt.count is missing"),
        (with("vary", "dt = [1e-3]\n[base]\ndt = 1e-4"), "vary.dt is given twice"),
        (with("vary", "'bond dt' = [[1, 1e-3], [2]]"), "vary.bond dt is [2]"),
        (with("vary", "'bond dt' = [[1, 1e-3]]\nbond = [3]"), "vary.bond is given twice"),
        (with("vary", "dt = [1e-3]\ndt = [1e-4]"), "line 4: duplicate key"),
        (with("series", "interval = 0"), "series.interval is 0"),
        (with("series", "interval = 0.1\ngrains = [999]"), "series.grains is 999"),
        (with("plots", "a = 1"), "unknown field 'plots'"),
        ("[base]\nbond = 3".to_owned(), "missing field 'name'"),
        ("name = ".to_owned(), "line 1"),
    ];
    for (text, expected) in cases {
        let output = sweep(&study(folder.path(), &text), &out, &[]);
        let said = said(&output);
        assert_eq!(output.status.code(), Some(2), "{text}: {said}");
        assert_eq!(said.trim_end().lines().count(), 1, "{text}: {said}");
        assert!(said.contains(expected), "{text}: {said}");
        assert!(!out.exists(), "{text} was refused, but a folder is there");
    }
    let sound = study(folder.path(), CRADLES);
    for shard in ["0/3", "4/3", "1", "a/b"] {
        let said = said(&sweep(&sound, &out, &["--shard", shard]));
        assert!(said.contains(&format!("shard is {shard}, but must be k/n")), "{said}");
    }
    assert!(said(&sweep(Path::new("none.toml"), &out, &[])).contains("No such file"));
}
