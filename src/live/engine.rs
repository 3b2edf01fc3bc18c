//! The loop of the solver's thread: it handles commands, takes the steps that are due, and publishes frames (the data
//! that the window draws).

use std::collections::VecDeque;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::time::Duration;

use triple_buffer::Input;

use super::clock::{Clock, receive_within};
use super::mode::Mode;
use super::{
    Command, LiveFrame, LiveOptions, LiveStart, LoadingProgress, Pace, RunHistory, StartSource,
    WorldFrame,
};
use crate::Instant;
use crate::error::Error;
use crate::sim::{Settings, Surroundings};

/// Number of frame intervals (the shortest time between two frames, the data that the window draws) after which a frame
/// that the window has not fetched is replaced by a newer frame. With a smaller number, time is spent on frames that
/// the window never fetches; with a larger number, the window shows changes late.
const UNFETCHED_INTERVALS: u32 = 3;
/// Shortest wall-clock time between two frames (the data that the window draws) while an initial state is being
/// computed.
const PROGRESS_INTERVAL: Duration = Duration::from_millis(50);

struct Outbox {
    frames: Input<LiveFrame>,
    wake: Box<dyn Fn() + Send>,
    interval: Duration,
    count: u64,
    sent: Instant,
    /// True if the last frame (the data that the window draws) does not show the newest state.
    is_behind: bool,
    /// True if a frame (the data that the window draws) must be sent as soon as the present step is finished, without
    /// waiting until the shortest time between two frames has passed.
    is_urgent: bool,
}

impl Outbox {
    fn wait(&self) -> Duration {
        let intervals = if self.frames.consumed() { 1 } else { UNFETCHED_INTERVALS };
        (intervals * self.interval).saturating_sub(self.sent.elapsed())
    }
}

pub(super) struct Engine {
    inbox: Receiver<(u64, Command)>,
    /// Commands that wait until an initial state is loaded or a seek (a jump to a recorded time) has ended.
    waiting: VecDeque<(u64, Command)>,
    outbox: Outbox,
    start: Option<Arc<LiveStart>>,
    /// Walls and discs that are not grains, as they are in the initial state. They include the walls that support the
    /// grains only until the first step.
    held: Option<Arc<Surroundings>>,
    history: RunHistory,
    mode: Mode,
    clock: Clock,
    /// Simulated time at which the run pauses by itself, s.
    stop_at_secs: Option<f64>,
    refusal: Option<Arc<str>>,
    acknowledged: u64,
    loads: u64,
    quit: bool,
    /// Callback that returns true to cancel the loading of an initial state ([`LiveOptions`]).
    gives_up: Box<dyn Fn() -> bool + Send>,
}

fn message(error: Error) -> Arc<str> {
    error.to_string().into()
}

impl Engine {
    pub(super) fn new(
        inbox: Receiver<(u64, Command)>,
        frames: Input<LiveFrame>,
        options: LiveOptions,
    ) -> Self {
        let LiveOptions { wake, gives_up, frame_interval: interval, recording_bytes } = options;
        let sent = Instant::now();
        Self {
            inbox,
            waiting: VecDeque::new(),
            outbox: Outbox {
                frames,
                wake,
                interval,
                count: 0,
                sent,
                is_behind: false,
                is_urgent: false,
            },
            start: None,
            held: None,
            history: RunHistory::new(recording_bytes),
            mode: Mode::Paused,
            clock: Clock::new(),
            stop_at_secs: None,
            refusal: None,
            acknowledged: 0,
            loads: 0,
            quit: false,
            gives_up,
        }
    }

    pub(super) fn run(mut self) {
        while !self.quit && self.turn(true) {}
    }

    /// Handles all commands, takes the steps that are due, and sends the frame (the data that the window draws) if it
    /// is due. If nothing is due and `may_sleep` is true, the thread sleeps until a command comes or something is due.
    /// Returns false if the window is closed, so that no further command can come.
    pub(super) fn turn(&mut self, may_sleep: bool) -> bool {
        if !self.receive(may_sleep) {
            return false;
        }
        match self.mode {
            Mode::Seeking { .. } => self.advance_seek(),
            Mode::Showing { .. } => self.advance_show(),
            Mode::Computing => self.advance_run(),
            Mode::Stepping { .. } => self.advance_step(),
            Mode::Paused | Mode::Loading(_) => {}
        }
        let is_due = self.outbox.is_urgent || self.outbox.wait().is_zero();
        if self.outbox.is_behind && is_due {
            self.outbox.is_urgent = false;
            self.publish();
        }
        true
    }

