//! One step of a falling pile, solved by two methods, with their costs for the same residual.
//!
//! cargo run --release --example two_methods

use slump::contact::ContactList;
use slump::error::Result;
use slump::scene::built_in;
use slump::sim::ProblemVisitor;
use slump::solver::{
    Memory, Method, Model, SolverSettings, StepProblem, StopTest, residual, solve,
};

/// Solves a problem with these settings and reports the cost.
struct Solve(SolverSettings);

impl ProblemVisitor for Solve {
    type Output = String;

    fn visit<M: Model>(self, problem: &mut StepProblem<M>, _: &ContactList) -> String {
        let report = solve(problem, &mut Memory::default(), &self.0);
        format!(
            "{:8} {:5} sweeps, {:2} factorisations, residual {:.1e}",
            self.0.method,
            report.sweeps,
            report.factorisations,
            residual(problem)
        )
    }
}

fn main() -> Result<()> {
    let scene = built_in("pile")?;
    let mut simulation = scene.simulation()?;
    simulation.take_steps(50)?;
    for method in [Method::Nsgs, Method::Newton] {
        let settings = SolverSettings {
            method,
            stop: StopTest::Residual,
            tolerance: 1e-6,
            max_sweeps: 20_000,
            ..SolverSettings::SWEEPS
        };
        println!("{}", simulation.next_problem(Solve(settings)));
    }
    Ok(())
}
