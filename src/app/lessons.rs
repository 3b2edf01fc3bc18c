//! The lessons: each shows one thing, with worlds side by side and a sentence or two on what to watch.
//! What their sentences say is checked by `tests/window/lessons.rs`, over many starts.

use glam::DVec2;

use super::IN_BROWSER;
use super::page::Page;
use super::preferences::{Choices, Preferences};
use super::watched_run::WatchedRun;
use crate::config::{Config, parse_discs};
use crate::error::Result;
use crate::scene::{NewPile, Scene};
use crate::sim::{Settings, Stepper};
use crate::solver::{Method, SolverSettings};
use crate::world::FrictionCone;

/// What one lesson shows.
#[derive(Debug)]
pub struct Lesson {
    /// What it is about.
    pub title: &'static str,
    /// What to do, and what to watch.
    pub watch: &'static str,
    /// Its scene.
    pub scene: &'static str,
    /// What is seen of it, lower left and upper right, in mean diameters; none is all of it.
    pub view: Option<[DVec2; 2]>,
    /// Its worlds, made of the settings that the window gives that scene.
    pub worlds: fn(Settings) -> Vec<Settings>,
    /// Simulated time per time on the wall.
    pub speed: f64,
    /// The quantities that are plotted.
    pub plots: &'static [&'static str],
    /// The page that is opened for it.
    pub page: Option<Page>,
    /// True if a slider starts the run again.
    pub starts_again: bool,
    /// True of settings whose change its sentences ask for, or leave true.
    pub leaves_free: fn(&str) -> bool,
    /// The controls that it asks for next, which are lit, by the names that the window notes their places by.
    pub asks_for: fn(&WatchedRun, &Preferences) -> &'static [&'static str],
}

/// A pile of the paper, slow enough to be followed.
const PILE: Lesson = Lesson {
    title: "",
    watch: "",
    scene: "pile",
    view: None,
    worlds: |base| vec![base],
    speed: 0.2,
    plots: &["slump"],
    page: None,
    starts_again: true,
    leaves_free: |_| false,
    asks_for: |run, _| if waits_at_start(run) { &["release"] } else { &[] },
};

fn waits_at_start(run: &WatchedRun) -> bool {
    run.frame.at_start() && !run.frame.playing
}

/// The seed of the lessons' pile, which slumps in the middle half of sixteen others in all of them; the shipped pile, which
/// was chosen for the paper's pattern, does not.
const SEED: u64 = 15;
/// Its grains at rest, which rain for seconds.
const GRAINS: &str = include_str!("../../assets/pile_138_seed15.csv");

impl Lesson {
    /// What makes its scene, and the scene.
    ///
    /// # Errors
    /// Where a scene is no longer there.
    pub fn scene(&self) -> Result<(Config, Scene)> {
        let mut config = Config::of_scene(self.scene);
        if self.scene != Config::DEFAULT_SCENE {
            return Ok((config.clone(), config.without_settling()?));
        }
        config.source.set_new_pile(&NewPile { seed: SEED, ..NewPile::default() });
        let grains = parse_discs(GRAINS, "assets/pile_138_seed15.csv".as_ref())?;
        Ok((config.clone(), config.scene_from(grains)?))
    }
}

fn two_time_steps(base: Settings, bond: f64) -> Vec<Settings> {
    [1e-4, 5e-3].map(|secs| base.with_bond(bond).over(secs)).into()
}

/// That many sweeps of Gauss-Seidel a step on Coulomb's law, solved or not.
fn sweeps(base: Settings, count: u32) -> Settings {
    Settings { solver: SolverSettings::to_residual(Method::Nsgs, 1e-6, count), ..base }
}

fn in_cone(mut settings: Settings, cone: FrictionCone) -> Settings {
    settings.parameters.cone = cone;
    settings
}

