//! Panel: a comparison of all solvers on the displayed step. A separate thread solves the step with each solver to
//! several tolerances.

use egui::{Color32, RichText, Ui};
use egui_plot::{Line, LineStyle};

use crate::Instant;
use crate::app::axes::{plot_with_axes, with_room};
use crate::app::number_text::clock_text;
use crate::app::theme;
use crate::app::watched_run::{TakenRun, WatchedRun};
use crate::app::work::{Reporter, Work, outcome_of_ended};
use crate::error::Result;
use crate::sim::{Settings, Simulation};
use crate::solver::{METHODS, Method, SolverSettings, StopTest};

/// Tolerances of the residual to which each solver solves the step, from loose to tight.
const TOLERANCES: [f64; 8] = [1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8];
/// Limit on the computing time of a step, s. A solver that takes longer is not tried with tighter tolerances.
const LIMIT_SECS: f64 = 0.25;
/// Largest number of times that each solver solves the step to each tolerance. The shortest computing time is reported,
/// because other programs can only make a solve slower. With a larger number the comparison takes longer.
const REPEATS: usize = 3;
const MOST_SWEEPS: u32 = 20_000;

/// Measured results of one solver for all tolerances.
struct RaceCurve {
    method: &'static str,
    /// Computing time of the step, ms, and its residual, from loose to tight tolerances. A tolerance for which the
    /// residual is not smaller than for looser tolerances has no point.
    points: Vec<[f64; 2]>,
}

/// The last measurement of a step, and the measurement that is in progress.
#[derive(Default)]
pub(super) struct StepRace {
    measured: Measured,
    work: Option<Work<Measured>>,
}

/// Measured computing times of one step by each solver.
#[derive(Default)]
struct Measured {
    /// Simulated time before the measured step, s.
    time_secs: f64,
    /// Results of the solvers.
    curves: Vec<RaceCurve>,
}

/// Measures the computing time of all solvers on the step after the displayed state. `run` is `None` if the user
/// cancelled before the solver's thread had sent a copy of the run.
fn race(run: Option<TakenRun>, reporter: &Reporter) -> Result<Measured> {
    let Some(run) = run else { return Ok(Measured::default()) };
    let simulation = &run.world.simulation;
    let mut curves = Vec::new();
    for (number, info) in METHODS.iter().enumerate() {
        let goes_on = || reporter.tell(number as f64 / METHODS.len() as f64).is_continue();
        let mut points: Vec<[f64; 2]> = Vec::new();
        for tolerance in TOLERANCES {
            let point = timed(simulation, info.method, tolerance, goes_on);
            let Some([ms, residual]) = point else { break };
            // A point that does not reduce the residual shows nothing new.
            if points.last().is_none_or(|&[_, before]| residual < before) {
                points.push([ms, residual]);
            }
            if ms > 1e3 * LIMIT_SECS {
                break;
            }
        }
        if !goes_on() {
            break;
        }
        if !points.is_empty() {
            curves.push(RaceCurve { method: info.name, points });
        }
    }
    Ok(Measured { time_secs: simulation.time_secs(), curves })
}

