//! Sparse systems of blocks: the order in which they are eliminated, and their factors.

mod block_cholesky;
mod block_lu;
mod elimination;

pub(super) use self::block_cholesky::SymmetricBlockMatrix;
pub(super) use self::block_lu::{Block, BlockMatrix};
pub(super) use self::elimination::{ContactGraph, Elimination};
