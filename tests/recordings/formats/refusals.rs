//! Files of others that are read, and what is refused, in one sentence.

use std::path::{Path, PathBuf};

use glam::DVec2;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use slump::data::{RecordedGrains, read_grains};
use slump::error::Result;

use crate::formats::moments::{THIRD, start, write};

/// What VTK 9.7 writes, of three points with the arrays that are needed.
const OF_OTHERS: [&str; 5] =
    ["ascii.vtp", "inline.vtp", "appended.vtp", "packed.vtp", "big_endian.vtp"];

const DUMP: &str = "ITEM: TIMESTEP\n7\nITEM: NUMBER OF ATOMS\n2\nITEM: BOX BOUNDS pp pp pp\n0 1\n0 1\n0 1\n\
                    ITEM: ATOMS id type x y z radius vx vy vz omegaz \n\
                    1 1 0.25 0.5 0 0.125 1 2 0 3 \n2 1 0.75 0.5 0 0.125 0 0 0 0 \n";

fn of_others(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/recordings/formats/of_others").join(name)
}

#[test]
fn whatever_vtk_writes_is_read() {
    for name in OF_OTHERS {
        let found = read_grains(&of_others(name), None).unwrap_or_else(|error| panic!("{error}"));
        let positions: Vec<DVec2> = found.grains.iter().map(|grain| grain.position).collect();
        let expected = [DVec2::new(0.0, THIRD), DVec2::new(1.0, THIRD), DVec2::new(2.0, -THIRD)];
        assert_eq!(positions, expected, "{name}");
        let radii: Vec<f32> = found.grains.iter().map(|grain| grain.radius as f32).collect();
        assert_eq!(radii, [0.5, 0.25, 0.1], "{name}");
        assert_eq!(found.grains[2].velocity, DVec2::new(6.0, 7.0), "{name}");
        assert_eq!(found.grains[1].angular_velocity, -2.0, "{name}");
    }
}

#[test]
fn a_dump_of_lammps_is_read() {
    let found = read(DUMP).expect("discs");
    assert_eq!(found.grains.len(), 2);
    assert_eq!(found.grains[0].position, DVec2::new(0.25, 0.5));
    assert_eq!(found.grains[0].velocity, DVec2::new(1.0, 2.0));
    assert_eq!(found.grains[0].angular_velocity, 3.0);
    // The last whole frame counts.
    let later = DUMP.replace("0.25 0.5", "0.125 0.5");
    let cut = &DUMP[..DUMP.len() - 30];
    let found = read(format!("{DUMP}{later}{cut}")).expect("discs");
    assert_eq!(found.grains[0].position.x, 0.125);
}

fn read(text: impl AsRef<[u8]>) -> Result<RecordedGrains> {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("file");
    std::fs::write(&path, text).expect("a file");
    read_grains(&path, None)
}

fn refusal(text: &str) -> String {
    let error = read(text).map(|found| panic!("{found:?} of {text}")).unwrap_err();
    let sentence = error.to_string();
    let (_, said) = sentence.split_once("file: ").expect("the path");
    said.to_owned()
}

#[test]
fn dumps_are_refused_in_one_sentence() {
    let form = "a LAMMPS dump in text with the columns x, y and radius";
    let cases = [
        (DUMP.replace("radius", "diameter"), "the columns are id, type, x, y, z, diameter, vx, vy, vz, omega, but must be such that x, y and radius are there".into()),
        (DUMP.replace("0.75 0.5", "NaN 0.5"), "line 11: x is NaN, but must be finite".into()),
        (DUMP.replace("0.75 0.5", "much 0.5"), "line 11: x: 'much' is none, but must be a number".into()),
        (DUMP.replace("0.75 0.5 0 0.125 0 0 0 0", "0.75 0.5"), "line 11: has too few columns, but must have one for each name".into()),
        (DUMP.replace("0.75 0.5 0", "0.75 0.5 0.25"), "line 11: z is 0.25, but must be 0, since the world is a plane".into()),
        (DUMP.replace("0 0.125 0", "0 -1 0"), "line 11: radius is -1, but must be finite and > 0".into()),
        (DUMP.replace("\n2 1", "\n1 1"), "line 11: id is 1, but must be another than in line 10".into()),
        (DUMP.replace("ATOMS\n2", "ATOMS\n3"), format!("has no whole frame, but must be {form}")),
        (DUMP.replace("ATOMS\n2", "ATOMS\nmany"), format!("line 4: 'many' is no number of rows, but must be {form}")),
        (DUMP.replace("ATOMS", "BONDS"), format!("has no whole frame, but must be {form}")),
        (DUMP.replace("ATOMS\n2", "ATOMS\n0"), "holds no disc, but must hold at least one".into()),
    ];
    for (text, sentence) in cases {
        assert_eq!(refusal(&text), sentence);
    }
}

