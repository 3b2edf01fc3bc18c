//! Fuzzing with hostile files: Parquet files with a wrong structure, saved runs with changed content and a correct
//! checksum, and links.

use slump::config::SavedState;
use slump::data::read_grains;
use slump::scene::built_in;
use slump::sim::Tally;

use super::Target;
use super::parsers::{NUMBERS, changed, check, is_legible, one_of};
use crate::columnar::Columnar;
use crate::program::*;

/// Whole numbers that can occur in the metadata of a Parquet file, and impossible ones.
const COUNTS: [i64; 12] = [0, 1, 2, 3, 5, 8, 16, 1 << 20, 1 << 28, i32::MAX as i64, i64::MAX, -1];

#[test]
fn columnar_files_by_structure() {
    let target = Target { name: "columnar", ending: "parquet", inputs: 1000 };
    target.fuzz(
        &[],
        |u| {
            let mut file = Columnar::default();
            for _ in 0..u.int_in_range(1..=3)? {
                let number = *u.choose(&COUNTS)?;
                match u.int_in_range(0..=10)? {
                    0 => file.rows = number,
                    1 => file.group_rows = number,
                    2 => file.values = number,
                    3 => file.children = number,
                    4 => file.depth = usize::from(u.int_in_range(0..=40_u8)?),
                    5 => file.codec = u.int_in_range(0..=8)?,
                    6 => file.encoding = u.int_in_range(0..=9)?,
                    7 => file.unpacked = number,
                    8 => file.packed = Some(number),
                    9 => file.dictionary = Some(number),
                    _ => file.page = u.bytes(16)?.to_vec(),
                }
            }
            let mut bytes = file.bytes();
            if u.ratio(1, 4)? {
                let place = u.choose_index(bytes.len())?;
                bytes[place] ^= 1 << u.int_in_range(0..=7)?;
            }
            // Each byte becomes a character, because an input is a text.
            Ok(bytes.into_iter().map(char::from).collect())
        },
        |text, path| {
            write(path, text.chars().map(|it| it as u8).collect::<Vec<_>>());
            read_grains(path, None).inspect_err(check).is_ok()
        },
    );
}

/// Returns a saved run with this content and a correct checksum. `whole` is a valid saved run from which the first line
/// is taken.
fn sealed(whole: &[u8], content: &[u8]) -> Vec<u8> {
    let end = whole.iter().position(|&byte| byte == b'\n').expect("a first line");
    let line = std::str::from_utf8(&whole[..end]).expect("UTF-8");
    let words: Vec<&str> = line.split(' ').take(3).collect();
    let (length, checksum) = (content.len(), blake3::hash(content));
    [format!("{} {length} {checksum}\n", words.join(" ")).as_bytes(), content].concat()
}

#[test]
fn saved_runs_that_were_changed_and_sealed_again() {
    let scene = built_in("cradle").expect("a scene");
    let simulation = scene.simulation().expect("a simulation");
    let whole = SavedState::new(scene, simulation, Tally::default()).to_bytes().expect("bytes");
    let content = whole.iter().position(|&byte| byte == b'\n').expect("a first line") + 1;
    let target = Target { name: "saved-runs", ending: "slump", inputs: 500 };
    target.fuzz(
        &[],
        |u| {
            let mut bytes = whole[content..].to_vec();
            for _ in 0..u.int_in_range(1..=4)? {
                let place = u.choose_index(bytes.len())?;
                match u.int_in_range(0..=2)? {
                    0 => bytes[place] ^= 1 << u.int_in_range(0..=7)?,
                    1 => {
                        bytes[place] =
                            *u.choose(&[0x00, 0x7f, 0xc0, 0xcb, 0xcf, 0xdd, 0xdf, 0xff])?
                    }
                    _ => bytes.truncate(place.max(1)),
                }
            }
            Ok(bytes.into_iter().map(char::from).collect())
        },
        |text, path| {
            let content: Vec<u8> = text.chars().map(|it| it as u8).collect();
            write(path, sealed(&whole, &content));
            SavedState::open(path).inspect_err(check).is_ok()
        },
    );
}

#[test]
fn links() {
    let texts = [
        "slump://run?scene=cradle&bond=20&from=12&bond=5&to=30&dt=0.005&to=6",
        "slump://run?initial=/dev/zero&to=3",
        "slump://run?scene=/etc/passwd.toml&to=3",
        "slump://run?save=a&to=18446744073709551616",
    ];
    let texts = texts.map(str::to_owned);
    let target = Target { name: "links", ending: "txt", inputs: 60 };
    target.fuzz(
        &texts,
        |u| {
            let mut link = changed(u, &texts)?;
            if u.ratio(1, 4)? {
                link = format!("{link}&to={}", one_of(u, NUMBERS)?);
            }
            Ok(link.replace('\0', "0"))
        },
        |link, _| {
            // Without a screen no window opens, but the link is read before.
            let mut command = assert_cmd::Command::from_std(slump("--open"));
            command.arg(link).env_remove("DISPLAY").env_remove("WAYLAND_DISPLAY");
            let output = command.timeout(PATIENCE).output().expect("it starts");
            let said = String::from_utf8(output.stderr).expect("UTF-8");
            assert_eq!(output.status.code(), Some(2), "{said}");
            assert!(said.lines().all(is_legible) && !said.contains("panicked"), "{said:?}");
            assert!(!said.contains("No such file") && !said.contains("/dev/zero: "), "{said}");
            !said.contains(" must ")
        },
    );
}
