//! Sparse systems of linear equations whose matrix consists of blocks: elimination order and factorisations.

mod block_cholesky;
mod block_lu;
mod elimination;

pub(super) use self::block_cholesky::SymmetricBlockMatrix;
pub(super) use self::block_lu::{Block, BlockMatrix, diagonal, inertias};
pub(super) use self::elimination::{ContactGraph, Elimination};

#[cfg(test)]
mod tests {
    /// Returns the pairs of neighbouring bodies on a square grid with `side` bodies along each side. Bodies are
    /// numbered row by row, from 0.
    pub(super) fn grid(side: u32) -> Vec<(u32, u32)> {
        let neighbours = |k: u32| {
            let right = (k % side + 1 < side).then_some((k, k + 1));
            let up = (k + side < side * side).then_some((k, k + side));
            [right, up].into_iter().flatten()
        };
        (0..side * side).flat_map(neighbours).collect()
    }

    /// Returns a generator of pseudo-random numbers between −½ and ½, with the same sequence in every run.
    pub(super) fn numbers() -> impl FnMut() -> f64 {
        let mut random = 1u64;
        move || {
            random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (random >> 11) as f64 / (1u64 << 53) as f64 - 0.5
        }
    }
}
