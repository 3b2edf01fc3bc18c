//! What columns hold: every number of the moments, bit for bit.

use slump::data::FormatName;
use slump::scene::{SCENES, Scene};
use slump::sim::{Moment, OtherBody, Stepper};

use super::expected::{contacts, grain_measures, grains, histograms, measures, observables, word};
use super::tables::{Columns, csv, metadata, number, parquet, parts, steps};
use super::{folder, record, scene, start};

#[track_caller]
fn assert_same(found: &Columns, expected: &Columns, what: &str) {
    for (name, cells) in expected {
        let there = found.get(name).unwrap_or_else(|| panic!("{what} has no column {name}"));
        assert_eq!(there.len(), cells.len(), "rows of {what}");
        let differs = there.iter().zip(cells).position(|(found, expected)| found != expected);
        if let Some(row) = differs {
            panic!("{what}, {name}, row {row}: {:?} for {:?}", there[row], cells[row]);
        }
    }
}

/// Records a scene, and checks that the files have all that its moments had.
fn check(scene: &Scene, frames: usize, every: u64) -> Vec<Moment> {
    let folder = folder();
    let formats = [FormatName::Parquet, FormatName::Csv];
    let mut recording = start(folder.path(), &formats, scene);
    let mut simulation = scene.simulation().expect("a scene");
    let (mut moments, mut rows) = (vec![simulation.moment()], Vec::new());
    recording.add(simulation.moment()).expect("a frame");
    for _ in 0..frames {
        for _ in 0..every {
            rows.push(*simulation.step().expect("a finite state"));
            recording.add_step(simulation.observables()).expect("a row");
        }
        moments.push(simulation.moment());
        recording.add(simulation.moment()).expect("a frame");
    }
    recording.finish().expect("a recording");
    let tables = [
        ("grains", grains(&moments)),
        ("contacts", contacts(&moments)),
        ("steps", observables(&rows)),
        ("grains", grain_measures(&moments)),
        ("measures", measures(&moments)),
        ("histograms", histograms(&moments)),
    ];
    for (name, expected) in &tables {
        let found = parquet(folder.path(), name);
        assert_same(&found, expected, name);
        let text = csv(&folder.path().join(format!("csv/{name}.csv")), &found);
        assert_same(&text, expected, &format!("{name}.csv"));
        assert_same(&text, &found, &format!("{name}.csv beside Parquet"));
        assert_same(&found, &text, &format!("{name} beside CSV"));
    }
    let index = std::fs::read_to_string(folder.path().join("frames.csv")).expect("an index");
    assert_eq!(index.lines().filter(|line| !line.starts_with('#')).count(), 1 + moments.len());
    moments
}

#[test]
fn a_pile_with_bonds_is_all_there_over_several_parts() {
    let mut pile = scene("pile");
    pile.stepper = Stepper::Range;
    pile.parameters.bond = 0.2;
    let moments = check(&pile, 120, 20);
    let contacts = || moments.iter().flat_map(|moment| &moment.contacts);
    let stretches = || contacts().filter_map(|contact| contact.bond_stretch);
    assert!(stretches().any(|stretch| stretch > 0.0), "bonds that are stretched");
    assert!(stretches().any(|stretch| stretch == 0.0), "and bonds that are not");
}

#[test]
fn walls_are_named_as_scene_files_name_them() {
    let moments = check(&scene("moving-walls"), 20, 5);
    let is_wall = |other| matches!(other, OtherBody::Boundary(_));
    assert!(moments.iter().flat_map(|moment| &moment.contacts).any(|it| is_wall(it.other)));
    let folder = folder();
    let walls = scene("moving-walls");
    let mut recording = start(folder.path(), &[FormatName::Parquet], &walls);
    record(&mut recording, &mut walls.simulation().expect("a scene"), 20, 5);
    recording.finish().expect("a recording");
    let contacts = parquet(folder.path(), "contacts");
    assert!(contacts["name_j"].contains(&word("piston 1")), "{:?}", contacts["name_j"]);
}

