//! The lessons of the window. Each lesson demonstrates one effect, with simulations side by side and a few sentences on
//! what to watch. `tests/window/lessons.rs` checks these sentences over many initial states.

use glam::DVec2;

use super::page::Page;
use super::predictions::{self, Question};
use super::preferences::{LessonPlace, Preferences};
use super::watched_run::WatchedRun;
use crate::config::{Config, parse_discs};
use crate::error::Result;
use crate::scene::{NewPile, Scene};
use crate::sim::{Settings, Stepper};
use crate::solver::{Method, SolverSettings};
use crate::world::FrictionCone;

/// A lesson: its texts, its scene, and the settings of the window.
#[derive(Debug)]
pub struct Lesson {
    /// Title of the lesson.
    pub title: &'static str,
    /// Text that tells the user what to do and what to watch.
    pub watch: &'static str,
    /// The question that the user answers before the run starts; `None` for a lesson without a question.
    pub question: Option<Question>,
    /// The result of the lesson in a sentence, for the end of the lesson.
    pub learnt: &'static str,
    /// Names of the settings whose sliders the lesson shows.
    pub sliders: &'static [&'static str],
    /// Name of the scene.
    pub scene: &'static str,
    /// Lower left and upper right corner of the view, in mean diameters; `None` shows the whole scene.
    pub view: Option<[DVec2; 2]>,
    /// Returns the settings of all simulations of the lesson, given the settings of the scene.
    pub worlds: fn(Settings) -> Vec<Settings>,
    /// Speed of playing: simulated time per wall-clock time.
    pub speed: f64,
    /// Names of the plotted quantities.
    pub plots: &'static [&'static str],
    /// Page of the sidebar that the lesson opens.
    pub page: Option<Page>,
    /// True if moving a slider restarts the run from its initial state.
    pub starts_again: bool,
    /// Returns true for the name of a setting that the user may change without making the texts of the lesson wrong.
    pub leaves_free: fn(&str) -> bool,
    /// Returns the names of the controls that the user should use next. The window highlights these controls.
    pub asks_for: fn(&WatchedRun, &Preferences) -> &'static [&'static str],
}

/// Lesson with the default values of the fields that lessons on the pile of Abramian & Staron (2020) do not set. The
/// run is played slowly enough to be watched.
const PILE: Lesson = Lesson {
    title: "",
    watch: "",
    question: None,
    learnt: "",
    sliders: &["bond", "dt"],
    scene: "pile",
    // The grains that roll farthest stay in view.
    view: Some([DVec2::new(-21.5, -0.8), DVec2::new(21.5, 10.5)]),
    worlds: |base| vec![base],
    speed: 0.2,
    plots: &["slump"],
    page: None,
    starts_again: true,
    leaves_free: |_| false,
    asks_for: |run, preferences| if waits_at_start(run) { first_step(preferences) } else { &[] },
};

/// Returns the controls that a lesson highlights before its run starts: the answers if the user must still predict the
/// result, otherwise the button that starts the run.
fn first_step(preferences: &Preferences) -> &'static [&'static str] {
    let LessonPlace { at, predictions, .. } = &preferences.lesson;
    let is_asked = lesson(*at).question.is_some() && !predictions.contains_key(at);
    if is_asked { &["answers"] } else { &["release"] }
}

fn waits_at_start(run: &WatchedRun) -> bool {
    run.frame.at_start() && !run.frame.playing
}

/// Seed of the lessons' pile. In lessons 1 and 3 the slump of this pile is within the interquartile range of the slumps
/// of sixteen piles with other seeds. The slump of the built-in pile is not, because the seed of that pile was chosen so
/// that its slump depends on Bond number and time step as in Abramian & Staron (2020).
const SEED: u64 = 15;
/// CSV list of the grains at rest in the pile made from [`SEED`]. The list is stored because computing the deposition
/// of this pile takes seconds.
const GRAINS: &str = include_str!("../../assets/pile_138_seed15.csv");

