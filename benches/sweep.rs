//! Benchmark: time of one contact update, time of a step apart from its sweeps, and time per contact of a whole solve,
//! sequentially and by colours (groups of contacts that share no grain).

mod common;

use std::hint::black_box;

use common::timing::{criterion, least_secs};
use criterion::Criterion;
use rayon::{ThreadPool, ThreadPoolBuilder};
use slump::sim::Simulation;
use slump::solver::{
    Memory, Method, Ordering, SolverSettings, SpinningPlane, StopTest, solve, sweep,
};

/// Number of sweeps of every timed step, so that the work is always the same.
const SWEEPS: u32 = 50;

/// Times a solve of the simulation's next contact problem, including set-up, in ns per contact and sweep, and returns
/// one line that summarises the times. The variants are: contacts in the default order, by colours one after the other,
/// by colours in parallel, and by colours in parallel on two threads.
fn by_colours(criterion: &mut Criterion, simulation: &Simulation, count: usize) -> String {
    let one_by_one = SolverSettings {
        method: Method::Nsgs,
        stop: StopTest::RelativeChange,
        tolerance: 0.0,
        max_sweeps: 2 * SWEEPS,
        ..SolverSettings::SWEEPS
    };
    let coloured = SolverSettings { ordering: Ordering::Coloured, ..one_by_one };
    let side_by_side = SolverSettings { method: Method::NsgsParallel, ..one_by_one };
    let mut time = |name: &str, settings: SolverSettings, pool: Option<&ThreadPool>| {
        let mut problem = common::problem(simulation, &settings);
        let mut memory = Memory::default();
        let updates = problem.rows.len() * settings.max_sweeps as usize;
        let mut run = || {
            let report = solve(&mut problem, &mut memory, &settings);
            assert_eq!(black_box(report).sweeps, settings.max_sweeps);
        };
        let name = format!("{name}/{count} discs");
        let secs = match pool {
            Some(pool) => least_secs(criterion, &name, || pool.install(&mut run)),
            None => least_secs(criterion, &name, run),
        };
        1e9 * secs / updates as f64
    };
    let pool = ThreadPoolBuilder::new().num_threads(2).build().expect("threads");
    let plain = time("one by one", one_by_one, None);
    let colours = time("colours, one by one", coloured, None);
    let lanes = time("colours, side by side", side_by_side, None);
    let threads = time("colours, side by side, two threads", side_by_side, Some(&pool));
    format!(
        "{count} discs, ns a contact and sweep of a solve: one by one {plain:.2}, by colours \
         {colours:.2}, side by side {lanes:.2}, on two threads {threads:.2}; nsgs / nsgs-parallel \
         {:.2}, on two threads {:.2}",
        plain / lanes,
        plain / threads
    )
}

fn main() {
    ThreadPoolBuilder::new().num_threads(1).build_global().expect("the first pool");
    let mut criterion = criterion();
    let mut summary = Vec::new();
    for count in [138, 2_000, 10_000] {
        let mut simulation = common::with(&common::settled(count), |numbers| numbers.bond = 20.0);
        let mut settings = *simulation.solver();
        // A cold start and a tolerance that cannot be met make every step take all its sweeps.
        (settings.stop, settings.tolerance) = (StopTest::RelativeChange, 1e-15);
        (settings.max_sweeps, settings.warm_start) = (SWEEPS, false);
        simulation.set_solver(settings).expect("proper settings");
        simulation.step().expect("a finite state");

        let mut problem = common::problem(&simulation, &SolverSettings::SWEEPS);
        let updates = problem.rows.len();
        let of_sweep = least_secs(&mut criterion, &format!("sweep/{count} discs"), || {
            black_box(sweep::<SpinningPlane, false>(&mut problem));
        });
        summary.push(by_colours(&mut criterion, &simulation, count));
        let of_step = least_secs(&mut criterion, &format!("step/{count} discs"), || {
            let sweeps = simulation.step().expect("a finite state").sweeps;
            assert_eq!(black_box(sweeps), SWEEPS);
        });
        let around = of_step - f64::from(SWEEPS) * of_sweep;
        summary.push(format!(
            "{count} discs, {updates} contacts: {:.2} ns a contact update; a step of {SWEEPS} sweeps \
             {:.3} ms, of which outside of plain sweeps {:.0} %",
            1e9 * of_sweep / updates as f64,
            1e3 * of_step,
            100.0 * around / of_step
        ));
    }
    let mut large = common::with(&common::settled(50_000), |numbers| numbers.bond = 20.0);
    large.step().expect("a finite state");
    summary.push(by_colours(&mut criterion, &large, 50_000));
    println!("\nleast over all repeats:\n{}", summary.join("\n"));
    criterion.final_summary();
}
