//! A live run (a simulation that the user watches while it is computed) whose solver shares no memory with the window,
//! for example in a browser's worker. The window and the solver exchange messages as bytes.
//!
//! Most commands are sent unchanged. A source of initial states is sent as data. A callback that receives a history
//! stays in the window's process and is called when the reply arrives. The solver sends only its newest frame, as the
//! difference from the previous frame, and makes the next frame when the window has seen the last one.

use std::collections::HashMap;
use std::marker::PhantomData;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use triple_buffer::{Output, triple_buffer};

use super::curve::CurveChange;
use super::engine::Engine;
use super::message::{from_bytes, to_bytes};
use super::{
    Command, Curve, LiveFrame, LiveOptions, LiveStart, PastRun, StartSource, StartTaker, Taker,
    WorldHistory,
};
use crate::Instant;
use crate::error::{Error, Result};

/// Time after which the solver sends another frame (the data that the window draws), although the window has not yet
/// confirmed the last one. While an initial state is being computed, the solver receives no messages, so it cannot
/// learn that the window has seen a frame.
const UNSEEN_INTERVAL: Duration = Duration::from_millis(100);

/// A message from the window to the solver. The first number of a message is the number of its command.
#[derive(Serialize, Deserialize)]
enum Request {
    Command(u64, Command),
    Load(u64, Vec<u8>),
    Take(u64, usize),
    TakeAll(u64),
    /// The window has received the last frame (the data that it draws).
    Seen,
}

/// A message from the solver to the window. The number in a message is the number of the command to which the message
/// replies.
#[derive(Serialize, Deserialize)]
enum Reply {
    Frame(Box<FrameChange>),
    Taken(u64, Arc<LiveStart>, Box<WorldHistory>),
    TakenAll(u64, Box<LiveStart>),
}

/// A frame (the data that the window draws) as its difference from the previous frame.
#[derive(Serialize, Deserialize)]
struct FrameChange {
    /// The frame (the data that the window draws) without the data that are sent only when they change: the initial
    /// state, the summaries of earlier runs, and the curves of measured quantities.
    frame: LiveFrame,
    start: Option<Arc<LiveStart>>,
    past: Option<Arc<[PastRun]>>,
    curves: Vec<CurveChange>,
}

impl FrameChange {
    fn between(before: &LiveFrame, frame: &LiveFrame) -> Self {
        let no_curve = Curve::default();
        let mut sent = LiveFrame { start: None, past: Arc::new([]), ..frame.clone() };
        let curves = sent.worlds.iter_mut().enumerate().map(|(index, world)| {
            let old = before.worlds.get(index).map_or(&no_curve, |world| &world.curve);
            CurveChange::between(old, &std::mem::take(&mut world.curve))
        });
        let curves = curves.collect();
        let start = frame.start.clone().filter(|_| before.loads != frame.loads);
        let past = (!Arc::ptr_eq(&before.past, &frame.past)).then(|| Arc::clone(&frame.past));
        Self { frame: sent, start, past, curves }
    }

    fn after(self, mut before: LiveFrame) -> LiveFrame {
        let Self { mut frame, start, past, curves } = self;
        frame.start = start.or(before.start.take());
        frame.past = past.unwrap_or_else(|| Arc::clone(&before.past));
        let mut old = before.worlds.into_iter().map(|world| world.curve);
        for (world, change) in frame.worlds.iter_mut().zip(curves) {
            world.curve = change.after(old.next().unwrap_or_default());
        }
        frame
    }
}

/// A callback of the window that waits for a history: of one simulation, or of the whole run.
enum Waiting {
    World(Taker),
    All(StartTaker),
}

/// Callback that sends the bytes of a message to the solver. Its second argument is true if the initial state that is
/// being loaded is to be abandoned.
pub type Ask = Box<dyn FnMut(Vec<u8>, bool)>;

/// Endpoint of a remote run in the window's process: sends commands to the solver and receives its frames (the data
/// that the window draws).
pub(super) struct RemoteRun {
    ask: Ask,
    inbox: Receiver<Vec<u8>>,
    frame: LiveFrame,
    waiting: HashMap<u64, Waiting>,
}

impl RemoteRun {
    pub(super) fn new(ask: Ask, inbox: Receiver<Vec<u8>>) -> Self {
        Self { ask, inbox, frame: LiveFrame::default(), waiting: HashMap::new() }
    }

    pub(super) fn send(&mut self, number: u64, command: Command) {
        let interrupts = command.interrupts();
        let request = match command {
            Command::Load(source) => match source.to_bytes() {
                Ok(bytes) => Request::Load(number, bytes),
                Err(refusal) => return self.refuse(refusal),
            },
            Command::Take(world, taker) => {
                self.waiting.insert(number, Waiting::World(taker));
                Request::Take(number, world)
            }
            Command::TakeAll(taker) => {
                self.waiting.insert(number, Waiting::All(taker));
                Request::TakeAll(number)
            }
            command => Request::Command(number, command),
        };
        self.ask(&request, interrupts);
    }

