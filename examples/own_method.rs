//! A user-defined solver: over-relaxed Gauss–Seidel, s ← s + ω (G(s) − s), compared with plain sweeps.
//!
//! cargo run --release --example own_method

use slump::error::Result;
use slump::scene::built_in;
use slump::sim::{Advance, Settings, Stage, StepResult};
use slump::solver::{ContactSystem, Model, SolveReport};

/// Sweeps with relaxation factor ω, repeated until a residual is reached.
struct OverRelaxed {
    factor: f64,
    residual: f64,
    /// Number of sweeps over all steps.
    sweeps: u64,
}

impl Advance for OverRelaxed {
    fn advance<M: Model>(&mut self, stage: &mut Stage<'_, M>, settings: &Settings) -> StepResult {
        let parameters = settings.parameters;
        let gravity = stage.world().gravity.magnitude();
        stage.prepare(settings, |approach| {
            parameters.restitution_velocity(approach.velocity, gravity)
        });
        let mut system = stage.system();
        let (mut before, mut after) = (Vec::new(), Vec::new());
        let mut report = SolveReport::default();
        while !report.converged && report.sweeps < 5_000 {
            system.read(&mut before);
            system.sweep();
            report.sweeps += 1;
            report.converged = system.residual() <= self.residual;
            if report.converged {
                break;
            }
            system.read(&mut after);
            for (after, before) in after.iter_mut().zip(&before) {
                *after = [0, 1].map(|k| before[k] + self.factor * (after[k] - before[k]));
            }
            system.write(&after);
        }
        self.sweeps += u64::from(report.sweeps);
        stage.move_by(report, settings)
    }
}

fn main() -> Result<()> {
    let scene = built_in("column")?;
    for factor in [1.0, 1.3, 1.6] {
        let mut method = OverRelaxed { factor, residual: 1e-6, sweeps: 0 };
        let mut simulation = scene.simulation()?;
        for _ in 0..50 {
            simulation.step_by(&mut method)?;
        }
        println!("ω = {factor}: {} sweeps for 50 steps", method.sweeps);
    }
    Ok(())
}