    /// Handles all commands. If nothing else is due and `may_sleep` is true, the thread sleeps until a command comes.
    /// Returns false if the window is closed, so that no further command can come.
    fn receive(&mut self, may_sleep: bool) -> bool {
        let mut commanded = false;
        loop {
            if !self.mode.seeks()
                && let Some((number, command)) = self.waiting.pop_front()
            {
                self.handle(number, command);
                commanded = true;
                continue;
            }
            let hurries = commanded || self.quit || !may_sleep;
            let wait = if hurries { Some(Duration::ZERO) } else { self.wait() };
            let received = match wait {
                None => self.inbox.recv().map_err(|_| RecvTimeoutError::Disconnected),
                Some(wait) => receive_within(&self.inbox, wait),
            };
            match received {
                Ok((number, command)) if self.mode.seeks() && command.waits_for_seek() => {
                    self.waiting.push_back((number, command));
                }
                Ok((number, command)) => self.handle(number, command),
                Err(RecvTimeoutError::Timeout) => break,
                Err(RecvTimeoutError::Disconnected) => return false,
            }
            commanded = true;
        }
        if commanded && !self.mode.seeks() {
            // If the next step is due at once, the frame after that step shows the effect of the commands.
            self.outbox.is_urgent = self.mode.plays() && self.wait_for_step().is_zero();
            if !self.outbox.is_urgent {
                self.publish();
            }
        }
        true
    }

    /// Returns the wall-clock time until a step or a frame (the data that the window draws) is due; `None` if nothing
    /// is due before the next command.
    pub(super) fn wait(&mut self) -> Option<Duration> {
        if self.mode.seeks() || matches!(self.mode, Mode::Stepping { .. }) {
            return Some(Duration::ZERO);
        }
        let frame = self.outbox.is_behind.then(|| self.outbox.wait());
        let step = self.mode.plays().then(|| self.wait_for_step());
        frame.into_iter().chain(step).min()
    }

    fn wait_for_step(&mut self) -> Duration {
        match self.mode {
            Mode::Showing { .. } => self.outbox.wait(),
            _ if self.history.present.is_on_its_way() => Duration::ZERO,
            _ => self.clock.wait(self.history.present.time_secs()),
        }
    }

    fn handle(&mut self, number: u64, command: Command) {
        if let Mode::Showing { until_secs } = self.mode
            && command.is_about_the_moment()
        {
            self.seek(until_secs, true);
            self.waiting.push_front((number, command));
            return;
        }
        match command {
            Command::Load(source) => self.load(source),
            Command::Compare(all) => self.restart(&all),
            Command::Reset => self.restart(&self.history.present.settings()),
            Command::Return(number) => {
                if self.history.go_to(number) {
                    self.mode = Mode::Paused;
                }
            }
            Command::Change(world, settings) => {
                if let Some(world) = self.history.present.worlds.get_mut(world) {
                    self.refusal = world.simulation.change(settings).err().map(message);
                }
            }
            Command::SetPull(world, pull) => {
                if let Some(world) = self.history.present.worlds.get_mut(world) {
                    world.simulation.set_pull(pull);
                }
            }
            Command::Edit(world, edit) => {
                if world < self.history.present.worlds.len() {
                    self.refusal = self.history.edit(world, edit).err().map(message);
                }
            }
            Command::Play => self.play(),
            Command::Pause => self.pause(),
            Command::Step => match &mut self.mode {
                Mode::Stepping { more } => *more += 1,
                _ => {
                    self.mode = Mode::Paused;
                    self.tick();
                    if self.history.present.is_on_its_way() {
                        self.mode = Mode::Stepping { more: 0 };
                    }
                }
            },
            Command::Seek(time_secs) => self.seek(time_secs, false),
            Command::SetPace(pace) => self.set_pace(pace),
            Command::Take(world, taker) => {
                if let (Some(world), Some(start)) =
                    (self.history.present.worlds.get(world), &self.start)
                {
                    taker(Arc::clone(start), world.handed_out());
                }
            }
            Command::TakeAll(taker) => {
                if let Some(start) = &self.start {
                    let history = Some(self.history.thinned());
                    taker(LiveStart { history, ..LiveStart::clone(start) });
                }
            }
            Command::CancelLoading => {}
            Command::Quit => self.quit = true,
        }
        self.acknowledged = number;
        self.outbox.is_behind = true;
    }

