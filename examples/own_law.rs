//! A user-defined contact law: grains whose restitution decreases with the impact speed, like viscoelastic spheres.
//!
//! cargo run --release --example own_law

use slump::error::Result;
use slump::scene::built_in;
use slump::sim::{Advance, Settings, Stage, StepResult};
use slump::solver::{Approach, Model};

/// e(v) = 1/(1 + (v/v₀)^⅕).
struct Viscoelastic {
    /// v₀, m/s: the impact speed at which e = ½.
    half_speed: f64,
}

impl Viscoelastic {
    fn restitution(&self, speed: f64) -> f64 {
        1.0 / (1.0 + (speed / self.half_speed).powf(0.2))
    }
}

impl Advance for Viscoelastic {
    fn advance<M: Model>(&mut self, stage: &mut Stage<'_, M>, settings: &Settings) -> StepResult {
        // Velocity that the law adds to the normal velocity of a contact: e times the velocity before the step.
        stage.prepare(settings, |Approach { velocity, .. }| {
            self.restitution(velocity.abs()) * velocity
        });
        let report = stage.solve(settings);
        stage.move_by(report, settings)
    }
}

fn main() -> Result<()> {
    let mut scene = built_in("collision")?;
    scene.parameters.bond = 0.0;
    let mut simulation = scene.simulation()?;
    let mut law = Viscoelastic { half_speed: 1.0 };
    let mut fastest = 0f64;
    for _ in 0..scene.parameters.steps_in(scene.duration_secs) {
        let before = simulation.world().grains.velocities[0].x;
        simulation.step_by(&mut law)?;
        let after = simulation.world().grains.velocities[0].x;
        fastest = fastest.max(-before);
        if before < 0.0 && after > 0.0 {
            println!("falls with {:.3} m/s and leaves with {after:.3} m/s", -before);
            println!(
                "restitution {:.3}, the law says {:.3}",
                -after / before,
                law.restitution(-before)
            );
            return Ok(());
        }
    }
    println!("it never bounced; the fastest fall was {fastest:.3} m/s");
    Ok(())
}
