//! Recordings of what the window has computed. A thread of their own computes all of it once more and writes
//! it down, so that neither the window nor the run waits.

use std::ops::ControlFlow;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, TryRecvError, channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use super::taken::{Opened, TakenRun};
use crate::data::{About, Claim, DataSettings, Recording, Times};
use crate::error::{Error, Result};
use crate::headless::told_of_data;
use crate::sim::live::{Change, Replay};
use crate::sim::{Pull, RunEnding, Simulation};

/// Least time between two looks at what the window says, and between two frames that show how far it is.
const INTERVAL: Duration = Duration::from_millis(50);
/// What has been done, in parts of this.
const WHOLE: f64 = 1000.0;

/// What is to be written.
pub(crate) struct DataOrder {
    /// Where to.
    pub folder: PathBuf,
    /// Whether an earlier recording there is removed.
    pub overwrite: bool,
    /// As what, and how often; after each step where no time between frames is given.
    pub settings: DataSettings,
    /// First and last simulated time, s; all that is recorded where none are given.
    pub stretch: Option<[f64; 2]>,
}

/// An export that is going on.
pub(crate) struct DataExport {
    shared: Arc<Shared>,
    outcome: Receiver<Result<String>>,
    thread: Option<JoinHandle<()>>,
}

/// What window and thread tell each other.
#[derive(Default)]
struct Shared {
    done: AtomicU32,
    is_cancelled: AtomicBool,
}

impl DataExport {
    /// Starts an export of a run that is on its way.
    pub(crate) fn start(
        context: &egui::Context,
        order: DataOrder,
        run: Receiver<TakenRun>,
    ) -> Self {
        let shared = Arc::new(Shared::default());
        let (outbox, outcome) = channel();
        let (context, of_thread) = (context.clone(), Arc::clone(&shared));
        let thread = std::thread::spawn(move || {
            let written = write(&order, &run, &of_thread, &context);
            // The window may have closed.
            let _ = outbox.send(written);
            context.request_repaint();
        });
        Self { shared, outcome, thread: Some(thread) }
    }

    /// How far it has come, 0 … 1.
    pub(crate) fn part(&self) -> f32 {
        self.shared.done.load(Ordering::Relaxed) as f32 / WHOLE as f32
    }

