//! What a run without a window leaves: its manifest and its table say the same, and nothing that went
//! wrong is in one of them alone.

use std::path::Path;

use serde_json::{Value, json};
use slump::sim::{Observables, Tally};

/// Checks the folder of a run that ended by itself with `code` and said `stderr`.
pub fn check(folder: &Path, code: i32, stderr: &str) {
    let rows = rows_of(&folder.join("observables.csv"));
    let manifest: Value =
        serde_json::from_str(&read(&folder.join("manifest.json"))).expect("a manifest");
    let run = &manifest["runs"][0];
    let mut tally = Tally::default();
    for (row, number) in rows.iter().zip(1..) {
        assert_eq!(row.step, number, "a row a step");
        assert!(!row.converged || row.residual.is_finite(), "{row:?}");
        tally.add(row);
    }
    assert_eq!(run["tally"], json(&tally), "the tally is that of the table");
    let end = rows.last().copied().unwrap_or_default();
    assert_eq!(run["step"], json(&end.step));
    assert_eq!(run["time_secs"], json(&end.time_secs));
    assert_eq!(run["ended"], if code == 0 { "complete" } else { "not-finite" });

    alarms(run, &rows, stderr);
    let told = stderr.contains("did not reach tolerance");
    assert_eq!(told, tally.unconverged_steps > 0, "steps that were not solved: {stderr}");
    pictures(folder, &manifest, &rows);
}

/// What went wrong by the table is alarmed in the manifest, and every alarm is told.
fn alarms(run: &Value, rows: &[Observables], stderr: &str) {
    let alarms = run["alarms"].as_array().expect("a list");
    let has = |kind: &str| alarms.iter().any(|alarm| alarm["kind"] == kind);
    let finite = |row: &Observables| {
        let Observables { kinetic_energy, potential_energy, max_overlap, slump, .. } = row;
        [kinetic_energy, potential_energy, max_overlap, slump].into_iter().all(|x| x.is_finite())
    };
    assert!(rows.iter().all(finite) || !alarms.is_empty(), "not finite in silence");
    assert_eq!(run["ended"] == "not-finite", has("not-finite"), "{run}");
    let any = |wrong: fn(&Observables) -> bool| rows.iter().any(wrong);
    assert_eq!(any(|row| row.lost_grains > 0), has("grain-lost"), "{run}");
    assert_eq!(any(|row| row.max_overlap > 0.05), has("overlap"), "{run}");
    for alarm in alarms.iter().filter(|alarm| alarm["kind"] != "not-finite") {
        let message = alarm["message"].as_str().expect("a sentence");
        assert!(stderr.contains(message), "{message} is not in {stderr}");
    }
    if has("not-finite") {
        assert!(stderr.contains("no longer finite"), "{stderr}");
    }
}

/// The pictures that the manifest names are there, no others are, and each shows a row of the table.
fn pictures(folder: &Path, manifest: &Value, rows: &[Observables]) {
    let listed = manifest["pictures"].as_array().expect("a list");
    for picture in listed {
        let shown = &picture["shows"][0]["observables"];
        let step = shown["step"].as_u64().expect("a step") as usize;
        if step > 0 {
            assert_eq!(*shown, json(&rows[step - 1]), "a picture shows a row");
        }
    }
    let mut named: Vec<&str> = listed.iter().filter_map(|it| it["file"].as_str()).collect();
    named.extend(["manifest.json", "observables.csv"]);
    named.sort_unstable();
    let entries = std::fs::read_dir(folder).expect("a folder");
    let mut there: Vec<String> =
        entries.flatten().map(|it| it.file_name().to_string_lossy().into_owned()).collect();
    there.sort_unstable();
    assert_eq!(there, named, "what is there and what the manifest names");
}

fn rows_of(table: &Path) -> Vec<Observables> {
    let text = read(table);
    assert!(text.is_empty() || text.ends_with('\n'), "a half row at the end");
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    reader.deserialize().map(|row| row.expect("a row")).collect()
}

fn read(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

fn json(value: &impl serde::Serialize) -> Value {
    json!(value)
}
