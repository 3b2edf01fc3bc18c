//! Discs out of LAMMPS dumps, ours or another's.

use std::path::Path;

use super::found::{FoundRow, NUMBERS, RecordedGrains, check_names, checked, no_such_step};
use crate::data::columns::KINDS;
use crate::data::lammps::read_frame;
use crate::error::{Error, Result};

/// Columns that dumps have under other names, and ours.
const NAMES: [(&str, &str); 5] =
    [("xu", "x"), ("yu", "y"), ("zu", "z"), ("omegaz", "omega"), ("element", "kind")];

/// Reads the moment of a step, or the last one.
///
/// # Errors
/// Where the file cannot be read, or a row is none.
pub(super) fn read(path: &Path, step: Option<u64>) -> Result<RecordedGrains> {
    let frame = match read_frame(path, step)? {
        Ok(frame) => frame,
        Err(known) => return Err(no_such_step(path, step.unwrap_or_default(), &known)),
    };
    let names: Vec<String> = frame.names.iter().map(|name| ours(name).to_owned()).collect();
    check_names(path, &names)?;
    let mut rows = Vec::new();
    for (text, line) in frame.rows.iter().zip(frame.first_line..) {
        let row = row(&names, text, line);
        rows.push(row.map_err(|said| Error::file(path, format!("line {line}: {said}")))?);
    }
    checked(path, rows, |line| (path.to_owned(), format!("line {line}")))
}

fn ours(name: &str) -> &str {
    NAMES.iter().find(|(theirs, _)| *theirs == name).map_or(name, |(_, ours)| ours)
}

fn row(names: &[String], text: &str, line: usize) -> std::result::Result<FoundRow, String> {
    let mut row =
        FoundRow { place: line as u64, id: None, kind: None, numbers: [0.0; NUMBERS.len()] };
    let mut words = text.split_ascii_whitespace();
    for name in names {
        let word = words.next().ok_or("has too few columns, but must have one for each name")?;
        let number =
            || word.parse().map_err(|_| format!("{name}: '{word}' is none, but must be a number"));
        match name.as_str() {
            "id" => {
                let id = word.parse();
                let allowed = "but must be a whole number ≥ 0";
                row.id = Some(id.map_err(|_| format!("id: '{word}' is none, {allowed}"))?);
            }
            // What others call elements are grains.
            "kind" => row.kind = KINDS.contains(&word).then(|| word.to_owned()),
            "z" => {
                let z: f64 = number()?;
                if z != 0.0 {
                    return Err(format!("z is {z}, but must be 0, since the world is a plane"));
                }
            }
            name => {
                if let Some(place) = NUMBERS.iter().position(|number| *number == name) {
                    row.numbers[place] = number()?;
                }
            }
        }
    }
    Ok(row)
}
