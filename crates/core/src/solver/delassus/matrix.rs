//! Assembles the Delassus operator W and the free velocities q of a step's problem. Checks a W that is given by its
//! entries, and sorts the entries into 2×2 blocks.
//!
//! W (1/kg) maps impulses to changes of the contacts' velocities; q (m/s) are the contacts' velocities without contact
//! impulses. Let M be the inertias of the bodies, one per velocity coordinate (component of a body's velocity or spin),
//! G the derivatives of the contacts' normal and tangential velocities by these coordinates, and v^free the bodies'
//! velocities without contact impulses. Then W = G M⁻¹ Gᵀ and q = G v^free, plus the restitution term in the normal
//! rows. A contact is coupled only to contacts that share one of its grains: the n contacts of one grain give n²
//! blocks.

use crate::error::{self, Error, Result};
use crate::solver::kinematics::Model;
use crate::solver::problem::{Row, StepProblem};

/// Largest allowed difference between the entries W_ij and W_ji of the Delassus operator W, as a fraction of √(W_ii
/// W_jj). It is the rounding error of a file with six digits.
const ASYMMETRY: f64 = 1e-5;

/// Entries of a sparse matrix, given by row, column and value; entries at the same position are added. The entries are
/// not checked before a problem is created from them.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Triplets {
    /// Row index of each entry of the matrix.
    pub row: Vec<u32>,
    /// Column index of each entry of the matrix.
    pub col: Vec<u32>,
    /// Value of each entry of the matrix, 1/kg.
    pub val: Vec<f64>,
}

