//! The tour: stations that each show one thing, with worlds side by side and a sentence on what to watch.
//! What their sentences say is checked by `tests/window/tour.rs`, which computes them.

use egui::{Align, Button, Layout, RichText, Ui};
use serde::{Deserialize, Serialize};

use super::preferences::Preferences;
use super::state::AppState;
use super::theme;
use crate::live::Command;
use crate::sim::{Settings, Stepper};
use crate::solver::{Fallback, Method, SolverSettings};
use crate::world::FrictionCone;

/// What one stop shows.
#[derive(Debug)]
pub struct Station {
    /// What it is about.
    pub title: &'static str,
    /// What to do, and what to watch.
    pub watch: &'static str,
    /// Its scene.
    pub scene: &'static str,
    /// Its worlds, made of the settings that the window gives that scene.
    pub worlds: fn(Settings) -> Vec<Settings>,
    /// Simulated time per time on the wall.
    pub speed: f64,
    /// The quantities that are plotted.
    pub plots: &'static [&'static str],
    /// The panel that is opened for it.
    pub panel: Option<&'static str>,
}

/// A pile of the paper, slow enough to be followed.
const PILE: Station = Station {
    title: "",
    watch: "",
    scene: "pile",
    worlds: |base| vec![base],
    speed: 0.2,
    plots: &["slump"],
    panel: None,
};

/// How the stations' piles are solved: what a station says was found under Coulomb's law.
pub(super) const SOLVER: SolverSettings = SolverSettings {
    fallback: Fallback::OfMethod,
    ..SolverSettings::to_residual(Method::Auto, 1e-6, 500)
};

fn two_time_steps(base: Settings, bond: f64) -> Vec<Settings> {
    [1e-4, 5e-3].map(|secs| base.with_bond(bond).over(secs)).into()
}

/// That many sweeps of Gauss-Seidel a step, solved or not.
fn sweeps(base: Settings, count: u32) -> Settings {
    let (method, fallback) = (Method::Nsgs, Fallback::None);
    let solver = SolverSettings { method, fallback, max_sweeps: count, ..base.solver };
    Settings { solver, ..base }
}

fn in_cone(mut settings: Settings, cone: FrictionCone) -> Settings {
    settings.parameters.cone = cone;
    settings
}

/// All of them, in their order.
pub const STATIONS: [Station; 9] = [
    Station {
        title: "The time step glues",
        watch: "One pile twice, with the same cohesion, Bond 20. Only the time step differs. Release the walls: \
                at Δt = 1e-4 s it spreads out, at 5e-3 s it stands.",
        worlds: |base| two_time_steps(base, 20.0),
        ..PILE
    },
    Station {
        title: "Strong piles: the reverse",
        watch: "The same at Bond 100. Now the small time step is the one that holds best; the pile at 5e-3 s sinks \
                a little. Look at the scale of the plot.",
        worlds: |base| two_time_steps(base, 100.0),
        ..PILE
    },
    Station {
        title: "Why: three grains on a line",
        watch: "A grain falls on a bonded pair. A bond cancels an opening speed of up to Bond·g·Δt in each step: at \
                Δt = 5e-4 s the pair is torn apart, at 1e-3 s the bond holds. Watch the energy.",
        scene: "cradle",
        worlds: |base| [5e-4, 1e-3].map(|secs| base.over(secs)).into(),
        speed: 0.5,
        plots: &["energy"],
        ..PILE
    },
    Station {
        title: "The solver's part",
        watch: "Bond 20, Δt = 5e-3 s: 5 sweeps a step, 40 sweeps, and solved to 1e-6. Only a solved step shows what \
                the law says; the sweeps not taken look like weaker glue. See the residual.",
        worlds: |base| {
            let base = base.with_bond(20.0).over(5e-3);
            vec![sweeps(base, 5), sweeps(base, 40), base]
        },
        plots: &["slump", "error"],
        panel: Some("solver"),
        ..PILE
    },
    Station {
        title: "A law in which Δt means little",
        watch: "Above the paper's law moreau, below range, whose bonds live until they are opened by δc: at Δt = \
                1e-4 and 5e-3 s. Above, the time step decides; below, the pile holds at both.",
        worlds: |base| {
            let of_law = |stepper| two_time_steps(Settings { stepper, ..base }, 20.0);
            [Stepper::Moreau, Stepper::Range].into_iter().flat_map(of_law).collect()
        },
        ..PILE
    },
    Station {
        title: "What friction hangs on",
        watch: "Bond 100, Δt = 1e-4 s. On the left friction is bounded by μ(N + C₀), cohesion included; on the right by \
                μ max(N, 0): there the strong pile slumps. The paper can be read both ways.",
        worlds: |base| {
            let base = base.with_bond(100.0).over(1e-4);
            [FrictionCone::Shifted, FrictionCone::Compressive]
                .map(|cone| in_cone(base, cone))
                .into()
        },
        panel: Some("physics"),
        ..PILE
    },
    Station {
        title: "Where a method breaks",
        watch: "A disc a thousand times as heavy on a light one. Ten sweeps a step cannot carry it, and the light \
                disc is squeezed; the right world is solved by newton. Watch the overlap.",
        scene: "mass-ratio",
        worlds: |base| {
            let solver = SolverSettings::to_residual(Method::Newton, 1e-6, 100);
            let base = Settings { solver, ..base };
            vec![sweeps(base, 10), base]
        },
        plots: &["overlap", "error"],
        ..PILE
    },
    Station {
        title: "Speed against accuracy",
        watch: "Start the pile, stop it while it slumps, and press Measure this step under Speed and accuracy: each \
                method solves the step that is shown, and its residual is drawn over its time.",
        worlds: |base| vec![base.with_bond(20.0).over(1e-3)],
        plots: &["slump", "error"],
        panel: Some("speed"),
        ..PILE
    },
    Station {
        title: "Your own pile",
        watch: "Under Run, choose a number of grains and a seed, and make a new pile; under Physics, its Bond and Δt. \
                Drag grains with the mouse. The tour can be taken up again at any time.",
        plots: &["slump", "overlap", "error", "energy"],
        panel: Some("run"),
        ..PILE
    },
];

