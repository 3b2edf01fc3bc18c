//! What a scene saves by computing no more physics than it needs: the same sweeps over the same
//! contacts, with the full model and with leaner ones.

use std::time::Instant;

use super::{Bench, ChartSection};
use crate::chart::{Axis, Chart, INK, Layer, MapCell, Sheet};
use crate::error::Result;
use crate::scene::{Scene, cradle, paper_pile};
use crate::sim::Simulation;
use crate::solver::{Method, SolverSettings, StopTest};
use crate::world::{Parameters, Physics};

const SMOOTH: Physics = Physics { axes: 2, friction: false, rotation: false, cohesion: true };
const UNTURNING: Physics = Physics { axes: 2, friction: true, rotation: false, cohesion: true };

/// One scene with one model.
struct TimedModel {
    scene: &'static str,
    model: &'static str,
    /// Where the steps that are timed begin.
    start: Simulation,
    steps: u32,
    /// Least time of a step, s.
    secs: f64,
}

pub(super) fn make(bench: &Bench) -> Result<Vec<ChartSection>> {
    let all = [
        ("cradle", "friction, rotation", before_the_shock(Physics::FULL)?, 2000),
        ("cradle", "neither", before_the_shock(SMOOTH)?, 2000),
        ("cradle", "line", before_the_shock(cradle().physics)?, 2000),
        ("pile of 138", "friction, rotation", pile(Physics::FULL)?, 20),
        ("pile of 138", "friction alone", pile(UNTURNING)?, 20),
        ("pile of 138", "neither", pile(SMOOTH)?, 20),
    ];
    let secs = f64::INFINITY;
    let mut models =
        all.map(|(scene, model, start, steps)| TimedModel { scene, model, start, steps, secs });
    let rounds = if bench.options.quick { 15 } else { 60 };
    // Round by round, so that a slow moment of the machine meets all models alike.
    for _ in 0..rounds {
        for model in &mut models {
            model.time()?;
        }
    }
    Ok(vec![draw(bench, &models)])
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
        ..SolverSettings::default()
    };
    Scene { physics, solver, ..paper_pile()? }.simulation()
}

impl TimedModel {
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

fn draw(bench: &Bench, models: &[TimedModel]) -> ChartSection {
    let mut report =
        "| scene | model | µs a step | times as fast as the full model |\n|---|---|---|---|"
            .to_owned();
    let mut table = String::from("scene,model,secs_per_step,times_as_fast\n");
    let mut charts = Vec::new();
    for of_scene in models.chunk_by(|one, other| one.scene == other.scene) {
        let (scene, full) = (of_scene[0].scene, of_scene[0].secs);
        let mut x = Axis::linear("", -0.6, of_scene.len() as f64 - 0.4);
        let y = Axis::linear("time of a step, full model = 1", 0.0, 1.2);
        let mut cells = Vec::new();
        let mut words = Vec::new();
        for (index, TimedModel { model, secs, .. }) in of_scene.iter().enumerate() {
            let (at, share, micros) = (index as f64, secs / full, 1e6 * secs);
            report.push_str(&format!("\n| {scene} | {model} | {micros:.3} | {:.2} |", 1.0 / share));
            table.push_str(&format!("{scene},\"{model}\",{secs:e},{}\n", 1.0 / share));
            let edges = [at - 0.35, at + 0.35];
            cells.push(MapCell { x: (at, edges), y: (share, [0.0, share]), value: share });
            let text = format!("{share:.2}  ({micros:.3} µs)");
            words.push(Layer::Words { at: (at - 0.3, share + 0.06), text, colour: INK });
            x.ticks.push((at, (*model).to_owned()));
        }
        let mut chart = Chart::new(scene, x, y);
        let colour = |_share: f64| (86, 150, 200);
        chart.layers.push(Layer::Cells { name: "time over full model".into(), cells, colour });
        chart.layers.extend(words);
        charts.push(chart);
    }
    let caption = bench.caption(&[
        "Least time of a step. Cradle: from before its shock on, to its own tolerance; pile: 50 sweeps of nsgs.",
    ]);
    let sheet = Sheet { size: (1800, 760), charts, caption };
    let tables = vec![("chart-model-times".into(), table)];
    ChartSection { name: "chart-model".into(), sheet, report, tables }
}