    fn set_pace(&mut self, pace: Pace) {
        self.clock.pace = pace;
        match self.mode {
            Mode::Showing { until_secs } => {
                self.clock.start(until_secs);
                if pace == Pace::Max {
                    self.seek(until_secs, true);
                }
            }
            _ => self.clock.start(self.history.present.time_secs()),
        }
    }

    fn play(&mut self) {
        let run = &self.history.present;
        let is_shown = matches!(self.mode, Mode::Showing { .. });
        if run.worlds.is_empty() || run.has_failed() || is_shown {
            return;
        }
        let now_secs = run.time_secs();
        let duration_secs =
            self.start.as_ref().map_or(f64::INFINITY, |start| start.scene.duration_secs);
        // Without a next stop, a run that continues at the end of its scene would never end.
        let passed = ((now_secs + 0.5 * run.time_step_secs()) / duration_secs).floor();
        self.stop_at_secs = Some((passed + 1.0) * duration_secs);
        self.clock.start(now_secs);
        let is_slow = matches!(self.clock.pace, Pace::RealTime(_));
        self.mode = if is_slow && run.is_stored() && run.replays() {
            Mode::Showing { until_secs: now_secs }
        } else {
            Mode::Computing
        };
    }

    /// Pauses the run. If a stored snapshot (a past state kept for display) is shown, the whole state at its time is
    /// computed, so that the run can continue from there.
    fn pause(&mut self) {
        match self.mode {
            Mode::Showing { until_secs } => self.seek(until_secs, false),
            Mode::Seeking { .. } => self.mode = Mode::Seeking { then_plays: false },
            _ if self.history.present.is_on_its_way() => self.mode = Mode::Stepping { more: 0 },
            _ => self.mode = Mode::Paused,
        }
    }

    /// Shows the stored snapshot (a past state kept for display) that is due. After the last stored snapshot, the
    /// simulations seek (jump to) the last recorded step, at which a keyframe (a copy of the whole state) is kept.
    fn advance_show(&mut self) {
        if !self.outbox.wait().is_zero() {
            return;
        }
        let due_secs = self.clock.time_secs();
        let end_secs = self.history.present.recorded_secs();
        let stop_secs = self.stop_at_secs.filter(|&stop| stop < end_secs);
        if due_secs < stop_secs.unwrap_or(end_secs) {
            self.mode = Mode::Showing { until_secs: due_secs };
            self.clock.count(0, due_secs);
            self.outbox.is_behind = true;
            return;
        }
        // A run that has reached the duration of its scene stops at that time.
        let half_step_secs = 0.5 * self.history.present.time_step_secs();
        let goes_on = self.stop_at_secs.is_none_or(|stop| end_secs + half_step_secs < stop);
        self.seek(stop_secs.unwrap_or(end_secs), goes_on);
    }

    /// Starts to compute the recorded state nearest to the simulated time `secs`, s. After that, the run plays if
    /// `then_plays` is true.
    fn seek(&mut self, secs: f64, then_plays: bool) {
        self.mode = Mode::Seeking { then_plays };
        self.history.present.seek(secs);
    }

    fn advance_seek(&mut self) {
        if self.history.present.advance_seek() {
            self.mode = Mode::of_play(self.mode.plays());
            self.publish();
        }
    }

    fn tick(&mut self) {
        self.history.keep_before_tick();
        let (steps, all_well) = self.history.present.tick();
        self.clock.count(steps, self.history.present.time_secs());
        if !all_well {
            self.mode = Mode::Paused;
        }
        self.outbox.is_behind = true;
    }

    fn advance_step(&mut self) {
        self.tick();
        match &mut self.mode {
            _ if self.history.present.is_on_its_way() => {}
            Mode::Stepping { more } if *more > 0 => *more -= 1,
            _ => {
                self.mode = Mode::Paused;
                self.publish();
            }
        }
    }

