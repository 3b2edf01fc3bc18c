//! Tests of the columns of recorded tables: they contain every number of the recorded states, bitwise.

use slump::granular::{GrainMeasures, measure};
use slump::scene::SCENES;
use slump::sim::{ContactState, GrainState, Moment, Observables, OtherBody, Stepper};
use slump::world::Disc;

use super::tables::{Cell, Columns, csv, metadata, number, parquet, parts, steps};
use super::*;
use crate::program::*;

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

/// Records a scene and checks that the files contain all data of the recorded states. Returns these states.
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
    let walls = moments.iter().map(slump::data::Table::of_walls);
    let names = walls.flat_map(|walls| walls.column("name").map(|names| names.values.len()));
    assert_eq!(parquet(folder.path(), "walls")["name"].len(), names.sum::<usize>());
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
    let index = read(folder.path().join("frames.csv"));
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
    recorded(folder.path(), &[FormatName::Parquet], &scene("moving-walls"), 20, 5);
    let contacts = parquet(folder.path(), "contacts");
    assert!(contacts["name_j"].contains(&word("piston 1")), "{:?}", contacts["name_j"]);
}

#[test]
fn rows_of_text_have_a_field_for_each_name_where_a_wall_has_several_parts() {
    let folder = folder();
    let formats = [FormatName::Parquet, FormatName::Csv];
    recorded(folder.path(), &formats, &scene("drum"), 4, 2);
    for table in ["grains", "contacts", "pairs", "walls", "steps", "measures", "histograms"] {
        let found = parquet(folder.path(), table);
        assert_same(&csv(&folder.path().join(format!("csv/{table}.csv")), &found), &found, table);
    }
    let names = &parquet(folder.path(), "walls")["name"];
    assert!(names.contains(&word("polyline 0, 72 fixed discs")), "the situation: {names:?}");
}

#[test]
fn lost_grains_say_so_and_stay() {
    // The grain is too fast for the wall to be detected at this time step, so it is lost.
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
    recorded(folder.path(), FormatName::ALL, &pile, 2, 1);
    for (table, column, unit) in
        [("grains", "vx", "m/s"), ("contacts", "normal_force", "N"), ("steps", "slump", "1")]
    {
        let said = metadata(&parts(folder.path(), table)[0]);
        assert_eq!(said["parameters.bond"], "37.5");
        let columns: serde_json::Value = serde_json::from_str(&said["columns"]).expect("JSON");
        assert_eq!(columns[column]["unit"], unit, "{table}");
    }
    let text = read(folder.path().join("csv/grains.csv"));
    assert!(text.contains("\n# parameters.bond: 37.5\n"), "{text:.400}");
    assert!(text.contains("\n# column vx [m/s]: velocity of the centre\n"), "{text:.900}");
    let manifest = json(folder.path().join("data.json"));
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
    for table in ["grains", "contacts", "pairs", "walls", "steps", "measures", "histograms"] {
        let (one, other) = (parts(one.path(), table), parts(other.path(), table));
        assert_eq!(one.len(), other.len());
        for (one, other) in one.iter().zip(&other) {
            assert_eq!(bytes(one), bytes(other));
        }
    }
    let grains = parquet(one.path(), "grains");
    assert_eq!(steps(&grains), (1..=50).collect::<Vec<_>>());
    assert!(grains["time"].iter().map(number).is_sorted());
}

/// Checks that the first frame of a dump begins at most 16 lines after the start of the file. If more lines precede it,
/// OVITO does not recognise the file (measured with OVITO 3.17.2).
#[test]
fn the_first_frame_of_a_dump_begins_where_ovito_looks_for_it() {
    for entry in SCENES {
        let folder = folder();
        let scene = scene(entry.name);
        let mut recording = start(folder.path(), &[FormatName::Ovito], &scene);
        recording.add(scene.simulation().expect("a scene").moment()).expect("a frame");
        recording.finish().expect("a recording");
        for name in ["grains", "contacts"] {
            let text = read(folder.path().join(format!("ovito/{name}.dump")));
            let head = text.lines().position(|line| line == "ITEM: TIMESTEP").expect("a frame");
            assert!(head <= 16, "{}: {head} lines in {name}", entry.name);
        }
    }
}

