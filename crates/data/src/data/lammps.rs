//! Writes recordings as LAMMPS dumps for OVITO and other readers. `ovito/grains.dump` is a text dump with one row per
//! grain. `ovito/contacts.dump` is a `dump local` with one row per contact between two discs, which readers show as
//! bonds. `ovito/walls.dump` has one row per wall. Contacts with boundaries (walls that are not discs) are left out,
//! because OVITO draws bonds only between particles and otherwise refuses the frame.
//!
//! Columns have the names that these readers expect. MDAnalysis finds the lines of a frame of grains by counting lines,
//! so these frames contain only the sections (`ITEM: …`) that every dump has. Neither MDAnalysis nor ASE accepts grains
//! without z or with unknown elements, so grains have the coordinate z = 0 and the name of a chemical element. The
//! description of the run is at the beginning of the file of contacts, and the times of frames are in the files of
//! contacts and walls. Numbers are written in the shortest form that reads back as the same number.

use std::fmt::Write as _;
use std::fs::File;
use std::io::{BufRead, BufReader, ErrorKind::NotFound};
use std::path::{Path, PathBuf};

use glam::DVec2;

use super::folder_files::{make_folder, remove};
use super::format::{Format, Frame, RecordingMark, RunFacts, check_count};
use super::table::{Column, Table, Values};
use crate::error::{Error, Result};
use crate::output::GrowingFile;
use crate::sim::{GrainState, Moment, OtherBody};
use slump_core::number::Parts;

pub(super) const FOLDER: &str = "ovito";
/// File names of the dumps of grains, contacts and walls.
pub(super) const FILES: [&str; 3] = ["grains.dump", "contacts.dump", "walls.dump"];

/// First line of a frame that is not complete yet. The line begins a section named `DRAFT`. Programs that read dumps do
/// not know this name, and skip such a section at the end of a file.
const DRAFT: &str = "ITEM: DRAFT";
/// Beginning of the first line of an incomplete frame. No line of a complete frame begins with this text. The text is
/// shorter than the whole line, because the rest of the line may already be replaced if the program was killed.
const OF_A_DRAFT: &str = "ITEM: D";
/// Header line above the simulated time of a frame, in the dumps of contacts and walls. The time is written ahead of
/// the step. The dump of grains contains no times, because MDAnalysis expects only the sections that every dump has.
const TIME: &str = "ITEM: TIME";
/// Header line above the step of a frame.
const STEP: &str = "ITEM: TIMESTEP";
/// First columns of the dump of grains, as (name in the dump, name in Slump's tables). All other columns follow with
/// their own names.
const GRAIN_COLUMNS: [(&str, &str); 10] = [
    ("id", "id"),
    ("type", "kind"),
    ("element", "kind"),
    ("x", "x"),
    ("y", "y"),
    ("radius", "radius"),
    ("vx", "vx"),
    ("vy", "vy"),
    ("omegaz", "omega"),
    // Not `coordination`: OVITO expects whole numbers in a column of this name, but fixed discs have no value.
    ("coordination_number", "coordination"),
];
/// First columns of the dump of contacts, as (name in the dump, name in Slump's tables). All other columns follow with
/// their own names.
const CONTACT_COLUMNS: [(&str, &str); 2] = [("batom1", "id_i"), ("batom2", "id_j")];
/// Columns of Slump's tables that dumps leave out: step and time are in the head of each frame, and `name_j` is the
/// name of a boundary, which does not concern contacts between discs.
const LEFT_OUT: [&str; 3] = ["step", "time", "name_j"];
/// The only column of the dump of grains with words: `element`, the name of a chemical element. Readers know no other
/// words, so all other columns have numbers instead of words.
const IN_WORDS: &str = "element";
/// Chemical elements that stand for grains, fixed discs and lost grains (which went through a wall or left the scene).
const ELEMENTS: [&str; 3] = ["H", "He", "Li"];
/// Beginning of the header line above the number of rows of a frame.
const COUNT: &str = "ITEM: NUMBER OF ";
/// The word for grains in the header lines of a dump.
const ATOMS: &str = LABELS[0];
/// The words for rows of grains, contacts and walls in the header lines of a dump.
const LABELS: [&str; 3] = ["ATOMS", "BONDS", "ENTRIES"];
/// The lowest number that LAMMPS accepts for a particle type.
const FIRST_TYPE: u32 = 1;

pub(super) struct Lammps {
    facts: RunFacts,
    grains: GrowingDump,
    contacts: GrowingDump,
    walls: GrowingDump,
}

/// A dump file to which frames are added.
struct GrowingDump {
    path: PathBuf,
    /// Open file of the dump; `None` before the first frame is added.
    file: Option<GrowingFile>,
}

