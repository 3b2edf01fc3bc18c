//! Work that takes longer than the window may wait: on a thread of its own, with how far it is, and to be stopped.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, TryRecvError, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use egui::Ui;

use crate::error::{Error, Result};

/// Least time between two looks at what the window says, and between two frames that show how far it is.
const INTERVAL: Duration = Duration::from_millis(50);

/// Work that is going on.
pub(crate) struct Work<T> {
    shared: Arc<WorkState>,
    outcome: Receiver<Result<T>>,
    thread: Option<JoinHandle<()>>,
}

/// What window and thread tell each other.
#[derive(Default)]
struct WorkState {
    /// The part that is done, 0 … 1, as the bits of an f32.
    done: AtomicU32,
    is_cancelled: AtomicBool,
}

/// The thread's side of it.
pub(crate) struct Reporter {
    shared: Arc<WorkState>,
    context: egui::Context,
    shown: Mutex<Instant>,
}

impl<T: Send + 'static> Work<T> {
    /// Starts it.
    pub(crate) fn start(
        context: &egui::Context,
        work: impl FnOnce(&Reporter) -> Result<T> + Send + 'static,
    ) -> Self {
        let shared = Arc::new(WorkState::default());
        let (outbox, outcome) = channel();
        let (context, of_thread) = (context.clone(), Arc::clone(&shared));
        let thread = std::thread::spawn(move || {
            let shown = Mutex::new(Instant::now());
            let reporter = Reporter { shared: of_thread, context, shown };
            // The window may have closed.
            let _ = outbox.send(work(&reporter));
            reporter.context.request_repaint();
        });
        Self { shared, outcome, thread: Some(thread) }
    }
}

impl<T> Work<T> {
    /// Ends it where it next looks.
    fn cancel(&self) {
        self.shared.is_cancelled.store(true, Ordering::Relaxed);
    }

    /// Ends it and waits until it has: files are closed before the process may end.
    pub(super) fn end(&mut self) {
        self.cancel();
        let _ = self.thread.take().map(JoinHandle::join);
    }

    /// Shows how far it is by that `name`, and the button that stops it.
    pub(super) fn show(&self, ui: &mut Ui, name: &str, stop: &str, hint: &str) {
        ui.horizontal(|ui| {
            // Not where the button was that started it: a second click there is none on this one.
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                if ui.button(stop).on_hover_text(hint).clicked() {
                    self.cancel();
                }
                let done = f32::from_bits(self.shared.done.load(Ordering::Relaxed));
                progress_bar(ui, name, done);
            });
        });
    }

    /// What became of it, once it has ended.
    pub(crate) fn outcome(&self) -> Option<Result<T>> {
        match self.outcome.try_recv() {
            Ok(outcome) => Some(outcome),
            Err(TryRecvError::Empty) => None,
            Err(TryRecvError::Disconnected) => {
                Some(Err(Error::value("work", "ended by a fault", "ended when it is done")))
            }
        }
    }
}

impl<T> Drop for Work<T> {
    fn drop(&mut self) {
        self.cancel();
    }
}

/// A bar that shows which part of something is done.
pub(super) fn progress_bar(ui: &mut Ui, name: &str, part: f32) {
    let bar = ui.add(egui::ProgressBar::new(part).desired_height(14.0));
    bar.widget_info(|| egui::WidgetInfo::labeled(egui::Role::ProgressIndicator, true, name));
}

impl Reporter {
    /// Says which part is done, and asks whether to go on.
    pub(crate) fn tell(&self, part: f64) -> ControlFlow<()> {
        self.shared.done.store((part as f32).clamp(0.0, 1.0).to_bits(), Ordering::Relaxed);
        let mut shown = self.shown.lock().unwrap_or_else(PoisonError::into_inner);
        if shown.elapsed() >= INTERVAL {
            *shown = Instant::now();
            self.context.request_repaint();
        }
        if self.is_cancelled() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }

    fn is_cancelled(&self) -> bool {
        self.shared.is_cancelled.load(Ordering::Relaxed)
    }

    /// A run, once the solver's thread has handed it out; nothing where the work is given up before.
    pub(crate) fn wait_for<R>(&self, run: &Receiver<R>) -> Result<Option<R>> {
        while !self.is_cancelled() {
            match run.recv_timeout(INTERVAL) {
                Ok(run) => return Ok(Some(run)),
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => return Err(closed()),
            }
        }
        Ok(None)
    }
}

/// A run, once the solver's thread has handed it out.
pub(super) fn received<R>(run: &Receiver<R>) -> Result<R> {
    run.recv().map_err(|_| closed())
}

fn closed() -> Error {
    Error::value("run", "closed", "open until it is written")
}