/// How far someone has come on the tour.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Tour {
    /// The station, from 0.
    pub at: usize,
    /// True while a window that is told nothing else opens there.
    pub on: bool,
    /// What was chosen before the tour, which comes back after it.
    pub(super) before: Option<Choices>,
}

impl Default for Tour {
    fn default() -> Self {
        Self { at: 0, on: true, before: None }
    }
}

/// What a station chooses in the place of the user.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Choices {
    pub quantities: Vec<String>,
    pub speed: f64,
    pub full_speed: bool,
}

impl AppState {
    /// Goes to a station of the tour.
    pub fn visit(&mut self, at: usize) {
        let station = self.preferences.visit(at);
        self.touring = true;
        self.shown.panel = station.panel;
        self.live.send(Command::SetPace(self.preferences.pace()));
        self.load_station(station);
    }

    /// Ends the tour, with the worlds as they are.
    pub(crate) fn leave_tour(&mut self) {
        if std::mem::take(&mut self.touring) {
            self.preferences.put_tour_away();
            self.preferences.tour.on = false;
            self.live.send(Command::SetPace(self.preferences.pace()));
        }
    }
}

impl Preferences {
    /// Goes to a station of the tour, or to the last where there are not so many, and makes its choices.
    pub(in crate::app) fn visit(&mut self, at: usize) -> &'static Station {
        let at = at.min(STATIONS.len() - 1);
        let station = &STATIONS[at];
        let plots = station.plots.iter().map(|name| (*name).to_owned()).collect();
        let choices = Choices {
            quantities: std::mem::replace(&mut self.quantities, plots),
            speed: std::mem::replace(&mut self.speed, station.speed),
            full_speed: std::mem::take(&mut self.full_speed),
        };
        let before = self.tour.before.take().unwrap_or(choices);
        self.tour = Tour { at, on: true, before: Some(before) };
        station
    }

    /// Brings back what was chosen before the tour.
    pub(in crate::app) fn put_tour_away(&mut self) {
        if let Some(Choices { quantities, speed, full_speed }) = self.tour.before.take() {
            (self.quantities, self.speed, self.full_speed) = (quantities, speed, full_speed);
        }
    }
}

/// Shows the strip.
pub(crate) fn show(ui: &mut Ui, state: &mut AppState) {
    let at = state.preferences.tour.at;
    let Some(Station { title, watch, .. }) = STATIONS.get(at) else { return };
    ui.horizontal(|ui| {
        let dark = ui.visuals().dark_mode;
        let accent = theme::accent(dark);
        let count = format!("{} of {}", at + 1, STATIONS.len());
        ui.label(RichText::new(count).color(accent));
        ui.label(RichText::new(*title).heading());
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            let hint = "End the tour; the worlds stay. It goes on here when it is taken up again.";
            let leave = ui.button("Leave").on_hover_text(hint);
            state.note_control("leave tour", leave.rect);
            if leave.clicked() {
                return state.leave_tour();
            }
            let next = RichText::new("Next ▶").color(theme::on_accent(dark));
            let next = ui.add_enabled(at + 1 < STATIONS.len(), Button::new(next).fill(accent));
            state.note_control("next station", next.rect);
            let next = next.on_hover_text("The next station");
            if next.clicked() {
                state.visit(at + 1);
            }
            let back = ui.add_enabled(at > 0, Button::new("◀ Back"));
            if back.on_hover_text("The station before").clicked() {
                state.visit(at.saturating_sub(1));
            }
            if ui.button("Again").on_hover_text("This station as it was at first").clicked() {
                state.visit(at);
            }
        });
    });
    ui.label(*watch);
}

/// The way back to the tour.
pub(crate) fn resume_button(ui: &mut Ui, state: &mut AppState) {
    let at = state.preferences.tour.at.min(STATIONS.len() - 1);
    let text = format!("Tour: {} of {}", at + 1, STATIONS.len());
    let button = ui.button(RichText::new(text).small());
    state.note_control("tour", button.rect);
    let hint = format!("Take up the tour: {}", STATIONS[at].title);
    if button.on_hover_text(hint).clicked() {
        state.visit(at);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_chosen_before_the_tour_comes_back_after_it() {
        let chosen = Preferences {
            quantities: vec!["energy".into()],
            speed: 3.0,
            full_speed: true,
            ..Preferences::default()
        };
        let mut preferences = chosen.clone();
        assert_eq!(preferences.visit(0).title, STATIONS[0].title);
        assert_eq!(preferences.visit(99).title, STATIONS[STATIONS.len() - 1].title);
        assert_ne!(preferences.quantities, chosen.quantities);
        preferences.put_tour_away();
        let tour = Tour { at: STATIONS.len() - 1, on: true, before: None };
        assert_eq!(preferences, Preferences { tour, ..chosen });
    }
}
