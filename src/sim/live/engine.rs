//! The loop of the solver's thread.

use std::collections::VecDeque;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::time::{Duration, Instant};

use triple_buffer::Input;

use super::clock::Clock;
use super::track::Track;
use super::worlds::Worlds;
use super::{
    Command, Frame, LiveOptions, Loader, Progress, Settings, Start, StartInfo, Variant, WorldFrame,
};
use crate::sim::{Snapshot, Surroundings};

/// A frame that nobody fetched yet is renewed after so many frame intervals: making one costs time,
/// and an old one shows late what happens.
const UNFETCHED_INTERVALS: u32 = 3;
/// Least time between two frames that tell of the progress of a loading.
const PROGRESS_INTERVAL: Duration = Duration::from_millis(50);

pub(super) struct Engine {
    inbox: Receiver<(u64, Command)>,
    /// Commands that wait for the end of a loading or a seek.
    waiting: VecDeque<(u64, Command)>,
    output: Input<Frame>,
    options: LiveOptions,
    start: Option<Start>,
    info: Option<Arc<StartInfo>>,
    held: Option<Arc<Surroundings>>,
    worlds: Worlds,
    clock: Clock,
    playing: bool,
    seeking: bool,
    /// Where this play pauses, s.
    stop_at_secs: Option<f64>,
    loading: Option<Progress>,
    refusal: Option<Arc<str>>,
    acknowledged: u64,
    frames: u64,
    loads: u64,
    published: Instant,
    /// Whether the newest state is one that no frame shows.
    unpublished: bool,
    quit: bool,
}

impl Engine {
    pub fn new(
        inbox: Receiver<(u64, Command)>,
        output: Input<Frame>,
        options: LiveOptions,
    ) -> Self {
        Self {
            inbox,
            waiting: VecDeque::new(),
            output,
            options,
            start: None,
            info: None,
            held: None,
            worlds: Worlds::default(),
            clock: Clock::new(),
            playing: false,
            seeking: false,
            stop_at_secs: None,
            loading: None,
            refusal: None,
            acknowledged: 0,
            frames: 0,
            loads: 0,
            published: Instant::now(),
            unpublished: false,
            quit: false,
        }
    }

    pub fn run(mut self) {
        while !self.quit {
            if !self.receive() {
                return;
            }
            if self.seeking {
                self.advance_seek();
            } else if self.playing && self.wait_for_step().is_zero() {
                self.tick();
                self.stop_when_done();
            }
            if self.unpublished && self.wait_for_frame().is_zero() {
                self.publish();
            }
        }
    }

    /// Takes in all commands; sleeps for one where nothing else is to be done. Whether there is
    /// anyone left to send any.
    fn receive(&mut self) -> bool {
        let mut commanded = false;
        loop {
            if !self.seeking
                && let Some((number, command)) = self.waiting.pop_front()
            {
                self.handle(number, command);
                commanded = true;
                continue;
            }
            let wait = if commanded || self.quit { Some(Duration::ZERO) } else { self.wait() };
            let received = match wait {
                None => self.inbox.recv().map_err(|_| RecvTimeoutError::Disconnected),
                Some(wait) => self.inbox.recv_timeout(wait),
            };
            match received {
                Ok((number, command)) if self.seeking && command.waits_for_seek() => {
                    self.waiting.push_back((number, command));
                }
                Ok((number, command)) => self.handle(number, command),
                Err(RecvTimeoutError::Timeout) => break,
                Err(RecvTimeoutError::Disconnected) => return false,
            }
            commanded = true;
        }
        if commanded && !self.seeking {
            self.publish();
        }
        true
    }

    /// How long nothing is to be done; none where only a command changes that.
    fn wait(&mut self) -> Option<Duration> {
        if self.seeking {
            return Some(Duration::ZERO);
        }
        let frame = self.unpublished.then(|| self.wait_for_frame());
        let step = self.playing.then(|| self.wait_for_step());
        frame.into_iter().chain(step).min()
    }

    fn wait_for_step(&mut self) -> Duration {
        self.clock.wait(self.worlds.time_secs())
    }

    fn wait_for_frame(&self) -> Duration {
        let fetched = self.output.consumed();
        let intervals = if fetched { 1 } else { UNFETCHED_INTERVALS };
        (intervals * self.options.frame_interval).saturating_sub(self.published.elapsed())
    }

    fn handle(&mut self, number: u64, command: Command) {
        match command {
            Command::Load(loader) => self.load(loader),
            Command::CancelLoading => {}
            Command::Compare(variants) => self.restart(&variants),
            Command::SetParameters(world, parameters) => {
                if let Some(track) = self.worlds.tracks.get_mut(world) {
                    self.refusal = track.simulation.set_parameters(parameters).err().map(message);
                }
            }
            Command::SetSolver(world, solver) => {
                if let Some(track) = self.worlds.tracks.get_mut(world) {
                    self.refusal = track.simulation.set_solver(solver).err().map(message);
                }
            }
            Command::SetPull(world, pull) => {
                if let Some(track) = self.worlds.tracks.get_mut(world) {
                    track.simulation.set_pull(pull);
                }
            }
            Command::Play => self.play(),
            Command::Pause => self.playing = false,
            Command::Step => {
                self.playing = false;
                self.tick();
            }
            Command::Reset => {
                let variants = self.worlds.variants();
                self.restart(&variants);
            }
            Command::Seek(time_secs) => {
                self.playing = false;
                self.seeking = true;
                self.worlds.seek(time_secs);
            }
            Command::SetPace(pace) => {
                self.clock.pace = pace;
                self.restart_clock();
            }
            Command::Quit => self.quit = true,
        }
        self.acknowledged = number;
        self.unpublished = true;
    }

