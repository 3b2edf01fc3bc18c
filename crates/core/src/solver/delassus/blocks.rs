//! W from its entries: 2×2 blocks in rows, checked.

use crate::error::{Error, Result};

/// Two entries of W that stand opposite each other may differ by this part of √(W_ii W_jj): what a
/// file of six digits loses.
const ASYMMETRY: f64 = 1e-5;

/// Entries of a sparse matrix; those of one place are added. Plain data, checked where a problem
/// is made of it.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Triplets {
    /// Row of each entry.
    pub row: Vec<u32>,
    /// Column of each entry.
    pub col: Vec<u32>,
    /// Each entry, 1/kg.
    pub val: Vec<f64>,
}

impl Triplets {
    /// (row, column, entry), in the order in which they stand.
    pub fn entries(&self) -> impl Iterator<Item = (u32, u32, f64)> {
        let places = self.row.iter().zip(&self.col);
        places.zip(&self.val).map(|((&row, &column), &value)| (row, column, value))
    }
}

pub(super) fn check_length(field: &str, length: usize, wanted: usize, meaning: &str) -> Result<()> {
    if length == wanted {
        return Ok(());
    }
    let allowed = format!("{wanted} ({meaning})");
    Err(Error::value(format!("the length of {field}"), length, allowed))
}

pub(super) fn check_each(
    field: &str,
    values: &[f64],
    allowed: &str,
    fits: impl Fn(f64) -> bool,
) -> Result<()> {
    match values.iter().position(|&value| !fits(value)) {
        Some(at) => Err(Error::value(format!("{field}[{at}]"), values[at], allowed)),
        None => Ok(()),
    }
}

/// [row contact, column contact] and what stands there.
pub(super) type Block = ([u32; 2], [[f64; 2]; 2]);

/// The blocks of W in rows.
pub(super) fn blocks(matrix: &Triplets, contacts: usize) -> Result<Vec<Block>> {
    let Triplets { row, col, val } = matrix;
    if val.is_empty() {
        return Err(Error::value("W", "empty", "a matrix with an entry on each diagonal place"));
    }
    check_length("W.row", row.len(), val.len(), "that of W.val")?;
    check_length("W.col", col.len(), val.len(), "that of W.val")?;
    check_each("W.val", val, "a finite number", |value| value.is_finite())?;
    for (field, indices) in [("W.row", row), ("W.col", col)] {
        if let Some(at) = indices.iter().position(|&index| index as usize >= 2 * contacts) {
            let allowed = format!("below {} (2 nc)", 2 * contacts);
            return Err(Error::value(format!("{field}[{at}]"), indices[at], allowed));
        }
    }
    let mut order: Vec<usize> = (0..val.len()).collect();
    order.sort_by_key(|&entry| [row[entry] / 2, col[entry] / 2]);
    let mut blocks: Vec<Block> = Vec::new();
    for entry in order {
        let place = [row[entry] / 2, col[entry] / 2];
        if blocks.last().is_none_or(|(last, _)| *last != place) {
            blocks.push((place, [[0.0; 2]; 2]));
        }
        // A block has just been pushed where there was none.
        let (_, block) = blocks.last_mut().expect("a block");
        block[row[entry] as usize % 2][col[entry] as usize % 2] += val[entry];
    }
    Ok(blocks)
}

pub(super) fn own_blocks(blocks: &[Block], contacts: usize) -> Result<Vec<[[f64; 2]; 2]>> {
    let mut own = vec![[[0.0; 2]; 2]; contacts];
    for ([row, column], block) in blocks {
        if row == column {
            own[*row as usize] = *block;
        }
    }
    for (contact, [[normal, mixed], [_, tangential]]) in own.iter().enumerate() {
        for (value, index) in [(normal, 2 * contact), (tangential, 2 * contact + 1)] {
            if *value <= 0.0 {
                return Err(Error::value(format!("W[{index}, {index}]"), value, "> 0"));
            }
        }
        let determinant = normal * tangential - mixed * mixed;
        if determinant <= 0.0 {
            let field = format!("the determinant of contact {contact}'s block of W");
            return Err(Error::value(field, determinant, "> 0"));
        }
    }
    Ok(own)
}

pub(super) fn check_symmetry(blocks: &[Block], own: &[[[f64; 2]; 2]]) -> Result<()> {
    for &([row, column], block) in blocks {
        let opposite = blocks
            .binary_search_by_key(&[column, row], |(place, _)| *place)
            .map_or([[0.0; 2]; 2], |at| blocks[at].1);
        for a in 0..2 {
            for b in 0..2 {
                let scale = (own[row as usize][a][a] * own[column as usize][b][b]).sqrt();
                let (one, other) = (block[a][b], opposite[b][a]);
                if (one - other).abs() > ASYMMETRY * scale {
                    let (i, j) = (2 * row as usize + a, 2 * column as usize + b);
                    let field = format!("W[{i}, {j}]");
                    let allowed = format!("W[{j}, {i}], which is {other}: W is symmetric");
                    return Err(Error::value(field, one, allowed));
                }
            }
        }
    }
    Ok(())
}