    pub(super) fn latest(&mut self) -> &LiveFrame {
        while let Ok(bytes) = self.inbox.try_recv() {
            match from_bytes(&bytes) {
                Ok(Reply::Frame(change)) => {
                    self.frame = change.after(std::mem::take(&mut self.frame));
                    self.ask(&Request::Seen, false);
                }
                Ok(Reply::Taken(number, start, world)) => {
                    if let Some(Waiting::World(taker)) = self.waiting.remove(&number) {
                        taker(start, *world);
                    }
                }
                Ok(Reply::TakenAll(number, start)) => {
                    if let Some(Waiting::All(taker)) = self.waiting.remove(&number) {
                        taker(*start);
                    }
                }
                Err(refusal) => self.refuse(refusal),
            }
        }
        &self.frame
    }

    fn ask(&mut self, request: &Request, interrupts: bool) {
        match to_bytes(request) {
            Ok(bytes) => (self.ask)(bytes, interrupts),
            Err(refusal) => self.refuse(refusal),
        }
    }

    fn refuse(&mut self, refusal: Error) {
        self.frame.refusal = Some(refusal.to_string().into());
    }
}

/// Callback that sends the bytes of a message to the window. Frames are also sent while an initial state is being
/// computed.
pub type Post = Box<dyn FnMut(Vec<u8>) + Send>;

/// Sends a frame (the data to draw) to the window when the window has confirmed the previous frame, or after
/// [`UNSEEN_INTERVAL`].
struct FramePoster {
    frames: Output<LiveFrame>,
    /// The last frame (the data to draw) that was sent to the window.
    posted: LiveFrame,
    posted_at: Instant,
    is_seen: bool,
    post: Post,
}

impl FramePoster {
    fn post_if_due(&mut self) {
        let is_due = self.is_seen || self.posted_at.elapsed() >= UNSEEN_INTERVAL;
        if !is_due || !self.frames.updated() {
            return;
        }
        let frame = self.frames.read();
        let change = FrameChange::between(&self.posted, frame);
        self.posted = frame.clone();
        (self.posted_at, self.is_seen) = (Instant::now(), false);
        self.reply(&Reply::Frame(Box::new(change)));
    }

    fn reply(&mut self, reply: &Reply) {
        // Plain data can always be encoded, so this cannot fail.
        if let Ok(bytes) = to_bytes(reply) {
            (self.post)(bytes);
        }
    }
}

/// Endpoint of a remote run in the solver's process: an engine that never sleeps. `S` is the type of its sources of
/// initial states.
pub struct RemoteEngine<S> {
    engine: Engine,
    commands: Sender<(u64, Command)>,
    poster: Arc<Mutex<FramePoster>>,
    sources: PhantomData<S>,
}

impl<S: StartSource + DeserializeOwned> RemoteEngine<S> {
    /// Returns an engine without an initial state, which sends its replies through the callback `post`.
    pub fn new(post: Post, options: LiveOptions) -> Self {
        let (commands, inbox) = channel();
        let (output, frames) = triple_buffer(&LiveFrame::default());
        let poster = Arc::new(Mutex::new(FramePoster {
            frames,
            posted: LiveFrame::default(),
            posted_at: Instant::now(),
            is_seen: true,
            post,
        }));
        let to = Arc::clone(&poster);
        let wake = Box::new(move || lock(&to).post_if_due());
        let engine = Engine::new(inbox, output, LiveOptions { wake, ..options });
        Self { engine, commands, poster, sources: PhantomData }
    }

    /// Handles a message from the window.
    ///
    /// # Errors
    /// If the message is invalid.
    pub fn receive(&mut self, message: &[u8]) -> Result<()> {
        let poster = Arc::clone(&self.poster);
        let (number, command) = match from_bytes(message)? {
            Request::Command(number, command) => (number, command),
            Request::Load(number, bytes) => {
                let source: S = from_bytes(&bytes)?;
                (number, Command::Load(Box::new(source)))
            }
            Request::Take(number, world) => {
                let hand_on = move |start, world| {
                    lock(&poster).reply(&Reply::Taken(number, start, Box::new(world)));
                };
                (number, Command::Take(world, Box::new(hand_on)))
            }
            Request::TakeAll(number) => {
                let hand_on =
                    move |start| lock(&poster).reply(&Reply::TakenAll(number, Box::new(start)));
                (number, Command::TakeAll(Box::new(hand_on)))
            }
            Request::Seen => {
                let mut poster = lock(&poster);
                poster.is_seen = true;
                poster.post_if_due();
                return Ok(());
            }
        };
        // The engine owns the receiver of the channel, so sending cannot fail.
        let _ = self.commands.send((number, command));
        Ok(())
    }

    /// Handles the received commands and takes the steps that are due. Returns the wall-clock time until the next step
    /// or frame (the data that the window draws) is due; `None` if nothing is due before the next message.
    pub fn turn(&mut self) -> Option<Duration> {
        self.engine.turn(false);
        self.engine.wait()
    }
}

fn lock(poster: &Mutex<FramePoster>) -> std::sync::MutexGuard<'_, FramePoster> {
    poster.lock().unwrap_or_else(PoisonError::into_inner)
}