impl Lesson {
    /// Returns the configuration of the lesson's scene, and the scene.
    ///
    /// # Errors
    /// If the scene no longer exists.
    pub fn scene(&self) -> Result<(Config, Scene)> {
        let mut config = Config::of_scene(self.scene);
        if self.scene != Config::DEFAULT_SCENE {
            return Ok((config.clone(), config.without_settling()?));
        }
        config.source.set_new_pile(&NewPile { seed: SEED, ..NewPile::default() });
        let grains = parse_discs(GRAINS, "assets/pile_138_seed15.csv".as_ref())?;
        Ok((config.clone(), config.scene_from(grains)?))
    }

    /// Begins this lesson, whose index is `at`: sets the preferences that the lesson needs.
    pub(super) fn begin(&self, at: usize, preferences: &mut Preferences) {
        let before = preferences.lesson.before.take();
        let before = before.unwrap_or_else(|| Box::new(preferences.clone()));
        let place = &mut preferences.lesson;
        (place.at, place.on, place.before) = (at, true, Some(before));
        preferences.quantities = self.plots.iter().map(|name| (*name).to_owned()).collect();
        (preferences.speed, preferences.full_speed) = (self.speed, false);
        (preferences.starts_again, preferences.page) = (self.starts_again, self.page);
        // The lessons on piles are about cohesion.
        preferences.style.show_forces = self.scene == Config::DEFAULT_SCENE;
    }
}

fn two_time_steps(base: Settings, bond: f64) -> Vec<Settings> {
    [1e-4, 5e-3].map(|secs| base.with_bond(bond).over(secs)).into()
}

/// Returns settings with the solver `nsgs`, which makes at most `count` Gauss-Seidel sweeps per step under Coulomb
/// friction, even if the step is then unsolved.
fn sweeps(base: Settings, count: u32) -> Settings {
    Settings { solver: SolverSettings::to_residual(Method::Nsgs, 1e-6, count), ..base }
}

