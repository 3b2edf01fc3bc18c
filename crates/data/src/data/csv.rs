//! Recordings as text: a growing table of each kind of row, `csv/grains.csv` and so on.

use std::io::Write;
use std::path::{Path, PathBuf};

use super::columns::empty_tables_of_frames;
use super::format::{Format, Frame, RunFacts};
use super::recording_folder::make_folder;
use super::table::{Table, Values};
use crate::error::Result;
use crate::output::GrowingFile;
use crate::sim::Observables;

pub(super) const FOLDER: &str = "csv";

pub(super) struct Csv {
    of_frames: [TextTable; 4],
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
}

/// What begins a line that is a comment.
pub(super) const COMMENT: u8 = b'#';

/// A table that is written row by row, below comments that say what the columns are.
pub(super) struct TextTable {
    path: PathBuf,
    /// Comments, and the line of names.
    head: String,
    file: Option<GrowingFile>,
    rows: Vec<u8>,
}

impl TextTable {
    /// A table with the columns of `table`. The file begins with the first rows, even if these are none.
    pub(super) fn new(path: PathBuf, run: &RunFacts, table: &Table) -> Self {
        let names: Vec<_> = table.columns.iter().map(|column| column.name).collect();
        let names = names.join(",");
        let facts = run.facts.iter().map(|(name, said)| format!("# {name}: {said}\n"));
        let columns = table.columns.iter();
        let columns = columns.map(|column| format!("# column {}\n", column.described(column.name)));
        let comments: String = facts.chain(columns).collect();
        let head = format!("{comments}{names}\n");
        Self { path, head, file: None, rows: Vec::new() }
    }

    pub(super) fn add(&mut self, table: &Table) -> Result<()> {
        let mut rows = std::mem::take(&mut self.rows);
        rows.clear();
        write_rows(&mut rows, table);
        self.begun()?.add_rows(&rows)?;
        self.rows = rows;
        Ok(())
    }

    /// The file, with its head at least.
    fn begun(&mut self) -> Result<&mut GrowingFile> {
        match &mut self.file {
            Some(file) => Ok(file),
            none => {
                let mut file = GrowingFile::start(self.path.clone())?;
                file.add_rows(self.head.as_bytes())?;
                Ok(none.insert(file))
            }
        }
    }

    /// Has all rows on the disk, and the head at least.
    pub(super) fn finish(&mut self) -> Result<()> {
        self.begun()?.sync();
        Ok(())
    }
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
                    // Memory takes whatever is written to it.
                    let _ = write!(text, "{}", values[row]);
                }
                Values::Flags(values) => {
                    let said = values[row].map_or("", |so| if so { "true" } else { "false" });
                    text.extend_from_slice(said.as_bytes());
                }
                Values::Words { words, codes } => {
                    text.extend_from_slice(words[codes[row] as usize].as_bytes());
                }
            }
        }
        text.push(b'\n');
    }
}
