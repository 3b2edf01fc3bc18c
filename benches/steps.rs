//! Benchmark: time of whole steps, from detection to the new state, with a fixed number of sweeps. The solvers are
//! `nsgs` (sequential) and `nsgs-parallel` (by tiles), on one thread and on two, with two stop criteria.

mod common;

use std::hint::black_box;

use common::timing::{criterion, least_secs};
use rayon::ThreadPoolBuilder;
use slump::solver::{Method, SolverSettings, StopTest};

/// Number of sweeps of every timed step.
const SWEEPS: u32 = 40;

/// Numbers of discs, unless the environment variable gives other numbers: `SLUMP_DISCS=100000,1000000 cargo bench
/// --bench steps`.
const DISCS: [usize; 3] = [2_000, 10_000, 50_000];

fn main() {
    ThreadPoolBuilder::new().num_threads(2).build_global().expect("the first pool");
    let named = std::env::var("SLUMP_DISCS").ok();
    let counts: Vec<usize> = match &named {
        Some(text) => text.split(',').map(|count| count.parse().expect("a number")).collect(),
        None => DISCS.to_vec(),
    };
    // A step inside a thread pool counts as one of several simulations, so it stays on its thread.
    let alone = ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
    let mut criterion = criterion();
    let mut summary = Vec::new();
    for count in counts {
        let settled = common::with(&common::settled(count), |numbers| numbers.bond = 20.0);
        for stop in [StopTest::RelativeChange, StopTest::Residual] {
            let mut time = |method: Method, threads: usize| {
                let mut simulation = settled.clone();
                // A cold start and a tolerance that cannot be met make every step take all its sweeps.
                let settings = SolverSettings {
                    method,
                    stop,
                    tolerance: 1e-15,
                    max_sweeps: SWEEPS,
                    warm_start: false,
                    ..*simulation.solver()
                };
                simulation.set_solver(settings).expect("proper settings");
                simulation.step().expect("a finite state");
                let mut step = || {
                    let sweeps = simulation.step().expect("a finite state").sweeps;
                    assert_eq!(black_box(sweeps), SWEEPS);
                };
                let name = format!("{} on {threads}/{count} discs, {stop:?}", method.name());
                1e3 * match threads {
                    1 => least_secs(&mut criterion, &name, || alone.install(&mut step)),
                    _ => least_secs(&mut criterion, &name, step),
                }
            };
            let plain = time(Method::Nsgs, 1);
            let tiles = time(Method::NsgsParallel, 1);
            let threads = time(Method::NsgsParallel, 2);
            summary.push(format!(
                "{count} discs, {stop:?}: ms a step of {SWEEPS} sweeps: nsgs {plain:.3}, nsgs-parallel \
                 {tiles:.3}, on two threads {threads:.3}; nsgs / nsgs-parallel {:.2}, two threads / one {:.2}",
                plain / tiles,
                tiles / threads
            ));
        }
    }
    println!("\nleast over all repeats:\n{}", summary.join("\n"));
    criterion.final_summary();
}
