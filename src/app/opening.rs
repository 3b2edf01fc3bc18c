//! Opening: from what a user asks for to a start, which is made where the run is computed.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, channel};
use std::time::Duration;

use egui::Context;
use glam::DVec2;
use serde::{Deserialize, Serialize};

use super::IN_BROWSER;
use super::export::STATE_ENDING;
use super::lessons::LESSONS;
use super::session::{SESSION_ENDING, open_session};
use super::sharing::RunLink;
use super::state::AppState;
use crate::Instant;
use crate::config::{Config, SavedState, SceneSource};
use crate::error::Result;
use crate::live::{
    Command, LiveStart, LoadingProgress, Preview, RunHistory, StartSource, Tell, WorldHistory,
    as_json, to_bytes,
};
use crate::scene::{Scene, Settling};
use crate::sim::{GrainView, Simulation, Snapshot, Tally};
use crate::world::{Boundary, Disc, Gravity};

/// What a start is made from. It is data, so that it can be sent to where the run is computed.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub enum Opening {
    /// A scene.
    Scene(#[serde(with = "as_json")] Box<Config>),
    /// A lesson by its place, with its worlds side by side.
    Lesson(usize),
    /// What a link tells of, with what its worlds have come to. Settings are those that it says, whatever the window
    /// would choose.
    Link(String),
    /// A saved run, to go on with it.
    Run(Box<SavedState>),
    /// A session, with its window as it was arranged.
    Session(Box<LiveStart>),
    /// The file of one of these two.
    File(PathBuf),
    /// One of these, with the file that it names.
    #[cfg(target_arch = "wasm32")]
    With {
        /// Its name.
        path: PathBuf,
        /// All that is in it.
        bytes: Vec<u8>,
        /// What names it.
        opening: Box<Opening>,
    },
}

impl StartSource for Opening {
    fn make(self: Box<Self>, tell: Tell<'_>) -> Result<LiveStart> {
        match *self {
            Self::Scene(config) => {
                let scene = settled(&config, tell)?;
                start(&scene, *config)
            }
            Self::Lesson(at) => {
                let lesson = &LESSONS[at.min(LESSONS.len() - 1)];
                let (config, scene) = lesson.scene()?;
                let worlds = (lesson.worlds)(scene.settings());
                let start = start(&scene, config)?;
                let zoomed = lesson.view.map(|view| view.map(|end| scene.mean_diameter * end));
                Ok(LiveStart { worlds, view: zoomed.unwrap_or(start.view), ..start })
            }
            Self::Link(text) => {
                let link = RunLink::read(&text)?;
                let config = link.config();
                let scene = settled(&config, tell)?;
                let start = start(&scene, config)?;
                let plans = link.plans(&scene.settings());
                let history = RunHistory::computed(&start.simulation, start.tally, &plans, tell)?;
                Ok(LiveStart { history: Some(history), ..start })
            }
            Self::Run(state) => Ok(start_of_run(*state)),
            Self::Session(start) => Ok(*start),
            Self::File(path) if is_session(&path) => open_session(&path),
            Self::File(path) => Ok(start_of_run(SavedState::open(&path)?)),
            #[cfg(target_arch = "wasm32")]
            Self::With { path, bytes, opening } => {
                crate::output::give_file(path, bytes);
                opening.make(tell)
            }
        }
    }

    fn to_bytes(&self) -> Result<Vec<u8>> {
        to_bytes(self)
    }
}

/// A run that is to be written down.
pub(crate) struct TakenRun {
    pub start: Arc<LiveStart>,
    pub world: WorldHistory,
}

/// Height of the walls that are drawn around a pile, in its own heights.
const WALL_HEIGHTS: f64 = 1.1;

impl AppState {
    /// Opens a scene.
    pub fn load(&mut self, config: Config) {
        self.config = config.clone();
        self.open(Opening::Scene(Box::new(config)));
    }

    /// Opens a saved run, to go on with it.
    pub fn load_run(&mut self, state: SavedState) {
        self.open(Opening::Run(Box::new(state)));
    }

    /// Opens the file of a saved run or of a session, to go on with it.
    pub fn load_saved(&mut self, path: &Path) {
        self.exports.data.saved_run = path.display().to_string();
        self.open(Opening::File(path.to_owned()));
    }

    /// Has a start made where the run is computed. Other than for a lesson, lessons are left.
    pub(crate) fn open(&mut self, opening: Opening) {
        if !matches!(opening, Opening::Lesson(_)) {
            self.leave_lessons();
        }
        self.live.send(Command::Load(Box::new(opening)));
    }