/// Solves the next step several times with one solver and tolerance. Returns the shortest computing time, ms, and the
/// residual. `None` if the solver cannot solve the step or if the user cancelled.
fn timed(
    simulation: &Simulation,
    method: Method,
    tolerance: f64,
    goes_on: impl Fn() -> bool,
) -> Option<[f64; 2]> {
    let before = *simulation.settings();
    let solver = SolverSettings {
        stop: StopTest::Residual,
        tolerance,
        max_sweeps: MOST_SWEEPS,
        ..before.solver.by(method)
    };
    let mut least = [f64::INFINITY, f64::NAN];
    for _ in 0..REPEATS {
        if !goes_on() {
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

/// Height of the chart that compares solvers, points.
const HEIGHT: f32 = 230.0;
/// Number of colours of curves. Further curves have the same colours with other line styles.
const COLOURS: usize = 6;

pub(super) fn show(ui: &mut Ui, run: &mut WatchedRun, race: &mut StepRace) {
    if let Some(outcome) = outcome_of_ended(&mut race.work) {
        race.measured = outcome.unwrap_or_default();
    }
    if let Some(work) = &race.work {
        let hint = "Leaves out the remaining solvers.";
        return work.show(ui, "Measuring", "Stop measuring", hint);
    }
    measure(ui, run, race);
    let Measured { time_secs, curves } = &race.measured;
    if curves.is_empty() {
        return;
    }
    draw(ui, curves);
    legend(ui, curves);
    let text = format!("The step after t = {}, measured here.", clock_text(*time_secs));
    ui.label(RichText::new(text).small().weak());
}

/// Shows the button that starts the measurement of the displayed step with all solvers.
fn measure(ui: &mut Ui, run: &mut WatchedRun, shown: &mut StepRace) {
    let is_possible = run.world().is_some_and(|world| {
        world.failure.is_none() && world.controls.settings.stepper.uses_method()
    });
    let button = ui.add_enabled(is_possible, egui::Button::new("Measure this step"));
    let hint = "Each solver solves the visible step, to one tolerance after the other. This takes some seconds.";
    let refusal = "This run cannot continue, or its stepper uses no solver.";
    let button = button.on_hover_text(hint).on_disabled_hover_text(refusal);
    if button.clicked() {
        let taken = run.take(run.selected);
        let work = |mut runs: Vec<_>, reporter: &Reporter| race(runs.pop(), reporter);
        shown.work = Some(Work::start(ui.ctx(), vec![taken], work));
        shown.measured = Measured::default();
    }
}

fn draw(ui: &mut Ui, curves: &[RaceCurve]) {
    let dark = ui.visuals().dark_mode;
    ui.label(RichText::new("residual against ms per step").small());
    let ends = [0, 1].map(|axis| {
        let points = curves.iter().flat_map(|curve| &curve.points);
        with_room(points.map(|point| point[axis].log10()), true)
    });
    plot_with_axes(ui, "speed and accuracy", [true; 2], "", ends)
        .height(HEIGHT)
        .allow_drag(false)
        .allow_zoom(false)
        .show(ui, |plot| {
            for (index, curve) in curves.iter().enumerate() {
                let (colour, style, _) = look(index, dark);
                let points = curve.points.iter().map(|point| point.map(f64::log10));
                let line = Line::new("", points.collect::<Vec<_>>());
                plot.line(line.color(colour).style(style).width(1.6));
            }
        });
}

/// Returns the colour and the line style of the curve with this index, and a character that shows the line style. No
/// two curves have the same colour and the same line style.
fn look(index: usize, dark: bool) -> (Color32, LineStyle, &'static str) {
    let (style, sign) = match index / COLOURS {
        0 => (LineStyle::Solid, "━"),
        1 => (LineStyle::dashed_loose(), "╍"),
        _ => (LineStyle::dotted_dense(), "┉"),
    };
    (theme::world_colour(index % COLOURS, dark), style, sign)
}

/// Shows the key of colours and line styles below the chart, where it covers no curve.
fn legend(ui: &mut Ui, curves: &[RaceCurve]) {
    let dark = ui.visuals().dark_mode;
    ui.horizontal_wrapped(|ui| {
        for (index, curve) in curves.iter().enumerate() {
            let (colour, _, sign) = look(index, dark);
            ui.spacing_mut().item_spacing.x = 3.0;
            ui.label(RichText::new(sign).color(colour));
            ui.label(RichText::new(curve.method).small());
            ui.add_space(6.0);
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::built_in;

    #[test]
    fn tighter_tolerances_come_to_smaller_residuals() {
        let scene = built_in("pile").unwrap();
        let mut simulation = scene.simulation().unwrap();
        simulation.take_steps(20).unwrap();
        let residual =
            |tolerance| timed(&simulation, Method::Newton, tolerance, || true).unwrap()[1];
        let (loose, tight) = (residual(1e-2), residual(1e-6));
        assert!(loose <= 1e-2 && tight <= 1e-6 && tight < loose, "{loose} and {tight}");
        assert_eq!(simulation.observables().step, 20, "the run itself takes no step");
        assert_eq!(timed(&simulation, Method::Newton, 1e-2, || false), None);
    }
}