impl Lammps {
    pub(super) fn start(folder: &Path, facts: &RunFacts) -> Result<Self> {
        let folder = folder.join(FOLDER);
        make_folder(&folder)?;
        let [grains, contacts, walls] =
            FILES.map(|name| GrowingDump { path: folder.join(name), file: None });
        Ok(Self { facts: facts.clone(), grains, contacts, walls })
    }
}

impl Format for Lammps {
    fn add(&mut self, frame: &Frame) -> Result<()> {
        self.grains.add(&grains(frame))?;
        self.contacts.add(&contacts(frame, &self.facts))?;
        self.walls.add(&walls(frame))
    }

    fn finish(&mut self) -> Result<()> {
        let files = [&self.grains.file, &self.contacts.file, &self.walls.file];
        files.into_iter().flatten().try_for_each(GrowingFile::sync)
    }

    fn check(&self, _step: u64, last_frame: Option<u64>, mark: &RecordingMark) -> Result<()> {
        [&self.grains, &self.contacts, &self.walls].into_iter().try_for_each(|dump| {
            let found = whole_frames(&dump.path, last_frame)?;
            check_count(&dump.path, "whole frames", found, mark.frames)
        })
    }

    fn roll_back(&mut self, _step: u64, last_frame: Option<u64>) -> Result<()> {
        self.grains.roll_back(last_frame)?;
        self.contacts.roll_back(last_frame)?;
        self.walls.roll_back(last_frame)
    }
}

impl GrowingDump {
    fn add(&mut self, text: &FrameText) -> Result<()> {
        match &mut self.file {
            Some(file) => file.add_at_once(DRAFT, &text.head, &text.rows),
            none => {
                let file = none.insert(GrowingFile::start(self.path.clone())?);
                file.add_at_once(DRAFT, &(text.front.clone() + &text.head), &text.rows)
            }
        }
    }

    fn roll_back(&mut self, last_frame: Option<u64>) -> Result<()> {
        self.file = None;
        match length_until(&self.path, last_frame)? {
            None => Ok(()),
            Some(0) => remove(&self.path),
            Some(length) => {
                self.file = Some(GrowingFile::go_on(self.path.clone(), length)?);
                Ok(())
            }
        }
    }
}

/// Returns the length, in bytes, of all frames up to step number `step` in a dump that Slump wrote; 0 if `step` is
/// `None`. Returns `None` if there is no file.
fn length_until(path: &Path, step: Option<u64>) -> Result<Option<u64>> {
    let file = match File::open(path) {
        Ok(file) => file,
        Err(error) if error.kind() == NotFound => return Ok(None),
        Err(error) => return Err(Error::file(path, error)),
    };
    let mut lines = BufReader::new(file);
    let mut line = String::new();
    let (mut line_start, mut frame_start) = (0, None);
    let (mut says_step, mut has_time) = (false, false);
    loop {
        line.clear();
        let length = lines.read_line(&mut line).map_err(|error| Error::file(path, error))?;
        if length == 0 || line.starts_with(OF_A_DRAFT) {
            return Ok(Some(line_start));
        }
        let text = line.trim_end();
        if says_step {
            let there = text.parse::<u64>().map_err(|_| {
                let reason = format!("the step is '{text}', but must be a whole number ≥ 0");
                Error::file(path, reason)
            })?;
            if Some(there) > step {
                return Ok(frame_start);
            }
        }
        says_step = text == STEP;
        has_time |= text == TIME;
        if text == TIME || (says_step && !has_time) {
            // Text ahead of the first frame belongs to that frame.
            frame_start = Some(frame_start.map_or(0, |_| line_start));
        }
        line_start += length as u64;
    }
}

/// Counts the complete frames up to step number `step` in a dump that Slump wrote; 0 without a file.
fn whole_frames(path: &Path, step: Option<u64>) -> Result<u64> {
    let mut lines = match File::open(path) {
        Ok(file) => BufReader::new(file),
        Err(error) if error.kind() == NotFound => return Ok(0),
        Err(error) => return Err(Error::file(path, error)),
    };
    let mut next = || -> Result<Option<String>> {
        let mut line = String::new();
        lines.read_line(&mut line).map_err(|error| Error::file(path, error))?;
        Ok(line.strip_suffix('\n').map(str::to_owned))
    };
    let number = |line: Option<String>| line.and_then(|line| line.parse::<u64>().ok());
    let (mut frames, mut count) = (0, 0);
    while let Some(line) = next()? {
        if line == STEP {
            let there = number(next()?);
            if there.is_none() || there > step {
                break;
            }
        } else if line.starts_with(COUNT) {
            count = number(next()?).unwrap_or(u64::MAX);
        } else if LABELS.iter().any(|label| line.starts_with(&format!("ITEM: {label} "))) {
            for _ in 0..count {
                if next()?.is_none_or(|row| row.starts_with("ITEM: ")) {
                    return Ok(frames);
                }
            }
            frames += 1;
        }
    }
    Ok(frames)
}

