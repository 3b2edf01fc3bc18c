//! Benchmark: cost of the window. It measures frames per second while the solver runs at full speed, steps per second
//! with and without the window, and the latency of a slider. The display itself is not included: the real panels are
//! drawn into memory by the driver that a window would use.
//!
//! ```text
//! cargo bench --bench window
//! cargo bench --bench window -- others     # only: slowdown of the world in front by other piles
//! cargo bench --bench window -- frames     # only: frames, steps and pauses of small and large scenes
//! ```

mod common;

use std::time::{Duration, Instant};

use slump::app::{AppState, Canvas, Preferences, SOFTWARE_FRAME_INTERVAL, theme, ui};
use slump::config::Config;
use slump::live::{Command, Live, LiveFrame, LiveOptions, LiveStart, Pace};
use slump::sim::{Simulation, Tally};
use slump::solver::{Method, SolverSettings, StopTest};

/// Width and height of the window, pixels.
const SIZE: [u32; 2] = [1280, 800];
/// Time during which frames are counted, s.
const COUNTED: Duration = Duration::from_secs(4);
/// Number of timed steps of the pile, during its collapse.
const STEPS: u64 = 1500;
/// Number of repeats; the fastest repeat counts.
const REPEATS: usize = 3;
/// Number of steps (Δt = 1e-3 s) of the pile that is timed while other piles are computed, and number of repeats.
const COLLAPSE: u64 = 900;
const TURNS: usize = 10;
/// Number of timed layouts of the panels; the fastest layout counts.
const FRAMES: usize = 100;
/// Number of changes of the time step, or of pauses, whose latency is measured.
const CHANGES: usize = 40;

/// A window without a display.
struct Window {
    state: AppState,
    canvas: Canvas,
    context: egui::Context,
}

impl Window {
    fn open(simulation: Simulation) -> Self {
        let live = Live::spawn(LiveOptions::default()).expect("a thread");
        let preferences =
            Preferences { full_speed: true, ensemble: false, ..Preferences::default() };
        let mut state = AppState::new(live, Config::default(), preferences);
        state.run.live.send(load(simulation));
        state.run.live.send(Command::SetPace(Pace::Max));
        let context = egui::Context::default();
        theme::install(&context);
        let canvas = Canvas::new().expect("a graphics driver");
        let mut window = Self { state, canvas, context };
        window.wait();
        window
    }

    fn draw(&mut self) {
        let Self { state, canvas, context } = self;
        canvas.draw(context, SIZE, 1.0, false, |root| ui(root, state)).expect("a picture");
    }

    /// Draws frames until every command has been carried out.
    fn wait(&mut self) {
        loop {
            self.draw();
            let frame = &self.state.run.frame;
            if frame.acknowledged == self.state.run.live.sent() && frame.loading.is_none() {
                return;
            }
        }
    }

    /// Returns the time to lay out the panels and make their triangles, without drawing pixels, ms: the shortest time
    /// of all repeats.
    fn panels(&mut self) -> f64 {
        let Self { state, context, .. } = self;
        let size = egui::vec2(SIZE[0] as f32, SIZE[1] as f32);
        let screen_rect = Some(egui::Rect::from_min_size(egui::Pos2::ZERO, size));
        let millis = (0..FRAMES).map(|_| {
            let start = Instant::now();
            let input = egui::RawInput { screen_rect, ..egui::RawInput::default() };
            let output = context.run_ui(input, |root| ui(root, state));
            std::hint::black_box(context.tessellate(output.shapes, output.pixels_per_point));
            1e3 * start.elapsed().as_secs_f64()
        });
        millis.fold(f64::INFINITY, f64::min)
    }

    /// Returns the median and the longest time from the command to pause until the run stands still, ms. Nothing is
    /// drawn meanwhile.
    fn pauses(&mut self) -> [f64; 2] {
        let mut millis: Vec<f64> = (0..CHANGES)
            .map(|_| {
                self.state.run.live.send(Command::Play);
                std::thread::sleep(Duration::from_millis(57));
                let start = Instant::now();
                let told = self.state.run.live.send(Command::Pause);
                let stands = |frame: &LiveFrame| frame.acknowledged >= told && !frame.playing;
                while !stands(self.state.run.live.latest()) {
                    std::thread::sleep(Duration::from_micros(100));
                }
                1e3 * start.elapsed().as_secs_f64()
            })
            .collect();
        millis.sort_by(f64::total_cmp);
        [millis[CHANGES / 2], millis[CHANGES - 1]]
    }

