//! Writes recordings as CSV text: one file for each table, such as `csv/grains.csv`, which grows during the run.

use std::fs::File;
use std::io::{BufRead, BufReader, ErrorKind::NotFound, Write};
use std::path::{Path, PathBuf};

use super::columns::empty_tables_of_frames;
use super::folder_files::make_folder;
use super::format::{Format, Frame, RecordingMark, RunFacts, check_count};
use super::table::{Table, Values};
use crate::error::{Error, Result};
use crate::output::{GrowingFile, remove_if_there};
use crate::sim::Observables;

pub(super) const FOLDER: &str = "csv";

pub(super) struct Csv {
    of_frames: [TextTable; 6],
    steps: TextTable,
}

impl Csv {
    pub(super) fn start(folder: &Path, facts: &RunFacts) -> Result<Self> {
        let folder = folder.join(FOLDER);
        make_folder(&folder)?;
        let start = |table: Table| {
            TextTable::new(folder.join(format!("{}.csv", table.name)), facts, &table)
        };
        Ok(Self {
            of_frames: empty_tables_of_frames().map(start),
            steps: start(Table::of_steps(&[])),
        })
    }
}

impl Format for Csv {
    fn add(&mut self, frame: &Frame) -> Result<()> {
        let tables = self.of_frames.iter_mut().zip(frame.tables());
        tables.into_iter().try_for_each(|(text, table)| text.add(table))
    }

    fn add_steps(&mut self, rows: &[Observables]) -> Result<()> {
        self.steps.add(&Table::of_steps(rows))
    }

    fn finish(&mut self) -> Result<()> {
        let mut tables = self.of_frames.iter_mut().chain([&mut self.steps]);
        tables.try_for_each(TextTable::finish)
    }

    fn check(&self, step: u64, last_frame: Option<u64>, mark: &RecordingMark) -> Result<()> {
        let of_frames =
            self.of_frames.iter().zip(mark.rows).map(|(it, rows)| (it, last_frame, rows));
        for (table, until, rows) in of_frames.chain([(&self.steps, Some(step), mark.steps)]) {
            check_count(&table.path, "rows", table.rows_there(until, u64::MAX)?.0.rows, rows)?;
        }
        Ok(())
    }

    fn roll_back(&mut self, step: u64, last_frame: Option<u64>) -> Result<()> {
        for table in &mut self.of_frames {
            table.roll_back(last_frame)?;
        }
        self.steps.roll_back(Some(step)).map(drop)
    }
}

/// First character of a comment line in CSV files.
pub(super) const COMMENT: u8 = b'#';

/// A CSV file that is written row by row, below comments that describe its columns.
pub(super) struct TextTable {
    path: PathBuf,
    /// Text above the rows: comments and the header line with the names of the columns.
    head: String,
    names: String,
    file: Option<GrowingFile>,
    rows: Vec<u8>,
}

/// Rows that remain in a table when a run resumes: their number, and the step of the last row.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct KeptRows {
    pub rows: u64,
    /// Number of the step of the last row; `None` without rows.
    pub step: Option<u64>,
}

impl TextTable {
    /// Prepares a CSV file with the columns of `table`. The first call of [`TextTable::add`] creates the file, even if
    /// that call adds no rows. [`TextTable::roll_back`] opens an existing file to continue it.
    pub(super) fn new(path: PathBuf, run: &RunFacts, table: &Table) -> Self {
        let names: Vec<_> = table.columns.iter().map(|column| column.name).collect();
        let names = names.join(",");
        let facts = run.facts.iter().map(|(name, said)| format!("# {name}: {said}\n"));
        let columns = table.columns.iter();
        let columns = columns.map(|column| format!("# column {}\n", column.described(column.name)));
        let comments: String = facts.chain(columns).collect();
        let head = format!("{comments}{names}\n");
        Self { path, head, names, file: None, rows: Vec::new() }
    }

    pub(super) fn add(&mut self, table: &Table) -> Result<()> {
        let mut rows = std::mem::take(&mut self.rows);
        rows.clear();
        write_rows(&mut rows, table);
        self.begun()?.add(&rows)?;
        self.rows = rows;
        Ok(())
    }

    /// Returns the open file. If the file does not exist yet, creates it and writes the text above the rows: comments
    /// and the header line.
    fn begun(&mut self) -> Result<&mut GrowingFile> {
        match &mut self.file {
            Some(file) => Ok(file),
            none => {
                let mut file = GrowingFile::start(self.path.clone())?;
                file.add(self.head.as_bytes())?;
                Ok(none.insert(file))
            }
        }
    }

