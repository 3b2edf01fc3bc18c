//! Tests of the command `slump budget`, which estimates the contributions to the error of a result (an error budget).

use crate::program::*;

fn budget(out: &Path, more: &[&str]) -> Command {
    let mut command = slump("budget");
    command.arg("--out").arg(out).args(more);
    command
}

/// Runs `slump budget` with additional arguments. Returns the report of the error budget.
fn answer(out: &Path, more: &[&str]) -> String {
    succeed(&mut budget(out, more));
    read(out.join("report.md"))
}

/// Returns the cells of the table `budget.csv`, without the column `cost`, which depends on the machine.
fn table(out: &Path) -> Vec<Vec<String>> {
    let text = read(out.join("budget.csv"));
    let mut rows = csv::Reader::from_reader(text.as_bytes());
    let header = rows.headers().expect("a header").clone();
    let row = |row: Result<csv::StringRecord, csv::Error>| {
        let row = row.expect("a row");
        let cells = row.iter().zip(&header).filter(|(_, name)| *name != "cost");
        cells.map(|(cell, _)| cell.to_owned()).collect()
    };
    rows.records().map(row).collect()
}

/// Returns the numbers in one column of the table `budget.csv`, from the rows about one cause of error, such as "time
/// step".
fn cell(rows: &[Vec<String>], cause: &str, column: usize) -> Vec<f64> {
    let of_cause = rows.iter().filter(|row| row[2] == cause);
    of_cause.filter_map(|row| row[column].parse().ok()).collect()
}

const STARTS: usize = 4;
const ADDS: usize = 5;

const CRADLE: [&str; 8] =
    ["--scene", "cradle", "--duration", "1", "--quantity", "max(max_overlap)", "--within", "1e-4"];

#[test]
fn a_killed_budget_goes_on_where_it_stopped_and_comes_to_the_same() {
    let folder = folder();
    let out = folder.path().join("killed");
    let journal = out.join("budget.jsonl");
    let lines = || std::fs::read_to_string(&journal).unwrap_or_default().lines().count();
    let mut kept = 0;
    for kills in 1..=10 {
        let mut child =
            budget(&out, &CRADLE).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
        wait_for("another run", || lines() > kept);
        kill(&mut child);
        kept = lines();
        assert!(!out.join("budget.csv").exists(), "not killed half way, at the {kills}. time");
    }
    let said = succeed(&mut budget(&out, &CRADLE));
    assert!(said.contains("runs were there"), "{said}");
    let whole = folder.path().join("whole");
    succeed(&mut budget(&whole, &CRADLE));
    assert_eq!(table(&out), table(&whole));
    for name in ["report.md", "budget.json", "budget-1.png", "budget-1.svg"] {
        assert!(out.join(name).metadata().is_ok_and(|file| file.len() > 100), "{name}");
    }
}

#[test]
fn parts_of_a_budget_join_to_what_one_machine_comes_to_and_cost_it_nothing() {
    let folder = folder();
    let whole = folder.path().join("whole");
    succeed(&mut budget(&whole, &CRADLE));
    let runs = |out: &Path| read(out.join("budget.jsonl")).lines().count();
    let all = runs(&whole);

    let joined = folder.path().join("joined");
    for part in ["1/3", "2/3", "3/3"] {
        let mut one = budget(&joined, &CRADLE);
        succeed(one.args(["--shard", part]));
        assert!(!joined.join("report.md").exists());
    }
    let keys = |part: u32| -> Vec<String> {
        let text = read(joined.join(format!("budget-{part}-of-3.jsonl")));
        let key = |line: &str| {
            let line: serde_json::Value = serde_json::from_str(line).expect("a line of JSON");
            line["record"]["key"].as_str().expect("a key").to_owned()
        };
        text.lines().map(key).collect()
    };
    let (first, second) = (keys(1), keys(2));
    assert!(!first.is_empty() && first.iter().all(|key| !second.contains(key)));

    let said = succeed(&mut budget(&joined, &CRADLE));
    assert!(said.contains("runs were there"), "{said}");
    assert_eq!(table(&joined), table(&whole));
    assert!(2 * runs(&joined) < all, "{} runs of {all} were its own", runs(&joined));
}

