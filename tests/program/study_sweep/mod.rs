//! Tests of the command `slump sweep`, which computes the runs of a study (a list of runs): results, resuming, shards
//! (parts of a study that are computed separately), and error messages about bad study files.

mod places;

use crate::program::*;

/// A study of 24 runs of the cradle, long enough to be killed halfway.
const CRADLES: &str = "
name = 'cradles'
[base]
scene = 'cradle'
duration = 6.0
[vary]
start = [7.0, 7.5, 8.0]
dt = { from = 2e-5, to = 1e-3, count = 8, scale = 'log' }
";

fn study(folder: &Path, text: &str) -> PathBuf {
    let path = folder.join("study.toml");
    write(&path, text);
    path
}

fn sweep(study: &Path, out: &Path, more: &[&str]) -> Command {
    let mut command = slump("sweep");
    command.arg(study).arg("--out").arg(out).args(more);
    command
}

fn runs(out: &Path) -> String {
    read(out.join("runs.csv"))
}

fn in_one_go(folder: &Path, study: &Path) -> String {
    let out = folder.join("whole");
    succeed(&mut sweep(study, &out, &[]));
    runs(&out)
}

#[test]
fn a_killed_sweep_goes_on_where_it_stopped_and_comes_to_the_same() {
    let folder = folder();
    let study = study(folder.path(), CRADLES);
    let out = folder.path().join("killed");
    let mut command = slump("sweep");
    command.arg(&study).arg("--out").arg(&out).stderr(Stdio::null());
    let mut child = command.spawn().expect("the program starts");
    let journal = out.join("runs.jsonl");
    let lines = || std::fs::read_to_string(&journal).unwrap_or_default().lines().count();
    wait_for("three runs", || lines() >= 3);
    kill(&mut child);
    let kept = lines();
    assert!((3..24).contains(&kept), "{kept} of 24 runs had ended: not killed half way");
    assert!(!out.join("runs.csv").exists(), "a table of a half study");
    // The journal as it is after a kill in the middle of a line.
    write(&journal, [&bytes(&journal)[..], b"{\"key\":\"0123"].concat());

    let again = succeed(&mut sweep(&study, &out, &[]));
    assert!(again.contains(&format!("{kept} of 24 runs were there")), "{again}");
    assert_eq!(lines(), 24, "no run twice, no half line");
    assert_eq!(runs(&out), in_one_go(folder.path(), &study));
    let report = json(out.join("report.json"));
    assert_eq!(report["groups"].as_array().map(Vec::len), Some(24), "{report}");
    assert_eq!(report["runs"], 24);
}

#[test]
fn parts_in_any_order_join_to_the_whole_bit_for_bit() {
    let folder = folder();
    let study = study(folder.path(), &CRADLES.replace("2e-5", "2e-4"));
    let (one, other) = (folder.path().join("one"), folder.path().join("other"));
    let merge = |parts: &[&Path]| {
        let mut command = slump("sweep merge");
        command.arg(&study).args(parts);
        command
    };
    succeed(&mut sweep(&study, &one, &["--shard", "3/3"]));
    succeed(&mut sweep(&study, &other, &["--shard", "1/3"]));
    let early = failure(&mut merge(&[&one, &other]));
    assert!(early.contains("16 of 24 runs"), "{early}");
    succeed(&mut sweep(&study, &one, &["--shard", "2/3"]));
    // Computing the same shard again does no harm.
    succeed(&mut sweep(&study, &one, &["--shard", "3/3"]));
    succeed(&mut merge(&[&one, &other]));
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
    succeed(&mut sweep(&first, &out, &[]));
    let before = runs(&out);
    let changed = study(folder.path(), &small.replace("7.5", "7.6"));
    let refused = failure(&mut sweep(&changed, &out, &[]));
    assert!(refused.contains("holds 24 runs of study cradles"), "{refused}");
    assert_eq!(runs(&out), before, "a refusal changes nothing");
    succeed(&mut sweep(&changed, &out, &["--redo"]));
    assert_ne!(runs(&out), before);
    assert_eq!(runs(&out), in_one_go(folder.path(), &changed));
}

