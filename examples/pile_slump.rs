//! Slump of the paper's pile after one second, at two time steps.
//!
//! cargo run --release --example pile_slump

use slump::error::Result;
use slump::scene::built_in;

fn main() -> Result<()> {
    for time_step_secs in [1e-3, 5e-3] {
        let mut scene = built_in("pile")?;
        scene.parameters.bond = 20.0;
        scene.parameters.time_step_secs = time_step_secs;
        let mut simulation = scene.simulation()?;
        simulation.take_steps(scene.parameters.steps_in(scene.duration_secs))?;
        let slump = simulation.observables().slump;
        println!("Bond 20, Δt = {time_step_secs} s: slump {slump:.3}");
    }
    Ok(())
}
