//! W and q of a step's problem.
//!
//! With G the gradients of a contact's (v_n, v_t) in the bodies' coordinates and M the inertias in
//! them, W = G M⁻¹ Gᵀ and q = G v^free, plus restitution's term in the normal rows. A contact
//! meets those that share one of its grains, and no others: where n of them share one, W has n² blocks.

use super::blocks::Triplets;
use crate::error::{Error, Result};
use crate::solver::problem::{Kinematics, Row, StepProblem};

/// Entries of W: a problem file of this many has some 500 MB. Piles of 300,000 discs have fewer.
const MOST_ENTRIES: u64 = 20_000_000;

/// W and q of a step's problem, its contacts in the order of its rows.
pub struct Assembled {
    /// W, 1/kg, exactly symmetric, sorted by row and column, without zeros.
    pub matrix: Triplets,
    /// q, m/s.
    pub free_velocities: Vec<f64>,
}

impl Assembled {
    /// Works W and q out. On a line, where there is no tangent, a tangential row has W_tt = W_nn and
    /// meets nothing.
    ///
    /// # Errors
    /// Names the body that most contacts share, where they make W too large.
    pub fn of<K: Kinematics>(problem: &StepProblem<K>) -> Result<Self> {
        let rows = || problem.fixed_rows.iter().map(|row| (row, false));
        let rows = rows().chain(problem.pair_rows.iter().map(|row| (row, true)));
        let contacts: Vec<_> = rows.collect();
        let mut contacts_of_body = vec![Vec::new(); problem.masses.len()];
        for (number, (row, pair)) in contacts.iter().enumerate() {
            contacts_of_body[row.i as usize].push(number);
            if *pair {
                contacts_of_body[row.j as usize].push(number);
            }
        }
        check_entries(&contacts_of_body)?;
        let mut matrix = Triplets::default();
        let mut free_velocities = Vec::with_capacity(2 * contacts.len());
        for (number, &(row, pair)) in contacts.iter().enumerate() {
            let mut others = contacts_of_body[row.i as usize].clone();
            if pair {
                others.extend(&contacts_of_body[row.j as usize]);
            }
            others.sort_unstable();
            others.dedup();
            for axis in 0..2 {
                for &other in &others {
                    for other_axis in 0..2 {
                        let places = [(contacts[number], axis), (contacts[other], other_axis)];
                        let value = entry(problem, places);
                        if value != 0.0 {
                            matrix.row.push((2 * number + axis) as u32);
                            matrix.col.push((2 * other + other_axis) as u32);
                            matrix.val.push(value);
                        }
                    }
                }
            }
            let free = |body: u32| &problem.free[body as usize];
            let [normal, tangential] = if pair {
                K::relative_velocity(row.normal, free(row.i), free(row.j))
            } else {
                row.velocity(free(row.i))
            };
            free_velocities.extend([normal + row.restitution_velocity, tangential]);
        }
        Ok(Self { matrix, free_velocities })
    }
}

/// Checks that W has room, by the contacts of each body: each meets all others.
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

/// A contact, whether it is one between two grains, and the axis: 0 normal, 1 tangential.
type Place<'a, K> = ((&'a Row<K>, bool), usize);

fn entry<K: Kinematics>(problem: &StepProblem<K>, places: [Place<'_, K>; 2]) -> f64 {
    let [((row, pair), axis), ((other, other_pair), other_axis)] = places;
    if K::AXES == 1 && (axis, other_axis) != (0, 0) {
        let same = std::ptr::eq(row, other) && axis == other_axis;
        return if same { 1.0 / row.effective_mass } else { 0.0 };
    }
    let bodies = |row: &Row<K>, pair: bool| [Some(row.i), pair.then_some(row.j)];
    let gradients = [K::gradients(row.normal), K::gradients(other.normal)];
    let mut sum = 0.0;
    for (side, body) in bodies(row, pair).into_iter().enumerate() {
        for (other_side, other_body) in bodies(other, other_pair).into_iter().enumerate() {
            let Some(body) = body.filter(|_| body == other_body) else { continue };
            let mass = problem.masses[body as usize];
            let (one, two) = (gradients[0][side][axis], gradients[1][other_side][other_axis]);
            let inertias = K::INERTIA_OVER_MASS.iter().take(K::DEGREES);
            for ((a, b), inertia) in one.iter().zip(two).zip(inertias) {
                sum += a * b / (mass * inertia);
            }
        }
    }
    sum
}
