//! What one contact update costs, and what a step costs around its sweeps.

mod common;

use std::hint::black_box;

use common::timing::{criterion, least_secs};
use slump::solver::{SolverSettings, SpinningPlane, StepModel, StepProblem, StopTest, sweep};

type Full = StepModel<SpinningPlane, true, false>;

/// Sweeps of every step that is timed: a fixed amount of work.
const SWEEPS: u32 = 50;

fn main() {
    let mut criterion = criterion();
    let mut summary = Vec::new();
    for count in [138, 2_000, 10_000] {
        let mut simulation = common::with(&common::settled(count), |numbers| numbers.bond = 20.0);
        let mut settings = *simulation.solver();
        // From a cold start to a tolerance that it cannot meet, every step takes all its sweeps.
        (settings.stop, settings.tolerance) = (StopTest::RelativeChange, 1e-15);
        (settings.max_sweeps, settings.warm_start) = (SWEEPS, false);
        simulation.set_solver(settings).expect("proper settings");
        simulation.step().expect("a finite state");

        let (world, contacts) = (simulation.world(), simulation.contacts());
        let warm = SolverSettings::default();
        let mut problem = StepProblem::<SpinningPlane>::default();
        problem.prepare::<Full>(world, contacts, simulation.parameters(), true, &warm);
        let updates = problem.contact_of_row.len();
        let of_sweep = least_secs(&mut criterion, &format!("sweep/{count} discs"), || {
            black_box(sweep::<Full, false>(&mut problem));
        });
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
    println!("\nleast over all repeats:\n{}", summary.join("\n"));
    criterion.final_summary();
}
