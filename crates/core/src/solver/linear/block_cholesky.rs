//! Sparse Cholesky factorisation of a symmetric positive definite matrix of blocks of D × D numbers, with one row and
//! one column of blocks per body. D is the number of degrees of freedom of a body.
//!
//! Rows are numbered by the bodies' positions in the elimination order. Let A be the matrix, U_ab its block in row a
//! and column b ≥ a after all earlier eliminations, and B_k = U_kk the diagonal block of position k. The later
//! neighbours of k are the positions b > k with a nonzero block U_kb. The elimination of position k computes the lower
//! triangular Cholesky factor L_k of B_k and the blocks W_kb of the final factor W:
//!
//! > B_k = L_k L_kᵀ,  W_kb = L_k⁻¹ U_kb,  U_ab ← U_ab − W_kaᵀ W_kb for all pairs of later neighbours a ≤ b of k
//!
//! (W_kaᵀ is the transpose of W_ka). Finally A is the product WᵀW, with the blocks L_kᵀ on the diagonal of W. This
//! takes half the work and half the memory of unsymmetric factors, and a positive definite matrix needs no pivoting.
//! Adjacent positions with the same later neighbours form a supernode and are eliminated together: each block that they
//! change is fetched once, and receives the changes from all of them while they are in the cache (C. C. Ashcraft, R. G.
//! Grimes, 1989). Diagonal blocks are factorised rather than inverted: the inverse of a block that is stiff along one
//! direction and soft along another loses half of all digits.

use std::ops::Range;

use super::block_lu::Block;
use super::elimination::Elimination;

/// Number of columns of a stored block: the length of a vector register, so that one operation changes a whole row.
const WIDTH: usize = 4;

/// A block of D × D numbers (D: degrees of freedom of a body), stored with [`WIDTH`] columns. The columns after the
/// first D are 0.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
struct Padded<const D: usize>([[f64; WIDTH]; D]);

impl<const D: usize> Padded<D> {
    const ZERO: Self = Self([[0.0; WIDTH]; D]);
}

/// A symmetric matrix, which [`SymmetricBlockMatrix::factorise`] replaces by its factors. The memory is reused for the
/// next matrix.
#[derive(Clone, Debug, Default)]
pub(crate) struct SymmetricBlockMatrix<const D: usize> {
    /// Diagonal blocks in elimination order. The factorisation replaces each block by its lower triangular Cholesky
    /// factor, with the inverses of the factor's diagonal entries on the diagonal.
    diagonal: Vec<Padded<D>>,
    /// Blocks above the diagonal, in row a and column b, one per pair of positions a < b of the elimination order whose
    /// bodies are neighbours. A block has the same index as its entry in [`Elimination::later`], the lists that give
    /// for each position a the positions b of the neighbours that are eliminated later.
    upper: Vec<Padded<D>>,
    /// Work memory for one supernode (adjacent rows that are eliminated together): the blocks of its rows to the right
    /// of the supernode, column by column.
    panel: Vec<Padded<D>>,
}

impl<const D: usize> SymmetricBlockMatrix<D> {
    /// Sets all blocks of the matrix to zero, and their number and order to those of `elimination`.
    pub(crate) fn clear(&mut self, elimination: &Elimination) {
        self.diagonal.clear();
        self.diagonal.resize(elimination.body_at.len(), Padded::ZERO);
        self.upper.clear();
        self.upper.resize(elimination.later.len(), Padded::ZERO);
    }

    /// Adds `block` to the diagonal block at position `place` of the elimination order.
    #[inline(always)]
    pub(crate) fn add_to_diagonal(&mut self, place: u32, block: &Block<D>) {
        add(&mut self.diagonal[place as usize], block);
    }

    /// Adds `block` to the off-diagonal block of two bodies that are neighbours. `number` is the index, in
    /// [`Elimination::later`], of the body that is eliminated second. The rows of the block belong to the body that is
    /// eliminated first.
    #[inline(always)]
    pub(crate) fn add_to_upper(&mut self, number: u32, block: &Block<D>) {
        add(&mut self.upper[number as usize], block);
    }