#[test]
fn a_redo_touches_nothing_while_another_program_writes() {
    let folder = folder();
    // One long run keeps the program busy; the other runs are short.
    let dt = "dt = [2e-8, 1e-4, 2e-4, 5e-4, 1e-3]";
    let long = format!("{}start = [7.5]\n{dt}\n", CRADLES.split("start").next().unwrap_or(""));
    let text = format!("{long}[series]\ninterval = 0.1\ngrains = [0]\n");
    let first = study(folder.path(), &text);
    let out = folder.path().join("out");
    let mut command = slump("sweep");
    command.arg(&first).arg("--out").arg(&out).stderr(Stdio::null()).stdout(Stdio::null());
    let mut child = command.spawn().expect("the program starts");
    let there = || {
        let records = std::fs::read_to_string(out.join("runs.jsonl")).unwrap_or_default();
        [std::fs::read_dir(out.join("series")).map_or(0, Iterator::count), records.lines().count()]
    };
    wait_for("three runs", || there()[1] >= 3);
    let changed = folder.path().join("changed.toml");
    write(&changed, text.replace("7.5", "7.6"));
    for study in [&first, &changed] {
        let before = there();
        let said = failure(&mut sweep(study, &out, &["--redo"]));
        assert!(said.contains("is being written by another program"), "{said}");
        assert!(there().iter().zip(before).all(|(now, before)| *now >= before), "{before:?}");
    }
    assert!(child.try_wait().expect("a child").is_none(), "the situation: it was still at it");
    kill(&mut child);
    write(&changed, SHORT);
    succeed(&mut sweep(&changed, &out, &["--redo"]));
}

#[test]
fn a_redo_removes_what_this_program_wrote_and_nothing_else() {
    let folder = folder();
    let text = format!("{SHORT}[data]\nevery_secs = 0.01\n");
    let old = study(folder.path(), &text);
    let out = folder.path().join("out");
    succeed(&mut sweep(&old, &out, &[]));
    let of_old = || names_in(&out.join("series")).len() + names_in(&out.join("data")).len();
    let before = of_old();
    let mine = ["notes.jsonl", "series/thesis.csv", "data/thesis/grains/part-00000.parquet"];
    for name in mine {
        std::fs::create_dir_all(out.join(name).parent().expect("a folder")).expect("a folder");
        write(out.join(name), "mine");
    }
    let new = study(folder.path(), &text.replace("short", "other").replace("7.5", "7.6"));
    succeed(&mut sweep(&new, &out, &["--redo"]));
    for name in mine {
        assert_eq!(read(out.join(name)), "mine", "{name}");
    }
    assert_eq!(of_old(), before + 2, "nothing is left of the old study but what is mine");
    // Slump recognises a journal by its contents.
    let other = folder.path().join("other");
    std::fs::create_dir(&other).expect("a folder");
    write(other.join("runs.jsonl"), "{\"mine\": 1}\n");
    let said = failure(&mut sweep(&new, &other, &[]));
    assert!(said.contains("runs.jsonl: holds no record of this program"), "{said}");
    assert_eq!(read(other.join("runs.jsonl")), "{\"mine\": 1}\n");
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
    let course = read(course.expect("a file").path());
    assert!(course.starts_with("step,time,time_step,") && course.contains(",x0,y0\n"), "{course}");
    assert_eq!(course.lines().count(), 1 + 6, "a row at 0, 0.01, … 0.05 s");
    // The initial states are stored now: the second sweep reads the states that the first one computed.
    std::fs::remove_file(out.join("runs.jsonl")).expect("the journal");
    succeed(&mut sweep(&study, &out, &[]));
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
        let said = sentence(&mut sweep(&study(folder.path(), &text), &out, &[]));
        assert!(said.contains(expected), "{text}: {said}");
        assert!(!out.exists(), "{text} was refused, but a folder is there");
    }
    let sound = study(folder.path(), CRADLES);
    for shard in ["0/3", "4/3", "1", "a/b"] {
        let said = failure(&mut sweep(&sound, &out, &["--shard", shard]));
        assert!(said.contains(&format!("shard is {shard}, but must be k/n")), "{said}");
    }
    assert!(failure(&mut sweep(Path::new("none.toml"), &out, &[])).contains("No such file"));
}

/// A study of three short runs, each of which writes a time series.
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
    names_in(folder).iter().map(|name| folder.join(name)).collect()
}

/// Computes all runs of a study. Returns the temporary folder, the path of the study file, the table of results as
/// text, and the folder with the results.
fn computed(text: &str) -> (TempDir, PathBuf, String, PathBuf) {
    let folder = folder();
    let study = study(folder.path(), text);
    let whole = in_one_go(folder.path(), &study);
    let out = folder.path().join("whole");
    (folder, study, whole, out)
}

