//! A sparse symmetric factorisation of D × D blocks, one row and column of blocks a body.
//!
//! With U_ab the block of places a < b and D_k what is left of a diagonal block when its turn comes,
//! eliminating place k makes
//!
//! > D_k = L_k L_kᵀ,  W_kb = L_k⁻¹ U_kb,  U_ab ← U_ab − W_kaᵀ W_kb for all later neighbours a ≤ b of k,
//!
//! and A = WᵀW in the end, W having L_kᵀ on its diagonal. That is half the work and half the memory of the
//! unsymmetric factors, and a positive definite matrix needs no pivoting. Diagonal blocks are factorised and not
//! inverted: one that is stiff along one direction and soft along another loses half of all digits in an
//! inverse.

use super::block_lu::Block;
use super::elimination::Elimination;

/// Rows of a block are as long as a vector register, so that a row is one operation.
const WIDTH: usize = 4;

/// A block whose columns from D on are 0.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
struct Padded<const D: usize>([[f64; WIDTH]; D]);

impl<const D: usize> Padded<D> {
    const ZERO: Self = Self([[0.0; WIDTH]; D]);
}

/// A symmetric matrix, then its factors. Memory is kept between matrices.
#[derive(Clone, Debug, Default)]
pub(crate) struct SymmetricBlockMatrix<const D: usize> {
    /// Diagonal blocks by place; then L_k, with the inverses of its diagonal entries.
    diagonal: Vec<Padded<D>>,
    /// Block (a, b) for each pair a < b of neighbours, numbered as in [`Elimination::later`].
    upper: Vec<Padded<D>>,
}

impl<const D: usize> SymmetricBlockMatrix<D> {
    /// A zero matrix of the given structure.
    pub(crate) fn clear(&mut self, elimination: &Elimination) {
        self.diagonal.clear();
        self.diagonal.resize(elimination.body_at.len(), Padded::ZERO);
        self.upper.clear();
        self.upper.resize(elimination.later.len(), Padded::ZERO);
    }

    /// Adds to the diagonal block of a place.
    #[inline(always)]
    pub(crate) fn add_to_diagonal(&mut self, place: u32, block: &Block<D>) {
        add(&mut self.diagonal[place as usize], block);
    }

    /// Adds to the block of two places that are neighbours, `number` being the index of the later one among
    /// [`Elimination::later`]; its rows are those of the earlier place.
    #[inline(always)]
    pub(crate) fn add_to_upper(&mut self, number: u32, block: &Block<D>) {
        add(&mut self.upper[number as usize], block);
    }

    /// Factorises in place.
    pub(crate) fn factorise(&mut self, elimination: &Elimination) {
        #[cfg(target_arch = "x86_64")]
        if std::arch::is_x86_feature_detected!("avx") {
            // SAFETY: the processor has just been asked.
            unsafe { self.factorise_with_avx(elimination) };
            return;
        }
        self.factorise_each(elimination);
    }

    /// The same operations in the same order, and so bitwise the same result, four at a time.
    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx")]
    fn factorise_with_avx(&mut self, elimination: &Elimination) {
        self.factorise_each(elimination);
    }

    #[inline(always)]
    fn factorise_each(&mut self, elimination: &Elimination) {
        let Self { diagonal, upper } = self;
        let mut targets = &elimination.targets[..];
        for place in 0..diagonal.len() {
            let factor = cholesky(&diagonal[place]);
            diagonal[place] = factor;
            let range = elimination.starts[place] as usize..elimination.starts[place + 1] as usize;
            for block in &mut upper[range.clone()] {
                solve_lower(&factor, block);
            }
            for first in range.clone() {
                let of_first = upper[first];
                subtract_product(
                    &mut diagonal[elimination.later[first] as usize],
                    &of_first,
                    &of_first,
                );
                let others = first + 1..range.end;
                // There is a target for every pair, in this very order.
                let (of_these, rest) = targets.split_at(others.len());
                targets = rest;
                for (second, &target) in others.zip(of_these) {
                    let of_second = upper[second];
                    subtract_product(&mut upper[target as usize], &of_first, &of_second);
                }
            }
        }
    }

    /// Solves with the factors: `vector` (by place) is the right-hand side and becomes the solution.
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
            for edge in elimination.starts[place] as usize..elimination.starts[place + 1] as usize {
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
            for edge in elimination.starts[place] as usize..elimination.starts[place + 1] as usize {
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

#[inline(always)]
fn add<const D: usize>(to: &mut Padded<D>, block: &Block<D>) {
    for (entries, numbers) in to.0.iter_mut().zip(block) {
        for (entry, number) in entries.iter_mut().zip(numbers) {
            *entry += number;
        }
    }
}

/// L with D = L Lᵀ, the inverses of its diagonal entries on its diagonal.
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

/// L⁻¹ of a block.
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

/// from − aᵀb.
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

    /// Springs of random directions and strengths between the bodies of a grid, and unit masses.
    #[test]
    fn a_grid_of_springs_is_solved_to_rounding() {
        let side = 7u32;
        let bodies = side * side;
        let pairs: Vec<(u32, u32)> = (0..bodies)
            .flat_map(|k| {
                let right = (k % side + 1 < side).then_some((k, k + 1));
                let up = (k + side < bodies).then_some((k, k + side));
                [right, up].into_iter().flatten()
            })
            .collect();
        let mut elimination = Elimination::default();
        elimination.analyse(bodies as usize, pairs.iter().copied());
        let mut random = 1u64;
        let mut number = || {
            random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (random >> 11) as f64 / (1u64 << 53) as f64 - 0.5
        };
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