/// The text of a frame in a dump.
struct FrameText {
    /// Text ahead of the first frame of a file: units, and the description of the run. It consists of sections (each
    /// below a line `ITEM: NAME`) that readers do not know. Readers skip such sections ahead of the first frame, but
    /// not between frames.
    pub front: String,
    /// Text of the frame from its first line to the names of the columns.
    pub head: String,
    pub rows: String,
}

/// Returns the text of a frame of grains: one row per grain, then one row per fixed disc.
fn grains(frame: &Frame) -> FrameText {
    let rows = 0..frame.grains.len();
    dump(ATOMS, frame, (&frame.grains, &GRAIN_COLUMNS), rows)
}

/// Returns the text of a frame of walls: one row per wall.
fn walls(frame: &Frame) -> FrameText {
    let rows = 0..frame.walls.len();
    dump(LABELS[2], frame, (&frame.walls, &[]), rows)
}

/// Returns the text of a frame of contacts: one row per contact between two discs.
fn contacts(frame: &Frame, facts: &RunFacts) -> FrameText {
    let contacts = frame.moment.contacts.iter().enumerate();
    let between_discs =
        contacts.filter(|(_, contact)| !matches!(contact.other, OtherBody::Boundary(_)));
    let rows: Vec<usize> = between_discs.map(|(row, _)| row).collect();
    let mut text = dump(LABELS[1], frame, (&frame.contacts, &CONTACT_COLUMNS), rows.into_iter());
    text.front = front(facts, frame);
    text
}