    /// Returns the newest step that the solver has published.
    fn newest_step(&mut self) -> u64 {
        let frame = self.state.run.live.latest();
        frame.worlds.first().map_or(0, |world| world.snapshot.observables.step)
    }

    fn steps(&self) -> u64 {
        self.state.run.world().map_or(0, |world| world.snapshot.observables.step)
    }
}

fn load(simulation: Simulation) -> Command {
    let mut scene = slump::scene::built_in("pile").expect("a scene");
    scene.duration_secs = f64::INFINITY;
    let (config, window) = (Config::of_scene("pile"), None);
    let view = [glam::DVec2::new(-0.1, 0.0), glam::DVec2::new(0.1, 0.06)];
    let (held_by, tally, worlds) = (Vec::new(), Tally::default(), Vec::new());
    let (slumps, history) = (true, None);
    Command::Load(Box::new(LiveStart {
        scene,
        config,
        window,
        simulation,
        tally,
        held_by,
        view,
        slumps,
        worlds,
        history,
    }))
}

fn pile() -> Simulation {
    let mut config = Config::default();
    (config.solver.tolerance, config.solver.max_sweeps) = (Some(1e-5), Some(2000));
    config.scene(|_| true).and_then(|scene| scene.simulation()).expect("the paper's pile")
}

fn main() {
    // With this argument criterion asks for the tests of a benchmark, and this benchmark has none.
    if std::env::args().any(|argument| argument == "--test") {
        return;
    }
    if std::env::args().any(|argument| argument == "others") {
        return beside_other_piles();
    }
    if std::env::args().any(|argument| argument == "frames") {
        return frames();
    }
    frames();
    steps();
    latency();
    beside_other_piles();
}

/// Measures how much other piles on idle cores slow down the pile in front: the collapse of this pile is timed
/// alternately with and without other piles. Nothing is drawn meanwhile.
fn beside_other_piles() {
    let cache = tempfile::tempdir().expect("a folder");
    let mut least = [f64::INFINITY; 2];
    for turn in 0..2 * TURNS {
        let beside = turn % 2 == 1;
        let live = Live::spawn(LiveOptions::default()).expect("a thread");
        let preferences =
            Preferences { full_speed: true, ensemble: beside, ..Preferences::default() };
        let mut state = AppState::new(live, Config::default(), preferences);
        state.ensemble.keep_in(cache.path().join(turn.to_string()));
        let context = egui::Context::default();
        theme::install(&context);
        while state.run.frame.worlds.is_empty() || beside && state.ensemble.threads() == 0 {
            let _ = context.run_ui(egui::RawInput::default(), |root| ui(root, &mut state));
        }
        std::thread::sleep(Duration::from_millis(300));
        state.run.live.send(Command::Play);
        let newest = |state: &mut AppState| {
            let worlds = &state.run.live.latest().worlds;
            worlds.first().map_or(0, |world| world.snapshot.observables.step)
        };
        let begun = Instant::now();
        while newest(&mut state) < COLLAPSE {
            std::thread::sleep(Duration::from_millis(1));
        }
        least[turn % 2] = least[turn % 2].min(begun.elapsed().as_secs_f64());
    }
    let [alone, with] = least.map(|secs| COLLAPSE as f64 / secs);
    let loss = 100.0 * (1.0 - with / alone);
    println!("in front: {alone:.0} steps/s alone, {with:.0} beside other piles, {loss:.1} % less");
}

