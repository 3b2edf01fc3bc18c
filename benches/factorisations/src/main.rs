//! Benchmark: factorises the matrices of an interior-point method, M + Σ Hᵀ K H over the contacts of recorded piles
//! (masses M, contact stiffnesses K, contact directions H), in four ways: by Slump's block LU (used by `newton`) and
//! block Cholesky (used by `interior-point`), and by the simplicial and supernodal Cholesky of the library faer. Prints
//! one row for each pile and factorisation: counts first, then times.
//!
//! `slump-factorisations pile/csv/contacts.csv …` reads the last frame of recordings that
//! `slump --headless --data pile/ --data-format csv` writes.

mod by_faer;
#[allow(dead_code, reason = "solvers need more of it")]
#[path = "../../../crates/core/src/solver/linear/mod.rs"]
mod linear;
mod matrix;
mod ours;

use std::time::{Duration, Instant};

use matrix::Matrix;

/// Time for which each factorisation is repeated. The shortest time of all repeats counts.
const PATIENCE: Duration = Duration::from_secs(2);

/// Cost of one factorisation of one matrix: size, operations, times and error.
pub struct Told {
    /// Name of the factorisation.
    pub name: &'static str,
    /// Number of stored entries of the factors.
    pub numbers: usize,
    /// Floating-point operations of a factorisation, multiplications and additions counted separately; `None` if
    /// unknown.
    pub flops: Option<f64>,
    /// Time to find the elimination order and the structure of the factors, s.
    pub analysis_secs: f64,
    /// Time to fill in the matrix and to factorise it, s.
    pub factors_secs: f64,
    /// Time to solve for one right-hand side with the factors, s.
    pub solution_secs: f64,
    /// Relative error of the solution x of Ax = b: ‖Ax − b‖ / ‖b‖.
    pub error: f64,
}

/// Returns the shortest time of a call, s, over as many calls as fit into [`PATIENCE`].
pub fn least_secs(mut call: impl FnMut()) -> f64 {
    let (begun, mut least) = (Instant::now(), f64::INFINITY);
    while begun.elapsed() < PATIENCE {
        let begun = Instant::now();
        call();
        least = least.min(begun.elapsed().as_secs_f64());
    }
    least
}

fn main() {
    let paths: Vec<String> = std::env::args().skip(1).collect();
    if paths.is_empty() {
        eprintln!("slump-factorisations: name contacts.csv of recordings, one or more");
        std::process::exit(2);
    }
    println!("bodies,pairs,way,numbers,mflop,analysis_ms,factors_ms,gflop_per_s,solution_ms,error");
    for path in &paths {
        let matrix = match Matrix::read(path) {
            Ok(matrix) => matrix,
            Err(error) => {
                eprintln!("slump-factorisations: {path}: {error}");
                std::process::exit(2);
            }
        };
        let ways = [
            ours::block_lu(&matrix),
            ours::block_cholesky(&matrix),
            by_faer::simplicial(&matrix),
            by_faer::supernodal(&matrix),
        ];
        for told in ways {
            let mflop = told.flops.map_or(String::new(), |flops| format!("{:.2}", 1e-6 * flops));
            let rate = told.flops.map_or(String::new(), |flops| {
                format!("{:.1}", 1e-9 * flops / told.factors_secs)
            });
            println!(
                "{},{},{},{},{mflop},{:.3},{:.3},{rate},{:.3},{:.1e}",
                matrix.bodies,
                matrix.pairs.len(),
                told.name,
                told.numbers,
                1e3 * told.analysis_secs,
                1e3 * told.factors_secs,
                1e3 * told.solution_secs,
                told.error,
            );
        }
    }
}