fn dump(
    label: &str,
    frame: &Frame,
    (table, first): (&Table, &[(&'static str, &str)]),
    rows: impl ExactSizeIterator<Item = usize>,
) -> FrameText {
    let columns = columns(table, first);
    let images = if label == ATOMS { images(&frame.moment) } else { None };
    let mut head = head(&frame.moment, label, rows.len());
    for (name, _) in &columns {
        head.extend([" ", name]);
        if let Some(along_z) = along_z(label, name) {
            head.extend([" ", along_z]);
        }
    }
    head.push_str(if images.is_some() { " ix iy iz\n" } else { "\n" });
    let mut text = String::new();
    for row in rows {
        for (place, (name, column)) in columns.iter().enumerate() {
            if place > 0 {
                text.push(' ');
            }
            push(&mut text, name, &column.values, row);
            if along_z(label, name).is_some() {
                text.push_str(" 0.0");
            }
        }
        if let Some(images) = &images {
            let [x, y] = images.get(row).copied().unwrap_or_default();
            let _ = write!(text, " {x} {y} 0");
        }
        text.push('\n');
    }
    FrameText { front: String::new(), head, rows: text }
}

/// Returns the name of the z component to be written after the column `name`; `None` if the column is not the y
/// component of a vector of grains. `label` is the word for the rows of the dump, such as `ATOMS`. Readers expect
/// vectors in three dimensions.
fn along_z(label: &str, name: &str) -> Option<&'static str> {
    match name {
        "y" if label == ATOMS => Some("z"),
        "vy" if label == ATOMS => Some("vz"),
        _ => None,
    }
}

/// Returns, for each grain, the numbers of periods along x and y between its unwrapped position, which continues across
/// periodic borders, and its position in the periodic cell. Returns `None` without periodic borders, and for shearing
/// borders, at which this difference is not a whole number of periods.
fn images(moment: &Moment) -> Option<Vec<[i64; 2]>> {
    let cell = moment.surroundings.periodic.filter(|cell| cell.shear_rate == 0.0)?;
    let periods = cell.periods();
    let of = |grain: &GrainState| {
        let ways = (grain.unwrapped - grain.position).to_array();
        let image = |(way, period): (f64, Option<f64>)| {
            period.map_or(0, |period| (way / period).round() as i64)
        };
        let [x, y] = [(ways[0], periods[0]), (ways[1], periods[1])];
        [image(x), image(y)]
    };
    Some(moment.grains.iter().map(of).collect())
}

fn columns<'a>(
    table: &'a Table,
    first: &[(&'static str, &str)],
) -> Vec<(&'static str, &'a Column)> {
    let named = first.iter().filter_map(|&(name, ours)| Some((name, table.column(ours)?)));
    let is_first = |column: &&Column| first.iter().any(|(_, ours)| *ours == column.name);
    let others = table.columns.iter().filter(|column| !is_first(column));
    let others = others.filter(|column| !LEFT_OUT.contains(&column.name));
    named.chain(others.map(|column| (column.name, column))).collect()
}

fn push(text: &mut String, name: &str, values: &Values, row: usize) {
    let mut buffer = ryu::Buffer::new();
    let _ = match values {
        Values::Numbers(numbers) => text.write_str(buffer.format(numbers[row])),
        Values::SomeNumbers(numbers) => {
            text.write_str(buffer.format(numbers[row].unwrap_or(f64::NAN)))
        }
        Values::Counts(counts) => write!(text, "{}", counts[row]),
        Values::Flags(flags) => write!(text, "{}", flags[row].map_or(-1, i8::from)),
        Values::Words { codes, .. } if name == IN_WORDS => {
            text.write_str(ELEMENTS[codes[row] as usize])
        }
        Values::Words { codes, .. } => write!(text, "{}", codes[row] + first_code(name)),
    };
}

/// Returns the number that is written for the first word in the list of words of the column `name`: 1 for `type`,
/// because LAMMPS numbers particle types from 1, and 0 for all other columns.
fn first_code(name: &str) -> u32 {
    if name == "type" { FIRST_TYPE } else { 0 }
}

/// Returns the text ahead of the first frame: one line with the metadata of the run, and for each dump one line that
/// describes its columns. There are no more lines, because OVITO recognises a file only if no more than 16 lines
/// precede its first frame (measured with OVITO 3.17.2).
fn front(facts: &RunFacts, frame: &Frame) -> String {
    let facts = facts.facts.iter().map(|(name, said)| format!("{name}: {said}"));
    let facts = facts.collect::<Vec<_>>().join("; ");
    let described = |table, first: &[(&'static str, &str)]| {
        let columns = columns(table, first);
        let columns = columns.iter().filter(|(name, _)| *name != IN_WORDS);
        let columns =
            columns.map(|(name, column)| column.described_with_codes(name, first_code(name)));
        columns.collect::<Vec<_>>().join("; ")
    };
    let of_contacts = described(&frame.contacts, &CONTACT_COLUMNS);
    let of_grains = described(&frame.grains, &GRAIN_COLUMNS);
    let of_walls = described(&frame.walls, &[]);
    format!(
        "ITEM: UNITS\nsi\nITEM: PARAMETERS\n{facts}\n{of_contacts}\ngrains: {of_grains}\n\
         walls: {of_walls}\n"
    )
}

fn head(moment: &Moment, label: &str, count: usize) -> String {
    let observables = &moment.observables;
    let ([min, max], radius) = bounds(moment);
    // The box is periodic (`pp`) along axes with periodic borders, and shrink-wrapped around the discs (`ss`) along
    // other axes.
    let periodic = moment.surroundings.periodic.unwrap_or_default();
    let [along_x, along_y] =
        periodic.periods().map(|period| if period.is_some() { "pp" } else { "ss" });
    let tilt = periodic.shift;
    let bounds = match tilt == 0.0 {
        true => {
            format!("{along_x} {along_y} ss\n{:?} {:?}\n{:?} {:?}\n", min.x, max.x, min.y, max.y)
        }
        // A tilted box is given by the axis-parallel box around it, and its tilt.
        false => format!(
            "xy xz yz {along_x} {along_y} ss\n{:?} {:?} {tilt:?}\n{:?} {:?} 0.0\n",
            min.x + tilt.negative_part(),
            max.x + tilt.positive_part(),
            min.y,
            max.y
        ),
    };
    let along_z = if tilt == 0.0 { "" } else { " 0.0" };
    let time = match label {
        ATOMS => String::new(),
        _ => format!("{TIME}\n{:?}\n", observables.time_secs),
    };
    format!(
        "{time}{STEP}\n{}\nITEM: NUMBER OF {label}\n{count}\n\
         ITEM: BOX BOUNDS {bounds}{:?} {:?}{along_z}\nITEM: {label}",
        observables.step, -radius, radius
    )
}

/// Returns the lower left and the upper right corner, m, of the box around all fixed discs and all grains that are
/// still in the scene. Along a periodic axis the box ends at the borders of the periodic cell. Also returns the largest
/// radius of these discs, m.
fn bounds(moment: &Moment) -> ([DVec2; 2], f64) {
    let grains = moment.grains.iter().filter(|grain| !grain.lost);
    let grains = grains.map(|grain| (grain.position, grain.radius));
    let fixed = moment.surroundings.fixed_discs.iter().map(|disc| (disc.position, disc.radius));
    let mut largest = 0f64;
    let mut corners: Option<[DVec2; 2]> = None;
    for (centre, radius) in grains.chain(fixed) {
        let [low, high] = [centre - radius, centre + radius];
        let [min, max] = corners.unwrap_or([low, high]);
        corners = Some([min.min(low), max.max(high)]);
        largest = largest.max(radius);
    }
    let periodic = moment.surroundings.periodic.unwrap_or_default();
    (periodic.borders_or(corners.unwrap_or_default()), largest)
}
