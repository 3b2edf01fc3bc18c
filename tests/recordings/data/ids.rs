//! Tests of the ids of bodies: an id belongs to the same body in the whole recording, even if the user adds and removes
//! grains.

use std::collections::BTreeMap;

use slump::config::SavedState;
use slump::sim::Tally;
use slump::world::Disc;

use super::tables::{Cell, Columns, number, parquet, whole};
use super::*;

/// Returns for each id the radius (bit pattern) of the body with this id. The discs of a pile have different radii, so
/// an id with two radii would belong to two bodies; this fails the test.
fn radii(rows: impl Iterator<Item = (u64, f64)>) -> BTreeMap<u64, u64> {
    let mut radii = BTreeMap::new();
    for (id, radius) in rows {
        let before = radii.insert(id, radius.to_bits());
        assert!(before.is_none_or(|bits| bits == radius.to_bits()), "id {id}: {radius}");
    }
    radii
}

/// Returns the numbers in the columns `id` and `radius` of all frames of a LAMMPS dump.
fn of_dump(path: &Path) -> Vec<(u64, f64)> {
    let (mut rows, mut places) = (Vec::new(), [0; 2]);
    for line in read(path).lines() {
        let words: Vec<&str> = line.split(' ').collect();
        if line.starts_with("ITEM: ATOMS ") {
            let place = |name| words.iter().position(|word| *word == name).expect(name) - 2;
            places = ["id", "radius"].map(place);
        } else if words.len() > 8 && !line.starts_with("ITEM") {
            let [id, radius] = places.map(|place| words[place]);
            rows.push((id.parse().expect("an id"), radius.parse().expect("a radius")));
        }
    }
    rows
}

/// Returns the numbers in the arrays `id` and `radius` of a VTK file.
fn of_vtk(path: &Path) -> Vec<(u64, f64)> {
    const DATA: &[u8] = b"<AppendedData encoding=\"raw\">\n   _";
    let bytes = bytes(path);
    let start = bytes.windows(DATA.len()).position(|part| part == DATA).expect("data") + DATA.len();
    let head = String::from_utf8_lossy(&bytes[..start]).into_owned();
    let array = |name: &str| {
        let (_, rest) = head.split_once(&format!("Name=\"{name}\"")).expect(name);
        let offset = rest.split_once("offset=\"").expect("an offset").1.split('"').next();
        let data =
            &bytes[start + offset.and_then(|it| it.parse::<usize>().ok()).expect("a number")..];
        let length = u64::from_le_bytes(*data.first_chunk().expect("a length")) as usize;
        data[8..8 + length].as_chunks::<8>().0.to_vec()
    };
    let ids = array("id").into_iter().map(u64::from_le_bytes);
    ids.zip(array("radius").into_iter().map(f64::from_le_bytes)).collect()
}

fn rows_of(columns: &Columns) -> impl Iterator<Item = (u64, f64)> + '_ {
    columns["id"].iter().map(whole).zip(columns["radius"].iter().map(number))
}

#[test]
fn an_id_belongs_to_one_body_for_the_whole_recording_in_every_format() {
    let folder = folder();
    let pile = scene("pile");
    let mut recording = start(folder.path(), FormatName::ALL, &pile);
    let mut simulation = pile.simulation().expect("a scene");
    record(&mut recording, &mut simulation, 2, 2);
    simulation.remove_grain(1).expect("it is there");
    record(&mut recording, &mut simulation, 2, 2);
    let new = |radius: f64, x: f64| Disc { position: glam::DVec2::new(x, 0.2), radius };
    simulation.add_grain(new(0.0031, 0.1), glam::DVec2::ZERO).expect("there is room");
    record(&mut recording, &mut simulation, 2, 2);
    // The id of a removed grain is not used again, even after the run is saved and read.
    let last = simulation.world().grains.len() - 1;
    simulation.remove_grain(last).expect("it is there");
    let saved = SavedState::new(pile.clone(), simulation, Tally::default());
    let bytes = saved.to_bytes().expect("bytes");
    let mut simulation = SavedState::from_bytes(&bytes, "saved").expect("a state").simulation;
    simulation.add_grain(new(0.0032, -0.1), glam::DVec2::ZERO).expect("there is room");
    simulation.remove_grain(40).expect("it is there");
    record(&mut recording, &mut simulation, 20, 2);
    recording.finish().expect("a recording");

    let table = parquet(folder.path(), "grains");
    let expected = radii(rows_of(&table));
    let (grains, fixed) = (pile.grains.len() as u64, pile.fixed_discs.len() as u64);
    let bodies = grains + fixed + pile.boundaries.len() as u64;
    let all: Vec<u64> = (0..grains + fixed).chain([bodies, bodies + 1]).collect();
    assert!(expected.keys().copied().eq(all), "{:?}", expected.keys());
    for (id, grain) in pile.grains.iter().enumerate() {
        assert_eq!(expected[&(id as u64)], grain.radius.to_bits(), "{id}");
    }
    assert_eq!([expected[&bodies], expected[&(bodies + 1)]], [0.0031, 0.0032].map(f64::to_bits));
    let text = super::tables::csv(&folder.path().join("csv/grains.csv"), &table);
    assert_eq!(radii(rows_of(&text)), expected);
    assert_eq!(radii(of_dump(&folder.path().join("ovito/grains.dump")).into_iter()), expected);
    let frames = (0..13).map(|frame| folder.path().join(format!("vtk/grains_{frame:06}.vtp")));
    assert_eq!(radii(frames.flat_map(|path| of_vtk(&path))), expected);

    // The ids in the tables of contacts and pairs occur in the table of grains of the same frame.
    let in_frame: Vec<(u64, u64)> =
        table["step"].iter().map(whole).zip(table["id"].iter().map(whole)).collect();
    for name in ["contacts", "pairs"] {
        let pairs = parquet(folder.path(), name);
        let mut seen = 0;
        for (row, step) in pairs["step"].iter().map(whole).enumerate() {
            let [i, j] = ["id_i", "id_j"].map(|column| whole(&pairs[column][row]));
            assert!(in_frame.contains(&(step, i)), "{name}: {i} at step {step}");
            if pairs["kind_j"][row] != Cell::Word("boundary".into()) {
                assert!(in_frame.contains(&(step, j)), "{name}: {j} at step {step}");
            }
            seen += usize::from(step > 4);
        }
        assert!(seen > 100, "{name}: {seen}");
    }
}
