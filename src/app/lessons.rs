//! The lessons: each shows one thing, with worlds side by side and a sentence or two on what to watch.
//! What their sentences say is checked by `tests/window/lessons.rs`, over many starts.

use egui::{Align, Button, ComboBox, Label, Layout, RichText, Ui};
use glam::DVec2;
use serde::{Deserialize, Serialize};

use super::IN_BROWSER;
use super::opening::Opening;
use super::page::Page;
use super::preferences::Preferences;
use super::state::AppState;
use super::theme;
use crate::config::{Config, parse_discs};
use crate::error::Result;
use crate::live::Command;
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
    /// True where a slider starts the run again.
    pub starts_again: bool,
    /// True of settings whose change its sentences ask for, or leave true.
    pub leaves_free: fn(&str) -> bool,
    /// The controls that it asks for next, which are lit, by the names that the window notes their places by.
    pub asks_for: fn(&AppState) -> &'static [&'static str],
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
    asks_for: |state| if waits_at_start(state) { &["release"] } else { &[] },
};

fn waits_at_start(state: &AppState) -> bool {
    state.frame.at_start() && !state.frame.playing
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
        watch: "This pile is stepped by 5 ms. Release it. When it stands, drag Δt to 0.1 ms: nothing happens, for bonds \
                that hold stay as they are. Tick the box below, and drag again: from the start, Δt matters.",
        worlds: |base| vec![base.with_bond(20.0).over(LONG_STEP_SECS)],
        starts_again: false,
        leaves_free: |name| name == "dt",
        asks_for: |state| {
            let parameters = state.world().map(|world| world.controls.settings.parameters);
            let is_long = parameters.is_some_and(|it| it.time_step_secs == LONG_STEP_SECS);
            match (state.frame.playing, is_long) {
                (true, _) => &[],
                _ if waits_at_start(state) => &["release"],
                (_, true) => &["Δt"],
                _ if !state.preferences.starts_again => &["start again"],
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
        title: "What friction hangs on",
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
        asks_for: |state| match (waits_at_start(state), state.preferences.page) {
            (true, Some(Page::Pile)) => &["scenes", "new pile", "Bond", "Δt", "ρ", "μ", "trust"],
            _ => &[],
        },
        ..PILE
    },
];

/// The time step of the lesson on bonds, s.
const LONG_STEP_SECS: f64 = 5e-3;

/// How far someone has come.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct LessonPlace {
    /// The lesson, from 0.
    pub at: usize,
    /// True while a window that is told nothing else opens there.
    pub on: bool,
    /// What was chosen before the lessons, which comes back after them.
    pub(super) before: Option<Choices>,
}

impl Default for LessonPlace {
    fn default() -> Self {
        Self { at: 0, on: true, before: None }
    }
}

/// What a lesson chooses in the place of the user.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Choices {
    pub quantities: Vec<String>,
    pub speed: f64,
    pub full_speed: bool,
    pub starts_again: bool,
    pub page: Option<Page>,
}

impl Choices {
    /// Puts them into force, and gives those that were.
    fn swap(self, preferences: &mut Preferences) -> Self {
        Self {
            quantities: std::mem::replace(&mut preferences.quantities, self.quantities),
            speed: std::mem::replace(&mut preferences.speed, self.speed),
            full_speed: std::mem::replace(&mut preferences.full_speed, self.full_speed),
            starts_again: std::mem::replace(&mut preferences.starts_again, self.starts_again),
            page: std::mem::replace(&mut preferences.page, self.page),
        }
    }
}

impl AppState {
    /// Goes to a lesson.
    pub fn visit(&mut self, at: usize) {
        self.preferences.visit(at);
        self.touring = true;
        self.shown.loads_before_lesson = self.frame.loads;
        self.live.send(Command::SetPace(self.preferences.pace()));
        self.open(Opening::Lesson(self.preferences.lesson.at));
    }

    /// Ends the lessons, with the worlds as they are.
    pub(crate) fn leave_lessons(&mut self) {
        if std::mem::take(&mut self.touring) {
            self.preferences.put_lesson_away();
            self.preferences.lesson.on = false;
            self.live.send(Command::SetPace(self.preferences.pace()));
        }
    }
}

impl Preferences {
    /// Goes to a lesson, or to the last where there are not so many, and makes its choices.
    pub(in crate::app) fn visit(&mut self, at: usize) {
        let at = at.min(LESSONS.len() - 1);
        let lesson = &LESSONS[at];
        let choices = Choices {
            quantities: lesson.plots.iter().map(|name| (*name).to_owned()).collect(),
            speed: lesson.speed,
            full_speed: false,
            starts_again: lesson.starts_again,
            page: lesson.page,
        };
        let replaced = choices.swap(self);
        let before = self.lesson.before.take().unwrap_or(replaced);
        self.lesson = LessonPlace { at, on: true, before: Some(before) };
    }

