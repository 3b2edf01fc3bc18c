//! The loop of the solver's thread.

use std::collections::VecDeque;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::time::{Duration, Instant};

use triple_buffer::Input;

use super::clock::Clock;
use super::frame::message;
use super::past::Past;
use super::worlds::Worlds;
use super::{Command, Frame, LiveOptions, Pace, Progress, Record, Start, StartInfo};
use crate::sim::Surroundings;

/// A frame that nobody fetched yet is renewed after so many frame intervals: making one costs time,
/// and an old one shows late what happens.
const UNFETCHED_INTERVALS: u32 = 3;
pub(super) struct Engine {
    pub(super) inbox: Receiver<(u64, Command)>,
    /// Commands that wait for the end of a loading or a seek.
    pub(super) waiting: VecDeque<(u64, Command)>,
    pub(super) output: Input<Frame>,
    pub(super) options: LiveOptions,
    pub(super) start: Option<Start>,
    pub(super) info: Option<Arc<StartInfo>>,
    pub(super) held: Option<Arc<Surroundings>>,
    pub(super) worlds: Worlds,
    pub(super) past: Past,
    pub(super) clock: Clock,
    pub(super) playing: bool,
    pub(super) seeking: bool,
    /// The simulated time up to which stored moments are shown in place of the present one, s.
    pub(super) film: Option<f64>,
    /// Where this play pauses, s.
    pub(super) stop_at_secs: Option<f64>,
    pub(super) loading: Option<Progress>,
    pub(super) refusal: Option<Arc<str>>,
    pub(super) acknowledged: u64,
    pub(super) frames: u64,
    pub(super) loads: u64,
    pub(super) published: Instant,
    /// Whether the newest state is one that no frame shows.
    pub(super) unpublished: bool,
    /// Whether the next step is to be shown as soon as it is taken.
    pub(super) urgent: bool,
    pub(super) quit: bool,
}

impl Engine {
    pub(super) fn new(
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
            past: Past::default(),
            clock: Clock::new(),
            playing: false,
            seeking: false,
            film: None,
            stop_at_secs: None,
            loading: None,
            refusal: None,
            acknowledged: 0,
            frames: 0,
            loads: 0,
            published: Instant::now(),
            unpublished: false,
            urgent: false,
            quit: false,
        }
    }

    pub(super) fn run(mut self) {
        while !self.quit {
            if !self.receive() {
                return;
            }
            if self.seeking {
                self.advance_seek();
            } else if self.playing && self.film.is_some() {
                if self.wait_for_frame().is_zero() {
                    self.advance_film();
                }
            } else if self.playing && self.wait_for_step().is_zero() {
                self.tick();
                self.stop_when_done();
            }
            if self.unpublished && (self.urgent || self.wait_for_frame().is_zero()) {
                self.urgent = false;
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
            // What was changed shows in the step that comes next, if that comes at once.
            self.urgent = self.playing && self.wait_for_step().is_zero();
            if !self.urgent {
                self.publish();
            }
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
        match self.film {
            Some(_) => self.wait_for_frame(),
            None => self.clock.wait(self.worlds.time_secs()),
        }
    }

    fn wait_for_frame(&self) -> Duration {
        let fetched = self.output.consumed();
        let intervals = if fetched { 1 } else { UNFETCHED_INTERVALS };
        (intervals * self.options.frame_interval).saturating_sub(self.published.elapsed())
    }

    fn handle(&mut self, number: u64, command: Command) {
        if self.film.is_some() && command.is_about_the_moment() {
            self.leave_film();
            self.waiting.push_front((number, command));
            return;
        }
        match command {
            Command::Load(loader) => self.load(loader),
            Command::CancelLoading => {}
            Command::Compare(variants) => self.restart(&variants),
            Command::Change(world, settings) => {
                if let Some(track) = self.worlds.tracks.get_mut(world) {
                    self.refusal = track.simulation.change(settings).err().map(message);
                }
            }
            Command::SetPull(world, pull) => {
                if let Some(track) = self.worlds.tracks.get_mut(world) {
                    track.simulation.set_pull(pull);
                }
            }
            Command::Edit(world, edit) => self.edit(world, edit),
            Command::Play => self.play(),
            Command::Pause => {
                self.playing = false;
                self.leave_film();
            }
            Command::Step => {
                self.playing = false;
                self.tick();
            }
            Command::Reset => {
                let variants = self.worlds.variants();
                self.restart(&variants);
            }
            Command::Return(number) => {
                if let Some(mut worlds) = self.past.take(number) {
                    worlds.keep_within(self.options.recording_bytes);
                    self.put_in_place(worlds);
                }
            }
            Command::Seek(time_secs) => {
                self.playing = false;
                self.seek(time_secs);
            }
            Command::SetPace(pace) => {
                self.clock.pace = pace;
                self.restart_clock();
                if pace == Pace::Max {
                    self.leave_film();
                }
            }
            Command::Quit => self.quit = true,
            Command::Name(..) | Command::Take(..) | Command::TakeAll(..) => self.hand_out(command),
        }
        self.acknowledged = number;
        self.unpublished = true;
    }

    /// Names what there is, or hands it out; nothing of it changes.
    fn hand_out(&mut self, command: Command) {
        match command {
            Command::Name(None, name) => self.worlds.name = name,
            Command::Name(Some(number), name) => self.past.name(number, name),
            Command::Take(world, taker) => {
                if let Some(track) = self.worlds.tracks.get(world) {
                    taker(track.taken());
                }
            }
            Command::TakeAll(taker) => {
                if let Some(start) = &self.start {
                    let record = Some(Record::of(&self.worlds, &self.past));
                    taker(Start { record, ..start.clone() });
                }
            }
            _ => {}
        }
    }

    fn play(&mut self) {
        if self.worlds.tracks.is_empty() || self.worlds.has_failed() || self.film.is_some() {
            return;
        }
        let duration = self.start.as_ref().map_or(f64::INFINITY, |start| start.duration_secs);
        let before_end = self.worlds.time_secs() + 0.5 * self.worlds.time_step_secs() < duration;
        self.stop_at_secs = before_end.then_some(duration);
        self.playing = true;
        self.restart_clock();
        self.begin_film();
    }

    fn tick(&mut self) {
        if self.worlds.branch() {
            self.past.keep(self.worlds.clone(), self.options.recording_bytes);
            self.worlds.name.clear();
        }
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
}

impl Command {
    /// Whether it changes a state that a seek is still computing.
    fn waits_for_seek(&self) -> bool {
        matches!(
            self,
            Self::Change(..)
                | Self::SetPull(..)
                | Self::Edit(..)
                | Self::Play
                | Self::Step
                | Self::Reset
                | Self::Return(..)
                | Self::Take(..)
                | Self::TakeAll(..)
        )
    }
}
