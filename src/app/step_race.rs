//! The step that is shown, solved by each method to one tolerance after the other, on a thread of its own.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::Instant;

use super::taken::TakenRun;
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
            if let Ok(TakenRun { taken, .. }) = run.recv() {
                race(&taken.simulation, &sender, &cancelled, &context);
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
