//! What a scene saves by computing no more physics than it needs: the same sweeps over the same
//! contacts, with the full model and with leaner ones.

use std::time::Instant;

use super::{Bench, Part};
use crate::error::Result;
use crate::scene::{Scene, cradle, paper_pile};
use crate::sim::Simulation;
use crate::solver::{Method, SolverSettings, StopTest};
use crate::study::chart::{Axis, Cell, Chart, INK, Layer, Rgb, Sheet};
use crate::world::{Parameters, Physics};

const SMOOTH: Physics = Physics { axes: 2, friction: false, rotation: false, cohesion: true };
const UNTURNING: Physics = Physics { axes: 2, friction: true, rotation: false, cohesion: true };

/// One scene with one model.
struct Entry {
    scene: &'static str,
    model: &'static str,
    /// Where the steps that are timed begin.
    start: Simulation,
    steps: u32,
    /// Least time of a step, s.
    secs: f64,
}

pub(super) fn make(bench: &Bench) -> Result<Vec<Part>> {
    let mut entries = Vec::new();
    for (model, physics) in [
        ("plane, friction, rotation", Physics::FULL),
        ("plane alone", SMOOTH),
        ("line", cradle().physics),
    ] {
        entries.push(Entry::new("cradle", model, before_the_shock(physics)?, 2000));
    }
    for (model, physics) in
        [("friction, rotation", Physics::FULL), ("friction alone", UNTURNING), ("neither", SMOOTH)]
    {
        entries.push(Entry::new("pile of 138", model, pile(physics)?, 20));
    }
    let rounds = if bench.quick { 15 } else { 60 };
    // Round by round, so that a slow moment of the machine meets all models alike.
    for _ in 0..rounds {
        for entry in &mut entries {
            entry.time()?;
        }
    }
    Ok(vec![draw(bench, &entries)])
}

/// The cradle from just before the shock on. Head-on, friction and spin stay 0, so every model does
/// the same sweeps.
fn before_the_shock(physics: Physics) -> Result<Simulation> {
    let line = cradle();
    let parameters = Parameters { friction: 0.5, ..line.parameters };
    let mut simulation = Scene { physics, parameters, ..line }.simulation()?;
    while simulation.time_secs() < 1.4 {
        simulation.step()?;
    }
    Ok(simulation)
}

/// The pile at its start. From a cold start to a tolerance that it cannot meet, every step takes all
/// its sweeps.
fn pile(physics: Physics) -> Result<Simulation> {
    let solver = SolverSettings {
        method: Method::Nsgs,
        stop: StopTest::RelativeChange,
        tolerance: 1e-15,
        max_sweeps: 50,
        warm_start: false,
    };
    Scene { physics, solver, ..paper_pile()? }.simulation()
}

impl Entry {
    fn new(scene: &'static str, model: &'static str, start: Simulation, steps: u32) -> Self {
        Self { scene, model, start, steps, secs: f64::INFINITY }
    }

    fn time(&mut self) -> Result<()> {
        let mut simulation = self.start.clone();
        let started = Instant::now();
        for _ in 0..self.steps {
            simulation.step()?;
        }
        self.secs = self.secs.min(started.elapsed().as_secs_f64() / f64::from(self.steps));
        Ok(())
    }
}

fn draw(bench: &Bench, entries: &[Entry]) -> Part {
    let full_of = |scene: &str| {
        entries.iter().find(|entry| entry.scene == scene).map_or(f64::NAN, |entry| entry.secs)
    };
    let mut report =
        "| scene | model | µs a step | times as fast as the full model |\n|---|---|---|---|"
            .to_owned();
    let mut table = String::from("scene,model,secs_per_step,times_as_fast\n");
    let mut cells = Vec::new();
    let mut layers = Vec::new();
    let mut ticks = Vec::new();
    for (index, Entry { scene, model, secs, .. }) in entries.iter().enumerate() {
        let (at, share) = (index as f64, secs / full_of(scene));
        report.push_str(&format!(
            "\n| {scene} | {model} | {:.3} | {:.2} |",
            1e6 * secs,
            1.0 / share
        ));
        table.push_str(&format!("{scene},\"{model}\",{secs:e},{}\n", 1.0 / share));
        cells.push(Cell {
            x: (at, [at - 0.35, at + 0.35]),
            y: (share, [0.0, share]),
            value: share,
        });
        layers.push(Layer::Words {
            at: (at - 0.3, share + 0.05),
            text: format!("{:.2} µs", 1e6 * secs),
            colour: INK,
        });
        layers.push(Layer::Words { at: (at - 0.34, -0.11), text: (*model).into(), colour: INK });
        ticks.push((at, format!("{scene}")));
    }
    let mut x = Axis::linear("", -0.6, entries.len() as f64 - 0.4);
    x.ticks = ticks;
    let y = Axis::linear("time of a step, full model = 1", 0.0, 1.2);
    let mut chart = Chart::new("What a scene's model costs", x, y);
    chart.layers.push(Layer::Cells { name: "time over full model".into(), cells, colour: bar });
    chart.layers.extend(layers);
    let mut sheet = Sheet::of(chart);
    sheet.size = (1500, 760);
    sheet.caption = bench.caption(&[
        "Least time of a step. Cradle: before the shock, to its own tolerance; pile: 50 sweeps of nsgs.",
    ]);
    Part {
        name: "chart-model".into(),
        sheet,
        report,
        tables: vec![("chart-model-times".into(), table)],
    }
}

fn bar(_share: f64) -> Rgb {
    (86, 150, 200)
}