type Row = Vec<(&'static str, Cell)>;

/// Arranges the rows of a table as columns.
fn columns(rows: impl IntoIterator<Item = Row>) -> Columns {
    let mut columns = Columns::new();
    for (name, cell) in rows.into_iter().flatten() {
        columns.entry(name.to_owned()).or_default().push(cell);
    }
    columns
}

fn word(word: &str) -> Cell {
    Cell::Word(word.to_owned())
}

fn optional(number: Option<f64>) -> Cell {
    number.map_or(Cell::Nothing, Cell::from)
}

fn grain_cells(moment: &Moment, id: usize, grain: &GrainState) -> Row {
    vec![
        ("step", Cell::Whole(moment.observables.step)),
        ("time", moment.observables.time_secs.into()),
        ("id", Cell::Whole(id as u64)),
        ("x", grain.position.x.into()),
        ("y", grain.position.y.into()),
        ("angle", grain.angle.into()),
        ("vx", grain.velocity.x.into()),
        ("vy", grain.velocity.y.into()),
        ("omega", grain.angular_velocity.into()),
        ("radius", grain.radius.into()),
        ("mass", grain.mass.into()),
        ("kind", word(if grain.lost { "lost" } else { "grain" })),
        ("x_unwrapped", grain.unwrapped.x.into()),
        ("y_unwrapped", grain.unwrapped.y.into()),
        ("material", word("")),
    ]
}

fn grains(moments: &[Moment]) -> Columns {
    columns(moments.iter().flat_map(|moment| {
        let of_grain = |(id, grain)| grain_cells(moment, id, grain);
        let of_disc = |(id, disc): (usize, &Disc)| {
            let still = GrainState {
                position: disc.position,
                unwrapped: disc.position,
                radius: disc.radius,
                angle: 0.0,
                velocity: glam::DVec2::ZERO,
                angular_velocity: 0.0,
                lost: false,
                ..moment.grains[0]
            };
            let mut cells = grain_cells(moment, moment.grains.len() + id, &still);
            cells.retain(|(name, _)| !["mass", "kind"].contains(name));
            cells.extend([("mass", Cell::Nothing), ("kind", word("fixed"))]);
            cells
        };
        let fixed = moment.surroundings.fixed_discs.iter().enumerate().map(of_disc);
        moment.grains.iter().enumerate().map(of_grain).chain(fixed).collect::<Vec<_>>()
    }))
}

fn contact_cells(moment: &Moment, contact: &ContactState) -> Row {
    let discs = moment.grains.len() + moment.surroundings.fixed_discs.len();
    let (id, kind, name) = match contact.other {
        OtherBody::Grain(index) => (index as usize, "grain", String::new()),
        OtherBody::FixedDisc(index) => {
            (moment.grains.len() + index as usize, "fixed", String::new())
        }
        OtherBody::Boundary(index) => {
            let boundary = &moment.surroundings.boundaries[index as usize];
            let said = serde_json::to_value(boundary).expect("JSON");
            let shape = said["shape"].as_str().expect("a word").to_owned();
            (discs + index as usize, "boundary", format!("{shape} {index}"))
        }
    };
    let bond = match moment.settings.stepper {
        Stepper::Range => Cell::Flag(contact.bond_stretch.is_some()),
        _ => Cell::Nothing,
    };
    vec![
        ("step", Cell::Whole(moment.observables.step)),
        ("time", moment.observables.time_secs.into()),
        ("id_i", Cell::Whole(contact.grain.into())),
        ("id_j", Cell::Whole(id as u64)),
        ("kind_j", word(kind)),
        ("name_j", Cell::Word(name)),
        ("x", contact.point.x.into()),
        ("y", contact.point.y.into()),
        ("nx", contact.normal.x.into()),
        ("ny", contact.normal.y.into()),
        ("gap", contact.gap.into()),
        ("normal_force", contact.normal_force.into()),
        ("tangential_force", contact.tangential_force.into()),
        ("status", word(contact.status.name())),
        ("bond", bond),
        ("stretch", optional(contact.bond_stretch)),
        ("age", Cell::Whole(contact.age_steps)),
        ("fx", contact.force.x.into()),
        ("fy", contact.force.y.into()),
    ]
}

fn contacts(moments: &[Moment]) -> Columns {
    let of = |moment| move |contact| contact_cells(moment, contact);
    columns(moments.iter().flat_map(|moment| moment.contacts.iter().map(of(moment))))
}

fn observables(all: &[Observables]) -> Columns {
    columns(all.iter().map(|row| {
        vec![
            ("step", Cell::Whole(row.step)),
            ("time", row.time_secs.into()),
            ("time_step", row.time_step_secs.into()),
            ("sweeps", Cell::Whole(row.sweeps.into())),
            ("factorisations", Cell::Whole(row.factorisations.into())),
            ("converged", Cell::Flag(row.converged)),
            ("stalled", Cell::Flag(row.stalled)),
            ("residual", row.residual.into()),
            ("model_residual", optional(row.model_residual)),
            ("velocity_error", row.velocity_error.into()),
            ("contacts", Cell::Whole(row.contacts.into())),
            ("compressive_contacts", Cell::Whole(row.compressive_contacts.into())),
            ("tensile_contacts", Cell::Whole(row.tensile_contacts.into())),
            ("mean_overlap", row.mean_overlap.into()),
            ("max_overlap", row.max_overlap.into()),
            ("kinetic_energy", row.kinetic_energy.into()),
            ("potential_energy", row.potential_energy.into()),
            ("normal_work", row.normal_work.into()),
            ("tangential_work", row.tangential_work.into()),
            ("drive_energy", optional(row.drive_energy)),
            ("drive_work", optional(row.drive_work)),
            ("border_work", optional(row.border_work)),
            ("gravity_work", row.gravity_work.into()),
            ("slump", row.slump.into()),
            ("bond_work", optional(row.bond_work)),
            ("bond_energy", optional(row.bond_energy)),
            ("broken_bond_energy", optional(row.broken_bond_energy)),
            ("lost_grains", Cell::Whole(row.lost_grains.into())),
        ]
    }))
}

fn measured(number: f64) -> Cell {
    optional((!number.is_nan()).then_some(number))
}

fn grain_measures(moments: &[Moment]) -> Columns {
    columns(moments.iter().flat_map(|moment| {
        let of_grain = |of_grain: GrainMeasures| {
            vec![
                ("coordination", f64::from(of_grain.coordination).into()),
                ("rattler", Cell::Flag(of_grain.rattler)),
                ("pressure", measured(of_grain.pressure)),
                ("deviator", measured(of_grain.deviator)),
                ("stress_xy", measured(of_grain.stress_xy)),
                ("cell_area", measured(of_grain.cell_area)),
                ("solid_fraction", measured(of_grain.solid_fraction)),
            ]
        };
        let mut rows: Vec<Row> = measure(moment).grains.into_iter().map(of_grain).collect();
        let nothing: Row = rows[0].iter().map(|(name, _)| (*name, Cell::Nothing)).collect();
        rows.extend(vec![nothing; moment.surroundings.fixed_discs.len()]);
        rows
    }))
}

fn measures(moments: &[Moment]) -> Columns {
    columns(moments.iter().map(|moment| {
        let pile = measure(moment).pile;
        vec![
            ("step", Cell::Whole(moment.observables.step)),
            ("time", moment.observables.time_secs.into()),
            ("grains", Cell::Whole(pile.grains.into())),
            ("stress_xx", measured(pile.stress_xx)),
            ("pressure", measured(pile.pressure)),
            ("fabric_anisotropy", measured(pile.fabric_anisotropy)),
            ("coordination", measured(pile.coordination)),
            ("rattlers", Cell::Whole(pile.rattlers.into())),
            ("solid_fraction_cells", measured(pile.solid_fraction_cells)),
            ("strong_share", measured(pile.strong_share)),
        ]
    }))
}

fn histograms(moments: &[Moment]) -> Columns {
    let mut rows = Vec::new();
    for moment in moments {
        for histogram in measure(moment).histograms {
            for (bin, &count) in histogram.counts.iter().enumerate() {
                rows.push(vec![
                    ("step", Cell::Whole(moment.observables.step)),
                    ("time", moment.observables.time_secs.into()),
                    ("quantity", word(histogram.quantity)),
                    ("unit", word(histogram.unit)),
                    ("from", histogram.edges[bin].into()),
                    ("to", histogram.edges[bin + 1].into()),
                    ("count", Cell::Whole(count)),
                ]);
            }
        }
    }
    columns(rows)
}
