//! Reads plane frictional contact problems in the text format of the program Siconos. The text contains, in this order,
//! the dimension, the number of contacts, the kind of storage, the two sizes of the matrix, the kind of sparse storage,
//! the matrix W as the library CSparse prints its compressed columns, the relative velocities q without contact
//! impulses, and the coefficients of friction μ.

use std::str::{FromStr, Lines};

use super::{Friction, ProblemFile};
use crate::error::{self, Error, Result};
use crate::solver::Triplets;
use crate::world::FrictionCone;

/// Number by which Siconos denotes sparse storage of a matrix.
const SPARSE: usize = 2;
/// Number by which Siconos denotes sparse storage by compressed columns.
const COMPRESSED_COLUMNS: usize = 2;

/// Parses a text in Siconos' format. The caller must check the numbers of the problem.
pub(super) fn parse(text: &str) -> Result<ProblemFile> {
    let mut lines = text.lines();
    let mut number = |what: &str| first_word::<usize>(&mut lines, what);
    only("the dimension", number("the dimension")?, 2)?;
    let nc = number("the number of contacts")?;
    let allowed = format!("no more than the file of {} bytes has room for", text.len());
    error::check(nc <= text.len(), "the number of contacts", nc, allowed)?;
    only("the kind of storage", number("the kind of storage")?, SPARSE)?;
    for what in ["the number of rows", "the number of columns"] {
        only(what, number(what)?, 2 * nc)?;
    }
    let kind = "the kind of sparse storage";
    only(kind, number(kind)?, COMPRESSED_COLUMNS)?;
    let matrix = columns(&mut lines, 2 * nc)?;
    let mut words = lines.flat_map(str::split_ascii_whitespace);
    let mut list = |field: &str, length: usize| -> Result<Vec<f64>> {
        (0..length)
            .map(|at| word(words.next().unwrap_or_default(), &format!("{field}[{at}]")))
            .collect()
    };
    let q = list("q", 2 * nc)?;
    let mu = list("mu", nc)?;
    Ok(ProblemFile {
        comment: None,
        nc,
        mu: Friction::Each(mu),
        cone: FrictionCone::Shifted,
        q,
        c0: None,
        start: None,
        bodies: None,
        matrix,
    })
}

/// Reads the matrix W. Each column has a line such as "col 3 : locations 6 to 8" and, below this line, a line "row :
/// value" for each location.
fn columns(lines: &mut Lines, count: usize) -> Result<Triplets> {
    let mut matrix = Triplets::default();
    // Skips two lines: the version of CSparse, and then sizes and norm of the matrix.
    lines.next();
    lines.next();
    for column in 0..count {
        let what = format!("column {column} of W");
        let line = lines.next().unwrap_or_default();
        let words: Vec<&str> = line.split_ascii_whitespace().collect();
        let ["col", number, ":", "locations", first, "to", last] = words[..] else {
            return Err(unreadable(&what, line));
        };
        only("the number of a column of W", word(number, &what)?, column)?;
        // The last location of an empty column is one before its first location.
        let (first, last): (i64, i64) = (word(first, &what)?, word(last, &what)?);
        for _ in first..=last {
            let line = lines.next().unwrap_or_default();
            let Some((row, value)) = line.split_once(':') else {
                return Err(unreadable(&what, line));
            };
            matrix.row.push(word(row, &what)?);
            matrix.col.push(column as u32);
            matrix.val.push(word(value, &what)?);
        }
    }
    Ok(matrix)
}

fn first_word<T: FromStr>(lines: &mut Lines, what: &str) -> Result<T> {
    word(lines.next().unwrap_or_default(), what)
}

fn word<T: FromStr>(text: &str, what: &str) -> Result<T> {
    text.trim().parse().map_err(|_| unreadable(what, text))
}

fn unreadable(what: &str, text: &str) -> Error {
    let found = match text.trim() {
        "" => "missing".to_owned(),
        text => format!("\"{text}\""),
    };
    Error::value(what, found, "there as in Siconos' text format, or the file a JSON object")
}

fn only(what: &str, found: usize, allowed: usize) -> Result<()> {
    if found == allowed {
        return Ok(());
    }
    Err(Error::value(what, found, allowed.to_string()))
}
