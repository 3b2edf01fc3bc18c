//! `slump validate`: what it leaves, that it goes on where it was stopped, and what it refuses.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn validate(options: &[&str], folder: &Path) -> Output {
    let mut command = Command::new(assert_cmd::cargo::cargo_bin!("slump"));
    command.arg("validate").args(options).arg("--out").arg(folder);
    command.output().expect("the program starts")
}

fn elasticity(folder: &Path) -> String {
    let output = validate(&["elasticity", "--quick"], folder);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{said}");
    said
}

/// Every row of the table, but for what was measured by the clock.
fn rows(folder: &Path) -> Vec<Vec<String>> {
    let mut reader = csv::Reader::from_path(folder.join("quantities.csv")).expect("a table");
    let names = reader.headers().expect("names").clone();
    let is_of_clock = |name: &str| ["simulated_secs_per_sec", "wall_secs"].contains(&name);
    let row = |record: csv::StringRecord| {
        let cells = names.iter().zip(record.iter()).filter(|(name, _)| !is_of_clock(name));
        cells.map(|(_, cell)| cell.to_owned()).collect()
    };
    reader.records().map(|record| row(record.expect("a row"))).collect()
}

fn journal(folder: &Path) -> PathBuf {
    let measured = folder.join("measured");
    let of_program = std::fs::read_dir(measured).expect("a folder").next().expect("a program");
    of_program.expect("a folder").path().join("quick").join("validation.jsonl")
}

#[test]
fn a_validation_goes_on_where_it_was_stopped_and_comes_out_the_same() {
    let whole = tempfile::tempdir().expect("a folder");
    elasticity(whole.path());
    for name in ["quantities.csv", "errors.csv", "errors.png", "errors.svg"] {
        assert!(whole.path().join(name).metadata().expect(name).len() > 40, "{name}");
    }
    check_report(whole.path());
    let rows_of_whole = rows(whole.path());
    // Half of the runs are taken away, and of the last one half a line is left, as a kill leaves it.
    let path = journal(whole.path());
    let text = std::fs::read_to_string(&path).expect("a journal");
    let lines: Vec<&str> = text.lines().collect();
    let half = lines.len() / 2;
    let cut = format!("{}\n{}", lines[..half].join("\n"), &lines[half][..40]);
    std::fs::write(&path, cut).expect("a journal");
    let said = elasticity(whole.path());
    assert!(said.contains(&format!("validation: {half} measurements were there")), "{said}");
    assert_eq!(rows(whole.path()), rows_of_whole);
    assert_eq!(std::fs::read_to_string(&path).expect("a journal").lines().count(), lines.len());
    // What is whole is not run again: not even the clock's numbers change.
    let read = |name: &str| std::fs::read(whole.path().join(name)).expect(name);
    let before = read("quantities.csv");
    elasticity(whole.path());
    assert_eq!(read("quantities.csv"), before);
}

/// That a row of discs has the published elasticity, and that the report says on what each number rests.
fn check_report(folder: &Path) {
    let rows = rows(folder);
    let of = |name: &str| {
        let found = rows.iter().find(|row| row[2].starts_with(name)).expect(name);
        [6, 9].map(|column| found[column].parse::<f64>().expect("a number"))
    };
    for name in ["q of jacobi", "q of nsgs interleaved", "q of nsgs bottom-up"] {
        let [published, measured] = of(name);
        assert!((measured / published - 1.0).abs() < 5e-3, "{name}: {measured} for {published}");
    }
    let report = std::fs::read_to_string(folder.join("report.md")).expect("a report");
    assert!(report.contains("Quick pass") && report.contains("read: Unger et al. 2002"));
    assert!(report.contains("derived: D. M. Young") && report.contains("**agrees**"), "{report}");
    assert!(!report.contains("NaN"), "{report}");
}

#[test]
fn what_is_no_experiment_method_or_number_is_refused_by_name() {
    let folder = tempfile::tempdir().expect("a folder");
    let cases: [(&[&str], &str); 6] = [
        (&["hourglass"], "elasticity"),
        (&["--methods", "gauss"], "nsgs"),
        (&["--time-steps", "1e-3,-1"], "time-steps is -1"),
        (&["--sweeps", "0"], "sweeps is 0"),
        (&["--sweeps", "5,5"], "sweeps is 5 twice"),
        (&["--tolerances", "nan"], "tolerances is NaN"),
    ];
    for (options, part) in cases {
        let output = validate(options, folder.path());
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{options:?}: {said}");
        assert!(said.contains(part) && said.lines().count() == 1, "{options:?}: {said}");
        assert!(!folder.path().join("measured").exists(), "{options:?} began to work");
    }
}