    /// Brings back what was chosen before the lessons.
    pub(in crate::app) fn put_lesson_away(&mut self) {
        if let Some(before) = self.lesson.before.take() {
            before.swap(self);
        }
    }
}

/// The bar above the scene.
pub(crate) fn show(ui: &mut Ui, state: &mut AppState) {
    let at = state.preferences.lesson.at.min(LESSONS.len() - 1);
    ui.horizontal(|ui| {
        let dark = ui.visuals().dark_mode;
        let accent = theme::accent(dark);
        ui.label(RichText::new("Slump").heading().color(accent));
        list(ui, state, at);
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            let fold = ui.button("▴").on_hover_text("Fold the bars: the scene is the window (B)");
            fold.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, "Fold"));
            state.preferences.folded |= fold.clicked();
            if !state.touring {
                return;
            }
            let hint =
                "End the lessons; the worlds stay. They go on here when they are taken up again.";
            let leave = ui.button("Leave").on_hover_text(hint);
            state.note_control("leave lessons", leave.rect);
            if leave.clicked() {
                return state.leave_lessons();
            }
            let next = RichText::new("Next ▶").color(theme::on_accent(dark));
            let next = ui.add_enabled(at + 1 < LESSONS.len(), Button::new(next).fill(accent));
            state.note_control("next lesson", next.rect);
            let next = next.on_hover_text("The next lesson");
            if next.clicked() {
                state.visit(at + 1);
            }
            let back = ui.add_enabled(at > 0, Button::new("◀ Back"));
            if back.on_hover_text("The lesson before").clicked() {
                state.visit(at.saturating_sub(1));
            }
            ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
                ui.add(Label::new(RichText::new(LESSONS[at].title).heading()).truncate());
            });
        });
    });
    if state.touring {
        let is_changed = has_other_worlds(state, &LESSONS[at]);
        ui.label(if is_changed { OTHER_WORLDS } else { LESSONS[at].watch });
    }
}

/// Lights the controls that the lesson asks for next, where all of the window is drawn.
pub(crate) fn light(ui: &Ui, state: &AppState) {
    if !state.touring || state.frame.loading.is_some() {
        return;
    }
    let lesson = &LESSONS[state.preferences.lesson.at.min(LESSONS.len() - 1)];
    let stroke = egui::Stroke::new(2.0, theme::accent(ui.visuals().dark_mode));
    for name in (lesson.asks_for)(state) {
        if let Some(rect) = state.controls.get(*name) {
            let ring = rect.expand(3.0);
            ui.painter().rect_stroke(ring, 5.0, stroke, egui::StrokeKind::Outside);
        }
    }
}

/// What is said in place of a lesson's sentences where they are no longer true.
const OTHER_WORLDS: &str = "A number was changed: these are no longer the worlds of the lesson. The list above has it as it was.";

/// True where worlds of a lesson are no longer those that it speaks of.
fn has_other_worlds(state: &AppState, lesson: &Lesson) -> bool {
    let Some(start) = &state.frame.start else { return false };
    let worlds = (lesson.worlds)(*start.settings());
    let is_there = state.frame.loads > state.shown.loads_before_lesson;
    let shown: Vec<Settings> =
        state.frame.worlds.iter().map(|world| world.controls.settings).collect();
    let held = || Settings::about().filter(|about| !(lesson.leaves_free)(about.name));
    let is_as_it_was = |(one, shown): (&Settings, &Settings)| {
        held().all(|about| one.get(about.name) == shown.get(about.name))
    };
    let are_all = shown.len() == worlds.len() && worlds.iter().zip(&shown).all(is_as_it_was);
    is_there && !are_all && held().next().is_some()
}

/// All lessons, to be gone to; the one that was left is marked.
fn list(ui: &mut Ui, state: &mut AppState, at: usize) {
    let text = match state.touring {
        true => format!("Lesson {} of {}", at + 1, LESSONS.len()),
        false => "Lessons".to_owned(),
    };
    let mut asked = None;
    let shown =
        ComboBox::from_id_salt("lessons").selected_text(text).width(104.0).show_ui(ui, |ui| {
            for (number, lesson) in LESSONS.iter().enumerate() {
                let text = format!("{}. {}", number + 1, lesson.title);
                if ui.selectable_label(number == at, text).clicked() {
                    asked = Some(number);
                }
            }
        });
    let response = shown.response;
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::ComboBox, true, "Lessons"));
    state.note_control("lessons", response.rect);
    if let Some(number) = asked {
        state.visit(number);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
        preferences.visit(1);
        assert!(!preferences.starts_again && preferences.page.is_none());
        preferences.visit(99);
        assert_ne!(preferences.quantities, chosen.quantities);
        preferences.put_lesson_away();
        let lesson = LessonPlace { at: LESSONS.len() - 1, on: true, before: None };
        assert_eq!(preferences, Preferences { lesson, ..chosen });
    }
}
