//! Tests that a remote run, whose solver exchanges only bytes with the window, equals a run in a thread of the window's
//! process.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};

use serde::de::DeserializeOwned;
use slump::config::Config;
use slump::live::{
    Command, Curve, Live, LiveFrame, LiveOptions, LiveStart, LoadingProgress, RemoteEngine,
    StartSource, Tell, WorldHistory,
};
use slump::sim::Settings;

/// A window and the solver of its remote run (the two exchange only bytes), with the messages between them.
struct Remote<S = LiveStart> {
    live: Live,
    engine: RemoteEngine<S>,
    /// Messages of the window. The second item is true if the message cancels the loading of a scene.
    requests: Receiver<(Vec<u8>, bool)>,
    replies: Receiver<Vec<u8>>,
    to_window: Sender<Vec<u8>>,
    bytes: usize,
    interruptions: usize,
}

impl Remote {
    fn new() -> Self {
        Self::with(LiveOptions::default())
    }
}

impl<S: StartSource + DeserializeOwned> Remote<S> {
    fn with(options: LiveOptions) -> Self {
        let (post_request, requests) = channel();
        let (post_reply, replies) = channel();
        let (to_window, inbox) = channel();
        let ask = Box::new(move |bytes, interrupts| {
            post_request.send((bytes, interrupts)).expect("a reader");
        });
        let reply = Box::new(move |bytes| post_reply.send(bytes).expect("a reader"));
        let live = Live::remote(ask, inbox);
        let engine = RemoteEngine::new(reply, options);
        Self { live, engine, requests, replies, to_window, bytes: 0, interruptions: 0 }
    }

    /// Passes messages between window and solver until a frame of the window fulfils a condition. Returns this frame.
    fn until(&mut self, wanted: impl Fn(&LiveFrame) -> bool) -> LiveFrame {
        let begun = std::time::Instant::now();
        loop {
            for (message, interrupts) in self.requests.try_iter() {
                self.interruptions += usize::from(interrupts);
                self.engine.receive(&message).expect("a message");
            }
            self.engine.turn();
            for reply in self.replies.try_iter() {
                self.bytes += reply.len();
                self.to_window.send(reply).expect("a reader");
            }
            let frame = self.live.latest();
            if wanted(frame) {
                return frame.clone();
            }
            assert!(begun.elapsed().as_secs() < 60, "stands still at {} s", frame.time_secs());
        }
    }

    fn done(&mut self) -> LiveFrame {
        let sent = self.live.sent();
        self.until(|frame| frame.acknowledged == sent && !frame.seeking && !frame.playing)
    }
}

fn start() -> LiveStart {
    let config = Config::of_scene("pile");
    let scene = config.scene(|_| true).expect("a pile");
    let simulation = scene.simulation().expect("a sound scene");
    let view = [glam::DVec2::ZERO, glam::DVec2::ONE];
    LiveStart {
        scene,
        config,
        window: None,
        simulation,
        tally: Default::default(),
        held_by: Vec::new(),
        view,
        slumps: true,
        worlds: Vec::new(),
        history: None,
    }
}

/// Returns a typical sequence of commands of a window.
fn commands(settings: Settings) -> Vec<Command> {
    let mut commands = vec![Command::Load(Box::new(start())), Command::Compare(vec![settings; 2])];
    commands.extend((0..30).map(|_| Command::Step));
    commands.push(Command::Change(1, settings.over(2e-3)));
    commands.extend((0..10).map(|_| Command::Step));
    commands.push(Command::Seek(0.02));
    commands
}

fn rows(curve: &Curve) -> Vec<slump::sim::Observables> {
    curve.rows().copied().collect()
}

fn assert_same(remote: &LiveFrame, local: &LiveFrame) {
    assert_eq!(remote.worlds.len(), local.worlds.len());
    assert_eq!(remote.recorded_secs(), local.recorded_secs());
    assert_eq!(remote.past.len(), local.past.len());
    for (remote, local) in remote.worlds.iter().zip(&local.worlds) {
        assert_eq!(remote.snapshot.grains, local.snapshot.grains);
        assert_eq!(remote.snapshot.observables, local.snapshot.observables);
        assert_eq!(remote.controls, local.controls);
        assert_eq!(rows(&remote.curve), rows(&local.curve));
    }
}

#[test]
fn a_remote_run_is_that_of_a_thread() {
    let settings = Settings::default().with_bond(20.0);
    let (mut remote, mut local) =
        (Remote::new(), Live::spawn(LiveOptions::default()).expect("a thread"));
    for (one, other) in commands(settings).into_iter().zip(commands(settings)) {
        remote.live.send(one);
        local.send(other);
    }
    let there = remote.done();
    let sent = local.sent();
    let here = loop {
        let frame = local.latest();
        if frame.acknowledged == sent && !frame.seeking {
            break frame.clone();
        }
        std::thread::yield_now();
    };
    assert!(here.worlds[1].curve.rows().count() > 20, "worlds have moved");
    assert_same(&there, &here);
}

