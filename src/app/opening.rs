//! Opening: from what a user asks for to a start that the solver's thread makes, and what was opened last.

use std::path::Path;
use std::sync::mpsc::{Receiver, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use egui::Context;
use glam::DVec2;

use super::budget;
use super::export::STATE_ENDING;
use super::session::{SESSION_ENDING, Session};
use super::sharing::RunLink;
use super::state::AppState;
use super::tour::Station;
use crate::config::{Config, SavedState, SceneSource};
use crate::error::Result;
use crate::live::{Command, LiveStart, LoadingProgress, Preview, RunHistory, WorldHistory};
use crate::scene::{Scene, Settling};
use crate::sim::{GrainView, Simulation, Snapshot, Tally};
use crate::world::{Boundary, Disc, Gravity};

/// What a run began with.
#[derive(Debug)]
pub(crate) struct Opened {
    /// Its scene.
    pub scene: Scene,
    /// What opens that scene again.
    pub config: Config,
}

/// What was opened last. It is noted where a start is made and looked up where a run is taken down, both on
/// the solver's thread, so that it is of the run that is there.
#[derive(Clone, Debug, Default)]
pub(crate) struct LastOpened(Arc<Mutex<Option<Arc<Opened>>>>);

impl LastOpened {
    /// Notes what is opened.
    pub(crate) fn note(&self, opened: Opened) {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) = Some(Arc::new(opened));
    }

    /// What was opened last; nothing before the first.
    pub(crate) fn get(&self) -> Option<Arc<Opened>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }
}

/// A run that is to be written down.
pub(crate) struct TakenRun {
    /// What it began with.
    pub opened: Arc<Opened>,
    /// What it has come to.
    pub world: WorldHistory,
}

/// Height of the walls that are drawn around a pile, in its own heights.
const WALL_HEIGHTS: f64 = 1.1;

/// Hears how far a start has come; false where it is given up.
type Tell<'a> = &'a mut dyn FnMut(LoadingProgress) -> bool;

impl AppState {
    /// Opens a scene.
    pub fn load(&mut self, config: Config) {
        self.leave_tour();
        self.config = config.clone();
        self.open(move |tell| {
            let mut scene = settled(&config, tell)?;
            budget::complete(&mut scene, &config.solver);
            Ok((start(&scene)?, Opened { scene, config }))
        });
    }

    /// Opens a station of the tour, with its worlds side by side.
    pub(super) fn load_station(&mut self, station: &'static Station) {
        self.open(move |_| {
            let config = Config::of_scene(station.scene);
            let mut scene = config.without_settling()?;
            budget::complete(&mut scene, &config.solver);
            let worlds = (station.worlds)(scene.settings());
            Ok((LiveStart { worlds, ..start(&scene)? }, Opened { scene, config }))
        });
    }

    /// Opens what a link tells of, with what its worlds have come to. Settings are those that it says, whatever the
    /// window would choose.
    pub(super) fn load_link(&mut self, link: RunLink) {
        self.leave_tour();
        self.open(move |tell| {
            let config = link.config();
            let scene = settled(&config, tell)?;
            let start = start(&scene)?;
            let plans = link.plans(&scene.settings());
            let history = RunHistory::computed(&start.simulation, start.tally, &plans, tell)?;
            Ok((LiveStart { history: Some(history), ..start }, Opened { scene, config }))
        });
    }

    /// Opens a session, with its window as it was arranged.
    pub(super) fn load_session(
        &mut self,
        session: impl FnOnce() -> Result<Session> + Send + 'static,
    ) {
        self.leave_tour();
        let (window, arriving) = channel();
        self.opening.arriving = Some(arriving);
        self.open(move |_| {
            let (start, opened, arrangement) = session()?.into_parts()?;
            // Whoever waits for it has gone where another file is opened already.
            let _ = window.send(arrangement);
            Ok((start, opened))
        });
    }

    /// Opens a saved run, to go on with it.
    pub fn load_run(&mut self, state: SavedState) {
        self.leave_tour();
        self.open(move |_| Ok(start_of_run(state)));
    }

    /// Opens the file of a saved run or of a session, to go on with it.
    pub fn load_saved(&mut self, path: &Path) {
        self.exports.data.saved_run = path.display().to_string();
        let path = path.to_owned();
        if path.extension().is_some_and(|ending| ending == SESSION_ENDING) {
            return self.load_session(move || Session::open(&path));
        }
        self.leave_tour();
        self.open(move |_| Ok(start_of_run(SavedState::open(&path)?)));
    }

