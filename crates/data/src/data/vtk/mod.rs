//! Writes recordings as files for ParaView and other readers of VTK. `vtk/grains.pvd` and `vtk/contacts.pvd` are series
//! with one `.vtp` file per frame. Grains are points with a radius. Contacts are lines from centre to centre, or from
//! the centre to the touched point of a boundary. `fields/fields.pvd`, a separate format, is a series of images
//! (`.vti`) of smoothed fields on a grid ([`Fields`](crate::granular::Fields)).
//!
//! Arrays have the names of the tables' columns. Two columns that are the x and y components of a vector become one
//! array (`velocity`, `normal`, `force` or `point`) with the third component 0, because vectors of VTK have three
//! components. The components have the names of the columns. Words become numbers, because readers cannot colour by
//! words. Some arrays belong to the whole file. They contain the words in the order of their numbers (`NAME_words`),
//! the description and unit of each column (`columns`), the description of the run (`about`), the measures of the whole
//! pile (`pile_NAME`), and the values of each wall (`wall_NAME`).

mod fields_file;
mod head;
mod vtk_file;

use std::fs::File;
use std::io::{Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use glam::DVec2;

use self::fields_file::{FieldsBox, fields_file};
use self::head::{add_facts, add_moment, moment_of};
use self::vtk_file::{VtkCells, VtkFile};
use super::folder_files::{files_named, make_folder, remove};
use super::format::{Format, Frame, RecordingMark, RunFacts};
use super::table::{Column, Table, Values};
use crate::error::{Error, Result};
use crate::output::PendingFile;
use crate::sim::{ContactState, Moment, OtherBody};

/// A file format of recordings that consists of one folder with VTK files.
pub(super) struct VtkFolder {
    pub name: &'static str,
    kinds: &'static [VtkKind],
}

/// One of the types of files in a folder of VTK files, such as files of grains. Each frame has one file of each type.
struct VtkKind {
    /// Beginning of the names of the files of this type, such as `grains`.
    name: &'static str,
    /// Ending of the names of the files of this type, such as `.vtp`.
    ending: &'static str,
    file: fn(&Frame, &RunFacts, &mut Option<FieldsBox>) -> Result<Vec<u8>>,
}

/// The format `vtk`: files of grains and files of contacts.
pub(super) const BODIES: VtkFolder = VtkFolder {
    name: "vtk",
    kinds: &[
        VtkKind {
            name: "grains",
            ending: ".vtp",
            file: |frame, facts, _| Ok(grains_file(frame, facts)),
        },
        VtkKind {
            name: "contacts",
            ending: ".vtp",
            file: |frame, facts, _| Ok(contacts_file(frame, facts)),
        },
    ],
};
/// The format `fields`: files of smoothed fields.
pub(super) const FIELDS: VtkFolder = VtkFolder {
    name: "fields",
    kinds: &[VtkKind { name: "fields", ending: ".vti", file: fields_file }],
};

const ENDING_OF_SERIES: &str = ".pvd";

/// Columns with the same value in all rows of a frame. They are not written as arrays of rows.
const OF_FRAME: [&str; 2] = ["step", "time"];
/// Prefix of the names of arrays with measures of the whole pile, because grains have arrays of the same names.
const PILE: &str = "pile_";
/// Prefix of the names of arrays with the columns of the table of walls.
const WALL: &str = "wall_";
/// Names of arrays of vectors, and the columns that are the components of these vectors.
const VECTORS: [(&str, [&str; 2]); 4] = [
    ("velocity", ["vx", "vy"]),
    ("normal", ["nx", "ny"]),
    ("point", ["x", "y"]),
    ("force", ["fx", "fy"]),
];
/// Number that is written for a flag without a value: it is neither true nor false, because the contact law does not
/// define the property.
const NEITHER: i8 = -1;

/// Length of a slot, the space for one entry in a `.pvd` file (list of frames), bytes. It is large enough for any time
/// and file name. It divides 4096, so that no slot lies in two blocks of 4096 bytes, between which a kill could
/// interrupt the writing of an entry.
const SLOT: usize = 128;
/// Length of the text ahead of the first slot (space for an entry) in a `.pvd` file, bytes. The opening tags are filled
/// with spaces to this length, a multiple of [`SLOT`], so that no slot lies in two blocks of 4096 bytes.
const HEAD: usize = 256;
/// Number of slots (spaces for entries) in a new `.pvd` file. It is doubled whenever no slot is free.
const FIRST_SLOTS: usize = 32;

const OPENING: &str = "<?xml version=\"1.0\"?>\n\
     <VTKFile type=\"Collection\" version=\"1.0\" byte_order=\"LittleEndian\">\n<Collection>\n";
const CLOSING: &str = "</Collection>\n</VTKFile>\n";

pub(super) struct Vtk {
    folder: PathBuf,
    kinds: &'static [VtkKind],
    facts: RunFacts,
    /// The `.pvd` file (list of frames) of each type of file; empty before the first frame of a new recording.
    series: Vec<PvdSeries>,
    /// Smoothing width and covered region of the fields; known from the first frame on.
    of_fields: Option<FieldsBox>,
}

impl Vtk {
    pub(super) fn start(folder: &Path, files: &VtkFolder, facts: &RunFacts) -> Result<Self> {
        let folder = folder.join(files.name);
        make_folder(&folder)?;
        let (facts, kinds) = (facts.clone(), files.kinds);
        Ok(Self { folder, kinds, facts, series: Vec::new(), of_fields: None })
    }

    /// Creates the `.pvd` file (list of frames) of each type of file, with entries for the files of the first frames.
    /// `times` are the simulated times of these frames, s.
    fn begin(&mut self, times: &[f64]) -> Result<()> {
        let series = self.kinds.iter().map(|kind| {
            let files = times.iter().zip(0..).map(|(&time, number)| (time, kind.file_name(number)));
            PvdSeries::of(
                self.folder.join(format!("{}{ENDING_OF_SERIES}", kind.name)),
                &files.collect::<Vec<_>>(),
            )
        });
        self.series = series.collect::<Result<_>>()?;
        Ok(())
    }
}

impl VtkFolder {
    /// True if a file with this name belongs to this file format.
    pub(super) fn has_named(&self, name: &str) -> bool {
        let is_series = |kind: &VtkKind| name.strip_prefix(kind.name) == Some(ENDING_OF_SERIES);
        self.kinds.iter().any(|kind| is_series(kind) || kind.number_of(name).is_some())
    }
}

impl VtkKind {
    fn file_name(&self, number: u64) -> String {
        format!("{}_{number:06}{}", self.name, self.ending)
    }

    /// Returns the number of the frame in a file name; `None` if the name is not that of a file of this type.
    fn number_of(&self, name: &str) -> Option<u64> {
        let digits = name.strip_prefix(self.name)?.strip_prefix('_')?.strip_suffix(self.ending)?;
        let are_digits = digits.len() >= 6 && digits.bytes().all(|byte| byte.is_ascii_digit());
        are_digits.then(|| digits.parse().ok())?
    }
}

impl Format for Vtk {
    fn add(&mut self, frame: &Frame) -> Result<()> {
        if self.series.is_empty() {
            self.begin(&[])?;
        }
        for (kind, series) in self.kinds.iter().zip(&mut self.series) {
            let bytes = (kind.file)(frame, &self.facts, &mut self.of_fields)?;
            let name = kind.file_name(frame.number);
            let mut file = PendingFile::start(&self.folder.join(&name))?;
            file.write(&bytes)?;
            // The run does not wait until the disk has the data.
            file.finish(false)?;
            series.add(frame.moment.observables.time_secs, &name)?;
        }
        Ok(())
    }

    fn check(&self, _step: u64, last_frame: Option<u64>, mark: &RecordingMark) -> Result<()> {
        for kind in self.kinds {
            let is_there = |number: &u64| {
                let path = self.folder.join(kind.file_name(*number));
                is_whole(&path) && moment_of(&path).is_ok_and(|(step, _)| Some(step) <= last_frame)
            };
            if let Some(lost) = (0..mark.frames).find(|number| !is_there(number)) {
                let reason = "is missing or cut, but must be as the saved run left it; --overwrite starts the run \
                    again";
                return Err(Error::file(self.folder.join(kind.file_name(lost)), reason));
            }
        }
        Ok(())
    }

    fn roll_back(&mut self, _step: u64, last_frame: Option<u64>) -> Result<()> {
        self.series.clear();
        let mut times = Vec::new();
        loop {
            let number = times.len() as u64;
            let paths = self.kinds.iter().map(|kind| self.folder.join(kind.file_name(number)));
            let paths: Vec<PathBuf> = paths.filter(|path| path.exists()).collect();
            if paths.len() < self.kinds.len() {
                break;
            }
            let (step_of_file, time_secs) = moment_of(&paths[0])?;
            if Some(step_of_file) > last_frame {
                break;
            }
            times.push(time_secs);
        }
        if !times.is_empty() {
            // The `.pvd` files, which readers open, are shortened before the files that they list are removed.
            self.begin(&times)?;
        }
        let first = self.folder.join(self.kinds[0].file_name(0));
        self.of_fields = if times.is_empty() { None } else { FieldsBox::of_file(&first) };
        let is_later = |name: &str| {
            let number = self.kinds.iter().find_map(|kind| kind.number_of(name));
            number.map_or(name.ends_with(ENDING_OF_SERIES) && times.is_empty(), |number| {
                number >= times.len() as u64
            })
        };
        let later = files_named(&self.folder, is_later)?;
        later.iter().try_for_each(|path| remove(path))
    }
}

/// Returns the bytes of the file with grains and fixed discs as points, with the columns of the table of grains.
fn grains_file(frame: &Frame, facts: &RunFacts) -> Vec<u8> {
    let surroundings = &frame.moment.surroundings;
    let fixed = surroundings.fixed_discs.iter().map(|disc| disc.position);
    let grains = frame.moment.grains.iter().map(|grain| grain.position);
    let centres: Vec<DVec2> = grains.chain(fixed).collect();
    let points = centres.iter().map(DVec2::to_array);
    let file = file(VtkFile::new(VtkCells::Points, points), frame, &frame.grains, "point", facts);
    let file = with_arrays(file, PILE, &frame.measures);
    with_arrays(file, WALL, &frame.walls).finish("radius")
}

/// Returns the bytes of the file with contacts as lines, with the columns of the table of contacts.
fn contacts_file(frame: &Frame, facts: &RunFacts) -> Vec<u8> {
    let lines = frame.moment.contacts.iter().map(|contact| line(&frame.moment, contact));
    let ends: Vec<DVec2> = lines.flatten().collect();
    let points = ends.iter().map(DVec2::to_array);
    file(VtkFile::new(VtkCells::Lines, points), frame, &frame.contacts, "", facts)
        .finish("normal_force")
}

/// True if a file is complete, which means that it ends with the last bytes of every VTK file.
fn is_whole(path: &Path) -> bool {
    let mut end = Vec::new();
    let read = File::open(path).and_then(|mut file| {
        file.seek(SeekFrom::End(-(vtk_file::END.len() as i64)))?;
        file.read_to_end(&mut end)
    });
    read.is_ok() && end == vtk_file::END.as_bytes()
}

/// Returns the two ends of the line that represents a contact, m. These are the present centres of the two discs, or
/// the centre of the grain and the touched point of a boundary. This point is the centre of the grain minus the branch
/// vector of the contact.
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

/// Adds step, time, description and all columns of a table to a file. The vector whose name in [`VECTORS`] is
/// `placed_by` is left out, because it is the position of the points, which the file already contains.
fn file(
    mut file: VtkFile,
    frame: &Frame,
    table: &Table,
    placed_by: &str,
    facts: &RunFacts,
) -> VtkFile {
    add_moment(&mut file, frame);
    let columns = table.columns.iter().filter(|column| !OF_FRAME.contains(&column.name));
    let described = columns.clone().map(|column| column.described_with_codes(column.name, 0));
    file.add_words("columns", described.collect::<Vec<_>>().iter());
    add_facts(&mut file, facts);
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

/// Adds the columns of a table whose rows are not points of the file, as arrays that belong to the whole file. The name
/// of each array is `prefix` followed by the name of the column.
fn with_arrays(mut file: VtkFile, prefix: &str, table: &Table) -> VtkFile {
    let columns = table.columns.iter().filter(|column| !OF_FRAME.contains(&column.name));
    for Column { name, values, .. } in columns {
        let name = format!("{prefix}{name}");
        match values {
            Values::Numbers(numbers) => file.add_numbers(&name, numbers.iter().copied()),
            Values::SomeNumbers(numbers) => {
                file.add_numbers(&name, numbers.iter().map(|number| number.unwrap_or(f64::NAN)));
            }
            Values::Counts(counts) => {
                file.add_numbers(&name, counts.iter().map(|&count| count as i64));
            }
            Values::Words { words, codes } => {
                file.add_words(&name, codes.iter().map(|&code| &words[code as usize]));
            }
            // Tables of walls and measures have no flags.
            Values::Flags(_) => {}
        }
    }
    file
}

/// Returns the values of a column that has a number in every row; an empty list for any other column.
fn numbers<'a>(table: &'a Table, name: &str) -> &'a [f64] {
    match table.column(name).map(|column| &column.values) {
        Some(Values::Numbers(numbers)) => numbers,
        _ => &[],
    }
}