    /// Replaces the matrix by its Cholesky factors.
    pub(crate) fn factorise(&mut self, elimination: &Elimination) {
        #[cfg(target_arch = "x86_64")]
        if std::arch::is_x86_feature_detected!("avx") {
            // SAFETY: AVX has just been detected.
            unsafe { self.factorise_with_avx(elimination) };
            return;
        }
        self.factorise_each(elimination);
    }

    /// Replaces the matrix by its Cholesky factors. Does the operations of `factorise_each`, the version for all
    /// processors, in the same order, but compiled for the AVX instructions: four numbers at a time. The result is
    /// bitwise the same.
    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx")]
    fn factorise_with_avx(&mut self, elimination: &Elimination) {
        self.factorise_each(elimination);
    }

    #[inline(always)]
    fn factorise_each(&mut self, elimination: &Elimination) {
        let mut targets = &elimination.targets[..];
        for supernode in elimination.supernodes.windows(2) {
            let places = supernode[0] as usize..supernode[1] as usize;
            for place in places.clone() {
                self.factorise_place(elimination, place, places.end);
                if place + 1 < places.end {
                    targets = &targets[pairs(elimination.row(place).len())..];
                }
            }
            let outside = elimination.row(places.end - 1);
            let (of_these, rest) = targets.split_at(pairs(outside.len()));
            targets = rest;
            if places.len() == 1 {
                self.subtract_row(elimination, outside, of_these);
            } else {
                self.subtract_supernode(elimination, places, of_these);
            }
        }
    }

    /// Factorises the row at position `place` of the elimination order, and subtracts its contribution from the later
    /// rows of its supernode (adjacent rows that are eliminated together), which ends before position `end`.
    #[inline(always)]
    fn factorise_place(&mut self, elimination: &Elimination, place: usize, end: usize) {
        let Self { diagonal, upper, .. } = self;
        let factor = cholesky(&diagonal[place]);
        diagonal[place] = factor;
        let row = elimination.row(place);
        for block in &mut upper[row.clone()] {
            solve_lower(&factor, block);
        }
        // All rows of a supernode end with blocks in the same columns.
        let (done, ahead) = upper.split_at_mut(row.end);
        for (later, first) in (place + 1..end).zip(row.clone()) {
            let of_first = &done[first];
            subtract_product(&mut diagonal[later], of_first, of_first);
            let begin = elimination.row(later).start - row.end;
            for (to, of_second) in ahead[begin..].iter_mut().zip(&done[first + 1..]) {
                subtract_product(to, of_first, of_second);
            }
        }
    }

    /// Subtracts the contributions of a factorised row from the blocks of later rows. The row is a supernode by itself:
    /// no other row is eliminated together with it.
    #[inline(always)]
    fn subtract_row(&mut self, elimination: &Elimination, row: Range<usize>, targets: &[u32]) {
        let Self { diagonal, upper, .. } = self;
        // `targets` has one entry per pair (first, second), in the order of this loop.
        let mut targets = targets.iter();
        for first in row.clone() {
            let of_first = upper[first];
            let on_first = &mut diagonal[elimination.later[first] as usize];
            subtract_product(on_first, &of_first, &of_first);
            for (second, &target) in (first + 1..row.end).zip(&mut targets) {
                let of_second = upper[second];
                subtract_product(&mut upper[target as usize], &of_first, &of_second);
            }
        }
    }

