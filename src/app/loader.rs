//! From what a user asks for to a start that the solver's thread makes.

use std::path::PathBuf;
use std::sync::mpsc::Sender;

use glam::DVec2;

use super::effort;
use super::link::Link;
use super::making::Making;
use super::session::{Arrangement, Session};
use super::taken::{LastOpened, Opened};
use super::tour::Station;
use crate::config::{Config, SavedState};
use crate::error::Result;
use crate::live::{Loader, Progress, Record, Start};
use crate::scene::Scene;
use crate::sim::Tally;
use crate::world::{Boundary, Disc, Gravity};

/// Height of the walls that are drawn around a pile, in its own heights.
const WALL_HEIGHTS: f64 = 1.1;

/// Makes the start of `config` on the thread that calls it.
pub(crate) fn loader(config: Config, last: LastOpened) -> Loader {
    Box::new(move |tell| {
        let mut scene = settled(&config, tell)?;
        effort::complete(&mut scene, &config.solver);
        let start = start(&scene)?;
        last.note(Opened { scene, config });
        Ok(start)
    })
}

/// The scene, shown and with progress told where a new pile has to settle first.
fn settled(config: &Config, tell: &mut dyn FnMut(Progress) -> bool) -> Result<Scene> {
    let mut making = Making::new();
    config.scene(|settling| tell(making.look(&settling)))
}

/// Makes the start of a station of the tour, with its worlds side by side.
pub(crate) fn loader_of_station(station: &'static Station, last: LastOpened) -> Loader {
    Box::new(move |_| {
        let config = Config::of_scene(station.scene);
        let mut scene = config.without_settling()?;
        effort::complete(&mut scene, &config.solver);
        let worlds = (station.worlds)(scene.settings());
        let start = Start { worlds, ..start(&scene)? };
        last.note(Opened { scene, config });
        Ok(start)
    })
}

/// Makes the start of a link, with what its worlds have come to. Settings are those that it says, whatever the
/// window would choose.
pub(crate) fn loader_of_link(link: Link, last: LastOpened) -> Loader {
    Box::new(move |tell| {
        let config = link.config();
        let scene = settled(&config, tell)?;
        let start = start(&scene)?;
        let plans = link.plans(&scene.settings());
        let record = Record::computed((&start.simulation, start.tally), &plans, tell)?;
        last.note(Opened { scene, config });
        Ok(Start { record: Some(record), ..start })
    })
}

/// Makes a start of a session, and hands on how its window was arranged.
pub(crate) fn loader_of_session(
    session: impl FnOnce() -> Result<Session> + Send + 'static,
    last: LastOpened,
    window: Sender<Arrangement>,
) -> Loader {
    Box::new(move |_| Ok(session()?.begin(&last, &window)))
}

/// Makes a start of a saved run, which goes on in time.
pub(crate) fn loader_of_run(state: SavedState, last: LastOpened) -> Loader {
    Box::new(move |_| Ok(start_of_run(state, &last)))
}

/// Makes a start of a file that a run was saved to.
pub(crate) fn loader_of_file(path: PathBuf, last: LastOpened) -> Loader {
    Box::new(move |_| Ok(start_of_run(SavedState::open(&path)?, &last)))
}

fn start_of_run(state: SavedState, last: &LastOpened) -> Start {
    let SavedState { scene, simulation, tally, .. } = state;
    let view = scene.view();
    let start = Start {
        name: scene.name.clone(),
        simulation,
        tally,
        duration_secs: scene.duration_secs,
        held_by: Vec::new(),
        view: [view.min, view.max],
        slumps: slumps(&scene),
        worlds: Vec::new(),
        record: None,
    };
    let config = Config::of_scene(&scene.name);
    last.note(Opened { scene, config });
    start
}

fn start(scene: &Scene) -> Result<Start> {
    let view = scene.view();
    Ok(Start {
        name: scene.name.clone(),
        simulation: scene.simulation()?,
        tally: Tally::default(),
        duration_secs: scene.duration_secs,
        held_by: walls(scene),
        view: [view.min, view.max],
        slumps: slumps(scene),
        worlds: Vec::new(),
        record: None,
    })
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::built_in;

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
}
