//! Long tasks on a separate thread, such as exports, with a progress bar and a button that stops the task.

#[cfg(target_arch = "wasm32")]
use std::cell::RefCell;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, TryRecvError, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;

use egui::Ui;

use crate::Instant;
use crate::error::{Error, Result};
use crate::live::receive_within;

/// Longest time for which a task waits for the copy of a run before it checks for a cancellation, and least time
/// between two updates of the progress bar. With a longer time, a cancelled task ends later; with a shorter time, the
/// window is drawn more often.
const INTERVAL: Duration = Duration::from_millis(50);

/// Trait of closures that can run on another thread.
#[cfg(not(target_arch = "wasm32"))]
pub(crate) trait MaySend: Send {}
#[cfg(not(target_arch = "wasm32"))]
impl<T: Send> MaySend for T {}
/// Trait of closures that would run on another thread. The browser version has no threads, so the trait requires
/// nothing.
#[cfg(target_arch = "wasm32")]
pub(crate) trait MaySend {}
#[cfg(target_arch = "wasm32")]
impl<T> MaySend for T {}

/// A task in progress. Dropping this value cancels the task.
pub(crate) struct Work<T> {
    shared: Arc<WorkState>,
    doer: Doer<T>,
}

/// Thread on which a task runs.
enum Doer<T> {
    /// A separate thread.
    #[cfg(not(target_arch = "wasm32"))]
    Thread { outcome: Receiver<Result<T>>, thread: Option<JoinHandle<()>> },
    /// The thread that calls [`Work::outcome`], because the browser version cannot start threads.
    #[cfg(target_arch = "wasm32")]
    Asker(RefCell<Box<dyn FnMut() -> Option<Result<T>>>>),
}

/// State that the window and the thread of the task share.
#[derive(Default)]
struct WorkState {
    /// Finished fraction of the task, 0 to 1, as the bits of an f32.
    done: AtomicU32,
    is_cancelled: AtomicBool,
}

/// Handle by which a task reports its progress and detects that the user cancelled it.
pub(crate) struct Reporter {
    shared: Arc<WorkState>,
    context: egui::Context,
    shown: Mutex<Instant>,
}

impl<T: Send + 'static> Work<T> {
    /// Starts a task that needs copies of runs from the solver's thread. The task begins when all copies have arrived
    /// through the channels `runs`. If the user cancels earlier, the task receives only the copies that have arrived.
    pub(crate) fn start<R: Send + 'static>(
        context: &egui::Context,
        runs: Vec<Receiver<R>>,
        work: impl FnOnce(Vec<R>, &Reporter) -> Result<T> + MaySend + 'static,
    ) -> Self {
        let shared = Arc::new(WorkState::default());
        let shown = Mutex::new(Instant::now());
        let reporter = Reporter { shared: Arc::clone(&shared), context: context.clone(), shown };
        let (mut came, mut work) = (Vec::new(), Some(work));
        // Waits up to `patience` for the next copy of a run. Returns `None` until all copies have arrived, and then the
        // result of the task.
        let advance = move |patience| {
            while let Some(run) = runs.get(came.len())
                && !reporter.is_cancelled()
            {
                match receive_within(run, patience) {
                    Ok(run) => came.push(run),
                    Err(RecvTimeoutError::Timeout) => return None,
                    Err(RecvTimeoutError::Disconnected) => return Some(Err(closed())),
                }
            }
            Some(work.take()?(std::mem::take(&mut came), &reporter))
        };
        Self { shared, doer: Doer::of(advance, context.clone()) }
    }
}

impl<T: Send + 'static> Doer<T> {
    #[cfg(target_arch = "wasm32")]
    fn of(
        mut advance: impl FnMut(Duration) -> Option<Result<T>> + 'static,
        _: egui::Context,
    ) -> Self {
        Self::Asker(RefCell::new(Box::new(move || advance(Duration::ZERO))))
    }

    #[cfg(not(target_arch = "wasm32"))]
    fn of(
        mut advance: impl FnMut(Duration) -> Option<Result<T>> + Send + 'static,
        context: egui::Context,
    ) -> Self {
        let (outbox, outcome) = channel();
        let thread = std::thread::spawn(move || {
            let outcome = loop {
                if let Some(outcome) = advance(INTERVAL) {
                    break outcome;
                }
            };
            // The window may have been closed, so that nobody receives the result.
            let _ = outbox.send(outcome);
            context.request_repaint();
        });
        Self::Thread { outcome, thread: Some(thread) }
    }
}

impl<T> Work<T> {
    /// Requests the task to end at its next check.
    fn cancel(&self) {
        self.shared.is_cancelled.store(true, Ordering::Relaxed);
    }

    /// Cancels the task and waits for its end, so that files are closed before the process ends.
    pub(super) fn end(&mut self) {
        self.cancel();
        #[cfg(not(target_arch = "wasm32"))]
        {
            let Doer::Thread { thread, .. } = &mut self.doer;
            let _ = thread.take().map(JoinHandle::join);
        }
    }

    /// Shows a progress bar called `name` and a button that stops the task.
    pub(super) fn show(&self, ui: &mut Ui, name: &str, stop: &str, hint: &str) {
        ui.horizontal(|ui| {
            // The button is at the other end of the line than the button that started the task, so that a double click
            // on the start button does not stop the task.
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                if ui.button(stop).on_hover_text(hint).clicked() {
                    self.cancel();
                }
                let done = f32::from_bits(self.shared.done.load(Ordering::Relaxed));
                progress_bar(ui, name, done);
            });
        });
    }

    /// Result of the task, if the task has ended.
    pub(crate) fn outcome(&self) -> Option<Result<T>> {
        match &self.doer {
            #[cfg(not(target_arch = "wasm32"))]
            Doer::Thread { outcome, .. } => match outcome.try_recv() {
                Ok(outcome) => Some(outcome),
                Err(TryRecvError::Empty) => None,
                Err(TryRecvError::Disconnected) => {
                    Some(Err(Error::value("work", "stopped by a fault", "finished")))
                }
            },
            #[cfg(target_arch = "wasm32")]
            Doer::Asker(ask) => ask.borrow_mut()(),
        }
    }
}

/// Returns the result of a task that has ended, and sets `work` to `None`.
pub(super) fn outcome_of_ended<T: Send + 'static>(work: &mut Option<Work<T>>) -> Option<Result<T>> {
    let outcome = work.as_ref()?.outcome()?;
    *work = None;
    Some(outcome)
}

impl<T> Drop for Work<T> {
    fn drop(&mut self) {
        self.cancel();
    }
}

/// Shows a bar with the finished fraction of a task.
pub(super) fn progress_bar(ui: &mut Ui, name: &str, part: f32) {
    let bar = ui.add(egui::ProgressBar::new(part).desired_height(14.0));
    bar.widget_info(|| egui::WidgetInfo::labeled(egui::Role::ProgressIndicator, true, name));
}

impl Reporter {
    /// Reports the finished fraction of the task. Returns `Break` if the user cancelled the task.
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
}

/// Returns the error for a run that the user closed before it was written to its file.
pub(super) fn closed() -> Error {
    Error::value("run", "closed", "open until it is written")
}