    /// Takes the step that is due, and pauses the run when it has reached its duration.
    fn advance_run(&mut self) {
        if !self.wait_for_step().is_zero() {
            return;
        }
        self.tick();
        let run = &self.history.present;
        if run.is_on_its_way() {
            return;
        }
        let end_secs = run.time_secs() + 0.5 * run.time_step_secs();
        if self.stop_at_secs.is_some_and(|stop| end_secs >= stop) {
            self.mode = Mode::Paused;
        }
        if !self.mode.plays() {
            self.publish();
        }
    }

    /// Replaces all simulations and their history by the initial state from `source`, unless the source fails or the
    /// user cancels the loading.
    fn load(&mut self, source: Box<dyn StartSource>) {
        self.pause();
        self.refusal = None;
        let before = std::mem::replace(&mut self.mode, Mode::Loading(LoadingProgress::default()));
        self.publish();
        let mut cancelled = false;
        let made = source.make(&mut |progress| {
            self.mode = Mode::Loading(progress);
            if self.outbox.sent.elapsed() >= PROGRESS_INTERVAL {
                self.publish();
            }
            cancelled |= self.is_interrupted();
            !cancelled
        });
        self.mode = before;
        match made {
            Ok(start) => self.begin(start),
            Err(_) if cancelled => {}
            Err(error) => self.refusal = Some(message(error)),
        }
    }

    /// Returns true if the loading of an initial state must stop, because a command makes it pointless or the callback
    /// `gives_up` returns true. All received commands are kept, to be handled after the loading.
    fn is_interrupted(&mut self) -> bool {
        let mut interrupted = (self.gives_up)();
        while let Ok((number, command)) = self.inbox.try_recv() {
            interrupted |= command.interrupts();
            self.waiting.push_back((number, command));
        }
        interrupted
    }

    fn begin(&mut self, mut start: LiveStart) {
        self.loads += 1;
        let mut surroundings = Surroundings::clone(&start.simulation.snapshot().surroundings);
        surroundings.boundaries.extend_from_slice(&start.held_by);
        self.held = Some(Arc::new(surroundings));
        let mut worlds = std::mem::take(&mut start.worlds);
        if worlds.is_empty() {
            worlds.push(*start.settings());
        }
        let history = start.history.take();
        self.start = Some(Arc::new(start));
        self.history.clear();
        match history {
            Some(history) => {
                self.history.take_up(history);
                self.mode = Mode::Paused;
            }
            None => self.restart(&worlds),
        }
    }

    /// Starts one simulation for each of these settings at the initial state.
    fn restart(&mut self, all: &[Settings]) {
        if let Some(start) = &self.start
            && !all.is_empty()
        {
            self.history.restart(&start.simulation, start.tally, all);
            self.mode = Mode::Paused;
        }
    }

    /// Sends a frame (the data that the window draws) of the newest state, and wakes the window.
    fn publish(&mut self) {
        let shown_secs = match self.mode {
            Mode::Showing { until_secs } => Some(until_secs),
            _ => None,
        };
        let run = &self.history.present;
        let worlds = run.worlds.iter().map(|world| {
            let moment = shown_secs.and_then(|secs| world.stored.at(secs));
            WorldFrame::of(world, moment, self.held.as_ref())
        });
        let loading = match &self.mode {
            Mode::Loading(progress) => Some(progress.clone()),
            _ => None,
        };
        self.outbox.count += 1;
        self.outbox.frames.write(LiveFrame {
            number: self.outbox.count,
            acknowledged: self.acknowledged,
            loads: self.loads,
            start: self.start.clone(),
            worlds: worlds.collect(),
            past: self.history.told(),
            ghosts: self.history.ghosts(shown_secs.unwrap_or_else(|| run.time_secs())),
            playing: self.mode.plays(),
            replaying: run.replays(),
            branching: run.branches(),
            seeking: self.mode.seeks() || matches!(self.mode, Mode::Stepping { .. }),
            stored: shown_secs.is_some(),
            loading,
            refusal: self.refusal.clone(),
            real_time_factor: self.clock.real_time_factor,
            steps_per_sec: self.clock.steps_per_sec,
        });
        self.outbox.sent = Instant::now();
        self.outbox.is_behind = false;
        (self.outbox.wake)();
    }
}
