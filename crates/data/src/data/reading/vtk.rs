//! Discs out of `.vtp` files, ours or those that ParaView and PyVista save, and out of series of them.

use std::path::Path;

use super::found::{FoundRow, NUMBERS, RecordedGrains, check_names, checked, no_such_step};
use crate::data::columns::KINDS;
use crate::data::vtk::{DataArray, Document, Piece, Said, values, words};
use crate::error::{Error, Result};

/// What a file must be, for messages.
const FORM: &str =
    "a .vtp file of points with the array radius, uncompressed or compressed with zlib";
/// Of each of [`NUMBERS`] the array, which positions have no name for, and the component.
const ARRAYS: [(Option<&str>, usize); NUMBERS.len()] = [
    (None, 0),
    (None, 1),
    (Some("radius"), 0),
    (Some("velocity"), 0),
    (Some("velocity"), 1),
    (Some("omega"), 0),
];

/// Reads a file, or of a series the last one, or that of a step.
///
/// # Errors
/// Where a file cannot be read, or a point is none.
pub(super) fn read(path: &Path, step: Option<u64>) -> Result<RecordedGrains> {
    let bytes = read_bytes(path)?;
    let files = match parsed(path, &bytes)?.files_of_series() {
        None => vec![path.to_owned()],
        Some(names) => names.map(|name| path.with_file_name(name)).collect(),
    };
    let mut known = Vec::new();
    for file in files.iter().rev() {
        let bytes = read_bytes(file)?;
        let document = parsed(file, &bytes)?;
        let found = document.step();
        if step.is_none() || found == step {
            return discs(file, &document);
        }
        known.extend(found);
    }
    known.reverse();
    match step {
        Some(step) => Err(no_such_step(path, step, &known)),
        None => Err(Error::file(path, "has no files, but must have at least one")),
    }
}

fn read_bytes(path: &Path) -> Result<Vec<u8>> {
    std::fs::read(path).map_err(|error| Error::unread(path, error, FORM))
}

fn parsed<'a>(path: &Path, bytes: &'a [u8]) -> Result<Document<'a>> {
    Document::of(bytes).map_err(|said| Error::unread(path, said, FORM))
}

fn discs(path: &Path, document: &Document<'_>) -> Result<RecordedGrains> {
    let refuse = |said: String| Error::unread(path, said, FORM);
    let piece = document.piece().map_err(refuse)?;
    let names = piece.of_points().iter().map(|array| array.name.clone());
    let names: Vec<String> = ["x", "y"].map(str::to_owned).into_iter().chain(names).collect();
    check_names(path, &names)?;
    let rows = rows(document, piece).map_err(refuse)?;
    checked(path, rows, |point| (path.to_owned(), format!("point {point}")))
}

fn rows(document: &Document<'_>, piece: &Piece) -> Said<Vec<FoundRow>> {
    let positions = piece.positions().ok_or("has no positions")?;
    let [x, y, z] = &components(document, positions, piece.points)?[..] else {
        return Err("has positions in less than 3 components, but must have 3".into());
    };
    if let Some((point, z)) = z.iter().enumerate().find(|(_, z)| **z != 0.0) {
        return Err(format!("point {point}: z is {z}, but must be 0, since the world is a plane"));
    }
    let ids = one_a_point(document, piece, "id")?;
    let kinds = kinds(document, piece)?;
    let row = |point: usize| FoundRow {
        place: point as u64,
        id: ids.as_ref().map(|ids| ids[point] as u64),
        kind: kinds.as_ref().map(|kinds| kinds[point].clone()),
        numbers: [0.0; NUMBERS.len()],
    };
    let mut rows: Vec<FoundRow> = (0..piece.points).map(row).collect();
    for (number, (name, component)) in ARRAYS.into_iter().enumerate() {
        let column = match name {
            None => [x, y][component].clone(),
            Some(name) => {
                let Some(array) = piece.array(name) else { continue };
                let columns = components(document, array, piece.points)?;
                let column = columns.into_iter().nth(component);
                column.ok_or_else(|| format!("has too few components in {name}"))?
            }
        };
        for (row, value) in rows.iter_mut().zip(column) {
            row.numbers[number] = value;
        }
    }
    Ok(rows)
}

/// What an array has for each point, a list a component.
fn components(document: &Document<'_>, array: &DataArray, points: usize) -> Said<Vec<Vec<f64>>> {
    let each = array.components;
    let values =
        values(document, array).map_err(|said| format!("the array {} {said}", array.name))?;
    if Some(values.len()) != points.checked_mul(each) || each == 0 {
        let (name, found) = (&array.name, values.len());
        return Err(format!(
            "the array {name} has {found} numbers, but must have {each} for each of {points} points"
        ));
    }
    let component = |first| values.iter().skip(first).step_by(each).copied().collect();
    Ok((0..each).map(component).collect())
}

fn one_a_point(document: &Document<'_>, piece: &Piece, name: &str) -> Said<Option<Vec<f64>>> {
    let Some(array) = piece.array(name) else { return Ok(None) };
    Ok(components(document, array, piece.points)?.into_iter().next())
}

/// The words of an array `kind` that means what ours does.
fn kinds(document: &Document<'_>, piece: &Piece) -> Said<Option<Vec<String>>> {
    let Some(list) = document.words_of_file("kind_words") else { return Ok(None) };
    let list = words(document, list)?;
    let is_ours = list.iter().all(|word| KINDS.contains(&word.as_str()));
    let Some(codes) = one_a_point(document, piece, "kind")?.filter(|_| is_ours) else {
        return Ok(None);
    };
    let word = |(point, code): (usize, f64)| {
        let word = list.get(code as usize).filter(|_| code >= 0.0);
        word.cloned().ok_or_else(|| {
            let last = list.len().saturating_sub(1);
            format!("point {point}: kind is {code}, but must be one of 0 to {last}")
        })
    };
    codes.into_iter().enumerate().map(word).collect::<Said<_>>().map(Some)
}