    /// Has the solver's thread make a start, and notes what it is of.
    fn open(
        &mut self,
        make: impl FnOnce(Tell<'_>) -> Result<(LiveStart, Opened)> + Send + 'static,
    ) {
        let last = self.opening.last.clone();
        self.live.send(Command::Load(Box::new(move |tell| {
            let (start, opened) = make(tell)?;
            last.note(opened);
            Ok(start)
        })));
    }

    /// Asks for the run of the selected world.
    pub(crate) fn take_run(&mut self) -> Receiver<TakenRun> {
        self.take_run_of(self.selected)
    }

    /// Asks for a world's run. It comes between two steps; nothing comes where that world is gone.
    pub(crate) fn take_run_of(&mut self, world: usize) -> Receiver<TakenRun> {
        let (sender, receiver) = channel();
        let last = self.opening.last.clone();
        let hand_on = move |world| {
            if let Some(opened) = last.get() {
                // Whoever asked may have gone.
                let _ = sender.send(TakenRun { opened, world });
            }
        };
        self.live.send(Command::Take(world, Box::new(hand_on)));
        receiver
    }
}

/// The scene, shown and with progress told where a new pile has to settle first.
fn settled(config: &Config, tell: Tell<'_>) -> Result<Scene> {
    let mut making = SettlingProgress::new();
    config.scene(|settling| tell(making.look(&settling)))
}

/// The start of a saved run, which goes on in time.
fn start_of_run(state: SavedState) -> (LiveStart, Opened) {
    let SavedState { scene, simulation, tally, .. } = state;
    let start = start_with(&scene, simulation, tally, Vec::new());
    let config = Config::of_scene(&scene.name);
    (start, Opened { scene, config })
}

fn start(scene: &Scene) -> Result<LiveStart> {
    Ok(start_with(scene, scene.simulation()?, Tally::default(), walls(scene)))
}

fn start_with(
    scene: &Scene,
    simulation: Simulation,
    tally: Tally,
    held_by: Vec<Boundary>,
) -> LiveStart {
    let view = scene.view();
    LiveStart {
        name: scene.name.clone(),
        simulation,
        tally,
        duration_secs: scene.duration_secs,
        held_by,
        view: [view.min, view.max],
        slumps: slumps(scene),
        worlds: Vec::new(),
        history: None,
    }
}

/// Whether grains lie on level ground that stays, and may spread: of others Δy_G, which goes by heights above y = 0,
/// says nothing. Nor does it of what hangs from a disc that is fixed.
fn slumps(scene: &Scene) -> bool {
    let is_down = |gravity: &Gravity| matches!(gravity, Gravity::Uniform { acceleration } if acceleration.x == 0.0 && acceleration.y < 0.0);
    let is_level = |boundary: &Boundary| matches!(boundary, Boundary::HalfSpace { normal, .. } if normal.x == 0.0 && normal.y > 0.0);
    let lowest_of_grains = scene.grains.iter().map(|grain| grain.position.y).reduce(f64::min);
    let lies_on = |disc: &Disc| lowest_of_grains.is_some_and(|lowest| disc.position.y < lowest);
    let has_ground = !scene.boundaries.is_empty() || scene.fixed_discs.iter().any(lies_on);
    scene.physics.axes == 2
        && has_ground
        && is_down(&scene.gravity)
        && scene.gravity_turn.is_none()
        && scene.motions.is_empty()
        && scene.boundaries.iter().all(is_level)
}

/// The walls of a pile that has not been released: a pile is at rest and needs none, but without
/// them nobody would see what is about to happen.
fn walls(scene: &Scene) -> Vec<Boundary> {
    if scene.name != Config::DEFAULT_SCENE || !scene.boundaries.is_empty() {
        return Vec::new();
    }
    let reach = |side: f64| {
        let ends = scene.grains.iter().map(|grain| side * grain.position.x + grain.radius);
        side * ends.fold(0.0, f64::max)
    };
    let tops = scene.grains.iter().map(|grain| grain.position.y + grain.radius);
    let height = WALL_HEIGHTS * tops.fold(0.0, f64::max);
    let wall = |x: f64| Boundary::Segment { from: DVec2::new(x, 0.0), to: DVec2::new(x, height) };
    vec![wall(reach(-1.0)), wall(reach(1.0))]
}

/// Settlings end when the fastest grain is this many orders of magnitude slower than at first.
const ORDERS_OF_SETTLING: f64 = 3.5;
/// Least time between two looks at the grains: what is faster no one sees.
const INTERVAL: Duration = Duration::from_millis(30);
/// Before this part is done, how long it took says nothing of how long it will take.
const PART_THAT_TELLS: f64 = 0.05;

/// What is told of a pile that is being made.
pub(super) struct SettlingProgress {
    begun: Instant,
    looked: Option<Instant>,
    preview: Option<Preview>,
    landed: usize,
    part: f64,
}

impl SettlingProgress {
    /// One that begins now.
    pub(super) fn new() -> Self {
        Self { begun: Instant::now(), looked: None, preview: None, landed: 0, part: 0.0 }
    }