/// All of them, in their order.
pub const LESSONS: [Lesson; 7] = [
    Lesson {
        title: "The time step glues",
        watch: if IN_BROWSER {
            "One pile twice, with the same cohesion. Only the solver's time step differs: 0.1 ms and 5 ms. Release, \
             and watch the slump. The mean of many piles differs likewise."
        } else {
            "One pile twice, with the same cohesion. Only the solver's time step differs: 0.1 ms and 5 ms. Release, \
             and watch the slump; other piles, in the plot, say how far one pile speaks for all."
        },
        worlds: |base| two_time_steps(base, 20.0),
        ..PILE
    },
    Lesson {
        title: "A bond made is a bond",
        watch: "This pile is stepped by 5 ms. Release it. When it stands, drag Δt to 0.1 ms: time goes on, and the \
                pile stays as it is, because its bonds hold. Then tick the box below and drag Δt a little: from the \
                start, it slumps more.",
        worlds: |base| vec![base.with_bond(20.0).over(LONG_STEP_SECS)],
        starts_again: false,
        leaves_free: |name| name == "dt",
        asks_for: |run, preferences| {
            let parameters = run.world().map(|world| world.controls.settings.parameters);
            let is_long = parameters.is_some_and(|it| it.time_step_secs == LONG_STEP_SECS);
            match (run.frame.playing, is_long) {
                _ if waits_at_start(run) => &["release"],
                (true, true) => &[],
                (false, true) => &["Δt"],
                _ if !preferences.starts_again => &["start again"],
                _ => &[],
            }
        },
        ..PILE
    },
    Lesson {
        title: "The solver's part",
        watch: "The same step, 5 ms, solved by 5 sweeps, by 40 sweeps, and to a tolerance. What sweeps leave unsolved looks \
                like weaker glue. The error of the velocities tells the three apart once the piles come to rest.",
        worlds: |base| {
            let base = base.with_bond(20.0).over(5e-3);
            vec![sweeps(base, 5), sweeps(base, 40), base]
        },
        plots: &["slump", "error"],
        ..PILE
    },
    Lesson {
        title: "A law in which Δt means little",
        watch: "Above the paper's law, moreau; below range, whose bonds live until they are opened by δc. At 0.1 ms and at \
                5 ms: above, the time step decides; below, bonds hold at both.",
        worlds: |base| {
            let of_law = |stepper| two_time_steps(Settings { stepper, ..base }, 20.0);
            [Stepper::Moreau, Stepper::Range].into_iter().flat_map(of_law).collect()
        },
        ..PILE
    },
    Lesson {
        title: "What friction depends on",
        watch: "Bond 100. On the left friction is bounded by μ(N + C₀), cohesion included; on the right by μ max(N, 0): \
                there the strong pile slumps. The paper can be read both ways.",
        worlds: |base| {
            let base = base.with_bond(100.0).over(1e-4);
            [FrictionCone::Shifted, FrictionCone::Compressive]
                .map(|cone| in_cone(base, cone))
                .into()
        },
        ..PILE
    },
    Lesson {
        title: "Where a method breaks",
        watch: "A disc a thousand times as heavy on a light one. Ten sweeps a step cannot carry it, and the light disc is \
                squeezed; on the right each step is solved. Watch the overlap.",
        scene: "mass-ratio",
        // The light disc, of which one would see nothing beside the heavy one.
        view: Some([DVec2::new(-1.3, -0.3), DVec2::new(1.3, 1.4)]),
        worlds: |base| {
            let solver = SolverSettings::to_residual(Method::Newton, 1e-6, 100);
            let base = Settings { solver, ..base };
            vec![sweeps(base, 10), base]
        },
        plots: &["overlap"],
        ..PILE
    },
    Lesson {
        title: "Your own pile",
        watch: "On the right: another scene, or a new pile of your number of grains and seed. Drag the sliders below, drag \
                grains with the mouse, and ask whether you can trust what you see.",
        page: Some(Page::Pile),
        leaves_free: |_| true,
        asks_for: |run, preferences| match (waits_at_start(run), preferences.page) {
            (true, Some(Page::Pile)) => &["scenes", "new pile", "Bond", "Δt", "ρ", "μ", "trust"],
            _ => &[],
        },
        ..PILE
    },
];

/// The time step of the lesson on bonds, s.
const LONG_STEP_SECS: f64 = 5e-3;

impl Lesson {
    /// The choices that the lesson makes in place of the user.
    pub(super) fn choices(&self) -> Choices {
        Choices {
            quantities: self.plots.iter().map(|name| (*name).to_owned()).collect(),
            speed: self.speed,
            full_speed: false,
            starts_again: self.starts_again,
            page: self.page,
            // The lessons on piles are about cohesion.
            show_forces: self.scene == Config::DEFAULT_SCENE,
        }
    }
}

/// The lesson of that number from 0, or the last one if there are not so many.
pub(super) fn lesson(at: usize) -> &'static Lesson {
    &LESSONS[at.min(LESSONS.len() - 1)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::preferences::LessonPlace;

    #[test]
    fn the_pile_of_the_lessons_is_the_one_that_its_command_line_makes() {
        let (config, scene) = LESSONS[0].scene().unwrap();
        assert_eq!(scene, config.scene(|_| true).unwrap());
    }

    #[test]
    fn what_was_chosen_before_the_lessons_comes_back_after_them() {
        let chosen = Preferences {
            quantities: vec!["energy".into()],
            speed: 3.0,
            full_speed: true,
            page: Some(Page::Look),
            ..Preferences::default()
        };
        let mut preferences = chosen.clone();
        preferences.begin_lesson(1, LESSONS[1].choices());
        assert!(!preferences.starts_again && preferences.page.is_none());
        preferences.begin_lesson(6, LESSONS[6].choices());
        assert_ne!(preferences.quantities, chosen.quantities);
        preferences.put_lesson_away();
        let lesson = LessonPlace { at: LESSONS.len() - 1, on: true, before: None };
        assert_eq!(preferences, Preferences { lesson, ..chosen });
    }
}
