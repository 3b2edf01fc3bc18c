//! Blocks of a symmetric matrix as its factorisation has them, and what it does with them.

use super::block_lu::Block;

/// Rows of a block are as long as a vector register, so that a row is one operation.
const WIDTH: usize = 4;

/// A block whose columns from D on are 0.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub(super) struct Padded<const D: usize>(pub [[f64; WIDTH]; D]);

impl<const D: usize> Padded<D> {
    pub(super) const ZERO: Self = Self([[0.0; WIDTH]; D]);
}

#[inline(always)]
pub(super) fn add<const D: usize>(to: &mut Padded<D>, block: &Block<D>) {
    for (entries, numbers) in to.0.iter_mut().zip(block) {
        for (entry, number) in entries.iter_mut().zip(numbers) {
            *entry += number;
        }
    }
}

/// L with D = L Lᵀ, the inverses of its diagonal entries on its diagonal.
#[inline(always)]
pub(super) fn cholesky<const D: usize>(block: &Padded<D>) -> Padded<D> {
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
pub(super) fn solve_lower<const D: usize>(factor: &Padded<D>, block: &mut Padded<D>) {
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

/// left − Σ aᵀb, for each `left` with its own b.
#[inline(always)]
pub(super) fn less_products<const D: usize, const N: usize>(
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

/// from − aᵀb.
#[inline(always)]
pub(super) fn subtract_product<const D: usize>(from: &mut Padded<D>, a: &Padded<D>, b: &Padded<D>) {
    let mut result = *from;
    for (factors, entries) in a.0.iter().zip(&b.0) {
        for (to, factor) in result.0.iter_mut().zip(factors) {
            for column in 0..WIDTH {
                // Rounded once, on every processor alike: those that have no such operation take far longer.
                to[column] = (-factor).mul_add(entries[column], to[column]);
            }
        }
    }
    *from = result;
}
