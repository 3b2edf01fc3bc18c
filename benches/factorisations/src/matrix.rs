//! Matrix of an interior-point method near convergence: unit masses, and contacts whose stiffness varies by many orders
//! of magnitude.

use std::collections::BTreeMap;
use std::error::Error;

use crate::linear::Block;

/// Smallest and largest contact stiffness relative to the masses, as powers of ten.
const STIFFNESS: [f64; 2] = [-6.0, 6.0];

/// Matrix M + Σ Hᵀ K H (masses M, contact stiffnesses K, contact directions H) in blocks of three rows: two axes and
/// the spin. In its units a disc has the mass 1 and the moment of inertia ½.
pub struct Matrix {
    /// Number of bodies.
    pub bodies: usize,
    /// Pairs of bodies in contact, each with the smaller number first.
    pub pairs: Vec<(u32, u32)>,
    /// Diagonal blocks, one per body.
    pub diagonal: Vec<Block<3>>,
    /// Off-diagonal blocks, one per pair. The rows of a block belong to the first body of its pair.
    pub off_diagonal: Vec<Block<3>>,
    /// Right-hand side, one block per body.
    pub right_side: Vec<[f64; 3]>,
}

impl Matrix {
    /// Builds the matrix from the contacts of the last frame in a CSV table of contacts, with random stiffnesses.
    ///
    /// # Errors
    /// Fails if the file cannot be read or is not a table of contacts.
    pub fn read(path: &str) -> Result<Self, Box<dyn Error>> {
        let mut reader = csv::ReaderBuilder::new().comment(Some(b'#')).from_path(path)?;
        let header = reader.headers()?.clone();
        let column = |name: &str| {
            let at = header.iter().position(|column| column == name);
            at.ok_or_else(|| format!("has no column {name}"))
        };
        let [step, i, j, kind, x, y] = [
            column("step")?,
            column("id_i")?,
            column("id_j")?,
            column("kind_j")?,
            column("nx")?,
            column("ny")?,
        ];
        let mut last = 0;
        let mut contacts: Vec<(u32, Option<u32>, [f64; 2])> = Vec::new();
        for record in reader.records() {
            let record = record?;
            let now: u64 = record[step].parse()?;
            if now != last {
                contacts.clear();
                last = now;
            }
            let other = if &record[kind] == "grain" { Some(record[j].parse()?) } else { None };
            contacts.push((record[i].parse()?, other, [record[x].parse()?, record[y].parse()?]));
        }
        Ok(Self::of(&contacts))
    }

    fn of(contacts: &[(u32, Option<u32>, [f64; 2])]) -> Self {
        let last = contacts.iter().flat_map(|&(i, j, _)| [Some(i), j]).flatten().max();
        let bodies = last.map_or(0, |last| last as usize + 1);
        let mut random = 1u64;
        let mut fraction = || {
            // Any well-mixed pseudorandom sequence is suitable here (Knuth's multiplier).
            random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (random >> 11) as f64 / (1u64 << 53) as f64
        };
        let mut diagonal = vec![[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 0.5]]; bodies];
        let mut blocks: BTreeMap<(u32, u32), Block<3>> = BTreeMap::new();
        for &(i, j, [x, y]) in contacts {
            // Gradients of v_n and of v_t with respect to the velocities of the two bodies. The gradient of v_t
            // includes the spins of both bodies.
            let rows = [([x, y, 0.0], [-x, -y, 0.0]), ([-y, x, 1.0], [y, -x, 1.0])];
            for (on_i, on_j) in rows {
                let stiffness = 10f64.powf(STIFFNESS[0] + (STIFFNESS[1] - STIFFNESS[0]) * fraction());
                let outer = |a: &[f64; 3], b: &[f64; 3]| a.map(|a| b.map(|b| stiffness * a * b));
                add(&mut diagonal[i as usize], &outer(&on_i, &on_i));
                if let Some(j) = j {
                    add(&mut diagonal[j as usize], &outer(&on_j, &on_j));
                    let block = if i < j { outer(&on_i, &on_j) } else { outer(&on_j, &on_i) };
                    add(blocks.entry((i.min(j), i.max(j))).or_insert([[0.0; 3]; 3]), &block);
                }
            }
        }
        let right_side = (0..bodies).map(|_| [(); 3].map(|()| fraction() - 0.5)).collect();
        let (pairs, off_diagonal) = blocks.into_iter().unzip();
        Self { bodies, pairs, diagonal, off_diagonal, right_side }
    }

    /// Returns the relative error of a solution x of Ax = b: ‖Ax − b‖ / ‖b‖.
    pub fn error(&self, solution: &[[f64; 3]]) -> f64 {
        let mut rest = self.right_side.clone();
        let mut subtract = |to: usize, block: &Block<3>, from: usize, transposed: bool| {
            for row in 0..3 {
                for column in 0..3 {
                    let entry = if transposed { block[column][row] } else { block[row][column] };
                    rest[to][row] -= entry * solution[from][column];
                }
            }
        };
        for (body, block) in self.diagonal.iter().enumerate() {
            subtract(body, block, body, false);
        }
        for (&(i, j), block) in self.pairs.iter().zip(&self.off_diagonal) {
            subtract(i as usize, block, j as usize, false);
            subtract(j as usize, block, i as usize, true);
        }
        let norm = |vector: &[[f64; 3]]| vector.iter().flatten().map(|x| x * x).sum::<f64>().sqrt();
        norm(&rest) / norm(&self.right_side)
    }
}

fn add(to: &mut Block<3>, block: &Block<3>) {
    for (entries, numbers) in to.iter_mut().zip(block) {
        for (entry, number) in entries.iter_mut().zip(numbers) {
            *entry += number;
        }
    }
}