    /// Subtracts the contributions of a factorised supernode (adjacent rows that are eliminated together) from the
    /// blocks of later rows. Each block is loaded and stored once for all rows of the supernode.
    #[inline(always)]
    fn subtract_supernode(
        &mut self,
        elimination: &Elimination,
        places: Range<usize>,
        mut targets: &[u32],
    ) {
        let Self { diagonal, upper, panel } = self;
        let outside = elimination.row(places.end - 1);
        // For each column outside the supernode, the panel has the blocks of all rows of the supernode in that column.
        panel.clear();
        for edge in outside.clone() {
            let back = outside.end - edge;
            panel.extend(places.clone().map(|place| upper[elimination.row(place).end - back]));
        }
        let with = |edge: usize| &panel[(edge - outside.start) * places.len()..][..places.len()];
        for first in outside.clone() {
            let of_first = with(first);
            let on_first = &mut diagonal[elimination.later[first] as usize];
            [*on_first] = less_products([*on_first], of_first, [of_first]);
            // `targets` has one entry per pair (first, second), in the order of this loop.
            let (of_these, rest) = targets.split_at(outside.end - first - 1);
            targets = rest;
            for (second, of_these) in (first + 1..).step_by(3).zip(of_these.chunks(3)) {
                if let Ok(three) = <[u32; 3]>::try_from(of_these) {
                    let blocks = three.map(|target| upper[target as usize]);
                    let others = [with(second), with(second + 1), with(second + 2)];
                    let blocks = less_products(blocks, of_first, others);
                    for (target, block) in three.into_iter().zip(blocks) {
                        upper[target as usize] = block;
                    }
                    continue;
                }
                for (second, &target) in (second..).zip(of_these) {
                    let block = &mut upper[target as usize];
                    [*block] = less_products([*block], of_first, [with(second)]);
                }
            }
        }
    }

    /// Solves the linear equations with the factors. `vector`, in elimination order, is the right-hand side on entry
    /// and the solution on return.
    pub(crate) fn solve(&self, elimination: &Elimination, vector: &mut [[f64; D]]) {
        for place in 0..vector.len() {
            let factor = &self.diagonal[place].0;
            let mut here = vector[place];
            for row in 0..D {
                for column in 0..row {
                    here[row] -= factor[row][column] * here[column];
                }
                here[row] *= factor[row][row];
            }
            vector[place] = here;
            for edge in elimination.row(place) {
                let there = &mut vector[elimination.later[edge] as usize];
                for (factors, here) in self.upper[edge].0.iter().zip(here) {
                    for (entry, factor) in there.iter_mut().zip(factors) {
                        *entry -= factor * here;
                    }
                }
            }
        }
        for place in (0..vector.len()).rev() {
            let mut here = vector[place];
            for edge in elimination.row(place) {
                let there = &vector[elimination.later[edge] as usize];
                for (entry, factors) in here.iter_mut().zip(&self.upper[edge].0) {
                    for (factor, number) in factors.iter().zip(there) {
                        *entry -= factor * number;
                    }
                }
            }
            let factor = &self.diagonal[place].0;
            for row in (0..D).rev() {
                for later in row + 1..D {
                    here[row] -= factor[later][row] * here[later];
                }
                here[row] *= factor[row][row];
            }
            vector[place] = here;
        }
    }
}

/// Number of pairs among `count` items, count (count − 1)/2.
fn pairs(count: usize) -> usize {
    count * count.saturating_sub(1) / 2
}

#[inline(always)]
fn add<const D: usize>(to: &mut Padded<D>, block: &Block<D>) {
    for (entries, numbers) in to.0.iter_mut().zip(block) {
        for (entry, number) in entries.iter_mut().zip(numbers) {
            *entry += number;
        }
    }
}

/// Returns the lower triangular Cholesky factor L of a diagonal block (the block is L Lᵀ), with the inverses of L's
/// diagonal entries on the diagonal.
#[inline(always)]
fn cholesky<const D: usize>(block: &Padded<D>) -> Padded<D> {
    let mut factor = Padded::ZERO;
    for row in 0..D {
        for column in 0..=row {
            let mut entry = block.0[row][column];
            for inner in 0..column {
                entry -= factor.0[row][inner] * factor.0[column][inner];
            }
            factor.0[row][column] =
                if column < row { entry * factor.0[column][column] } else { 1.0 / entry.sqrt() };
        }
    }
    factor
}

/// Replaces `block` by the product L⁻¹ `block`. The lower triangular matrix L is given as `factor`, in the form that
/// [`cholesky`] returns.
#[inline(always)]
fn solve_lower<const D: usize>(factor: &Padded<D>, block: &mut Padded<D>) {
    for row in 0..D {
        let mut entries = block.0[row];
        for inner in 0..row {
            for (entry, earlier) in entries.iter_mut().zip(block.0[inner]) {
                *entry -= factor.0[row][inner] * earlier;
            }
        }
        block.0[row] = entries.map(|entry| entry * factor.0[row][row]);
    }
}

