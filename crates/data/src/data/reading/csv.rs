//! Reads discs from CSV files in SI units. The header line is `x,y,radius`, optionally with `vx,vy,omega` and other
//! columns of a recording's table of grains. Lines that start with `#` are comments.

use std::collections::BTreeSet;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;

use csv::{ReaderBuilder, StringRecord, Trim};

use super::rows::{
    DiscRow, LEFT_OUT, NUMBERS, OF_GRAINS, RecordedGrains, discs_of_rows, has_needed, known_names,
    no_such_step, unknown_of,
};
use crate::data::csv::COMMENT;
use crate::error::{Error, Result};
use crate::input::{BoundedLines, open};

/// Description of a valid file of discs, for error messages.
const FORM: &str = "a CSV of discs: a header line x,y,radius, with vx,vy,omega where they move, and as \
                    many numbers in each line below";

/// Largest number of characters of a header line that an error message shows, so that the message remains short even if
/// the line is long.
const MOST_SHOWN: usize = 80;

/// Reads discs from the text of a CSV file; `path` is for error messages.
///
/// # Errors
/// If a line is not a disc; the message names the line.
pub fn parse_grains(text: &str, path: &Path) -> Result<RecordedGrains> {
    CsvFile { path, wanted: None, open: || Ok(text.as_bytes()) }.read()
}

/// Reads the discs of step number `step` from a CSV file, or of the last step in the file if `step` is `None`.
pub(super) fn read(path: &Path, step: Option<u64>) -> Result<RecordedGrains> {
    CsvFile { path, wanted: step, open: || open(path, FORM) }.read()
}

/// A CSV file of discs, and the requested step.
struct CsvFile<'a, Open> {
    path: &'a Path,
    wanted: Option<u64>,
    /// Function that opens the file: once to read it, and again if an error message must name a line.
    open: Open,
}

struct CsvColumns {
    all: usize,
    step: Option<usize>,
    id: Option<usize>,
    kind: Option<usize>,
    material: Option<usize>,
    numbers: [Option<usize>; NUMBERS.len()],
}