    /// Waits until all data of the file are on the disk. If no rows were added, creates the file with the comments and
    /// the header line only.
    pub(super) fn finish(&mut self) -> Result<()> {
        self.begun()?.sync()
    }

    /// Removes the rows of all steps after `step` (all rows if `step` is `None`), and an incomplete row at the end.
    /// Returns the number of the rows that remain and the step of the last of these rows.
    pub(super) fn roll_back(&mut self, step: Option<u64>) -> Result<KeptRows> {
        self.file = None;
        let (kept, whole) = self.rows_there(step, u64::MAX)?;
        if kept.rows == 0 {
            remove_if_there(&self.path)?;
        } else {
            self.file = Some(GrowingFile::go_on(self.path.clone(), whole)?);
        }
        Ok(kept)
    }

    /// Counts the rows of the file up to step number `step` (no rows if it is `None`), but no more than `most` rows.
    /// Returns the number of these rows with the step of the last row, and the length, bytes, of the file up to the end
    /// of the counted rows, including the text above the rows. If the file does not exist, the number of rows and the
    /// length are 0.
    pub(super) fn rows_there(&self, step: Option<u64>, most: u64) -> Result<(KeptRows, u64)> {
        let mut file = match File::open(&self.path) {
            Ok(file) => BufReader::new(file),
            Err(error) if error.kind() == NotFound => return Ok((KeptRows::default(), 0)),
            Err(error) => return Err(Error::file(&self.path, error)),
        };
        let (mut kept, mut whole, mut number) = (KeptRows::default(), 0, 0);
        let mut names_seen = false;
        let mut line = Vec::new();
        loop {
            line.clear();
            let read = file.read_until(b'\n', &mut line);
            let length = read.map_err(|error| Error::file(&self.path, error))?;
            number += 1;
            let Some(text) = line.strip_suffix(b"\n") else { return Ok((kept, whole)) };
            if names_seen {
                let there = step_of(text).ok_or_else(|| self.refuse(number, text))?;
                if Some(there) > step || kept.rows == most {
                    return Ok((kept, whole));
                }
                kept = KeptRows { rows: kept.rows + 1, step: Some(there) };
            } else if text.first() != Some(&COMMENT) {
                if text != self.names.as_bytes() {
                    return Err(self.refuse(number, text));
                }
                names_seen = true;
            }
            whole += length as u64;
        }
    }

    fn refuse(&self, line: u64, found: &[u8]) -> Error {
        let found = String::from_utf8_lossy(found);
        let reason = format!(
            "line {line} is '{found}', but must be of a table with the columns {}",
            self.names
        );
        Error::file(&self.path, reason)
    }
}

fn step_of(row: &[u8]) -> Option<u64> {
    let step = row.split(|&byte| byte == b',').next()?;
    str::from_utf8(step).ok()?.parse().ok()
}

fn write_rows(text: &mut Vec<u8>, table: &Table) {
    let mut numbers = ryu::Buffer::new();
    for row in 0..table.len() {
        for (place, column) in table.columns.iter().enumerate() {
            if place > 0 {
                text.push(b',');
            }
            match &column.values {
                Values::Numbers(values) => {
                    text.extend_from_slice(numbers.format(values[row]).as_bytes());
                }
                Values::SomeNumbers(values) => {
                    let said = values[row].map_or("", |value| numbers.format(value));
                    text.extend_from_slice(said.as_bytes());
                }
                Values::Counts(values) => {
                    // Writing to memory cannot fail.
                    let _ = write!(text, "{}", values[row]);
                }
                Values::Flags(values) => {
                    let said = values[row].map_or("", |so| if so { "true" } else { "false" });
                    text.extend_from_slice(said.as_bytes());
                }
                Values::Words { words, codes } => {
                    write_word(text, &words[codes[row] as usize]);
                }
            }
        }
        text.push(b'\n');
    }
}

/// Writes a word as one field of a row, with quotes around it if it contains commas or quotes (RFC 4180).
fn write_word(text: &mut Vec<u8>, word: &str) {
    if word.contains([',', '"']) {
        let _ = write!(text, "\"{}\"", word.replace('"', "\"\""));
    } else {
        text.extend_from_slice(word.as_bytes());
    }
}