fn add(file: &mut VtkFile, Column { name, values, .. }: &Column) {
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

/// A `.pvd` file: the list by which ParaView finds the file of each simulated time.
///
/// This list grows by one frame at a time, and must be complete whenever it is read or the program is killed. Entries
/// are therefore slots of fixed length ahead of the closing tags, and free slots are blank. A new entry is written in
/// one operation within one block of 4096 bytes, which a kill cannot interrupt. If no slot is free, the file is
/// rewritten with twice as many slots, so the cost per frame stays constant on average.
struct PvdSeries {
    path: PathBuf,
    file: File,
    /// Number of entries in the list: filled slots (spaces of fixed length for one entry each).
    count: usize,
    slots: usize,
}

impl PvdSeries {
    /// Creates the `.pvd` file `path` with an entry for each of the given files, which are in the same folder:
    /// (simulated time in s, name). The result is the same as if the files had been added one by one.
    fn of(path: PathBuf, files: &[(f64, String)]) -> Result<Self> {
        let entries: Vec<u8> =
            files.iter().flat_map(|(time_secs, name)| entry(*time_secs, name)).collect();
        let mut slots = FIRST_SLOTS;
        while slots < files.len() {
            slots *= 2;
        }
        Self::write_anew(path, &entries, slots)
    }

    /// Adds an entry for the file of a simulated time, s. The file is in the folder of the `.pvd` file.
    fn add(&mut self, time_secs: f64, file: &str) -> Result<()> {
        if self.count == self.slots {
            let text = std::fs::read(&self.path).map_err(|error| Error::file(&self.path, error))?;
            let entries = text.get(HEAD..HEAD + self.count * SLOT).unwrap_or_default();
            *self = Self::write_anew(self.path.clone(), entries, 2 * self.slots)?;
        }
        let place = HEAD + self.count * SLOT;
        let written = self.file.seek(SeekFrom::Start(place as u64));
        let written = written.and_then(|_| self.file.write_all(&entry(time_secs, file)));
        written.map_err(|error| Error::file(&self.path, error))?;
        self.count += 1;
        Ok(())
    }

    fn write_anew(path: PathBuf, entries: &[u8], slots: usize) -> Result<Self> {
        let mut file = PendingFile::start(&path)?;
        file.write(&padded(OPENING, HEAD))?;
        file.write(entries)?;
        let count = entries.len() / SLOT;
        file.write(&padded("", SLOT).repeat(slots - count))?;
        file.write(CLOSING.as_bytes())?;
        file.finish(false)?;
        let file = File::options().write(true).open(&path);
        let file = file.map_err(|error| Error::file(&path, error))?;
        Ok(Self { path, file, count, slots })
    }
}

/// Returns the text of a filled slot: the entry for the file of a simulated time, s.
fn entry(time_secs: f64, file: &str) -> Vec<u8> {
    padded(&format!("<DataSet timestep=\"{time_secs:?}\" file=\"{file}\"/>"), SLOT)
}

/// Returns a text as a line of `length` bytes, filled with blanks.
fn padded(text: &str, length: usize) -> Vec<u8> {
    let mut line = format!("{:1$}", text, length - 1).into_bytes();
    line.push(b'\n');
    line
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn any_time_and_name_fit_into_a_slot() {
        for time_secs in [-f64::MIN_POSITIVE, f64::MAX, 1.0 / 3.0, -1.234_567_890_123_456_7e-300] {
            let slot = entry(time_secs, &format!("contacts_{}.vtp", u64::MAX));
            assert_eq!(slot.len(), SLOT, "{}", String::from_utf8_lossy(&slot));
        }
    }
}