#[test]
fn a_damaged_record_is_named_and_computed_anew() {
    let (_folder, study, whole, out) = computed(SHORT);
    let journal = out.join("runs.jsonl");
    let sound = bytes(&journal);
    let text = String::from_utf8(sound.clone()).expect("UTF-8");
    assert_eq!(text.lines().count(), 3);
    // Damages: a digit of a result, bits all over the file, a missing line break, and an additional line break.
    let digit = text.find("\"largest_residual\":").expect("a result") + 19;
    let mut damages: Vec<(usize, u8)> =
        (0..10).map(|k| (k * text.len() / 10 + 3, 1 << (k % 8))).collect();
    damages.push((digit, 1));
    damages.push((text.find('\n').expect("a line"), 0x20));
    damages.push((text.find(',').expect("a comma"), b',' ^ b'\n'));
    for (place, bits) in damages {
        let mut bytes = sound.clone();
        bytes[place] ^= bits;
        write(&journal, &bytes);
        std::fs::remove_file(out.join("runs.csv")).expect("the table");
        let output = succeed(&mut sweep(&study, &out, &[]));
        let named = output.matches("runs.jsonl: line ").count();
        assert!((1..=2).contains(&named), "byte {place}: {}", output);
        assert_eq!(runs(&out), whole, "byte {place}");
        let again = said(&run(&mut sweep(&study, &out, &[])));
        assert!(!again.contains("damaged"), "told of once: {}", again);
    }
}

#[test]
fn a_damaged_state_is_named_and_settled_anew() {
    let text =
        "name = 'pile'\n[base]\ngrains = 20\nbox-width = 6\nduration = 0.01\n[vary]\nseed = [1]\n";
    let (_folder, study, whole, out) = computed(text);
    let state = files(&out.join("states")).remove(0);
    let sound = read(&state);
    let digit = sound.rfind("e-").expect("a number") - 1;
    let mut bytes = sound.clone().into_bytes();
    assert!(bytes[digit].is_ascii_digit());
    bytes[digit] ^= 1;
    write(&state, bytes);
    std::fs::remove_file(out.join("runs.jsonl")).expect("the journal");
    let output = succeed(&mut sweep(&study, &out, &[]));
    assert!(output.contains("is damaged"), "{output}");
    assert!(output.contains("states"), "{output}");
    assert_eq!((runs(&out), read(&state)), (whole, sound));
}

#[test]
fn deleted_courses_are_made_again() {
    let (_folder, study, whole, out) = computed(SHORT);
    let course = files(&out.join("series")).remove(1);
    let before = bytes(&course);
    std::fs::remove_file(&course).expect("it was there");
    let output = said(&run(&mut sweep(&study, &out, &[])));
    assert!(output.contains("2 of 3 runs were there"), "{output}");
    assert_eq!((runs(&out), std::fs::read(&course).ok()), (whole, Some(before)));
}

#[test]
fn a_course_that_was_edited_is_named_and_computed_anew() {
    let (_folder, study, whole, out) = computed(SHORT);
    let courses = files(&out.join("series"));
    let before: Vec<_> = courses.iter().map(bytes).collect();
    // A changed digit in the last row of one series, and a missing last row of another.
    let digit = before[0].iter().rposition(u8::is_ascii_digit).expect("a number");
    let mut edited = before[0].clone();
    edited[digit] ^= 1;
    write(&courses[0], edited);
    let text = String::from_utf8(before[2].clone()).expect("UTF-8");
    let (shorter, _) = text.trim_end().rsplit_once('\n').expect("rows");
    write(&courses[2], format!("{shorter}\n"));
    let output = said(&run(&mut sweep(&study, &out, &[])));
    assert!(output.contains("1 of 3 runs were there"), "{output}");
    for (number, course) in courses.iter().enumerate() {
        let named = output.contains(&format!("{}: is damaged", course.display()));
        assert_eq!(named, number != 1, "{output}");
        assert_eq!(std::fs::read(course).ok().as_ref(), before.get(number), "course {number}");
    }
    assert_eq!(runs(&out), whole);
    let again = said(&run(&mut sweep(&study, &out, &[])));
    assert!(again.contains("3 of 3 runs were there"), "{again}");
}

