//! Slump's own factorisations: block LU and block Cholesky.

use crate::linear::{Block, BlockMatrix, Elimination, SymmetricBlockMatrix};
use crate::matrix::Matrix;
use crate::{Told, least_secs};

/// Times the unsymmetric block LU factorisation, which the solver `newton` uses.
pub fn block_lu(matrix: &Matrix) -> Told {
    let mut factors = BlockMatrix::<3>::default();
    let put = |factors: &mut BlockMatrix<3>, elimination: &Elimination, edges: &[u32]| {
        factors.clear(elimination);
        for (body, block) in matrix.diagonal.iter().enumerate() {
            *factors.diagonal_mut(elimination.place_of[body]) = *block;
        }
        for ((&(i, j), block), &edge) in matrix.pairs.iter().zip(&matrix.off_diagonal).zip(edges) {
            let [i, j] = [i, j].map(|body| elimination.place_of[body as usize]);
            let (ij, ji) = factors.off_diagonal_mut(edge, i < j);
            (*ij, *ji) = (*block, transposed(block));
        }
    };
    let told = tell(matrix, |elimination, edges, vector| match vector {
        None => {
            put(&mut factors, elimination, edges);
            factors.factorise(elimination);
        }
        Some(vector) => factors.solve(elimination, vector),
    });
    // Unlike the symmetric factorisation, LU stores both triangles and computes every product twice.
    Told {
        name: "block LU",
        numbers: 2 * told.numbers,
        flops: told.flops.map(|it| 2.0 * it),
        ..told
    }
}

/// Times the symmetric block Cholesky factorisation, which the solver `interior-point` uses.
pub fn block_cholesky(matrix: &Matrix) -> Told {
    let mut factors = SymmetricBlockMatrix::<3>::default();
    tell(matrix, |elimination, edges, vector| match vector {
        None => {
            factors.clear(elimination);
            for (body, block) in matrix.diagonal.iter().enumerate() {
                factors.add_to_diagonal(elimination.place_of[body], block);
            }
            for ((&(i, j), block), &edge) in
                matrix.pairs.iter().zip(&matrix.off_diagonal).zip(edges)
            {
                let [i, j] = [i, j].map(|body| elimination.place_of[body as usize]);
                let block = if i < j { *block } else { transposed(block) };
                factors.add_to_upper(edge, &block);
            }
            factors.factorise(elimination);
        }
        Some(vector) => factors.solve(elimination, vector),
    })
}

/// Times the calls of `act`: without a vector `act` factorises the matrix, with a vector it solves for this vector.
fn tell(
    matrix: &Matrix,
    mut act: impl FnMut(&Elimination, &[u32], Option<&mut [[f64; 3]]>),
) -> Told {
    let mut elimination = Elimination::default();
    let analysis_secs = least_secs(|| {
        elimination.analyse(matrix.bodies, matrix.pairs.iter().copied());
    });
    let edge = |&(i, j): &(u32, u32)| {
        let [i, j] = [i, j].map(|body| elimination.place_of[body as usize]);
        elimination.block(i.min(j), i.max(j)) as u32
    };
    let edges: Vec<u32> = matrix.pairs.iter().map(edge).collect();
    let factors_secs = least_secs(|| act(&elimination, &edges, None));
    let mut vector = vec![[0.0; 3]; matrix.bodies];
    let mut solve = || {
        for (place, &body) in elimination.body_at.iter().enumerate() {
            vector[place] = matrix.right_side[body as usize];
        }
        act(&elimination, &edges, Some(&mut vector));
    };
    let solution_secs = least_secs(&mut solve);
    let place = |body: usize| elimination.place_of[body] as usize;
    let solution: Vec<_> = (0..matrix.bodies).map(|body| vector[place(body)]).collect();
    // The product of two blocks and its addition to a third block are 54 operations, and half as many on a diagonal
    // block.
    let (edges, products) = (elimination.later.len() as f64, elimination.targets.len() as f64);
    Told {
        name: "block Cholesky",
        numbers: 9 * elimination.later.len() + 6 * matrix.bodies,
        flops: Some(54.0 * products + 27.0 * edges + 27.0 * edges),
        analysis_secs,
        factors_secs,
        solution_secs,
        error: matrix.error(&solution),
    }
}

fn transposed(block: &Block<3>) -> Block<3> {
    std::array::from_fn(|row| std::array::from_fn(|column| block[column][row]))
}
