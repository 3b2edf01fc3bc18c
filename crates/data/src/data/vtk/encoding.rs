//! What the files of a frame say: its tables as points and lines with arrays.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use glam::DVec2;

use super::poly_data::{Cells, PolyData};
use crate::data::format::{About, Frame};
use crate::data::table::{Column, Table, Values};
use crate::error::{Error, Result};
use crate::sim::{ContactState, Moment, OtherBody};

/// What the step is called, …
pub(super) const STEP: &str = "step";
/// … and the time, s: VTK's readers look for this name.
const TIME: &str = "TimeValue";
/// Bytes in which a file says both.
const LONGEST_HEAD: u64 = 1024;
/// Columns that are the same in all rows of a frame.
const OF_FRAME: [&str; 2] = ["step", "time"];
/// In front of the names of what is measured of the whole pile, since grains have arrays of the same names.
const PILE: &str = "pile_";
/// Vectors, and the columns that are their components.
const VECTORS: [(&str, [&str; 2]); 3] =
    [("velocity", ["vx", "vy"]), ("normal", ["nx", "ny"]), ("point", ["x", "y"])];
/// What stands where a law knows no such thing as a flag.
const NEITHER: i8 = -1;

/// Grains as points, with the columns of their table.
pub(super) fn grains(frame: &Frame, about: &About) -> Vec<u8> {
    let surroundings = &frame.moment.surroundings;
    let fixed = surroundings.fixed_discs.iter().map(|disc| disc.position);
    let grains = frame.moment.grains.iter().map(|grain| grain.position);
    let centres: Vec<DVec2> = grains.chain(fixed).collect();
    let points = centres.iter().map(DVec2::to_array);
    let file = file(PolyData::new(Cells::Points, points), frame, &frame.grains, "point", about);
    with_measures(file, &frame.measures).finish("radius")
}

/// Contacts as lines, with the columns of their table.
pub(super) fn contacts(frame: &Frame, about: &About) -> Vec<u8> {
    let lines = frame.moment.contacts.iter().map(|contact| line(&frame.moment, contact));
    let ends: Vec<DVec2> = lines.flatten().collect();
    let points = ends.iter().map(DVec2::to_array);
    file(PolyData::new(Cells::Lines, points), frame, &frame.contacts, "", about)
        .finish("normal_force")
}

/// Step and time, s, of the frame that a file has.
///
/// # Errors
/// Where it cannot be read, or is none of these files.
pub(super) fn moment_of(path: &Path) -> Result<(u64, f64)> {
    let mut head = Vec::new();
    let read = File::open(path).and_then(|file| file.take(LONGEST_HEAD).read_to_end(&mut head));
    read.map_err(|error| Error::file(path, error))?;
    let head = String::from_utf8_lossy(&head);
    let number = |name: &str| {
        let (_, rest) = head.split_once(&format!("Name=\"{name}\""))?;
        let (number, _) = rest.split_once('>')?.1.split_once('<')?;
        Some(number.to_owned())
    };
    let step = number(STEP).and_then(|number| number.parse().ok());
    let time_secs = number(TIME).and_then(|number| number.parse().ok());
    step.zip(time_secs).ok_or_else(|| {
        Error::file(path, format!("says no {STEP} and {TIME}, but must be a file that slump wrote"))
    })
}

/// From centre to centre as they are now, or to the touched point of a boundary, which the branch
/// leads to.
fn line(moment: &Moment, contact: &ContactState) -> [DVec2; 2] {
    let from = moment.grains[contact.grain as usize].position;
    let periodic = moment.surroundings.periodic;
    let near = |place| periodic.map_or(place, |periodic| periodic.near(place, from));
    let to = match contact.other {
        OtherBody::Grain(number) => near(moment.grains[number as usize].position),
        OtherBody::FixedDisc(number) => {
            near(moment.surroundings.fixed_discs[number as usize].position)
        }
        OtherBody::Boundary(_) => from - contact.branch,
    };
    [from, to]
}

/// Adds all that the table has, except for the vector that says where its points are.
fn file(
    mut file: PolyData,
    frame: &Frame,
    table: &Table,
    placed_by: &str,
    about: &About,
) -> PolyData {
    let observables = &frame.moment.observables;
    file.add_number(STEP, observables.step as i64);
    file.add_number(TIME, observables.time_secs);
    let columns = table.columns.iter().filter(|column| !OF_FRAME.contains(&column.name));
    let described = columns.clone().map(|column| column.described_with_codes(column.name, 0));
    file.add_words("columns", described.collect::<Vec<_>>().iter());
    let facts = about.facts.iter().map(|(name, said)| format!("{name}: {said}"));
    file.add_words("about", facts);
    for column in columns {
        let is_part = |(_, parts): &&(&str, [&str; 2])| parts.contains(&column.name);
        match VECTORS.iter().find(is_part) {
            Some((name, _)) if *name == placed_by => {}
            Some((name, parts)) => {
                if let ([x, y], true) =
                    (parts.map(|part| numbers(table, part)), parts[0] == column.name)
                {
                    file.add_vectors(name, *parts, x.iter().zip(y).map(|(&x, &y)| [x, y]));
                }
            }
            None => add(&mut file, column),
        }
    }
    file
}

/// Adds what is measured of the whole pile.
fn with_measures(mut file: PolyData, measures: &Table) -> PolyData {
    let columns = measures.columns.iter().filter(|column| !OF_FRAME.contains(&column.name));
    for Column { name, values, .. } in columns {
        let name = format!("{PILE}{name}");
        match values {
            Values::Numbers(numbers) => {
                numbers.iter().for_each(|&number| file.add_number_or_none(&name, number));
            }
            Values::SomeNumbers(numbers) => {
                let numbers = numbers.iter().map(|number| number.unwrap_or(f64::NAN));
                numbers.for_each(|number| file.add_number_or_none(&name, number));
            }
            Values::Counts(counts) => {
                counts.iter().for_each(|&count| file.add_number_or_none(&name, count as i64));
            }
            // None of a pile is.
            Values::Flags(_) | Values::Words { .. } => {}
        }
    }
    file
}

/// The numbers of a column that has a number in each row.
fn numbers<'a>(table: &'a Table, name: &str) -> &'a [f64] {
    match table.column(name).map(|column| &column.values) {
        Some(Values::Numbers(numbers)) => numbers,
        _ => &[],
    }
}

fn add(file: &mut PolyData, Column { name, values, .. }: &Column) {
    match values {
        Values::Numbers(numbers) => file.add_column(name, numbers.iter().copied()),
        Values::SomeNumbers(numbers) => {
            file.add_column(name, numbers.iter().map(|number| number.unwrap_or(f64::NAN)));
        }
        Values::Counts(counts) => file.add_column(name, counts.iter().map(|&count| count as i64)),
        Values::Flags(flags) => {
            file.add_column(name, flags.iter().map(|flag| flag.map_or(NEITHER, i8::from)));
        }
        Values::Words { words, codes } => {
            file.add_column(name, codes.iter().map(|&code| code as i32));
            file.add_words(&format!("{name}_words"), words.iter());
        }
    }
}