impl Triplets {
    /// Iterates over the entries as (row, column, value), in the order in which they are stored.
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

/// A 2×2 block of the Delassus operator: the indices [row contact, column contact], and the four entries, 1/kg.
pub(super) type EntryBlock = ([u32; 2], [[f64; 2]; 2]);

/// Checks the entries of the Delassus operator, and sorts them into 2×2 blocks by row contact and column contact.
pub(super) fn blocks(matrix: &Triplets, contacts: usize) -> Result<Vec<EntryBlock>> {
    let Triplets { row, col, val } = matrix;
    error::check(!val.is_empty(), "W", "empty", "a matrix with an entry on each diagonal place")?;
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
    let mut blocks: Vec<EntryBlock> = Vec::new();
    for entry in order {
        let place = [row[entry] / 2, col[entry] / 2];
        if blocks.last().is_none_or(|(last, _)| *last != place) {
            blocks.push((place, [[0.0; 2]; 2]));
        }
        // `blocks` is not empty here: the condition above adds a block to an empty list.
        let (_, block) = blocks.last_mut().expect("a block");
        block[row[entry] as usize % 2][col[entry] as usize % 2] += val[entry];
    }
    Ok(blocks)
}

pub(super) fn own_blocks(blocks: &[EntryBlock], contacts: usize) -> Result<Vec<[[f64; 2]; 2]>> {
    let mut own = vec![[[0.0; 2]; 2]; contacts];
    for ([row, column], block) in blocks {
        if row == column {
            own[*row as usize] = *block;
        }
    }
    for (contact, [[normal, mixed], [_, tangential]]) in own.iter().enumerate() {
        for (value, index) in [(normal, 2 * contact), (tangential, 2 * contact + 1)] {
            error::check(*value > 0.0, format!("W[{index}, {index}]"), value, "> 0")?;
        }
        let determinant = normal * tangential - mixed * mixed;
        if determinant <= 0.0 {
            let field = format!("the determinant of contact {contact}'s block of W");
            return Err(Error::value(field, determinant, "> 0"));
        }
    }
    Ok(own)
}

pub(super) fn check_symmetry(blocks: &[EntryBlock], own: &[[[f64; 2]; 2]]) -> Result<()> {
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

/// Maximum number of entries of the Delassus operator. A problem file with this number of entries has about 500 MB.
/// Piles of 300,000 discs have fewer entries.
const MOST_ENTRIES: u64 = 20_000_000;

/// The Delassus operator W and the free velocities q (velocities without contact impulses) of a step's contact problem,
/// with the contacts in the order of the problem's rows.
pub struct Assembled {
    /// The Delassus operator W, 1/kg: exactly symmetric, sorted by row and column, without entries of 0.
    pub matrix: Triplets,
    /// The free velocities q, m/s: for each contact the normal and the tangential velocity without contact impulses,
    /// restitution term included.
    pub free_velocities: Vec<f64>,
}

impl Assembled {
    /// Computes the Delassus operator W and the free velocities q (velocities without contact impulses) of a problem.
    /// In a problem with one space dimension there is no tangent; then the tangential rows of W have W_tt = W_nn on the
    /// diagonal and no other entries.
    ///
    /// # Errors
    /// An error names the body with the most contacts, if W would have too many entries.
    // Without inlining, the function is compiled once per model, in this crate.
    #[inline(never)]
    pub fn of<M: Model>(problem: &StepProblem<M>) -> Result<Self> {
        let mut contacts_of_body = vec![Vec::new(); problem.bodies.masses.len()];
        for (number, row) in problem.rows() {
            contacts_of_body[row.i as usize].push(number);
            if problem.rows.is_pair(number) {
                contacts_of_body[row.j as usize].push(number);
            }
        }
        check_entries(&contacts_of_body)?;
        let mut matrix = Triplets::default();
        let mut free_velocities = Vec::with_capacity(2 * problem.rows.len());
        for (number, row) in problem.rows() {
            let mut others = contacts_of_body[row.i as usize].clone();
            if problem.rows.is_pair(number) {
                others.extend(&contacts_of_body[row.j as usize]);
            }
            others.sort_unstable();
            others.dedup();
            for axis in 0..2 {
                for &other in &others {
                    for other_axis in 0..2 {
                        let value = entry(problem, [number, axis], [other, other_axis]);
                        if value != 0.0 {
                            matrix.row.push((2 * number + axis) as u32);
                            matrix.col.push((2 * other + other_axis) as u32);
                            matrix.val.push(value);
                        }
                    }
                }
            }
        }
        problem.for_each_velocity(&problem.bodies.free, |row, [normal, tangential]| {
            free_velocities.extend([normal + row.restitution_velocity, tangential]);
        });
        Ok(Self { matrix, free_velocities })
    }
}

/// Checks that the Delassus operator has at most [`MOST_ENTRIES`] entries. The argument lists the contacts of each
/// body. Each contact has one block of four entries, and each pair of contacts that share a body has two such blocks.
fn check_entries(contacts_of_body: &[Vec<usize>]) -> Result<()> {
    let of_body = |contacts: &Vec<usize>| 4 * (contacts.len() as u64).pow(2);
    let entries: u64 = contacts_of_body.iter().map(of_body).sum();
    let most = contacts_of_body.iter().enumerate().max_by_key(|(_, contacts)| contacts.len());
    match most {
        Some((body, contacts)) if entries > MOST_ENTRIES => {
            let field = format!("the number of contacts of grains[{body}]");
            let allowed = format!(
                "so small that W has at most {MOST_ENTRIES} entries, where it has up to {entries}"
            );
            Err(Error::value(field, contacts.len(), allowed))
        }
        _ => Ok(()),
    }
}

/// Returns the entry of the Delassus operator, 1/kg, in the row of one contact and axis and the column of another
/// contact and axis (0 normal, 1 tangential).
fn entry<M: Model>(
    problem: &StepProblem<M>,
    [number, axis]: [usize; 2],
    [other_number, other_axis]: [usize; 2],
) -> f64 {
    let (row, other) = (problem.rows.get(number), problem.rows.get(other_number));
    if M::AXES == 1 && (axis, other_axis) != (0, 0) {
        let same = number == other_number && axis == other_axis;
        return if same { 1.0 / row.effective_mass } else { 0.0 };
    }
    let bodies =
        |row: &Row<M>, number: usize| [Some(row.i), problem.rows.is_pair(number).then_some(row.j)];
    let gradients = [M::gradients(row.normal), M::gradients(other.normal)];
    let mut sum = 0.0;
    for (side, body) in bodies(row, number).into_iter().enumerate() {
        for (other_side, other_body) in bodies(other, other_number).into_iter().enumerate() {
            let Some(body) = body.filter(|_| body == other_body) else { continue };
            let mass = problem.bodies.masses[body as usize];
            let (one, two) = (gradients[0][side][axis], gradients[1][other_side][other_axis]);
            let inertias = M::INERTIA_OVER_MASS.iter().take(M::DEGREES);
            for ((a, b), inertia) in one.iter().zip(two).zip(inertias) {
                sum += a * b / (mass * inertia);
            }
        }
    }
    sum
}