    /// Takes in how far it has come.
    pub(super) fn look(&mut self, settling: &Settling<'_>) -> LoadingProgress {
        if self.looked.is_none_or(|at| at.elapsed() >= INTERVAL) {
            self.looked = Some(Instant::now());
            let snapshot = settling.simulation.snapshot();
            // One that bounces off has landed all the same.
            self.landed = self.landed.max(landed(&snapshot));
            let view = view_of(&snapshot);
            self.preview = Some(Preview { snapshot: Arc::new(snapshot), view });
        }
        self.part = self.part.max(settled_part(settling));
        let grains = settling.simulation.world().grains.len();
        let text = if settling.rains {
            format!("Raining a new pile: {} of {grains} grains have landed", self.landed)
        } else {
            let fastest = settling.speed_over_rest;
            format!("A new pile of {grains} comes to rest: fastest grain {fastest:.0} × rest")
        };
        let left = self.left(self.begun.elapsed().as_secs_f64());
        LoadingProgress {
            part: self.part as f32,
            text: text + &left,
            preview: self.preview.clone(),
        }
    }

    /// How long it may take, where that can be told, after so many seconds.
    fn left(&self, elapsed_secs: f64) -> String {
        if self.part < PART_THAT_TELLS {
            return String::new();
        }
        let left_secs = elapsed_secs * (1.0 - self.part) / self.part;
        if left_secs < 90.0 {
            format!(", some {:.0} s left", left_secs.ceil())
        } else {
            format!(", some {:.0} min left", (left_secs / 60.0).ceil())
        }
    }
}

/// How much of a settling is done, 0 … 1: rain falls for a quarter of the limit at most, then the slowing down tells.
pub(super) fn settled_part(settling: &Settling) -> f64 {
    let rained = match settling.rains {
        true => (4.0 * settling.time_secs / settling.limit_secs).min(1.0),
        false => 1.0,
    };
    let slowed = 1.0 - settling.speed_over_rest.log10() / ORDERS_OF_SETTLING;
    0.5 * rained * (1.0 + slowed.clamp(0.0, 1.0))
}

/// How many grains touch what is below all of them, or others that do.
fn landed(snapshot: &Snapshot) -> usize {
    let count = snapshot.grains.len();
    let is_below = |way: DVec2| way.y < -0.5 * way.length();
    let mut partners = vec![Vec::new(); count];
    let mut next = Vec::new();
    for contact in &snapshot.contacts {
        let grain = contact.grain as usize;
        match contact.other_grain {
            Some(other) => {
                partners[grain].push(other as usize);
                partners[other as usize].push(grain);
            }
            // Walls stand beside grains, not below them.
            None if is_below(contact.to - contact.from) => next.push(grain),
            None => {}
        }
    }
    let mut has_landed = vec![false; count];
    while let Some(grain) = next.pop() {
        if !std::mem::replace(&mut has_landed[grain], true) {
            next.extend(&partners[grain]);
        }
    }
    has_landed.into_iter().filter(|&it| it).count()
}

/// Where grains are, with the box and the base below: it shrinks as they come down.
fn view_of(snapshot: &Snapshot) -> [DVec2; 2] {
    let diameter = snapshot.surroundings.mean_diameter;
    let ends = |side: DVec2| {
        let end = |grain: &GrainView| side * grain.position + DVec2::splat(grain.radius);
        side * snapshot.grains.iter().map(end).fold(DVec2::NEG_INFINITY, DVec2::max)
    };
    let (lower, upper) = (ends(DVec2::NEG_ONE), ends(DVec2::ONE));
    [DVec2::new(lower.x, lower.y.min(0.0)) - diameter, upper + diameter]
}

/// Opens the last file that was dropped in this frame.
pub(super) fn take_dropped_files(context: &Context, state: &mut AppState) {
    let dropped = context.input(|input| input.raw.dropped_files.last().cloned());
    let Some(file) = dropped else { return };
    let path = file.path();
    match dropped_file(path) {
        Some(DroppedFile::Scene(config)) => state.load(*config),
        Some(DroppedFile::SavedRun) => state.load_saved(path),
        None => {
            let name = path.display();
            state.warn(format!(
                "{name} is neither a scene (.toml) nor a list of discs (.csv) nor a saved run (.{STATE_ENDING}) nor a session (.{SESSION_ENDING})"
            ));
        }
    }
}

/// What a dropped file asks for.
#[derive(Debug, PartialEq)]
enum DroppedFile {
    /// A start.
    Scene(Box<Config>),
    /// To go on with what is in the file, a saved run or a session.
    SavedRun,
}

/// What a dropped file asks for, by its ending.
fn dropped_file(path: &Path) -> Option<DroppedFile> {
    let ending = path.extension()?.to_str()?.to_ascii_lowercase();
    match ending.as_str() {
        "toml" => path.to_str().map(|path| DroppedFile::Scene(Box::new(Config::of_scene(path)))),
        "csv" => {
            let source = SceneSource { initial: Some(path.to_owned()), ..SceneSource::default() };
            Some(DroppedFile::Scene(Box::new(Config { source, ..Config::default() })))
        }
        STATE_ENDING | SESSION_ENDING => Some(DroppedFile::SavedRun),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{NewPile, built_in, settle};

    #[test]
    fn slump_tells_of_piles_and_heaps_and_of_nothing_that_falls_or_is_pushed() {
        let told = |name: &str| slumps(&built_in(name).unwrap());
        assert!(told("pile"));
        for name in
            ["cradle", "moving-walls", "drum", "vibrated", "thin-wall", "newtons-cradle", "chain"]
        {
            assert!(!told(name), "{name}");
        }
        let hourglass =
            Config::of_scene("assets/scenes/hourglass.toml").without_settling().unwrap();
        assert!(!slumps(&hourglass));
    }

    #[test]
    fn grains_land_one_after_another_and_the_part_never_falls() {
        let pile = NewPile { grains: 40, box_width_in_diameters: 8.0, ..NewPile::default() };
        let mut making = SettlingProgress::new();
        let (mut parts, mut landed, mut tops) = (Vec::new(), Vec::new(), Vec::new());
        let mut diameter = 0.0;
        settle(&pile, |settling| {
            // As if each look were the first for a while.
            making.looked = None;
            let told = making.look(&settling);
            let preview = told.preview.expect("something to see");
            assert_eq!(preview.snapshot.grains.len(), 40);
            parts.push(told.part);
            landed.push(making.landed);
            tops.push(preview.view[1].y);
            diameter = preview.snapshot.surroundings.mean_diameter;
            if settling.rains {
                let said = format!("{} of 40 grains have landed", making.landed);
                assert!(told.text.contains(&said), "{}", told.text);
            }
            true
        })
        .expect("a pile");
        assert!(parts.is_sorted() && parts[0] < 0.1 && parts[parts.len() - 1] > 0.9, "{parts:?}");
        assert!(landed[0] < 10 && landed.contains(&40) && landed.is_sorted(), "{landed:?}");
        let some = landed.iter().filter(|&&count| (10..40).contains(&count)).count();
        assert!(some > 5, "they fall one after another: {landed:?}");
        // Five rows of eight lie in the box, uneven by a grain or so; the view ends a diameter above the highest.
        let rows = 40.0 / 8.0;
        let top = tops[tops.len() - 1] / diameter;
        assert!((rows..rows + 3.0).contains(&top), "the view ends above the pile: {top} d");
        assert!(tops[0] > (top + 3.0) * diameter, "the view shrinks: {tops:?}");
    }

    #[test]
    fn time_is_told_once_something_is_known_of_it() {
        let mut making = SettlingProgress::new();
        making.part = 0.01;
        assert_eq!(making.left(1.0), "");
        making.part = 0.25;
        assert_eq!(making.left(4.0), ", some 12 s left");
        assert_eq!(making.left(100.0), ", some 5 min left");
    }

    #[test]
    fn endings_tell_scenes_from_discs_and_saved_runs() {
        let config = |path: &str| match dropped_file(path.as_ref()) {
            Some(DroppedFile::Scene(config)) => config.source,
            other => panic!("{path} is {other:?}"),
        };
        assert_eq!(config("a/Box.TOML").scene.as_deref(), Some("a/Box.TOML"));
        assert_eq!(config("a/pile.csv").initial.as_deref(), Some("a/pile.csv".as_ref()));
        assert_eq!(dropped_file("a/checkpoint.slump".as_ref()), Some(DroppedFile::SavedRun));
        assert_eq!(dropped_file("a/pile.png".as_ref()), None);
    }
}