#[test]
fn redo_works_on_what_cannot_be_read() {
    let (_folder, study, whole, out) = computed(SHORT);
    for name in ["runs.jsonl", "study.json"] {
        let path = out.join(name);
        let mut damaged = bytes(&path);
        // A file without any sign of Slump may belong to somebody else, and remains unchanged.
        write(&path, "\u{0}mine");
        failure(&mut sweep(&study, &out, &["--redo"]));
        assert_eq!(read(&path), "\u{0}mine", "{name}");
        assert_eq!(runs(&out), whole, "a refusal removes nothing");
        let place = damaged.len() - 20;
        damaged[place] = 0xff;
        write(&path, damaged);
    }
    failure(&mut sweep(&study, &out, &[]));
    succeed(&mut sweep(&study, &out, &["--redo"]));
    assert_eq!(runs(&out), whole);
    // Two valid records of the same run that contradict each other.
    let journal = out.join("runs.jsonl");
    let text = read(&journal);
    let line = text.lines().next().expect("a record");
    let (_, record) = line.split_once("\"record\":").expect("a record");
    let record = record[..record.len() - 1].replacen("\"sweeps\":", "\"sweeps\":1", 1);
    let checksum = &blake3::hash(record.as_bytes()).to_hex()[..16];
    let other = format!("{{\"checksum\":\"{checksum}\",\"record\":{record}}}\n");
    write(&journal, text.clone() + &other);
    let refused = failure(&mut sweep(&study, &out, &[]));
    assert!(refused.contains("came out otherwise before"), "{refused}");
    succeed(&mut sweep(&study, &out, &["--redo"]));
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
        succeed(&mut sweep(&old.0, &out, &["--redo"]));
        let mut redo = slump("sweep --redo --out");
        redo.arg(&out).arg(&new.0).stderr(Stdio::null()).stdout(Stdio::null());
        let mut child = redo.spawn().expect("it starts");
        std::thread::sleep(Duration::from_millis(round * round));
        // The program may already have ended.
        let _ = child.kill();
        child.wait().expect("it ended");
        let label = read(out.join("study.json"));
        let is_new = label.contains("\"other\"");
        found[usize::from(is_new)] += 1;
        let (file, table) = if is_new { &new } else { &old };
        if let Ok(left) = std::fs::read_to_string(out.join("runs.csv")) {
            assert_eq!(&left, table, "round {round}: the other study's table");
        }
        succeed(&mut sweep(file, &out, &[]));
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
    let label = || read(out.join("study.json"));
    let before = label();
    // A folder in place of the table cannot be removed. It stops `--redo` at a point that a kill would rarely hit.
    std::fs::remove_file(out.join("runs.csv")).expect("a table");
    std::fs::create_dir(out.join("runs.csv")).expect("a folder in its place");
    let new = study(folder.path(), &SHORT.replace("short", "other"));
    failure(&mut sweep(&new, &out, &["--redo"]));
    assert_eq!(label(), before, "the new study's label beside the old one's table");
    std::fs::remove_dir(out.join("runs.csv")).expect("a folder");
    succeed(&mut sweep(&new, &out, &["--redo"]));
    assert!(label().contains("\"other\""));
}

#[test]
fn runs_that_went_wrong_say_so_in_the_table_and_are_read_back_as_they_were() {
    let folder = folder();
    // Time steps far too long for the springs: in the first run the residual and the energy overflow, in the second run
    // the state does.
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
    let first = succeed(&mut sweep(&study, &out, &[]));
    assert!(first.contains("2 of 2 runs raised alarms ("), "{first}");
    let table = runs(&out);
    let mut lines = table.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let header = lines.next().expect("a header");
    let column = |name: &str| header.iter().position(|column| *column == name).expect("a column");
    let rows: Vec<_> = lines.collect();
    let [status, alarms] = ["status", "alarms"].map(column);
    let told = [0, 1].map(|run| (rows[run][status], rows[run][alarms].contains("not-finite")));
    assert_eq!(told, [("not-finite", true); 2], "{table}");
    let residual: f64 = rows[0][column("largest_residual")].parse().expect("a number");
    assert!(!residual.is_finite(), "{table}");
    for row in &rows {
        assert_ne!(row[column("unconverged_steps")], "0", "{table}");
        assert_eq!(row[column("lost_grains")], "0", "{table}");
    }
    let again = succeed(&mut sweep(&study, &out, &[]));
    assert!(again.contains("2 of 2 runs were there"), "{again}");
    assert_eq!(runs(&out), table);
}

#[test]
fn a_command_a_run_is_listed_and_together_they_come_to_the_same() {
    let folder = folder();
    let study = study(
        folder.path(),
        "name = 'two'\n[base]\nscene = 'cradle'\nduration = 0.5\n[vary]\nstart = [7.0, 8.0]\n",
    );
    let out = folder.path().join("of a list");
    let listed = run(&mut sweep(&study, &out, &["--list"]));
    let listed = String::from_utf8(listed.stdout).expect("text");
    assert_eq!(listed.lines().count(), 2, "{listed}");
    assert!(!out.exists(), "nothing is run");
    for line in listed.lines() {
        let program = slump("").get_program().to_str().expect("UTF-8").to_owned();
        let command = line.replacen("slump", &program, 1);
        succeed(Command::new("sh").args(["-c", &command]));
        // A batch queue may run a command a second time.
        succeed(Command::new("sh").args(["-c", &command]));
    }
    succeed(slump("sweep").arg("merge").arg(&study).arg(&out));
    assert_eq!(runs(&out), in_one_go(folder.path(), &study));
}
