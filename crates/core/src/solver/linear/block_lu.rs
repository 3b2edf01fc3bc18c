//! Sparse LU factorisation of a matrix of D × D blocks, with one row and one column of blocks per body.
//!
//! The pattern of nonzero blocks is symmetric; the entries of the blocks need not be symmetric. There is no pivoting
//! between blocks: the matrices that Newton's method factorises are masses plus contact stiffnesses, whose diagonal
//! blocks dominate unless friction is large. If a factorisation breaks down, the factors contain entries that are not
//! finite, or Newton's method rejects the step that it computes with them.

use super::elimination::Elimination;
use crate::solver::kinematics::Model;

/// A block of D × D numbers (D: degrees of freedom of a body).
pub(crate) type Block<const D: usize> = [[f64; D]; D];

/// Returns a block with these numbers on its diagonal and 0 elsewhere.
pub(crate) fn diagonal<const D: usize>(numbers: [f64; D]) -> Block<D> {
    let mut block = [[0.0; D]; D];
    for (axis, row) in block.iter_mut().enumerate() {
        row[axis] = numbers[axis];
    }
    block
}

/// Returns the inertias of a body of mass `mass` (kg), one per degree of freedom, kg. The velocity of a rotation is
/// radius times angular velocity (m/s), so its inertia is a mass, too.
pub(crate) fn inertias<M: Model, const D: usize>(mass: f64) -> [f64; D] {
    std::array::from_fn(|axis| mass * M::INERTIA_OVER_MASS[axis])
}

/// A matrix, which [`BlockMatrix::factorise`] replaces by its factors. The memory is reused for the next matrix.
#[derive(Clone, Debug, Default)]
pub(crate) struct BlockMatrix<const D: usize> {
    /// Diagonal blocks in elimination order. [`BlockMatrix::factorise`] replaces each block by the inverse of the
    /// diagonal block of the upper factor.
    diagonal: Vec<Block<D>>,
    /// Blocks below the diagonal, in row b and column a, one per pair of positions a < b of the elimination order whose
    /// bodies are neighbours. A block has the same index as its entry in [`Elimination::later`], the lists that give
    /// for each position a the positions b of the neighbours that are eliminated later.
    lower: Vec<Block<D>>,
    /// Blocks above the diagonal, in row a and column b, one per pair of positions a < b of the elimination order whose
    /// bodies are neighbours. A block has the same index as its entry in [`Elimination::later`], the lists that give
    /// for each position a the positions b of the neighbours that are eliminated later.
    upper: Vec<Block<D>>,
}

impl<const D: usize> BlockMatrix<D> {
    /// Sets all blocks of the matrix to zero, and their number and order to those of `elimination`.
    pub(crate) fn clear(&mut self, elimination: &Elimination) {
        let zero = [[0.0; D]; D];
        for (blocks, count) in [
            (&mut self.diagonal, elimination.body_at.len()),
            (&mut self.lower, elimination.later.len()),
            (&mut self.upper, elimination.later.len()),
        ] {
            blocks.clear();
            blocks.resize(count, zero);
        }
    }

    /// Sets the matrix to the diagonal matrix of the inertias of bodies with these masses (kg).
    pub(crate) fn start<M: Model>(&mut self, elimination: &Elimination, masses: &[f64]) {
        self.clear(elimination);
        for (&place, &mass) in elimination.place_of.iter().zip(masses) {
            self.diagonal[place as usize] = diagonal(inertias::<M, D>(mass));
        }
    }

    /// Returns the diagonal block at position `place` of the elimination order.
    pub(crate) fn diagonal_mut(&mut self, place: u32) -> &mut Block<D> {
        &mut self.diagonal[place as usize]
    }

    /// Returns the two off-diagonal blocks of two neighbouring bodies i and j: the block in row i and column j, and the
    /// block in row j and column i. `number` is the index, in [`Elimination::later`], of the body that is eliminated
    /// second.
    #[inline(always)]
    pub(crate) fn off_diagonal_mut(
        &mut self,
        number: u32,
        i_is_earlier: bool,
    ) -> (&mut Block<D>, &mut Block<D>) {
        let (upper, lower) = (&mut self.upper[number as usize], &mut self.lower[number as usize]);
        if i_is_earlier { (upper, lower) } else { (lower, upper) }
    }

    /// Replaces the matrix by its triangular factors: the lower factor L below the diagonal (the diagonal blocks of L
    /// are unit matrices), the upper factor U above the diagonal, and the inverses of U's diagonal blocks on the
    /// diagonal.
    pub(crate) fn factorise(&mut self, elimination: &Elimination) {
        let mut targets = elimination.targets.iter();
        for place in 0..self.diagonal.len() {
            let inverse = inverse(&self.diagonal[place]);
            self.diagonal[place] = inverse;
            let range = elimination.row(place);
            for edge in range.clone() {
                self.lower[edge] = product(&self.lower[edge], &inverse);
            }
            for first in range.clone() {
                let a = elimination.later[first] as usize;
                let lower_a = self.lower[first];
                subtract_product(&mut self.diagonal[a], &lower_a, &self.upper[first]);
                for second in first + 1..range.end {
                    // `targets` has one entry per pair (first, second), in the order of this loop.
                    let Some(&target) = targets.next() else { return };
                    let target = target as usize;
                    let (upper_b, lower_b) = (self.upper[second], self.lower[second]);
                    subtract_product(&mut self.upper[target], &lower_a, &upper_b);
                    let upper_a = self.upper[first];
                    subtract_product(&mut self.lower[target], &lower_b, &upper_a);
                }
            }
        }
    }

