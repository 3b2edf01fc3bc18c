//! Work that takes longer than the window may wait: on a thread of its own, with how far it is, and to be stopped.

use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, TryRecvError, channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use egui::Ui;

use super::opening::TakenRun;
use crate::error::{Error, Result};

/// Least time between two looks at what the window says, and between two frames that show how far it is.
const INTERVAL: Duration = Duration::from_millis(50);
/// What has been done, in parts of this.
const WHOLE: f64 = 1000.0;

/// Work that is going on.
pub(crate) struct Work {
    shared: Arc<WorkState>,
    outcome: Receiver<Result<String>>,
    thread: Option<JoinHandle<()>>,
}

/// What window and thread tell each other.
#[derive(Default)]
struct WorkState {
    done: AtomicU32,
    is_cancelled: AtomicBool,
}

/// The thread's side of it.
pub(crate) struct Reporter {
    shared: Arc<WorkState>,
    context: egui::Context,
    shown: std::cell::Cell<Instant>,
}

impl Work {
    /// Starts it. What it returns is said in the window.
    pub(crate) fn start(
        context: &egui::Context,
        work: impl FnOnce(&Reporter) -> Result<String> + Send + 'static,
    ) -> Self {
        let shared = Arc::new(WorkState::default());
        let (outbox, outcome) = channel();
        let (context, of_thread) = (context.clone(), Arc::clone(&shared));
        let thread = std::thread::spawn(move || {
            let shown = std::cell::Cell::new(Instant::now());
            let reporter = Reporter { shared: of_thread, context, shown };
            // The window may have closed.
            let _ = outbox.send(work(&reporter));
            reporter.context.request_repaint();
        });
        Self { shared, outcome, thread: Some(thread) }
    }

    /// How far it has come, 0 … 1.
    fn part(&self) -> f32 {
        self.shared.done.load(Ordering::Relaxed) as f32 / WHOLE as f32
    }

    /// Ends it where it next looks.
    fn cancel(&self) {
        self.shared.is_cancelled.store(true, Ordering::Relaxed);
    }

    /// Shows how far it is by that `name`, and the button that stops it.
    pub(super) fn show(&self, ui: &mut Ui, name: &str, stop: &str, hint: &str) {
        ui.horizontal(|ui| {
            // Not where the button was that started it: a second click there is none on this one.
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                if ui.button(stop).on_hover_text(hint).clicked() {
                    self.cancel();
                }
                let bar = ui.add(egui::ProgressBar::new(self.part()).desired_height(14.0));
                bar.widget_info(|| {
                    egui::WidgetInfo::labeled(egui::Role::ProgressIndicator, true, name)
                });
            });
        });
    }

    /// What became of it, and whether it failed, once it has ended.
    pub(crate) fn take_outcome(&self) -> Option<(String, bool)> {
        match self.outcome.try_recv() {
            Ok(Ok(told)) => Some((told, false)),
            Ok(Err(error)) => Some((error.to_string(), true)),
            Err(TryRecvError::Empty) => None,
            Err(TryRecvError::Disconnected) => {
                Some(("the export ended before it was done".to_owned(), true))
            }
        }
    }
}

impl Drop for Work {
    fn drop(&mut self) {
        // Files are closed before the process may end.
        self.cancel();
        let _ = self.thread.take().map(JoinHandle::join);
    }
}

impl Reporter {
    /// Says which part is done, and asks whether to go on.
    pub(crate) fn tell(&self, part: f64) -> ControlFlow<()> {
        self.shared.done.store((WHOLE * part.clamp(0.0, 1.0)) as u32, Ordering::Relaxed);
        if self.shown.get().elapsed() >= INTERVAL {
            self.shown.set(Instant::now());
            self.context.request_repaint();
        }
        if self.is_cancelled() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }

    /// Whether it is to end.
    pub(crate) fn is_cancelled(&self) -> bool {
        self.shared.is_cancelled.load(Ordering::Relaxed)
    }

    /// The run, once the solver's thread has handed it out; nothing where the work is given up before.
    pub(crate) fn wait_for(&self, run: &Receiver<TakenRun>) -> Result<Option<TakenRun>> {
        while !self.is_cancelled() {
            match run.recv_timeout(INTERVAL) {
                Ok(run) => return Ok(Some(run)),
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => {
                    return Err(Error::value("run", "closed", "open when it is exported"));
                }
            }
        }
        Ok(None)
    }
}
