//! Panel: how long methods take to solve the step that is shown how well. Each solves it to one tolerance after the other,
//! on a thread of its own.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::Instant;

use egui::{Color32, RichText, Ui};
use egui_plot::{GridMark, Line, LineStyle, MarkerShape, PlotPoints, Points};

use crate::app::opening::TakenRun;
use crate::app::plots::still_plot;
use crate::app::state::AppState;
use crate::app::theme;
use crate::sim::{Settings, Simulation};
use crate::solver::{Fallback, METHODS, Method, SolverSettings, StopTest};

/// Tolerances of the residual, from loose to tight.
const TOLERANCES: [f64; 8] = [1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8];
/// A method that takes longer for a step, s, has no tighter one.
const LIMIT_SECS: f64 = 0.25;
/// Times a step is taken, of which the shortest counts.
const REPEATS: usize = 3;
const MOST_SWEEPS: u32 = 20_000;

/// What a method came to.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct RaceCurve {
    /// Its name.
    pub method: &'static str,
    /// Time of the step (ms) and its residual, from loose to tight.
    pub points: Vec<[f64; 2]>,
}

/// A race on one step.
pub(crate) struct StepRace {
    /// The step that they solve: simulated time, s.
    pub time_secs: f64,
    /// Those that have come to their end.
    pub curves: Vec<RaceCurve>,
    /// Whether all have.
    pub is_over: bool,
    news: Receiver<RaceCurve>,
    is_cancelled: Arc<AtomicBool>,
}

impl StepRace {
    /// Begins with the step that follows the moment of a run that is on its way.
    pub(crate) fn start(run: Receiver<TakenRun>, time_secs: f64, context: egui::Context) -> Self {
        let (sender, news) = channel();
        let is_cancelled = Arc::new(AtomicBool::new(false));
        let cancelled = Arc::clone(&is_cancelled);
        std::thread::spawn(move || {
            if let Ok(TakenRun { world, .. }) = run.recv() {
                race(&world.simulation, &sender, &cancelled, &context);
            }
            drop(sender);
            context.request_repaint();
        });
        Self { time_secs, curves: Vec::new(), is_over: false, news, is_cancelled }
    }

    /// Takes in what has come.
    pub(crate) fn look(&mut self) {
        loop {
            match self.news.try_recv() {
                Ok(curve) => self.curves.push(curve),
                Err(std::sync::mpsc::TryRecvError::Empty) => return,
                Err(std::sync::mpsc::TryRecvError::Disconnected) => {
                    self.is_over = true;
                    return;
                }
            }
        }
    }
}

impl Drop for StepRace {
    fn drop(&mut self) {
        self.is_cancelled.store(true, Ordering::Relaxed);
    }
}

fn race(
    simulation: &Simulation,
    news: &Sender<RaceCurve>,
    is_cancelled: &AtomicBool,
    context: &egui::Context,
) {
    for info in &METHODS {
        let mut points = Vec::new();
        for tolerance in TOLERANCES {
            let point = timed(simulation, info.method, tolerance, is_cancelled);
            let Some([ms, residual]) = point else { break };
            // A method that comes no further has nothing more to show.
            if points.last().is_none_or(|&[_, before]: &[f64; 2]| residual < before) {
                points.push([ms, residual]);
            }
            if ms > 1e3 * LIMIT_SECS {
                break;
            }
        }
        if is_cancelled.load(Ordering::Relaxed) {
            return;
        }
        if !points.is_empty() && news.send(RaceCurve { method: info.name, points }).is_err() {
            return;
        }
        context.request_repaint();
    }
}

/// The least time of the step, ms, and its residual; nothing where it cannot be taken so.
fn timed(
    simulation: &Simulation,
    method: Method,
    tolerance: f64,
    is_cancelled: &AtomicBool,
) -> Option<[f64; 2]> {
    let before = *simulation.settings();
    let solver = SolverSettings {
        stop: StopTest::Residual,
        tolerance,
        max_sweeps: MOST_SWEEPS,
        fallback: Fallback::None,
        ..before.solver.by(method)
    };
    let mut least = [f64::INFINITY, f64::NAN];
    for _ in 0..REPEATS {
        if is_cancelled.load(Ordering::Relaxed) {
            return None;
        }
        let mut copy = simulation.clone();
        copy.change(Settings { solver, ..before }).ok()?;
        let begun = Instant::now();
        let residual = copy.step().ok()?.residual;
        let ms = 1e3 * begun.elapsed().as_secs_f64();
        least = [least[0].min(ms), residual];
        if ms > 1e3 * LIMIT_SECS {
            break;
        }
    }
    (least[1] > 0.0 && least[1].is_finite()).then_some(least)
}

/// Height of the plot, points.
const HEIGHT: f32 = 230.0;
/// Colours before dashes tell curves apart.
const COLOURS: usize = 6;

/// Shows the panel.
pub(crate) fn show(ui: &mut Ui, state: &mut AppState) {
    measure(ui, state);
    if let Some(race) = &state.race {
        draw(ui, &race.curves, now(state, race));
        legend(ui, &race.curves);
        let how = if race.is_over { "measured here" } else { "being measured" };
        let text = format!(
            "The step that follows t = {:.4} s, {how}; ◆ is the present method.",
            race.time_secs
        );
        ui.label(RichText::new(text).small().weak());
    }
    readings(ui, state);
}