    /// Solves the linear equations with the factors. `vector`, in elimination order, is the right-hand side on entry
    /// and the solution on return.
    pub(crate) fn solve(&self, elimination: &Elimination, vector: &mut [[f64; D]]) {
        for place in 0..vector.len() {
            let here = vector[place];
            for edge in elimination.row(place) {
                let there = &mut vector[elimination.later[edge] as usize];
                subtract_applied(there, &self.lower[edge], &here);
            }
        }
        for place in (0..vector.len()).rev() {
            let mut here = vector[place];
            for edge in elimination.row(place) {
                let there = vector[elimination.later[edge] as usize];
                subtract_applied(&mut here, &self.upper[edge], &there);
            }
            let mut solution = [0.0; D];
            for (row, solution) in self.diagonal[place].iter().zip(&mut solution) {
                *solution = dot(row, &here);
            }
            vector[place] = solution;
        }
    }
}

#[inline(always)]
fn dot<const D: usize>(a: &[f64; D], b: &[f64; D]) -> f64 {
    let mut sum = 0.0;
    for index in 0..D {
        sum += a[index] * b[index];
    }
    sum
}

#[inline(always)]
fn product<const D: usize>(a: &Block<D>, b: &Block<D>) -> Block<D> {
    let mut result = [[0.0; D]; D];
    for row in 0..D {
        for inner in 0..D {
            for column in 0..D {
                result[row][column] += a[row][inner] * b[inner][column];
            }
        }
    }
    result
}

#[inline(always)]
fn subtract_product<const D: usize>(from: &mut Block<D>, a: &Block<D>, b: &Block<D>) {
    for row in 0..D {
        for inner in 0..D {
            for column in 0..D {
                from[row][column] -= a[row][inner] * b[inner][column];
            }
        }
    }
}

#[inline(always)]
fn subtract_applied<const D: usize>(from: &mut [f64; D], a: &Block<D>, b: &[f64; D]) {
    for row in 0..D {
        from[row] -= dot(&a[row], b);
    }
}

/// Returns the inverse of a block, by Gauss–Jordan elimination with pivoting inside the block.
fn inverse<const D: usize>(block: &Block<D>) -> Block<D> {
    let mut left = *block;
    let mut right = [[0.0; D]; D];
    for (index, row) in right.iter_mut().enumerate() {
        row[index] = 1.0;
    }
    for column in 0..D {
        let mut pivot = column;
        for row in column + 1..D {
            if left[row][column].abs() > left[pivot][column].abs() {
                pivot = row;
            }
        }
        left.swap(column, pivot);
        right.swap(column, pivot);
        let scale = 1.0 / left[column][column];
        for index in 0..D {
            left[column][index] *= scale;
            right[column][index] *= scale;
        }
        for row in 0..D {
            if row != column {
                let factor = left[row][column];
                for index in 0..D {
                    left[row][index] -= factor * left[column][index];
                    right[row][index] -= factor * right[column][index];
                }
            }
        }
    }
    right
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solver::linear::tests::{grid, numbers};

    #[test]
    fn a_grid_of_unsymmetric_blocks_is_solved_to_rounding() {
        let side = 6u32;
        let bodies = (side * side) as usize;
        let pairs = grid(side);
        let mut elimination = Elimination::default();
        elimination.analyse(bodies, pairs.iter().copied());
        let mut number = numbers();
        let mut block = || [(); 3].map(|()| [(); 3].map(|()| number()));
        let mut matrix = BlockMatrix::<3>::default();
        matrix.clear(&elimination);
        let mut entries = Vec::new();
        for place in 0..bodies as u32 {
            let mut diagonal = block();
            for (index, row) in diagonal.iter_mut().enumerate() {
                row[index] += 8.0;
            }
            *matrix.diagonal_mut(place) = diagonal;
            entries.push((place, place, diagonal));
        }
        for &(i, j) in &pairs {
            let (a, b) = (elimination.place_of[i as usize], elimination.place_of[j as usize]);
            let number = elimination.block(a.min(b), a.max(b)) as u32;
            let (there, back) = (block(), block());
            let (upper, lower) = matrix.off_diagonal_mut(number, a < b);
            (*upper, *lower) = (there, back);
            entries.extend([(a, b, there), (b, a, back)]);
        }
        let solution: Vec<[f64; 3]> = (0..bodies).map(|k| [1.0, k as f64, -2.0]).collect();
        let mut vector = vec![[0.0; 3]; bodies];
        for (row, column, block) in &entries {
            subtract_applied(&mut vector[*row as usize], block, &solution[*column as usize]);
        }
        matrix.factorise(&elimination);
        matrix.solve(&elimination, &mut vector);
        for (found, expected) in vector.iter().zip(&solution) {
            for (found, expected) in found.iter().zip(expected) {
                assert!((found + expected).abs() < 1e-12 * (1.0 + expected.abs()));
            }
        }
    }
}