    /// Asks for a world's run. It comes between two steps; nothing comes where that world is gone.
    pub(crate) fn take_run(&mut self, world: usize) -> Receiver<TakenRun> {
        let (sender, receiver) = channel();
        let hand_on = move |start, world| {
            // Whoever asked may have gone.
            let _ = sender.send(TakenRun { start, world });
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
fn start_of_run(state: SavedState) -> LiveStart {
    let SavedState { scene, simulation, tally, .. } = state;
    let config = Config::of_scene(&scene.name);
    start_with(&scene, config, simulation, tally, Vec::new())
}

/// The start of a scene, which `config` opens.
pub(super) fn start(scene: &Scene, config: Config) -> Result<LiveStart> {
    Ok(start_with(scene, config, scene.simulation()?, Tally::default(), walls(scene)))
}

fn start_with(
    scene: &Scene,
    config: Config,
    simulation: Simulation,
    tally: Tally,
    held_by: Vec<Boundary>,
) -> LiveStart {
    let view = scene.view();
    LiveStart {
        scene: scene.clone(),
        config,
        window: None,
        simulation,
        tally,
        held_by,
        view: [view.min, view.max],
        slumps: slumps(scene),
        worlds: Vec::new(),
        history: None,
    }
}

/// True where grains lie on level ground that stays, and may spread: of others Δy_G, which goes by heights above y = 0,
/// says nothing. Nor does it of what hangs from a disc that is fixed.
fn slumps(scene: &Scene) -> bool {
    let is_down =
        matches!(&scene.gravity, Gravity::Uniform { acceleration: g } if g.x == 0.0 && g.y < 0.0);
    let is_level = |boundary: &Boundary| matches!(boundary, Boundary::HalfSpace { normal, .. } if normal.x == 0.0 && normal.y > 0.0);
    let lowest_of_grains = scene.grains.iter().map(|grain| grain.position.y).reduce(f64::min);
    let lies_on = |disc: &Disc| lowest_of_grains.is_some_and(|lowest| disc.position.y < lowest);
    let has_ground = !scene.boundaries.is_empty() || scene.fixed_discs.iter().any(lies_on);
    scene.physics.axes == 2
        && has_ground
        && is_down
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
    part: f64,
}

impl SettlingProgress {
    /// One that begins now.
    pub(super) fn new() -> Self {
        Self { begun: Instant::now(), looked: None, preview: None, part: 0.0 }
    }

    /// Takes in how far it has come.
    pub(super) fn look(&mut self, settling: &Settling<'_>) -> LoadingProgress {
        if self.looked.is_none_or(|at| at.elapsed() >= INTERVAL) {
            self.looked = Some(Instant::now());
            let snapshot = settling.simulation.snapshot();
            let view = view_of(&snapshot);
            self.preview = Some(Preview { snapshot: Arc::new(snapshot), view });
        }
        self.part = self.part.max(settled_part(settling));
        let grains = settling.simulation.world().grains.len();
        let text = if settling.rains {
            format!("Raining a new pile of {grains}")
        } else {
            let fastest = settling.speed_over_rest;
            format!("A new pile of {grains} comes to rest: fastest grain {fastest:.0} × rest")
        };
        let text = text + &self.left(self.begun.elapsed().as_secs_f64());
        LoadingProgress { part: self.part as f32, text, preview: self.preview.clone() }
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

/// Opens the last file that was dropped in this frame. A page has to wait for its content.
pub(super) fn take_dropped_files(context: &Context, state: &mut AppState) {
    let dropped = context.input(|input| input.raw.dropped_files.last().cloned());
    let Some(file) = dropped.filter(|_| !IN_BROWSER) else { return };
    let path = file.path();
    match opening_of(path) {
        Some(Opening::File(path)) => state.load_saved(&path),
        Some(opening) => state.open(opening),
        None => state.warn(refused_file(path)),
    }
}

/// What opens a file, by its name.
pub(super) fn opening_of(path: &Path) -> Option<Opening> {
    if is_saved_run(path) {
        return Some(Opening::File(path.to_owned()));
    }
    Some(Opening::Scene(Box::new(dropped_scene(path)?)))
}

/// That a file is none of those that can be opened.
pub(super) fn refused_file(path: &Path) -> String {
    let name = path.display();
    format!(
        "{name} is neither a scene (.toml) nor a list of discs (.csv) nor a saved run (.{STATE_ENDING}) nor a session (.{SESSION_ENDING})"
    )
}

fn is_session(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ending == SESSION_ENDING)
}

/// True for the name of a saved run or a session.
pub(super) fn is_saved_run(path: &Path) -> bool {
    is_session(path) || path.extension().is_some_and(|ending| ending == STATE_ENDING)
}

/// What opens a file that is a scene or a list of discs by its name.
fn dropped_scene(path: &Path) -> Option<Config> {
    match path.extension()?.to_str()?.to_ascii_lowercase().as_str() {
        "toml" => path.to_str().map(Config::of_scene),
        "csv" => {
            let source = SceneSource { initial: Some(path.to_owned()), ..SceneSource::default() };
            Some(Config { source, ..Config::default() })
        }
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
    fn a_pile_in_the_making_is_seen_and_its_part_never_falls() {
        let pile = NewPile { grains: 40, box_width_in_diameters: 8.0, ..NewPile::default() };
        let mut making = SettlingProgress::new();
        let (mut parts, mut tops) = (Vec::new(), Vec::new());
        let mut diameter = 0.0;
        settle(&pile, |settling| {
            // As if each look were the first for a while.
            making.looked = None;
            let told = making.look(&settling);
            let preview = told.preview.expect("something to see");
            assert_eq!(preview.snapshot.grains.len(), 40);
            parts.push(told.part);
            tops.push(preview.view[1].y);
            diameter = preview.snapshot.surroundings.mean_diameter;
            let said = if settling.rains { "Raining a new pile of 40" } else { "A new pile of 40" };
            assert!(told.text.starts_with(said), "{}", told.text);
            true
        })
        .expect("a pile");
        assert!(parts.is_sorted() && parts[0] < 0.1 && parts[parts.len() - 1] > 0.9, "{parts:?}");
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
        let config = |path: &str| dropped_scene(path.as_ref()).expect(path).source;
        assert_eq!(config("a/Box.TOML").scene.as_deref(), Some("a/Box.TOML"));
        assert_eq!(config("a/pile.csv").initial.as_deref(), Some("a/pile.csv".as_ref()));
        assert!(is_saved_run("a/checkpoint.slump".as_ref()));
        assert!(!is_saved_run("a/pile.png".as_ref()));
        assert_eq!(dropped_scene("a/pile.png".as_ref()), None);
    }
}