/// The button that measures the step that is shown.
fn measure(ui: &mut Ui, state: &mut AppState) {
    if let Some(race) = &mut state.race {
        race.look();
    }
    let is_under_way = state.race.as_ref().is_some_and(|race| !race.is_over);
    let can = state.world().is_some_and(|world| {
        world.failure.is_none() && world.controls.settings.stepper.uses_method()
    });
    ui.horizontal(|ui| {
        let button = ui.add_enabled(can && !is_under_way, egui::Button::new("Measure this step"));
        let hint = "Each method solves the step that is shown, to one tolerance after the other: some seconds.";
        let button = button.on_hover_text(hint);
        if button.on_disabled_hover_text("There is no method to measure, or it is being done.").clicked() {
            let time_secs = state.world().map_or(0.0, |world| world.snapshot.observables.time_secs);
            let run = state.take_run();
            state.race = Some(StepRace::start(run, time_secs, ui.ctx().clone()));
        }
        if is_under_way {
            ui.spinner();
        }
    });
}

/// Where the present method is on the chart of its own step: the run's own mean time, once it is at that step.
fn now(state: &AppState, race: &StepRace) -> Option<[f64; 2]> {
    let world = state.world()?;
    let row = &world.snapshot.observables;
    let is_of_step = (row.time_secs - race.time_secs).abs() < 2.0 * row.time_step_secs;
    let told = is_of_step && world.step_ms > 0.0 && row.residual > 0.0;
    told.then(|| [world.step_ms.log10(), row.residual.log10()])
}

fn draw(ui: &mut Ui, curves: &[RaceCurve], now: Option<[f64; 2]>) {
    let dark = ui.visuals().dark_mode;
    ui.label(RichText::new("residual against ms a step").small());
    still_plot(ui, "speed and accuracy", HEIGHT)
        .x_grid_spacer(|grid| decades(grid.bounds))
        .y_grid_spacer(|grid| decades(grid.bounds))
        .x_axis_formatter(|mark, _| power_of_ten(mark.value))
        .y_axis_formatter(|mark, _| power_of_ten(mark.value))
        .show(ui, |plot| {
            for (index, curve) in curves.iter().enumerate() {
                let (colour, style) = look(index, dark);
                let points = curve.points.iter().map(|point| point.map(f64::log10));
                let places: PlotPoints<'_> = points.collect();
                plot.line(Line::new("", places).color(colour).style(style).width(1.6));
            }
            if let Some(place) = now {
                let ink = if dark { Color32::WHITE } else { Color32::BLACK };
                let dot = Points::new("now", PlotPoints::new(vec![place]));
                plot.points(dot.shape(MarkerShape::Diamond).radius(6.0).color(ink));
            }
        });
}

/// Colour and stroke of a curve, which no other one has.
fn look(index: usize, dark: bool) -> (Color32, LineStyle) {
    let style = match index / COLOURS {
        0 => LineStyle::Solid,
        1 => LineStyle::dashed_loose(),
        _ => LineStyle::dotted_dense(),
    };
    (theme::world_colour(index % COLOURS, dark), style)
}

/// What colours and strokes mean, below the chart, of which it hides nothing.
fn legend(ui: &mut Ui, curves: &[RaceCurve]) {
    let dark = ui.visuals().dark_mode;
    ui.horizontal_wrapped(|ui| {
        for (index, curve) in curves.iter().enumerate() {
            let (colour, _) = look(index, dark);
            let stroke = ["━", "╍", "┉"][(index / COLOURS).min(2)];
            ui.spacing_mut().item_spacing.x = 3.0;
            ui.label(RichText::new(stroke).color(colour));
            ui.label(RichText::new(curve.method).small());
            ui.add_space(6.0);
        }
    });
}

/// How long the steps of the worlds take, and how well they are solved.
fn readings(ui: &mut Ui, state: &AppState) {
    let mut is_told = false;
    for (index, world) in state.frame.worlds.iter().enumerate() {
        let (ms, residual) = (world.step_ms, world.snapshot.observables.residual);
        if ms > 0.0 && residual > 0.0 {
            let name = super::compare::title(state, index);
            ui.label(format!("{name}: {ms:.3} ms a step, residual {residual:.1e}"));
            is_told = true;
        }
    }
    if !is_told {
        ui.weak("The run shows here from its first step on.");
    }
}

/// Powers of ten between two exponents, every so many that there are seven at the most.
fn decades((low, high): (f64, f64)) -> Vec<GridMark> {
    let (first, last) = (low.ceil() as i64, high.floor() as i64);
    let step = ((last - first).max(0) / 7 + 1) as usize;
    let marks = (first..=last).filter(|exponent| exponent.rem_euclid(step as i64) == 0);
    marks.map(|exponent| GridMark { value: exponent as f64, step_size: step as f64 }).collect()
}

fn power_of_ten(exponent: f64) -> String {
    format!("1e{exponent:.0}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::built_in;

    #[test]
    fn tighter_tolerances_come_to_smaller_residuals() {
        let mut scene = built_in("pile").unwrap();
        // So that the step has a solution.
        scene.parameters.restitution_threshold = 2.0;
        let mut simulation = scene.simulation().unwrap();
        simulation.take_steps(20).unwrap();
        let never = AtomicBool::new(false);
        let residual =
            |tolerance| timed(&simulation, Method::Newton, tolerance, &never).unwrap()[1];
        let (loose, tight) = (residual(1e-2), residual(1e-6));
        assert!(loose <= 1e-2 && tight <= 1e-6 && tight < loose, "{loose} and {tight}");
        assert_eq!(simulation.observables().step, 20, "the run itself takes no step");
        assert_eq!(timed(&simulation, Method::Newton, 1e-2, &AtomicBool::new(true)), None);
    }
}
