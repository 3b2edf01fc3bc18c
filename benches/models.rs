//! Benchmark: time that a scene saves because only the physics that it needs is computed.

mod common;

use std::hint::black_box;

use common::timing::{criterion, least_secs};
use slump::scene::{Scene, cradle};
use slump::sim::{Settings, Simulation};
use slump::solver::StopTest;
use slump::world::{Parameters, Physics};

const SMOOTH: Physics = Physics { axes: 2, friction: false, rotation: false, cohesion: true };

/// Returns the scene `cradle` at a moment just before its shock, with the given physics. The collision is head-on, so
/// friction and spin stay 0, and every model takes the same sweeps.
fn cradle_with(physics: Physics) -> Simulation {
    let line = cradle();
    let parameters = Parameters { friction: 0.5, ..line.parameters };
    let mut simulation =
        Scene { physics, parameters, ..line }.simulation().expect("a proper scene");
    while simulation.time_secs() < 1.4 {
        simulation.step().expect("a finite state");
    }
    simulation
}

/// Returns 138 discs at rest with the given physics. Each step takes 50 sweeps.
fn pile_with(physics: Physics) -> Simulation {
    let settled = common::settled(138);
    let world = settled.world().clone();
    let mut settings = *settled.solver();
    (settings.stop, settings.tolerance) = (StopTest::RelativeChange, 1e-15);
    (settings.max_sweeps, settings.warm_start) = (50, false);
    let settings = Settings { solver: settings, ..*settled.settings() };
    Simulation::new(world, physics, settings, 0.0).expect("a proper scene")
}

fn main() {
    const STEPS: usize = 2_000;
    let mut criterion = criterion();
    let mut time = |name: &str, start: &Simulation, steps: usize| {
        let secs = least_secs(&mut criterion, name, || {
            let mut simulation = start.clone();
            for _ in 0..steps {
                black_box(simulation.step().expect("a finite state"));
            }
        });
        1e6 * secs / steps as f64
    };
    let line = time("cradle/line", &cradle_with(cradle().physics), STEPS);
    let smooth = time("cradle/plane without friction", &cradle_with(SMOOTH), STEPS);
    let full = time("cradle/plane, friction, rotation", &cradle_with(Physics::FULL), STEPS);
    let smooth_pile = time("138 discs/without friction", &pile_with(SMOOTH), 20);
    let full_pile = time("138 discs/friction, rotation", &pile_with(Physics::FULL), 20);
    println!("\nleast over all repeats, µs a step:");
    println!(
        "cradle: line {line:.3}, plane without friction {smooth:.3}, full model {full:.3}: \
         the line is {:.2} times as fast as the full model",
        full / line
    );
    println!(
        "138 discs, 50 sweeps: without friction {smooth_pile:.1}, full model {full_pile:.1}: \
         {:.2} times as fast without",
        full_pile / smooth_pile
    );
    criterion.final_summary();
}