/// A scene file of a disc that falls freely from rest. With semi-implicit steps its change of height at the time t is
/// −g t (t + Δt)/2 (g: gravity), so the height is known exactly, and its error is proportional to Δt.
const FALL: &str = "
name = 'fall'
mean_diameter = 1.0
duration_secs = 1.0
physics = { axes = 2, cohesion = false, friction = false, rotation = false }
gravity = { kind = 'uniform', acceleration = [0.0, -8.0] }
parameters = { time_step_secs = 0.125, bond = 0.0, restitution = 0.0, friction = 0.0 }
grains = [{ position = [0.0, 100.0], radius = 0.5 }]
";

#[test]
fn the_time_step_of_a_falling_disc_has_the_share_that_theory_gives_it() {
    let folder = folder();
    let scene = folder.path().join("fall.toml");
    write(&scene, FALL);
    let out = folder.path().join("out");
    let name = scene.to_str().unwrap();
    let said =
        answer(&out, &["--scene", name, "--quantity", "potential_energy", "--within", "0.01"]);
    let rows = table(&out);
    let mass = std::f64::consts::PI / 4.0;
    let error = |step: f64| -mass * 8.0 * 0.5 * 8.0 * step;
    let adds = cell(&rows, "time step", ADDS);
    let expected = [2.0, 4.0, 8.0].map(|by| error(0.125 / by) - error(0.125));
    for (found, expected) in adds.iter().zip(expected.iter().chain([&-error(0.125)])) {
        assert!((found - expected).abs() < 1e-6 * expected, "{found} {expected}\n{said}");
    }
    assert_eq!(adds.len(), 4, "three time steps and the limit\n{said}");
    assert!(said.contains("So the method moves it by more than 0.01"), "{said}");
    assert!(rows.iter().all(|row| row[2] != "friction model" && row[2] != "number of grains"));
}

#[test]
fn a_scene_that_comes_to_nothing_has_no_number() {
    let folder = folder();
    let out = folder.path().join("out");
    // With this time step the disc flies through the wall, so the quantity has no value.
    let lost = ["--scene", "thin-wall", "--dt", "0.1", "--quantity", "kinetic_energy"];
    let said = answer(&out, &lost);
    assert!(
        said.contains(
            "The kinetic_energy has no value: of the scene as it is, 6 of 6 runs came to nothing"
        ),
        "{said}"
    );
    assert!(cell(&table(&out), "value itself", ADDS).is_empty());
    assert!(!out.join("budget-1.png").exists());
}

#[test]
fn what_cannot_be_asked_is_refused_in_one_sentence() {
    let folder = folder();
    let out = folder.path().join("out");
    let cases: [(&[&str], &str); 8] = [
        (&["--quantity", "slumpp"], "quantity is slumpp"),
        (&["--within", "-1"], "within is -1"),
        (&["--within", "nan"], "within is NaN"),
        (&["--from", "2"], "from is 2"),
        (&["--to", "0"], "to is 0"),
        (&["--cost", "5"], "--cost"),
        (&["--cost", "0s"], "--cost"),
        (&["--dt", "nan"], "dt is NaN"),
    ];
    for (more, said) in cases {
        let error = failure(&mut budget(&out, more));
        assert!(error.contains(said), "{error}");
        assert!(!out.join("budget.jsonl").exists(), "{more:?}");
    }
}

#[test]
fn piles_of_other_seeds_are_what_a_pile_is_held_against() {
    let folder = folder();
    let out = folder.path().join("out");
    let pile =
        ["--grains", "12", "--box-width", "6", "--deposition", "drop-and-roll", "--bond", "20"];
    let rest = ["--duration", "0.05", "--quantity", "slump", "--within", "0.5"];
    let said = answer(&out, &[&pile[..], &rest[..]].concat());
    assert!(said.contains("piles that differ in their seed"), "{said}");
    assert!(said.contains("The pile that was asked for has"), "{said}");
    let rows = table(&out);
    assert!(
        cell(&rows, "packing", STARTS)[0] >= 4.0
            && cell(&rows, "number of grains", STARTS)[0] >= 4.0
    );
    assert!(cell(&rows, "cone of friction", STARTS)[0] >= 4.0);
}
