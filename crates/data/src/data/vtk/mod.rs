//! For ParaView and all that reads VTK's files: `vtk/grains.pvd` and `vtk/contacts.pvd`, each a series of
//! one `.vtp` a frame. Grains are points with a radius, contacts lines from centre to centre, or to the
//! touched point of a boundary.
//!
//! Arrays have the names of the tables' columns. Two columns that are one vector are one array, `velocity`,
//! `normal` or `point`, with the columns' names for its components: VTK's vectors are in space. Words are
//! numbers, since nothing is coloured by words; `NAME_words`, an array of the file as a whole, has the
//! words in the order of the numbers, `columns` what each column is and its unit, `about` the run. What is
//! measured of the whole pile is there too, as `pile_NAME`.

mod poly_data;

use std::fs::File;
use std::io::{Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use glam::DVec2;

use self::poly_data::{PolyData, VtkCells};
use super::format::{Format, Frame, RunFacts};
use super::recording_folder::make_folder;
use super::table::{Column, Table, Values};
use crate::column_spec::STEP;
use crate::error::{Error, Result};
use crate::output::PendingFile;
use crate::sim::{ContactState, Moment, OtherBody};

pub(super) const FOLDER: &str = "vtk";
/// Of the files, the beginnings of their names.
const KINDS: [&str; 2] = ["grains", "contacts"];
const ENDING: &str = ".vtp";
const ENDING_OF_SERIES: &str = ".pvd";

/// What the time is called, s: VTK's readers look for this name.
const TIME: &str = "TimeValue";
/// Columns that are the same in all rows of a frame.
const OF_FRAME: [&str; 2] = ["step", "time"];
/// In front of the names of what is measured of the whole pile, since grains have arrays of the same names.
const PILE: &str = "pile_";
/// Vectors, and the columns that are their components.
const VECTORS: [(&str, [&str; 2]); 3] =
    [("velocity", ["vx", "vy"]), ("normal", ["nx", "ny"]), ("point", ["x", "y"])];
/// What stands where a law knows no such thing as a flag.
const NEITHER: i8 = -1;

const OPENING: &str = "<?xml version=\"1.0\"?>\n\
     <VTKFile type=\"Collection\" version=\"1.0\" byte_order=\"LittleEndian\">\n<Collection>\n";
const CLOSING: &str = "</Collection>\n</VTKFile>\n";

pub(super) struct Vtk {
    folder: PathBuf,
    facts: RunFacts,
    /// From the first frame on, one of a kind.
    series: Option<[PvdSeries; 2]>,
}

impl Vtk {
    pub(super) fn start(folder: &Path, facts: &RunFacts) -> Result<Self> {
        let folder = folder.join(FOLDER);
        make_folder(&folder)?;
        Ok(Self { folder, facts: facts.clone(), series: None })
    }
}

/// True if a file in the folder has a name of these files.
pub(super) fn is_name_of_file(name: &str) -> bool {
    KINDS
        .iter()
        .filter_map(|kind| name.strip_prefix(kind))
        .any(|rest| rest == ENDING_OF_SERIES || number_of(rest).is_some())
}

impl Format for Vtk {
    fn add(&mut self, frame: &Frame) -> Result<()> {
        let series = match &mut self.series {
            Some(series) => series,
            none => {
                let [grains, contacts] = KINDS.map(|kind| {
                    PvdSeries::start(self.folder.join(format!("{kind}{ENDING_OF_SERIES}")))
                });
                none.insert([grains?, contacts?])
            }
        };
        let texts = [grains_file(frame, &self.facts), contacts_file(frame, &self.facts)];
        for ((kind, series), bytes) in KINDS.iter().zip(series).zip(texts) {
            let name = file_name(kind, frame.number);
            let mut file = PendingFile::start(&self.folder.join(&name))?;
            file.write(&bytes)?;
            // A run does not wait for the disk.
            file.finish(false)?;
            series.add(frame.moment.observables.time_secs, &name)?;
        }
        Ok(())
    }
}

fn file_name(kind: &str, number: u64) -> String {
    format!("{kind}_{number:06}{ENDING}")
}

/// The number of a file of ours, by what its name has behind its kind.
fn number_of(rest: &str) -> Option<u64> {
    let digits = rest.strip_prefix('_')?.strip_suffix(ENDING)?;
    let are_digits = digits.len() >= 6 && digits.bytes().all(|byte| byte.is_ascii_digit());
    are_digits.then(|| digits.parse().ok())?
}

/// Grains as points, with the columns of their table.
fn grains_file(frame: &Frame, facts: &RunFacts) -> Vec<u8> {
    let surroundings = &frame.moment.surroundings;
    let fixed = surroundings.fixed_discs.iter().map(|disc| disc.position);
    let grains = frame.moment.grains.iter().map(|grain| grain.position);
    let centres: Vec<DVec2> = grains.chain(fixed).collect();
    let points = centres.iter().map(DVec2::to_array);
    let file = file(PolyData::new(VtkCells::Points, points), frame, &frame.grains, "point", facts);
    with_measures(file, &frame.measures).finish("radius")
}

/// Contacts as lines, with the columns of their table.
fn contacts_file(frame: &Frame, facts: &RunFacts) -> Vec<u8> {
    let lines = frame.moment.contacts.iter().map(|contact| line(&frame.moment, contact));
    let ends: Vec<DVec2> = lines.flatten().collect();
    let points = ends.iter().map(DVec2::to_array);
    file(PolyData::new(VtkCells::Lines, points), frame, &frame.contacts, "", facts)
        .finish("normal_force")
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
    facts: &RunFacts,
) -> PolyData {
    let observables = &frame.moment.observables;
    file.add_number(STEP, observables.step as i64);
    file.add_number(TIME, observables.time_secs);
    let columns = table.columns.iter().filter(|column| !OF_FRAME.contains(&column.name));
    let described = columns.clone().map(|column| column.described_with_codes(column.name, 0));
    file.add_words("columns", described.collect::<Vec<_>>().iter());
    let facts = facts.facts.iter().map(|(name, said)| format!("{name}: {said}"));
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

/// A `.pvd` file: which file shows which time, for ParaView. An entry takes the place of the closing tags, which follow
/// it in the same write, so that it is whole whenever somebody reads it.
struct PvdSeries {
    path: PathBuf,
    file: File,
    /// Where the next entry goes, bytes.
    end: u64,
}

impl PvdSeries {
    fn start(path: PathBuf) -> Result<Self> {
        let file = File::create(&path)
            .map_err(|error| Error::file(&path, format!("cannot be written ({error})")))?;
        let mut series = Self { path, file, end: 0 };
        series.write(OPENING)?;
        Ok(series)
    }

    /// Adds the file of a time, s, which lies in the series' folder.
    fn add(&mut self, time_secs: f64, file: &str) -> Result<()> {
        self.write(&format!("<DataSet timestep=\"{time_secs:?}\" file=\"{file}\"/>\n"))
    }

    fn write(&mut self, text: &str) -> Result<()> {
        let written = self.file.seek(SeekFrom::Start(self.end));
        let written =
            written.and_then(|_| self.file.write_all(format!("{text}{CLOSING}").as_bytes()));
        written.map_err(|error| Error::file(&self.path, error))?;
        self.end += text.len() as u64;
        Ok(())
    }
}