    fn play(&mut self) {
        if self.worlds.tracks.is_empty() || self.worlds.has_failed() {
            return;
        }
        let duration = self.start.as_ref().map_or(f64::INFINITY, |start| start.duration_secs);
        let before_end = self.worlds.time_secs() + 0.5 * self.worlds.time_step_secs() < duration;
        self.stop_at_secs = before_end.then_some(duration);
        self.playing = true;
        self.restart_clock();
    }

    fn restart_clock(&mut self) {
        self.clock.start(self.worlds.time_secs());
    }

    /// Puts worlds at the start, one a variant.
    fn restart(&mut self, variants: &[Variant]) {
        let Some(start) = &self.start else { return };
        if variants.is_empty() {
            return;
        }
        self.worlds = Worlds::new(&start.simulation, variants, self.options.recording_bytes);
        self.playing = false;
        self.seeking = false;
    }

    fn load(&mut self, loader: Loader) {
        self.playing = false;
        self.refusal = None;
        self.loading = Some(Progress::default());
        self.publish();
        let mut cancelled = false;
        let outcome = loader(&mut |progress| {
            self.tell_progress(progress);
            cancelled |= self.is_interrupted();
            !cancelled
        });
        self.loading = None;
        match outcome {
            Ok(start) => self.begin(start),
            Err(_) if cancelled => {}
            Err(error) => self.refusal = Some(message(error)),
        }
    }

    fn tell_progress(&mut self, progress: Progress) {
        self.loading = Some(progress);
        if self.published.elapsed() >= PROGRESS_INTERVAL {
            self.publish();
        }
    }

    /// Whether a command came that makes the present loading pointless. The others wait.
    fn is_interrupted(&mut self) -> bool {
        let mut interrupted = false;
        while let Ok((number, command)) = self.inbox.try_recv() {
            interrupted |=
                matches!(command, Command::CancelLoading | Command::Load(_) | Command::Quit);
            self.waiting.push_back((number, command));
        }
        interrupted
    }

    fn begin(&mut self, start: Start) {
        self.loads += 1;
        let settings = Settings::of(&start.simulation);
        self.info = Some(Arc::new(StartInfo {
            number: self.loads,
            name: start.name.clone(),
            duration_secs: start.duration_secs,
            held: !start.held_by.is_empty(),
            view: start.view,
            physics: start.simulation.physics(),
            parameters: settings.parameters,
            solver: settings.solver,
        }));
        let mut surroundings = Surroundings::clone(&start.simulation.snapshot().surroundings);
        surroundings.boundaries.extend_from_slice(&start.held_by);
        self.held = Some(Arc::new(surroundings));
        let Settings { parameters, solver, .. } = settings;
        let variant = Variant { parameters, solver };
        self.start = Some(start);
        self.restart(&[variant]);
    }

    fn tick(&mut self) {
        let (steps, all_well) = self.worlds.tick();
        self.clock.count(steps, self.worlds.time_secs());
        self.playing &= all_well;
        self.unpublished = true;
    }

    fn stop_when_done(&mut self) {
        let end_secs = self.worlds.time_secs() + 0.5 * self.worlds.time_step_secs();
        self.playing &= self.stop_at_secs.is_none_or(|stop| end_secs < stop);
        if !self.playing {
            self.publish();
        }
    }

    fn advance_seek(&mut self) {
        if self.worlds.advance_seek() {
            self.seeking = false;
            self.publish();
        }
    }

    fn publish(&mut self) {
        self.frames += 1;
        let worlds = self.worlds.tracks.iter().map(|track| self.world_frame(track)).collect();
        let frame = Frame {
            number: self.frames,
            acknowledged: self.acknowledged,
            start: self.info.clone(),
            worlds,
            playing: self.playing,
            seeking: self.seeking,
            loading: self.loading.clone(),
            refusal: self.refusal.clone(),
            real_time_factor: self.clock.real_time_factor,
            steps_per_sec: self.clock.steps_per_sec,
        };
        self.output.write(frame);
        self.published = Instant::now();
        self.unpublished = false;
        (self.options.wake)();
    }

    fn world_frame(&self, track: &Track) -> WorldFrame {
        let mut snapshot: Snapshot = track.simulation.snapshot();
        if snapshot.observables.step == 0
            && let Some(held) = &self.held
        {
            snapshot.surroundings = Arc::clone(held);
        }
        WorldFrame {
            snapshot: Arc::new(snapshot),
            settings: Settings::of(&track.simulation),
            curve: track.curve.clone(),
            recorded_secs: track.recording.end_secs(),
            unconverged_steps: track.unconverged,
            step_ms: 1e3 * track.step_secs,
            failure: track.failure.clone(),
        }
    }
}

impl Command {
    /// Whether it changes a state that a seek is still computing.
    fn waits_for_seek(&self) -> bool {
        matches!(
            self,
            Self::SetParameters(..)
                | Self::SetSolver(..)
                | Self::SetPull(..)
                | Self::Play
                | Self::Step
                | Self::Reset
        )
    }
}

fn message(error: crate::error::Error) -> Arc<str> {
    error.to_string().into()
}