#[test]
fn lost_grains_say_so_and_stay() {
    // Faster than a wall can be seen at such a step.
    let mut thin = scene("thin-wall");
    thin.grains[0].velocity *= 100.0;
    let moments = check(&thin, 60, 1);
    let lost = |moment: &Moment| moment.grains.iter().filter(|grain| grain.lost).count();
    assert!(moments.iter().any(|moment| lost(moment) > 0), "a grain that is lost");
}

#[test]
fn units_and_parameters_are_in_the_metadata() {
    let folder = folder();
    let mut pile = scene("pile");
    pile.parameters.bond = 37.5;
    let mut recording = start(folder.path(), FormatName::ALL, &pile);
    record(&mut recording, &mut pile.simulation().expect("a scene"), 2, 1);
    recording.finish().expect("a recording");
    for (table, column, unit) in
        [("grains", "vx", "m/s"), ("contacts", "normal_force", "N"), ("steps", "slump", "1")]
    {
        let said = metadata(&parts(folder.path(), table)[0]);
        assert_eq!(said["parameters.bond"], "37.5");
        let columns: serde_json::Value = serde_json::from_str(&said["columns"]).expect("JSON");
        assert_eq!(columns[column]["unit"], unit, "{table}");
    }
    let text = std::fs::read_to_string(folder.path().join("csv/grains.csv")).expect("a table");
    assert!(text.contains("\n# parameters.bond: 37.5\n"), "{text:.400}");
    assert!(text.contains("\n# column vx [m/s]: velocity of the centre\n"), "{text:.900}");
    let manifest = std::fs::read(folder.path().join("data.json")).expect("a manifest");
    let manifest: serde_json::Value = serde_json::from_slice(&manifest).expect("JSON");
    assert_eq!(manifest["about"]["parameters.bond"], "37.5");
    assert_eq!(manifest["formats"][0], "parquet");
    assert_eq!(manifest["tables"]["contacts"][8]["name"], "nx");
}

#[test]
fn parts_end_with_a_frame_and_do_not_hang_on_how_fast_the_disk_was() {
    let pile = scene("pile");
    let folders = [folder(), folder()];
    for (folder, waits) in folders.iter().zip([false, true]) {
        let mut recording = start(folder.path(), &[FormatName::Parquet], &pile);
        let mut simulation = pile.simulation().expect("a scene");
        for _ in 0..50 {
            record(&mut recording, &mut simulation, 1, 1);
            if waits {
                recording.flush().expect("written");
            }
        }
        recording.finish().expect("a recording");
    }
    let [one, other] = &folders;
    let names = parts(one.path(), "grains");
    assert!(names.len() > 2, "several parts: {}", names.len());
    for table in ["grains", "contacts", "steps", "measures", "histograms"] {
        let (one, other) = (parts(one.path(), table), parts(other.path(), table));
        assert_eq!(one.len(), other.len());
        for (one, other) in one.iter().zip(&other) {
            assert_eq!(std::fs::read(one).expect("a part"), std::fs::read(other).expect("a part"));
        }
    }
    let grains = parquet(one.path(), "grains");
    assert_eq!(steps(&grains), (1..=50).collect::<Vec<_>>());
    assert!(grains["time"].iter().map(number).is_sorted());
}

/// OVITO looks no further for a first frame, and then knows no format for the file: a head of 16 lines passes,
/// one of 17 does not (OVITO 3.17.2).
#[test]
fn the_first_frame_of_a_dump_begins_where_ovito_looks_for_it() {
    for entry in SCENES {
        let folder = folder();
        let scene = scene(entry.name);
        let mut recording = start(folder.path(), &[FormatName::Ovito], &scene);
        recording.add(scene.simulation().expect("a scene").moment()).expect("a frame");
        recording.finish().expect("a recording");
        for name in ["grains", "contacts"] {
            let text = std::fs::read_to_string(folder.path().join(format!("ovito/{name}.dump")));
            let text = text.expect("a dump");
            let head = text.lines().position(|line| line == "ITEM: TIME").expect("a frame");
            assert!(head <= 16, "{}: {head} lines in {name}", entry.name);
        }
    }
}