#[test]
fn vtk_files_are_refused_in_one_sentence() {
    let text = std::fs::read_to_string(of_others("ascii.vtp")).expect("a file");
    let form = "a .vtp file of points with the array radius, uncompressed or compressed with zlib";
    let cases = [
        (
            text.replace("radius", "size"),
            "the columns are x, y, size, velocity, omega, but must be such that x, y and radius are there".to_owned(),
        ),
        (
            text.replace("0.5 0.25", "0.5 much"),
            format!("the array radius says 'much', which is no number, but must be {form}"),
        ),
        (
            text.replace("0.5 0.25", "0.5 -0.25"),
            "point 1: radius is -0.25, but must be finite and > 0".into(),
        ),
        (
            text.replace("0.5 0.25", "0.5"),
            "the array radius has 2 numbers, but must have 1 for each of 3 points"
                .into(),
        ),
        (
            text.replace("NumberOfPoints=\"3\"", "NumberOfPoints=\"4\""),
            "the array Points has 9 numbers, but must have 3 for each of 4 points"
                .into(),
        ),
        (
            text.replace("PolyData", "ImageData"),
            format!("is a file of the type ImageData, but must be {form}"),
        ),
        (
            text.replace("<Points>", "<Places>").replace("</Points>", "</Places>"),
            format!("has no positions, but must be {form}"),
        ),
        (
            text.replace("<Piece", "<Part").replace("</Piece", "</Part"),
            "has 0 pieces, but must have one".into(),
        ),
    ];
    for (text, sentence) in cases {
        assert_eq!(refusal(&text), sentence);
    }
    for no_xml in ["<VTKFile", "<VTKFile></Piece>", "<?xml version=\"1.0\"?>", "<?xml?><html/>"] {
        let sentence = refusal(no_xml);
        assert!(sentence.ends_with(&format!("but must be {form}")), "{sentence}");
    }
    let packed = std::fs::read_to_string(of_others("packed.vtp")).expect("a file");
    let other = refusal(&packed.replace("vtkZLibDataCompressor", "vtkLZ4DataCompressor"));
    assert!(other.ends_with("is compressed with vtkLZ4DataCompressor, but must be with vtkZLibDataCompressor or not at all"), "{other}");
}

/// Whatever a file says, reading it ends, with discs or a sentence.
#[test]
fn no_file_makes_reading_panic() {
    let folder = tempfile::tempdir().expect("a folder");
    write(&mut start(folder.path()), 0..2);
    let ours = folder.path().join("vtk/grains_000001.vtp");
    let dump = folder.path().join("ovito/grains.dump");
    let files = OF_OTHERS.map(of_others).into_iter().chain([ours, dump]);
    let mut random = Pcg64::seed_from_u64(14);
    for path in files {
        let good = std::fs::read(path).expect("a file");
        for _ in 0..400 {
            let mut bytes = good.clone();
            for _ in 0..random.random_range(1..4) {
                let at = random.random_range(0..bytes.len());
                match random.random_range(0..3) {
                    0 => bytes.truncate(at.max(1)),
                    1 => bytes[at] = random.random(),
                    _ => drop(bytes.drain(at..(at + 3).min(bytes.len()))),
                }
                if bytes.is_empty() {
                    break;
                }
            }
            if let Err(error) = read(&bytes) {
                assert!(error.to_string().contains("must "), "{error}");
            }
        }
    }
}