/// Returns N blocks. Block number k is `left[k]` minus the sum of the matrix products of the blocks of `a`, transposed,
/// with the blocks of the list `b[k]`: the first of `a` with the first of `b[k]`, and so on.
#[inline(always)]
fn less_products<const D: usize, const N: usize>(
    mut left: [Padded<D>; N],
    a: &[Padded<D>],
    b: [&[Padded<D>]; N],
) -> [Padded<D>; N] {
    let b = b.map(|b| &b[..a.len()]);
    for at in 0..a.len() {
        for (left, b) in left.iter_mut().zip(b) {
            subtract_product(left, &a[at], &b[at]);
        }
    }
    left
}

/// Subtracts from the block `from` the product aᵀb of the blocks `a` (transposed) and `b`.
#[inline(always)]
fn subtract_product<const D: usize>(from: &mut Padded<D>, a: &Padded<D>, b: &Padded<D>) {
    let mut result = *from;
    for (factors, entries) in a.0.iter().zip(&b.0) {
        for (to, factor) in result.0.iter_mut().zip(factors) {
            for column in 0..WIDTH {
                to[column] -= factor * entries[column];
            }
        }
    }
    *from = result;
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solver::linear::tests::{grid, numbers};

    /// Checks the solution of a linear system with a known solution. The matrix consists of unit masses, and of springs
    /// with random directions and strengths between the bodies of a grid.
    #[test]
    fn a_grid_of_springs_is_solved_to_rounding() {
        let side = 15u32;
        let bodies = side * side;
        let pairs = grid(side);
        let mut elimination = Elimination::default();
        elimination.analyse(bodies as usize, pairs.iter().copied());
        let supernodes = elimination.supernodes.windows(2);
        assert!(
            supernodes
                .map(|ends| ends[0] as usize..ends[1] as usize)
                .any(|places| { places.len() > 2 && elimination.row(places.end - 1).len() > 4 }),
            "one that changes blocks by threes and single ones"
        );
        let mut number = numbers();
        let mut matrix = SymmetricBlockMatrix::<3>::default();
        matrix.clear(&elimination);
        let solution: Vec<[f64; 3]> = (0..bodies).map(|k| [1.0, f64::from(k), -2.0]).collect();
        let mut vector = solution.clone();
        for place in 0..bodies {
            let one = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
            matrix.add_to_diagonal(place, &one);
        }
        for &(i, j) in &pairs {
            let (i, j) = (elimination.place_of[i as usize], elimination.place_of[j as usize]);
            let (a, b) = (i.min(j), i.max(j));
            let (on_a, on_b) = ([(); 3].map(|()| number()), [(); 3].map(|()| number()));
            let stiffness = 10.0 * (1.0 + number());
            let block = |x: &[f64; 3], y: &[f64; 3]| x.map(|x| y.map(|y| stiffness * x * y));
            matrix.add_to_diagonal(a, &block(&on_a, &on_a));
            matrix.add_to_diagonal(b, &block(&on_b, &on_b));
            matrix.add_to_upper(elimination.block(a, b) as u32, &block(&on_a, &on_b));
            let of = |x: &[f64; 3], at: u32| -> f64 {
                x.iter().zip(&solution[at as usize]).map(|(x, v)| x * v).sum()
            };
            let force = stiffness * (of(&on_a, a) + of(&on_b, b));
            for axis in 0..3 {
                vector[a as usize][axis] += force * on_a[axis];
                vector[b as usize][axis] += force * on_b[axis];
            }
        }
        matrix.factorise(&elimination);
        matrix.solve(&elimination, &mut vector);
        for (found, expected) in vector.iter().zip(&solution) {
            for (found, expected) in found.iter().zip(expected) {
                assert!((found - expected).abs() < 1e-11 * (1.0 + expected.abs()));
            }
        }
    }
}