impl<Source: Read, Open: Fn() -> Result<Source>> CsvFile<'_, Open> {
    fn read(&self) -> Result<RecordedGrains> {
        let mut reader = ReaderBuilder::new()
            .comment(Some(COMMENT))
            .trim(Trim::All)
            .flexible(true)
            .from_reader(BoundedLines::new((self.open)()?));
        let refuse = |error| Error::unread(self.path, error, FORM);
        let places = self.places(reader.headers().map_err(refuse)?)?;
        let (mut rows, mut steps) = (Vec::new(), BTreeSet::new());
        let mut record = StringRecord::new();
        while reader.read_record(&mut record).map_err(refuse)? {
            if let Some(place) = places.step {
                let step = self.whole(&record, place, "step")?;
                let last = steps.last().copied();
                steps.insert(step);
                if self.wanted.or(last).is_some_and(|wanted| step < wanted)
                    || self.wanted.is_some_and(|wanted| step > wanted)
                {
                    continue;
                }
                if last.is_some_and(|last| last < step) {
                    rows.clear();
                }
            }
            rows.push(self.row(&places, &record)?);
        }
        let known: Vec<u64> = steps.into_iter().collect();
        match self.wanted {
            Some(step) if !known.contains(&step) => Err(no_such_step(self.path, step, &known)),
            _ => discs_of_rows(self.path, rows, |byte| (self.path.to_owned(), self.line_at(byte))),
        }
    }

    fn places(&self, names: &StringRecord) -> Result<CsvColumns> {
        let refuse = |reason: String| Err(Error::file(self.path, reason));
        let all: Vec<String> = names.iter().map(str::to_owned).collect();
        if !has_needed(&all) {
            let found: String = all.join(",").chars().take(MOST_SHOWN).collect();
            return refuse(format!(
                "the header line is '{found}', but must be one that names x, y and radius{}",
                way_out(&all)
            ));
        }
        if all[0].is_empty() {
            return refuse(
                "the first column of the header line has no name, but must have one; if it counts rows, \
                 leave it out (in pandas, to_csv(..., index=False))"
                    .to_owned(),
            );
        }
        if let Some(unknown) = unknown_of(&all) {
            return refuse(format!(
                "the header line names '{unknown}', but must name nothing but {}",
                known_names()
            ));
        }
        let is_twice = |(place, name): &(usize, &String)| all[..*place].contains(name);
        if let Some((_, twice)) = all.iter().enumerate().find(is_twice) {
            return refuse(format!("the header line names {twice} twice, but must name it once"));
        }
        let place = |name: &str| all.iter().position(|there| there == name);
        let [step, id, kind, material] = ["step", "id", "kind", "material"].map(place);
        Ok(CsvColumns { all: all.len(), step, id, kind, material, numbers: NUMBERS.map(place) })
    }

    fn row(&self, places: &CsvColumns, record: &StringRecord) -> Result<DiscRow> {
        if record.len() != places.all {
            let reason = format!("has {} columns, but must have {}", record.len(), places.all);
            return Err(self.refuse(record, &reason));
        }
        let mut numbers = LEFT_OUT;
        for ((number, place), name) in numbers.iter_mut().zip(places.numbers).zip(NUMBERS) {
            let Some(place) = place else { continue };
            let said = record.get(place).unwrap_or_default();
            // Fixed discs have neither mass nor density, so these fields may be empty.
            if OF_GRAINS.contains(&name) && said.is_empty() {
                continue;
            }
            *number = said.parse().map_err(|_| {
                self.refuse(record, &format!("{name}: '{said}' is none, but must be a number"))
            })?;
        }
        let id = places.id.map(|place| self.whole(record, place, "id")).transpose()?;
        let word = |place: Option<usize>| record.get(place?).map(str::to_owned);
        let (kind, material) = (word(places.kind), word(places.material));
        let material = material.filter(|name| !name.is_empty());
        Ok(DiscRow { place: byte_of(record), id, kind, material, numbers })
    }

    fn whole(&self, record: &StringRecord, place: usize, name: &str) -> Result<u64> {
        let said = record.get(place).unwrap_or_default();
        said.parse().map_err(|_| {
            let reason = format!("{name}: '{said}' is none, but must be a whole number ≥ 0");
            self.refuse(record, &reason)
        })
    }

    fn refuse(&self, record: &StringRecord, reason: &str) -> Error {
        Error::file(self.path, format!("{}: {reason}", self.line_at(byte_of(record))))
    }

    /// Returns the line of a record in the file, as `line 3`. `byte` is the position that the CSV reader states for the
    /// record. The reader states the position before any blank lines and comments that it skipped, so these lines are
    /// skipped here, too.
    fn line_at(&self, byte: u64) -> String {
        let Ok(source) = (self.open)() else { return "a line".to_owned() };
        let mut start = 0;
        for (line, number) in
            BufReader::new(source).split(b'\n').map_while(std::result::Result::ok).zip(1..)
        {
            let is_blank = line.is_empty() || line == b"\r" || line[0] == COMMENT;
            if start >= byte && !is_blank {
                return format!("line {number}");
            }
            start += line.len() as u64 + 1;
        }
        "the last line".to_owned()
    }
}

/// Returns the end of an error message about a header line that lacks needed columns: a hint how to repair it; empty if
/// no hint fits.
fn way_out(found: &[String]) -> &'static str {
    let all = |is_so: &dyn Fn(&str) -> bool| !found.is_empty() && found.iter().all(|it| is_so(it));
    if all(&|it| it.parse::<f64>().is_ok()) {
        ", which is no comment: numpy.savetxt writes it without '# ' if comments='' is given"
    } else if let [only] = found
        && only.contains([';', '\t', ' '])
    {
        " with commas between them: neither semicolons nor blanks separate columns"
    } else {
        ""
    }
}

fn byte_of(record: &StringRecord) -> u64 {
    record.position().map_or(0, csv::Position::byte)
}
