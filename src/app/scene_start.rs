//! Preparation of a scene or a saved run as the initial state of a run in the window.

use glam::DVec2;

use crate::config::{Config, SavedState};
use crate::error::Result;
use crate::live::LiveStart;
use crate::scene::Scene;
use crate::sim::{Simulation, Tally};
use crate::world::{Boundary, Disc, Gravity};

/// Height of the walls that are drawn around a pile, as a multiple of the pile's height.
const WALL_HEIGHTS: f64 = 1.1;

/// Returns the initial state for a saved run, which continues from its simulated time.
pub(super) fn start_of_run(state: SavedState) -> LiveStart {
    let SavedState { scene, simulation, tally, .. } = state;
    let config = Config::of_scene(&scene.name);
    LiveStart { tally, ..start_with(&scene, config, simulation) }
}

/// Returns the initial state for a scene. `config` is the configuration from which the scene can be built again.
pub(super) fn start(scene: &Scene, config: Config) -> Result<LiveStart> {
    let held_by = walls(scene);
    Ok(LiveStart { held_by, ..start_with(scene, config, scene.simulation()?) })
}

fn start_with(scene: &Scene, config: Config, simulation: Simulation) -> LiveStart {
    let view = scene.view();
    LiveStart {
        scene: scene.clone(),
        config,
        window: None,
        simulation,
        tally: Tally::default(),
        held_by: Vec::new(),
        view: [view.min, view.max],
        slumps: slumps(scene),
        worlds: Vec::new(),
        history: None,
    }
}

/// Smallest number of grains that count as a heap. For example, two discs that touch are not a heap.
const LEAST_OF_HEAP: usize = 10;

/// True if the scene is a heap, so that the slump Δy_G (relative drop of the mean height above y = 0) has a meaning: at
/// least ten grains lie on level ground that does not move, and can spread. For example, grains that hang from a fixed
/// disc are not a heap.
fn slumps(scene: &Scene) -> bool {
    let is_down =
        matches!(&scene.gravity, Gravity::Uniform { acceleration: g } if g.x == 0.0 && g.y < 0.0);
    let is_level = |boundary: &Boundary| matches!(boundary, Boundary::HalfSpace { normal, .. } if normal.x == 0.0 && normal.y > 0.0);
    let lowest_of_grains = scene.grains.iter().map(|grain| grain.position.y).reduce(f64::min);
    let lies_on = |disc: &Disc| lowest_of_grains.is_some_and(|lowest| disc.position.y < lowest);
    let has_ground = !scene.boundaries.is_empty() || scene.fixed_discs.iter().any(lies_on);
    scene.grains.len() >= LEAST_OF_HEAP
        && scene.physics.axes == 2
        && has_ground
        && is_down
        && scene.gravity_turn.is_none()
        && scene.motions.is_empty()
        && scene.boundaries.iter().all(is_level)
}

/// Returns the walls that are drawn around the built-in pile before its first step. These walls are not part of the
/// simulation. They show why the pile is at rest before the first step and spreads after it. Other scenes have no such
/// walls.
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
