//! The frames of a dump, ours or another's.

use std::fs::File;
use std::io::{BufRead, BufReader, ErrorKind::NotFound, Lines};
use std::iter::Zip;
use std::ops::RangeFrom;
use std::path::Path;

use crate::error::{Error, Result};

/// What a file must be, for messages.
const FORM: &str = "a LAMMPS dump in text with the columns x, y and radius";
/// Begins what is no frame yet. No reader knows such an item, and each skips it at the end of a file.
pub(super) const DRAFT: &str = "ITEM: DRAFT";
/// What a line begins with that belongs to a draft, also to one of whose word a kill has left a part.
const OF_A_DRAFT: &str = "ITEM: D";
/// How the head of a frame of ours begins, …
const TIME: &str = "ITEM: TIME";
/// … and what says the step of any.
const STEP: &str = "ITEM: TIMESTEP";
const COUNT: &str = "ITEM: NUMBER OF ATOMS";
const ROWS: &str = "ITEM: ATOMS";

/// Length of the frames of a dump of ours up to a step, bytes, or of none; none where there is no file.
///
/// # Errors
/// Where it cannot be read, or a step is none.
pub(super) fn length_until(path: &Path, step: Option<u64>) -> Result<Option<u64>> {
    let file = match File::open(path) {
        Ok(file) => file,
        Err(error) if error.kind() == NotFound => return Ok(None),
        Err(error) => return Err(Error::file(path, error)),
    };
    let mut lines = BufReader::new(file);
    let mut line = String::new();
    let (mut line_start, mut frame_start) = (0, None);
    let mut says_step = false;
    loop {
        line.clear();
        let length = lines.read_line(&mut line).map_err(|error| Error::file(path, error))?;
        if length == 0 || line.starts_with(OF_A_DRAFT) {
            return Ok(Some(line_start));
        }
        let text = line.trim_end();
        if says_step && Some(step_of(path, text)?) > step {
            return Ok(frame_start);
        }
        says_step = text == STEP;
        if text == TIME {
            // What stands ahead of the first frame goes with it.
            frame_start = Some(frame_start.map_or(0, |_| line_start));
        }
        line_start += length as u64;
    }
}

fn step_of(path: &Path, said: &str) -> Result<u64> {
    said.trim().parse().map_err(|_| {
        Error::file(path, format!("the step is '{said}', but must be a whole number ≥ 0"))
    })
}

/// The rows of a frame, as text.
pub(in crate::data) struct DumpFrame {
    /// Names of the columns.
    pub names: Vec<String>,
    pub rows: Vec<String>,
    /// Line of the first row, from 1.
    pub first_line: usize,
}

/// The last frame of a file that has all its rows, or that of a step; or the steps that there are.
///
/// # Errors
/// Where it cannot be read, or is no dump.
pub(in crate::data) fn read_frame(
    path: &Path,
    wanted: Option<u64>,
) -> Result<std::result::Result<DumpFrame, Vec<u64>>> {
    let file = File::open(path).map_err(|error| Error::unread(path, error, FORM))?;
    let mut lines = Dump { path, lines: BufReader::new(file).lines().zip(1..) };
    let (mut last, mut known) = (None, Vec::new());
    let (mut step, mut count) = (None, 0);
    while let Some((line, number)) = lines.next()? {
        match line.trim_end() {
            STEP => {
                let Some((said, _)) = lines.next()? else { break };
                step = Some(step_of(path, &said)?);
            }
            COUNT => {
                let Some((said, number)) = lines.next()? else { break };
                count = said.trim().parse().map_err(|_| {
                    let said = format!("line {number}: '{}' is no number of rows", said.trim());
                    Error::unread(path, said, FORM)
                })?;
            }
            rows if rows.starts_with(ROWS) => {
                let names =
                    rows[ROWS.len()..].split_ascii_whitespace().map(str::to_owned).collect();
                let is_wanted = wanted.is_none() || step == wanted;
                let Some(rows) = lines.rows(count, is_wanted)? else { break };
                known.extend(step);
                if is_wanted {
                    last = Some(DumpFrame { names, rows, first_line: number + 1 });
                }
            }
            _ => {}
        }
    }
    if last.is_none() && known.is_empty() {
        return Err(Error::file(path, format!("has no whole frame, but must be {FORM}")));
    }
    Ok(last.ok_or(known))
}

/// A file that is read line by line.
struct Dump<'a> {
    path: &'a Path,
    lines: Zip<Lines<BufReader<File>>, RangeFrom<usize>>,
}

impl Dump<'_> {
    /// The next line with its number.
    fn next(&mut self) -> Result<Option<(String, usize)>> {
        let Some((line, number)) = self.lines.next() else { return Ok(None) };
        let line = line.map_err(|error| Error::unread(self.path, error, FORM))?;
        Ok(Some((line, number)))
    }

    /// So many rows, of which nothing is kept where they are not wanted; none where there are fewer.
    fn rows(&mut self, count: usize, are_wanted: bool) -> Result<Option<Vec<String>>> {
        let mut rows = Vec::new();
        for _ in 0..count {
            let Some((row, _)) = self.next()? else { return Ok(None) };
            if are_wanted {
                rows.push(row);
            }
        }
        Ok(Some(rows))
    }
}
