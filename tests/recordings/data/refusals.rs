//! Tests of files that are not valid initial states: Slump refuses them in one sentence with the file, the position,
//! the value and the allowed values.

use std::sync::Arc;

use parquet::data_type::{ByteArrayType, DoubleType, Int64Type};
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::parser::parse_message_type;
use rand::RngExt;
use rand_pcg::Pcg64;
use rand_pcg::rand_core::SeedableRng;
use slump::data::read_grains;

use super::tables::parts;
use super::*;
use crate::columnar::Columnar;

enum Column<'a> {
    Numbers(&'a str, &'a [f64]),
    Whole(&'a str, &'a [i64]),
    Words(&'a str, &'a [&'a str]),
}

fn write_columns(path: &Path, columns: &[Column<'_>]) {
    let field = |column: &Column<'_>| match column {
        Column::Numbers(name, _) => format!("REQUIRED DOUBLE {name};"),
        Column::Whole(name, _) => format!("REQUIRED INT64 {name};"),
        Column::Words(name, _) => format!("REQUIRED BYTE_ARRAY {name} (UTF8);"),
    };
    let fields: String = columns.iter().map(field).collect();
    let schema = parse_message_type(&format!("message discs {{ {fields} }}")).expect("a schema");
    let file = std::fs::File::create(path).expect("a file");
    let properties = Arc::new(WriterProperties::builder().build());
    let mut file = SerializedFileWriter::new(file, Arc::new(schema), properties).expect("a writer");
    let mut group = file.next_row_group().expect("a group");
    for column in columns {
        let mut writer = group.next_column().expect("a column").expect("one more");
        match column {
            Column::Numbers(_, values) => {
                writer.typed::<DoubleType>().write_batch(values, None, None)
            }
            Column::Whole(_, values) => writer.typed::<Int64Type>().write_batch(values, None, None),
            Column::Words(_, words) => {
                let words: Vec<_> = words.iter().map(|word| (*word).into()).collect();
                writer.typed::<ByteArrayType>().write_batch(&words, None, None)
            }
        }
        .expect("values");
        writer.close().expect("a column");
    }
    group.close().expect("a group");
    file.close().expect("a file");
}

const XS: Column<'static> = Column::Numbers("x", &[0.0, 0.01, 0.02]);
const YS: Column<'static> = Column::Numbers("y", &[0.004, 0.005, 0.006]);
const RADII: Column<'static> = Column::Numbers("radius", &[0.002, 0.002, 0.0025]);

#[test]
fn parquet_of_others_is_read() {
    let folder = folder();
    let path = folder.path().join("discs.parquet");
    write_columns(&path, &[RADII, Column::Words("kind", &["grain", "grain", "grain"]), YS, XS]);
    let found = read_grains(&path, None).expect("discs");
    assert_eq!(found.grains.len(), 3);
    assert_eq!(found.grains[2].radius, 0.0025);
    assert_eq!(found.grains[2].position, glam::DVec2::new(0.02, 0.006));
    assert_eq!(found.grains[2].velocity, glam::DVec2::ZERO);
    // Columns of whole numbers are accepted, and the ids determine the order of the discs.
    let ids = Column::Whole("id", &[7, 3, 5]);
    write_columns(&path, &[Column::Whole("x", &[1, 2, 3]), YS, RADII, ids]);
    let found = read_grains(&path, None).expect("discs");
    let places: Vec<f64> = found.grains.iter().map(|grain| grain.position.x).collect();
    assert_eq!(places, [2.0, 3.0, 1.0]);
}

#[test]
fn parquet_that_is_no_state_is_told_of_by_row_and_column() {
    let folder = folder();
    let path = folder.path().join("discs.parquet");
    let check = |columns: &[Column<'_>], expected: &str| {
        write_columns(&path, columns);
        let said = refusal(&["--initial", text(&path), "--data", "no"]);
        assert_eq!(said, format!("{}: {expected}", path.display()));
    };
    check(&[XS, YS], "the columns are x, y, but must be such that x, y and radius are there");
    let unknown = [XS, YS, RADII, Column::Words("colour", &["a", "b", "c"])];
    write_columns(&path, &unknown);
    let said = refusal(&["--initial", text(&path), "--data", "no"]);
    assert!(said.contains("a column is colour, but must be one of step, time, id, x, y"), "{said}");
    check(
        &[Column::Numbers("x", &[0.0, f64::NAN, 1.0]), YS, RADII],
        "row 2: x is NaN, but must be finite",
    );
    check(
        &[XS, YS, Column::Numbers("radius", &[0.1, 0.1, -0.1])],
        "row 3: radius is -0.1, but must be finite and > 0",
    );
    check(
        &[XS, YS, RADII, Column::Numbers("omega", &[0.0, 0.0, f64::INFINITY])],
        "row 3: omega is inf, but must be finite",
    );
    check(
        &[XS, YS, RADII, Column::Whole("id", &[4, 9, 4])],
        "row 3: id is 4, but must be another than in row 1",
    );
    check(
        &[XS, YS, RADII, Column::Whole("id", &[4, -9, 4])],
        "row 2: id is -9, but must be a whole number ≥ 0",
    );
    check(
        &[XS, YS, RADII, Column::Words("kind", &["grain", "wall", "grain"])],
        "row 2: kind is wall, but must be grain or fixed or lost",
    );
    check(
        &[XS, YS, Column::Words("radius", &["1", "1", "1"])],
        "column radius holds something else, but must hold numbers",
    );
    check(
        &[XS, YS, RADII, Column::Words("kind", &["fixed", "lost", "fixed"])],
        "holds no disc, but must hold at least one",
    );
    let none = Column::Numbers("x", &[]);
    check(
        &[none, Column::Numbers("y", &[]), Column::Numbers("radius", &[])],
        "holds no disc, but must hold at least one",
    );
}

#[test]
fn text_that_is_no_state_is_told_of_by_line() {
    let folder = folder();
    let path = folder.path().join("discs.csv");
    let check = |table: &str, expected: &str| {
        write(&path, table);
        let said = refusal(&["--initial", text(&path), "--data", "no"]);
        assert_eq!(said, format!("{}: {expected}", path.display()));
    };
    check(
        "# one\nid,x,y,radius\n4,0,0.1,1\n\n4,0.1,0.1,1\n",
        "line 5: id is 4, but must be another than in line 3",
    );
    check(
        "step,x,y,radius\n1,0,0.1,1\n-1,0.1,0.1,1\n",
        "line 3: step: '-1' is none, but must be a whole number ≥ 0",
    );
    check(
        "x,y,radius,kind\n0,0.1,1,grain\n0.1,0.1,1,wall\n",
        "line 3: kind is wall, but must be grain or fixed or lost",
    );
    check("x,y,radius,x\n0,0.1,1,2\n", "the header line names x twice, but must name it once");
    check("x,y,radius\n0,0.1\n", "line 2: has 2 columns, but must have 3");
    check("step,x,y,radius\n", "holds no disc, but must hold at least one");
}

#[test]
fn masses_densities_and_materials_of_a_file_are_used_in_every_format() {
    let folder = folder();
    let [path, columns] = ["discs.csv", "discs.parquet"].map(|name| folder.path().join(name));
    let check = |path: &Path, place: &str, expected: &str| {
        let said = refusal(&["--initial", text(path), "--data", "no"]);
        assert_eq!(said, format!("{}: {place}{expected}", path.display()));
    };
    for mass in ["0", "-1", "inf"] {
        write(&path, format!("x,y,radius,mass\n0,0.0075,0.0025,{mass}\n"));
        let expected = format!("mass is {mass} kg, but must be left out or finite and > 0");
        check(&path, "line 2: ", &expected);
        write(&path, format!("x,y,radius,density\n0,0.0075,0.0025,{mass}\n"));
        let expected = format!("density is {mass} kg/m², but must be left out or finite and > 0");
        check(&path, "line 2: ", &expected);
    }
    write(&path, "x,y,radius,mass,density\n0,0.0075,0.0025,1e-5,1\n");
    check(&path, "line 2: ", "density is 1 kg/m², but must be left out where a mass is given");
    let said = |table: &str| {
        write(&path, table);
        refusal(&["--initial", text(&path), "--data", "no"])
    };
    let unknown = said("x,y,radius,material\n0,0.0075,0.0025,ice\n");
    assert!(unknown.starts_with("grains[0].material is ice, but must be left out"), "{unknown}");
    let unknown = said("x,y,radius,kind,material\n0,0.1,0.0025,grain,\n0,0,0.0025,fixed,ice\n");
    assert!(
        unknown.contains("the material of a fixed disc is ice, but must be one of"),
        "{unknown}"
    );

    let mut scene = scene("pile");
    scene.grains.clear();
    scene.fixed_discs.clear();
    let names = ["one", "other"].map(str::to_owned);
    scene.materials =
        names.map(|name| slump::world::Material { name, ..Default::default() }).to_vec();
    let mut masses_in = |source: &Path| {
        scene.source = Some(slump::scene::GrainSource::Csv { path: source.into() });
        let file = folder.path().join("scene.toml");
        write(&file, slump::config::scene_to_toml(&scene).expect("TOML"));
        let read = slump::config::read_scene(&file).expect("a scene");
        let run = read.simulation().expect("a proper scene");
        let grains = run.world().grains.clone();
        let is_given = read.grains.iter().map(|grain| grain.mass.is_some()).collect::<Vec<_>>();
        assert_eq!(read.materials[1].fixed_discs, if source == path { vec![1] } else { vec![] });
        (grains.masses, grains.materials, is_given)
    };
    let implied = std::f64::consts::PI * 0.0025 * 0.0025;
    write(
        &path,
        format!(
            "x,y,radius,kind,mass,density,material\n0,0.0075,0.0025,grain,1e-2,,other\n\
             0,0,0.0025,fixed,,,\n0.1,0,0.0025,fixed,,,other\n0,0.0125,0.0025,grain,,3,one\n\
             0,0.0225,0.0025,grain,{implied},,\n"
        ),
    );
    let expected = (vec![1e-2, 3.0 * implied, implied], vec![1, 0, 0], vec![true, true, false]);
    assert_eq!(masses_in(&path), expected);
    let materials = Column::Words("material", &["other", "", "one"]);
    let masses = Column::Numbers("mass", &[1e-5, 1e-2, 1e-2]);
    write_columns(&columns, &[XS, YS, RADII, masses, materials]);
    assert_eq!(masses_in(&columns), (vec![1e-5, 1e-2, 1e-2], vec![1, 0, 0], vec![true; 3]));
}

/// Checks that Slump refuses tables in the default formats of pandas, numpy and spreadsheets, and says how to correct
/// them.
#[test]
fn a_table_of_another_program_is_refused_with_the_way_to_mend_it() {
    let folder = folder();
    let path = folder.path().join("discs.csv");
    for (table, expected) in [
        (
            ",x,y,radius\n0,0,0.1,1\n",
            "has no name, but must have one; if it counts rows, leave it out",
        ),
        (
            "# x,y,radius\n0.0,1e-1,1.0\n",
            "the header line is '0.0,1e-1,1.0', but must be one that names",
        ),
        ("# x,y,radius\n0.0,1e-1,1.0\n", "numpy.savetxt writes it without '# ' if comments=''"),
        ("x;y;radius\n0;0.1;1\n", "the header line is 'x;y;radius', but must be one that names"),
        ("x;y;radius\n0;0.1;1\n", "with commas between them"),
        ("x y radius\n0 0.1 1\n", "with commas between them"),
        ("x\ty\tradius\n0\t0.1\t1\n", "with commas between them"),
    ] {
        write(&path, table);
        let said = refusal(&["--initial", text(&path), "--data", "no"]);
        assert!(said.contains(expected), "{said}");
    }
}

#[test]
fn what_is_nothing_of_all_that_is_told_of() {
    let folder = folder();
    let empty = folder.path().join("empty");
    std::fs::create_dir(&empty).expect("a folder");
    let said = refusal(&["--initial", text(&empty), "--data", "no"]);
    assert!(said.contains("empty: has no grains, but must be a file of discs"), "{said}");
    let said = refusal(&["--initial", "no/such.parquet", "--data", "no"]);
    assert!(said.starts_with("no/such.parquet: No such file"), "{said}");
    let path = folder.path().join("cut.parquet");
    write(&path, "PAR1 and no more");
    let said = refusal(&["--initial", text(&path), "--data", "no"]);
    assert!(said.contains("but must be a Parquet file"), "{said}");
}

#[test]
fn damaged_parquet_is_refused_or_read_and_nothing_else() {
    let folder = folder();
    recorded(folder.path(), &[FormatName::Parquet], &scene("pile"), 2, 1);
    let whole = bytes(&parts(folder.path(), "grains")[0]);
    let path = folder.path().join("damaged.parquet");
    let mut random = Pcg64::seed_from_u64(3);
    let mut refused = 0;
    for round in 0..600 {
        let mut bytes = whole.clone();
        // Most of the possible errors are in the footer of a Parquet file.
        let from = if round % 2 == 0 { 0 } else { bytes.len().saturating_sub(9000) };
        for _ in 0..random.random_range(1..4) {
            let place = random.random_range(from.max(4)..bytes.len());
            bytes[place] ^= 1 << random.random_range(0..8);
        }
        if round % 10 == 0 {
            bytes.truncate(random.random_range(4..bytes.len()));
        }
        write(&path, &bytes);
        if let Err(error) = read_grains(&path, None) {
            let said = error.to_string();
            assert!(said.contains(" must ") && !said.contains('\n'), "{said}");
            refused += 1;
        }
    }
    assert!(refused > 90, "many were damaged where it shows: {refused}");
}

/// Checks that a scene file that is too long is refused before it is parsed. A scene needs about sixty times the length
/// of its text in memory.
#[test]
fn a_text_that_nobody_means_is_refused_before_it_is_parsed() {
    let folder = folder();
    let path = folder.path().join("huge.toml");
    let file = std::fs::File::create(&path).expect("a file");
    file.set_len((32 << 20) + 1).expect("a hole");
    let said = refusal(&["--scene", text(&path)]);
    assert!(said.contains("has more than 33554432 bytes, but must have no more"), "{said}");
}

/// Flips each bit of two small Parquet files and checks that reading neither panics nor runs out of memory. In an
/// earlier version one flipped bit caused an allocation of 24 GiB, because the decoder read other numbers than the
/// check before the decoding.
#[test]
fn parquet_with_any_bit_turned_is_read_or_refused() {
    let folder = folder();
    let path = folder.path().join("discs.parquet");
    let truth = Columnar::default();
    let lie = Columnar { rows: 1 << 28, group_rows: 1 << 28, ..truth.clone() };
    let mut refused = 0;
    for whole in [truth.bytes(), lie.bytes()] {
        for bit in 0..8 * whole.len() {
            let mut bytes = whole.clone();
            bytes[bit / 8] ^= 1 << (bit % 8);
            write(&path, &bytes);
            refused += usize::from(read_grains(&path, None).is_err());
        }
    }
    assert!(refused > 2_000, "{refused}");
}

/// Checks that Slump refuses small Parquet files with wrong numbers. In earlier versions each of these files ended the
/// program abruptly: by lack of memory, by a stack overflow, or by a panic of the decoder.
#[test]
fn small_parquet_that_lies_is_refused_in_a_sentence() {
    let folder = folder();
    let path = folder.path().join("discs.parquet");
    let truth = Columnar::default();
    write(&path, truth.bytes());
    let found = read_grains(&path, None).expect("what is true is read");
    assert_eq!(found.grains.len(), 2);
    let dictionary = Some(i64::from(i32::MAX));
    for (lie, expected) in [
        (Columnar { children: i64::from(i32::MAX), ..truth.clone() }, "has a group of 2147483647"),
        (
            Columnar { children: 1, depth: 100_000, ..truth.clone() },
            "columns nested deeper than 16",
        ),
        (Columnar { rows: 1 << 28, group_rows: 1 << 28, ..truth.clone() }, "has 268435456 rows in"),
        (Columnar { rows: 3, ..truth.clone() }, "has 2 rows, but must have 3"),
        (Columnar { rows: 9, group_rows: 9, ..truth.clone() }, "must be a Parquet file"),
        (Columnar { encoding: 8, ..truth.clone() }, "is damaged, but must be"),
        (Columnar { encoding: 6, ..truth.clone() }, "encoded by lengths"),
        (
            Columnar { codec: 1, unpacked: i64::from(i32::MAX), ..truth.clone() },
            "has a page of 2147483647",
        ),
        (Columnar { dictionary, ..truth.clone() }, "has a dictionary of 2147483647 values"),
        (Columnar { packed: Some(1 << 40), ..truth.clone() }, "ends within a header"),
    ] {
        write(&path, lie.bytes());
        let said = refusal(&["--initial", text(&path), "--data", "no"]);
        assert!(said.contains(expected) && said.contains(" must "), "{lie:?}: {said}");
    }
}