/// All lessons, in their order.
pub const LESSONS: [Lesson; 7] = [
    Lesson {
        title: "Two time steps",
        watch: "One pile twice, with the same cohesion: Bond 20, so that a contact can pull with the weight of ten grains. Only \
                the time step Δt of the solver differs: 0.1 ms and 5 ms. The slump Δy is the drop of the mean height, divided \
                by that height.",
        question: Some(Question {
            text: "Will both piles slump alike?",
            answers: ["alike", "not alike"],
            rows: predictions::last_rows,
            result: predictions::two_time_steps,
        }),
        learnt: "Long steps act like glue: in each step cohesion stops grains that separate at up to Bond·g·Δt, 0.02 m/s at \
                 0.1 ms and 1 m/s at 5 ms. A bond ends at a gap of 1e-5 diameters (touch tolerance). Lesson 4 has a law under \
                 which Δt hardly matters.",
        worlds: |base| two_time_steps(base, 20.0),
        ..PILE
    },
    Lesson {
        title: "A pile at rest",
        watch: "This pile is computed with Δt = 5 ms. Release it. When it rests, drag Δt to 0.1 ms: the run continues from \
                there.",
        question: Some(Question {
            text: "What will the pile at rest do with the shorter Δt?",
            answers: ["slump again", "stay"],
            rows: predictions::rows_around_change,
            result: predictions::shorter_at_rest,
        }),
        learnt: "A bond at rest holds at every Δt. The length of a step matters while grains are torn apart.",
        worlds: |base| vec![base.with_bond(20.0).over(LONG_STEP_SECS)],
        starts_again: false,
        leaves_free: |name| name == "dt",
        asks_for: |run, preferences| {
            let parameters = run.world().map(|world| world.controls.settings.parameters);
            let is_long = parameters.is_some_and(|it| it.time_step_secs == LONG_STEP_SECS);
            match (run.frame.playing, is_long) {
                _ if waits_at_start(run) => first_step(preferences),
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
        watch: "The same step of 5 ms, computed in three ways: by 5 sweeps of nsgs over all contacts, by 40 sweeps, and by the \
                solver Solved, whose error is small. The second plot shows the error of the velocities.",
        question: Some(Question {
            text: "Five sweeps leave steps unsolved. Will that pile hold better or worse than the pile of Solved?",
            answers: ["better", "worse"],
            rows: predictions::last_rows,
            result: predictions::unsolved_steps,
        }),
        learnt: "Unsolved steps are an error that looks like weaker glue. Here it happens to cancel the glue of the long step: five \
                 sweeps slump like the short step of lesson 1, but by two errors.",
        worlds: |base| {
            let base = base.with_bond(20.0).over(5e-3);
            vec![sweeps(base, 5), sweeps(base, 40), base]
        },
        plots: &["slump", "error"],
        view: None,
        ..PILE
    },
    Lesson {
        title: "Bonds with a length",
        watch: "Above, the law of the paper (moreau): a bond breaks as soon as grains separate. Below, the law range: a bond \
                breaks when it has been opened by δc. Each law runs with 0.1 ms and with 5 ms.",
        question: Some(Question {
            text: "Will Δt change the slump under range as much as under moreau?",
            answers: ["as much", "less"],
            rows: predictions::last_rows,
            result: predictions::two_laws,
        }),
        learnt: "A bond with a length costs the same energy at every Δt, so the slump hardly depends on Δt.",
        worlds: |base| {
            let of_law = |stepper| two_time_steps(Settings { stepper, ..base }, LESSON_4_BOND);
            [Stepper::Moreau, Stepper::Range].into_iter().flat_map(of_law).collect()
        },
        ..PILE
    },
    Lesson {
        title: "What friction depends on",
        watch: "Bond 100. C₀ is the strength of a bond, N the force of a contact. On the left friction is at most μ(N + C₀): \
                cohesion counts. On the right it is at most μN: cohesion does not count.",
        question: Some(Question {
            text: "Which pile will slump more?",
            answers: ["left", "right"],
            rows: predictions::last_rows,
            result: predictions::two_cones,
        }),
        learnt: "Strong bonds hold a pile only if cohesion adds to friction. The paper can be read both ways.",
        worlds: |base| {
            let mut worlds = [base.with_bond(100.0).over(1e-4); 2];
            worlds[0].parameters.cone = FrictionCone::Shifted;
            worlds[1].parameters.cone = FrictionCone::Compressive;
            worlds.into()
        },
        sliders: &["bond", "dt", "mu"],
        ..PILE
    },
    Lesson {
        title: "A heavy disc",
        watch: "A disc rests on a light disc and is a thousand times as heavy. On the left each step gets ten sweeps, on the \
                right each step is solved. The plot shows the overlap.",
        question: Some(Question {
            text: "Will ten sweeps per step carry the heavy disc?",
            answers: ["yes", "no"],
            rows: predictions::last_rows,
            result: predictions::ten_sweeps,
        }),
        learnt: "Each method breaks somewhere. Test it on a case whose right answer you know.",
        scene: "mass-ratio",
        // The view shows the light disc, which would be too small to see next to the heavy disc.
        view: Some([DVec2::new(-1.3, -0.3), DVec2::new(1.3, 1.4)]),
        worlds: |base| vec![sweeps(base, 10), Settings { solver: SolverSettings::DEFAULT, ..base }],
        plots: &["overlap"],
        sliders: &["dt"],
        ..PILE
    },
    Lesson {
        title: "Your own pile",
        watch: "On the right: another scene, or a new pile of your number of grains and seed. Drag the sliders below, drag \
                grains with the mouse, and ask whether you can trust the result.",
        question: Some(Question {
            text: "Will your pile slump by more than 0.3?",
            answers: ["more", "less"],
            rows: predictions::last_rows,
            result: predictions::own_pile,
        }),
        learnt: "A number needs several piles, a shorter Δt and a better solver before you can trust it.",
        worlds: |base| vec![base.over(1e-4)],
        page: Some(Page::Pile),
        leaves_free: |_| true,
        sliders: &["bond", "dt", "rho", "mu"],
        ..PILE
    },
];

/// Bond number of lesson 4. It is small enough that the piles slump under both contact laws (`moreau` and `range`).
const LESSON_4_BOND: f64 = 8.0;
/// Time step at the beginning of lesson 2 (a pile at rest), s. The user shortens the time step later.
const LONG_STEP_SECS: f64 = 5e-3;

/// Returns the lesson with the index `at`, or the last lesson if `at` is too large.
pub(super) fn lesson(at: usize) -> &'static Lesson {
    &LESSONS[at.min(LESSONS.len() - 1)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_pile_of_the_lessons_is_the_one_that_its_command_line_makes() {
        let (config, scene) = LESSONS[0].scene().unwrap();
        assert_eq!(scene, config.scene(|_| true).unwrap());
    }
}