    /// Ends it after the present step. Frames that are written stay.
    pub(crate) fn cancel(&self) {
        self.shared.is_cancelled.store(true, Ordering::Relaxed);
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

impl Drop for DataExport {
    fn drop(&mut self) {
        // The recording is closed before the process may end.
        self.cancel();
        let _ = self.thread.take().map(JoinHandle::join);
    }
}

impl Shared {
    fn is_cancelled(&self) -> bool {
        self.is_cancelled.load(Ordering::Relaxed)
    }

    /// The run, once the solver's thread has handed it out; nothing where the export is given up before.
    fn wait_for(&self, run: &Receiver<TakenRun>) -> Result<Option<TakenRun>> {
        while !self.is_cancelled() {
            match run.recv_timeout(INTERVAL) {
                Ok(run) => return Ok(Some(run)),
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => {
                    return Err(Error::value("run", "closed", "open when its data is exported"));
                }
            }
        }
        Ok(None)
    }
}

impl DataOrder {
    /// The simulated times of a run that are asked for, s.
    ///
    /// # Errors
    /// Where none of them is recorded.
    fn stretch_of(&self, replay: &Replay) -> Result<[f64; 2]> {
        let Some([from, to]) = self.stretch else { return Ok([f64::NEG_INFINITY, f64::INFINITY]) };
        let (first, last) = (replay.start().time_secs(), replay.end_secs());
        let recorded = format!("within what is recorded, {first} s to {last} s");
        if !(first..=last).contains(&from) {
            return Err(Error::value("from", from, recorded));
        }
        if !(first..=last).contains(&to) {
            return Err(Error::value("to", to, recorded));
        }
        if to < from {
            return Err(Error::value(
                "to",
                to,
                format!("at or after the {from} s it is to begin at"),
            ));
        }
        Ok([from, to])
    }
}

fn write(
    order: &DataOrder,
    run: &Receiver<TakenRun>,
    shared: &Shared,
    context: &egui::Context,
) -> Result<String> {
    order.settings.validate("data-every")?;
    let Some(run) = shared.wait_for(run)? else { return Ok(NOTHING.to_owned()) };
    let replay = &run.taken.replay;
    let stretch = order.stretch_of(replay)?;
    let claim = Claim::of(&order.folder, order.overwrite)?;
    let (first_secs, last_secs) = (replay.start().time_secs(), stretch[1].min(replay.end_secs()));
    let mut writing = Writing {
        order,
        opened: &run.opened,
        replay,
        until_secs: last_secs,
        claim: Some(claim),
        recording: None,
    };
    let mut begun_at = None;
    let mut shown = Instant::now();
    let ended = replay.run(stretch, |simulation, is_within| {
        let from = *begun_at.get_or_insert(simulation.time_secs().max(first_secs));
        let part = (simulation.time_secs() - from) / (last_secs - from).max(f64::MIN_POSITIVE);
        shared.done.store((WHOLE * part.clamp(0.0, 1.0)) as u32, Ordering::Relaxed);
        if shown.elapsed() >= INTERVAL {
            shown = Instant::now();
            context.request_repaint();
        }
        if shared.is_cancelled() {
            return Ok(ControlFlow::Break(()));
        }
        if is_within {
            writing.take(simulation)?;
        }
        Ok(ControlFlow::Continue(()))
    })?;
    writing.finish(&ended)
}

/// Which grains were pulled by the mouse in which steps.
fn pulls(mut pull: Option<Pull>, first_step: u64, changes: &[&Change]) -> Vec<String> {
    let mut told = Vec::new();
    let mut since = first_step;
    for change in changes {
        let next = change.controls.pull;
        let grain = |pull: Option<Pull>| pull.map(|pull| pull.grain);
        if grain(next) != grain(pull) {
            if let Some(Pull { grain, .. }) = pull {
                told.push(format!("grain {grain} in steps {since} to {}", change.after_step));
            }
            since = change.after_step + 1;
        }
        pull = next;
    }
    told.extend(pull.map(|Pull { grain, .. }| format!("grain {grain} from step {since} on")));
    told
}

/// What is told where an export was given up at once.
const NOTHING: &str = "Stopped before the first frame";

/// A recording that begins with the first moment of its stretch.
struct Writing<'a> {
    order: &'a DataOrder,
    opened: &'a Opened,
    replay: &'a Replay,
    until_secs: f64,
    /// The folder, until the recording has it.
    claim: Option<Claim>,
    recording: Option<Recording>,
}

impl Writing<'_> {
    /// Takes the next moment.
    fn take(&mut self, simulation: &Simulation) -> Result<()> {
        if let Some(claim) = self.claim.take() {
            self.recording = Some(self.start(claim, simulation)?);
        }
        let Some(recording) = &mut self.recording else { return Ok(()) };
        // No step led to the moment that all began with.
        if simulation.observables().step > self.replay.start().observables().step {
            recording.add_step(simulation.observables())?;
        }
        match self.order.settings.every_secs {
            Some(_) => recording.add_if_due(simulation),
            None => recording.add(simulation.moment()),
        }
    }

    fn start(&self, claim: Claim, simulation: &Simulation) -> Result<Recording> {
        let formats = self.order.settings.formats();
        let recording = Recording::start_in(claim, &formats, &self.about(simulation)?)?;
        Ok(match self.order.settings.every_secs {
            Some(secs) => recording.at(Times::Every(secs), simulation),
            None => recording,
        })
    }

    /// What is to be known of the recording: the scene with the settings of the first moment, and what was
    /// changed later on.
    fn about(&self, simulation: &Simulation) -> Result<About> {
        let mut scene = self.opened.scene.clone();
        scene.set_settings(*simulation.settings());
        let step = simulation.observables().step;
        let changes: Vec<_> = self.replay.changes(step, self.until_secs).collect();
        let settings = changes
            .iter()
            .map(|change| (change.after_step, change.time_secs, change.controls.settings));
        let mut about = scene.about_run(&settings.collect::<Vec<_>>())?;
        let mut tell = |name: &str, said: String| about.facts.push((name.to_owned(), said));
        tell("exported", format!("from the window, from step {step} to {} s", self.until_secs));
        let start = self.replay.start().observables();
        if start.step > 0 {
            tell("restarted_from", format!("step {}, {} s", start.step, start.time_secs));
        }
        let pulls = pulls(simulation.pull(), step, &changes);
        if !pulls.is_empty() {
            tell("pulled_by_hand", pulls.join(", "));
        }
        Ok(about)
    }

    fn finish(self, ended: &RunEnding) -> Result<String> {
        let Some(recording) = self.recording else { return Ok(NOTHING.to_owned()) };
        let told = told_of_data(recording.folder(), recording.frames());
        recording.finish()?;
        Ok(match ended {
            RunEnding::Done => told,
            RunEnding::Stopped => format!("Stopped with {told}"),
            RunEnding::NotFinite(_) => {
                format!("{told}, up to the last step with a finite state")
            }
        })
    }
}