fn frames() {
    for count in [138, 2_000, 10_000, 50_000] {
        let simulation = if count == 138 { pile() } else { large(count) };
        let mut window = Window::open(simulation);
        window.state.run.live.send(Command::Play);
        window.wait();
        let (start, first) = (Instant::now(), window.steps());
        let mut drawn = 0;
        while start.elapsed() < COUNTED {
            window.draw();
            drawn += 1;
        }
        let secs = start.elapsed().as_secs_f64();
        let steps = (window.steps() - first) as f64 / secs;
        let name = window.canvas.name().to_owned();
        let panels = window.panels();
        println!("{count} discs: panels {panels:.2} ms of a frame");
        println!("{count} discs: {:.0} frames/s, {steps:.1} steps/s ({name})", drawn as f64 / secs);
        let [median, worst] = window.pauses();
        println!("{count} discs: pause to standstill: median {median:.1} ms, worst {worst:.1} ms");
    }
}

/// Returns settling discs with the solver settings that the window uses by default for large scenes: forty sweeps on
/// all cores.
fn large(count: usize) -> Simulation {
    let mut simulation = common::settled(count);
    let settings = SolverSettings {
        method: Method::NsgsParallel,
        stop: StopTest::Residual,
        tolerance: 1e-6,
        max_sweeps: 40,
        ..*simulation.solver()
    };
    simulation.set_solver(settings).expect("proper settings");
    simulation
}

fn steps() {
    let best = |run: &dyn Fn() -> f64| (0..REPEATS).map(|_| run()).fold(f64::INFINITY, f64::min);
    let alone = best(&|| {
        let mut simulation = pile();
        let start = Instant::now();
        for _ in 0..STEPS {
            simulation.step().expect("a finite state");
        }
        start.elapsed().as_secs_f64()
    });
    let recorded = best(&|| {
        let mut live = Live::spawn(LiveOptions::default()).expect("a thread");
        live.send(load(pile()));
        live.send(Command::SetPace(Pace::Max));
        let start = Instant::now();
        live.send(Command::Play);
        while live
            .latest()
            .worlds
            .first()
            .is_none_or(|world| world.snapshot.observables.step < STEPS)
        {
            std::thread::sleep(Duration::from_millis(1));
        }
        start.elapsed().as_secs_f64()
    });
    let shown = best(&|| {
        let mut window = Window::open(pile());
        let start = Instant::now();
        let (mut drawn, mut shown) = (start, 0);
        window.state.run.live.send(Command::Play);
        loop {
            let news = window.state.run.live.latest().number != shown;
            // The end is detected in the newest frame, whether it is drawn or not, because a delay of the picture is
            // not a delay of the solver.
            if window.newest_step() >= STEPS {
                break;
            }
            // Like the event loop of a window, draws a frame when there is a new frame, but not too often.
            if news && drawn.elapsed() >= SOFTWARE_FRAME_INTERVAL {
                drawn = Instant::now();
                window.draw();
                shown = window.state.run.frame.number;
            } else {
                std::thread::sleep(Duration::from_millis(1));
            }
        }
        start.elapsed().as_secs_f64()
    });
    for (name, secs) in [("no thread", alone), ("thread, recorded", recorded), ("window", shown)] {
        let rate = STEPS as f64 / secs;
        println!("{name}: {rate:.0} steps/s, {:+.1} %", 100.0 * (alone / secs - 1.0));
    }
}

fn latency() {
    let mut live = Live::spawn(LiveOptions::default()).expect("a thread");
    live.send(load(pile()));
    live.send(Command::SetPace(Pace::Max));
    live.send(Command::Play);
    let mut settings = *pile().settings();
    let mut millis: Vec<f64> = (0..CHANGES)
        .map(|change| {
            std::thread::sleep(Duration::from_millis(37));
            settings.parameters.time_step_secs = 1e-3 * (1.0 + 1e-3 * change as f64);
            let start = Instant::now();
            live.send(Command::Change(0, settings));
            while live.latest().worlds.first().is_none_or(|world| {
                world.snapshot.observables.time_step_secs != settings.parameters.time_step_secs
            }) {
                std::thread::sleep(Duration::from_micros(100));
            }
            1e3 * start.elapsed().as_secs_f64()
        })
        .collect();
    millis.sort_by(f64::total_cmp);
    let (median, worst) = (millis[CHANGES / 2], millis[CHANGES - 1]);
    println!("slider to snapshot: median {median:.1} ms, worst {worst:.1} ms");
}
