//! Discs as CSV: header `x,y,radius` and, where there are any, `vx,vy,omega` and what else a recording's
//! grains have; SI units; lines that start with `#` are comments.

use std::collections::BTreeSet;
use std::fs::File;
use std::io::{BufRead, BufReader};
use std::path::Path;

use super::{
    COMMENT, DiscRow, NUMBERS, RecordedGrains, discs_of_rows, empty_grains, has_needed,
    no_such_step,
};
use crate::error::{Error, Result};

/// What a file of discs must be, for messages.
const FORM: &str = "a CSV of discs: a header line x,y,radius, with vx,vy,omega where they move, and as \
                    many numbers in each line below";

/// Characters of a header that a message shows.
const MOST_SHOWN: usize = 80;

/// Reads discs from the text of a CSV file; `path` is for messages.
///
/// # Errors
/// Where a line is none; the message names it.
pub fn parse_grains(text: &str, path: &Path) -> Result<RecordedGrains> {
    read_lines(text.as_bytes(), path, None)
}

/// Reads the moment of a step, or the last one.
pub(super) fn read(path: &Path, step: Option<u64>) -> Result<RecordedGrains> {
    let file = File::open(path).map_err(|error| Error::unread(path, error, FORM))?;
    read_lines(BufReader::new(file), path, step)
}

fn read_lines(text: impl BufRead, path: &Path, wanted: Option<u64>) -> Result<RecordedGrains> {
    let mut columns = None;
    let (mut rows, mut steps) = (Vec::new(), BTreeSet::new());
    for (number, line) in (1..).zip(text.lines()) {
        let line = line.map_err(|error| Error::unread(path, error, FORM))?;
        // Some programs begin a file with a mark of its encoding.
        let line = line.trim_start_matches('\u{feff}');
        if line.is_empty() || line.as_bytes()[0] == COMMENT {
            continue;
        }
        let cells = line.split(',').map(|cell| cell.trim().trim_matches('"')).collect();
        let Some(columns) = &columns else {
            columns = Some(CsvColumns::of(cells, path)?);
            continue;
        };
        let line = CsvLine { path, number, cells };
        if let Some(place) = columns.step {
            let step = line.whole(place, "step")?;
            let last = steps.last().copied();
            steps.insert(step);
            if wanted.or(last).is_some_and(|wanted| step < wanted)
                || wanted.is_some_and(|wanted| step > wanted)
            {
                continue;
            }
            if last.is_some_and(|last| last < step) {
                rows.clear();
            }
        }
        rows.push(line.row(columns)?);
    }
    if columns.is_none() {
        CsvColumns::of(Vec::new(), path)?;
    }
    let known: Vec<u64> = steps.into_iter().collect();
    match wanted {
        Some(step) if !known.contains(&step) => Err(no_such_step(path, step, &known)),
        _ => discs_of_rows(path, rows, |line| (path.to_owned(), format!("line {line}"))),
    }
}

struct CsvColumns {
    all: usize,
    step: Option<usize>,
    id: Option<usize>,
    kind: Option<usize>,
    numbers: [Option<usize>; NUMBERS.len()],
}

impl CsvColumns {
    fn of(names: Vec<&str>, path: &Path) -> Result<Self> {
        let refuse = |reason: String| Err(Error::file(path, reason));
        if !has_needed(&names) {
            let found: String = names.join(",").chars().take(MOST_SHOWN).collect();
            return refuse(format!(
                "the header line is '{found}', but must be one that names x, y and radius"
            ));
        }
        let known = empty_grains();
        if let Some(unknown) = names.iter().find(|name| known.column(name).is_none()) {
            let known: Vec<_> = known.columns.iter().map(|column| column.name).collect();
            return refuse(format!(
                "the header line names {unknown}, but must name nothing but {}",
                known.join(", ")
            ));
        }
        let is_twice = |(place, name): &(usize, &&str)| names[..*place].contains(name);
        if let Some((_, twice)) = names.iter().enumerate().find(is_twice) {
            return refuse(format!("the header line names {twice} twice, but must name it once"));
        }
        let place = |name: &str| names.iter().position(|there| *there == name);
        let (step, id, kind) = (place("step"), place("id"), place("kind"));
        Ok(Self { all: names.len(), step, id, kind, numbers: NUMBERS.map(place) })
    }
}

struct CsvLine<'a> {
    path: &'a Path,
    number: u64,
    cells: Vec<&'a str>,
}

impl CsvLine<'_> {
    fn row(&self, columns: &CsvColumns) -> Result<DiscRow> {
        if self.cells.len() != columns.all {
            let found = self.cells.len();
            return Err(self.refuse(&format!("has {found} columns, but must have {}", columns.all)));
        }
        let mut numbers = [0.0; NUMBERS.len()];
        for ((number, place), name) in numbers.iter_mut().zip(columns.numbers).zip(NUMBERS) {
            let Some(place) = place else { continue };
            let said = self.cells[place];
            *number = said.parse().map_err(|_| {
                self.refuse(&format!("{name}: '{said}' is none, but must be a number"))
            })?;
        }
        let id = columns.id.map(|place| self.whole(place, "id")).transpose()?;
        let kind = columns.kind.map(|place| self.cells[place].to_owned());
        Ok(DiscRow { place: self.number, id, kind, numbers })
    }

    fn whole(&self, place: usize, name: &str) -> Result<u64> {
        let said = self.cells.get(place).copied().unwrap_or_default();
        said.parse().map_err(|_| {
            self.refuse(&format!("{name}: '{said}' is none, but must be a whole number ≥ 0"))
        })
    }

    fn refuse(&self, reason: &str) -> Error {
        Error::file(self.path, format!("line {}: {reason}", self.number))
    }
}
