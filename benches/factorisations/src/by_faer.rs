//! Factorisations by the library faer, on one thread, in faer's own elimination order (minimum degree).

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymmetricOrdering, factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMat, Triplet};
use faer::{Conj, Mat, Par, Side};

use crate::matrix::Matrix;
use crate::{Told, least_secs};

/// Times the simplicial Cholesky factorisation, which factorises one column at a time.
pub fn simplicial(matrix: &Matrix) -> Told {
    tell("faer simplicial", matrix, SupernodalThreshold::FORCE_SIMPLICIAL)
}

/// Times the supernodal Cholesky factorisation, which factorises columns of similar structure together.
pub fn supernodal(matrix: &Matrix) -> Told {
    tell("faer supernodal", matrix, SupernodalThreshold::FORCE_SUPERNODAL)
}

fn tell(name: &'static str, matrix: &Matrix, threshold: SupernodalThreshold) -> Told {
    let lower = lower(matrix);
    let parameters = CholeskySymbolicParams {
        supernodal_flop_ratio_threshold: threshold,
        ..CholeskySymbolicParams::default()
    };
    let analyse = || {
        let order = SymmetricOrdering::Amd;
        factorize_symbolic_cholesky(lower.symbolic(), Side::Lower, order, parameters)
            .expect("memory for the structure")
    };
    let analysis_secs = least_secs(|| drop(analyse()));
    let symbolic = analyse();
    let mut numbers = vec![0.0; symbolic.len_val()];
    let stack = symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Default::default());
    let mut memory = MemBuffer::new(stack.or(symbolic.solve_in_place_scratch::<f64>(1, Par::Seq)));
    let factors_secs = least_secs(|| {
        let stack = MemStack::new(&mut memory);
        symbolic
            .factorize_numeric_llt(
                &mut numbers,
                lower.as_ref(),
                Side::Lower,
                Default::default(),
                Par::Seq,
                stack,
                Default::default(),
            )
            .expect("the matrix is positive definite");
    });
    let factors = LltRef::<'_, usize, f64>::new(&symbolic, &numbers);
    let right_side = Mat::from_fn(3 * matrix.bodies, 1, |at, _| matrix.right_side[at / 3][at % 3]);
    let mut solution = right_side.clone();
    let solution_secs = least_secs(|| {
        solution.copy_from(&right_side);
        let stack = MemStack::new(&mut memory);
        factors.solve_in_place_with_conj(Conj::No, solution.as_mut(), Par::Seq, stack);
    });
    let of_body = |body| std::array::from_fn(|axis| solution[(3 * body + axis, 0)]);
    let solution: Vec<[f64; 3]> = (0..matrix.bodies).map(of_body).collect();
    let error = matrix.error(&solution);
    let numbers = symbolic.len_val();
    Told { name, numbers, flops: None, analysis_secs, factors_secs, solution_secs, error }
}

fn lower(matrix: &Matrix) -> SparseColMat<usize, f64> {
    let mut entries = Vec::new();
    for (body, block) in matrix.diagonal.iter().enumerate() {
        for row in 0..3 {
            for column in 0..=row {
                entries.push(Triplet::new(3 * body + row, 3 * body + column, block[row][column]));
            }
        }
    }
    for (&(i, j), block) in matrix.pairs.iter().zip(&matrix.off_diagonal) {
        // The lower triangle is stored, and the rows of the later body are the lower rows.
        for (column, entries_of_row) in block.iter().enumerate() {
            for (row, &entry) in entries_of_row.iter().enumerate() {
                entries.push(Triplet::new(3 * j as usize + row, 3 * i as usize + column, entry));
            }
        }
    }
    let size = 3 * matrix.bodies;
    SparseColMat::try_new_from_triplets(size, size, &entries).expect("entries within the matrix")
}