#[test]
fn what_is_taken_down_remotely_comes_with_its_start() {
    let mut remote = Remote::new();
    remote.live.send(Command::Load(Box::new(start())));
    remote.live.send(Command::Step);
    let (sender, taken) = channel::<(String, WorldHistory)>();
    let hand_on = move |start: std::sync::Arc<LiveStart>, world| {
        sender.send((start.scene.name.clone(), world)).expect("a reader");
    };
    remote.live.send(Command::Take(0, Box::new(hand_on)));
    let (sender, all) = channel::<LiveStart>();
    remote
        .live
        .send(Command::TakeAll(Box::new(move |start| sender.send(start).expect("a reader"))));
    let frame = remote.done();
    let (name, world) = taken.try_recv().expect("a run");
    assert_eq!((&*name, world.simulation.observables().step), ("pile", 1));
    assert_eq!(world.simulation.snapshot().grains, frame.worlds[0].snapshot.grains);
    let all = all.try_recv().expect("all of it");
    assert!(all.history.is_some_and(|history| history.is_sound()));
}

#[test]
fn a_frame_of_a_long_remote_run_sends_what_is_new_alone() {
    let mut remote = Remote::new();
    remote.live.send(Command::Load(Box::new(start())));
    for _ in 0..300 {
        remote.live.send(Command::Step);
        remote.done();
    }
    let early = std::mem::take(&mut remote.bytes);
    let whole = remote.live.latest().worlds[0].curve.len();
    assert!(whole >= 300, "its curve is long: {whole}");
    for _ in 0..100 {
        remote.live.send(Command::Step);
        remote.done();
    }
    let late = remote.bytes;
    assert!(late < early / 2, "100 later frames are {late} bytes, 300 early ones {early}");
}

#[test]
fn what_cannot_be_made_remotely_is_refused_in_a_sentence() {
    let mut remote = Remote::new();
    let mut broken = start();
    broken.scene.name = "broken".into();
    struct None(LiveStart);
    impl StartSource for None {
        fn make(self: Box<Self>, _: slump::live::Tell<'_>) -> slump::error::Result<LiveStart> {
            Ok(self.0)
        }
        fn to_bytes(&self) -> slump::error::Result<Vec<u8>> {
            Err(slump::error::Error::value("start", "here alone", "one that can be sent"))
        }
    }
    remote.live.send(Command::Load(Box::new(None(broken))));
    let refusal = remote.live.latest().refusal.clone().expect("a refusal");
    assert_eq!(&*refusal, "start is here alone, but must be one that can be sent");
}

/// True if the window has sent a command for which the loading of a scene must stop.
static IS_POINTLESS: AtomicBool = AtomicBool::new(false);

/// Source of a pile: a deposition that continues until it is cancelled, or a pile that exists already.
#[derive(serde::Serialize, serde::Deserialize)]
struct Rain {
    is_endless: bool,
}

impl StartSource for Rain {
    fn make(self: Box<Self>, tell: Tell<'_>) -> slump::error::Result<LiveStart> {
        if !self.is_endless {
            return Ok(start());
        }
        for told in 1.. {
            // While a scene is loaded, no message arrives. The window signals the cancellation in another way.
            IS_POINTLESS.store(told == 100, Ordering::Relaxed);
            if !tell(LoadingProgress::default()) {
                assert_eq!(told, 100, "given up when it was asked for");
                break;
            }
        }
        Err(slump::error::Error::value("rain", "given up", "waited for"))
    }

    fn to_bytes(&self) -> slump::error::Result<Vec<u8>> {
        slump::live::to_bytes(self)
    }
}

#[test]
fn a_start_that_is_made_remotely_is_given_up_though_no_message_comes_in() {
    let gives_up = Box::new(|| IS_POINTLESS.load(Ordering::Relaxed));
    let mut remote = Remote::<Rain>::with(LiveOptions { gives_up, ..LiveOptions::default() });
    remote.live.send(Command::Load(Box::new(Rain { is_endless: false })));
    remote.live.send(Command::Step);
    assert_eq!((remote.done().loads, remote.interruptions), (1, 1));
    remote.live.send(Command::Load(Box::new(Rain { is_endless: true })));
    remote.done();
    // The message of the command that cancels the loading arrives after the loading has ended.
    remote.live.send(Command::CancelLoading);
    let frame = remote.done();
    assert!(frame.loading.is_none() && frame.refusal.is_none(), "giving up is no failure");
    assert_eq!((frame.loads, frame.worlds[0].snapshot.observables.step), (1, 1), "what was there");
    assert_eq!(remote.interruptions, 3, "a start, another, and the end of that");
}
