//! The panels of the window, one a file. Each is a function of the user interface and the state.

#![deny(dead_code, reason = "a panel that nothing shows would not be missed")]

pub(super) mod compare;
mod data;
pub(super) mod distributions;
mod grabbing;
mod grain;
pub(super) mod help;
mod physics;
pub(super) mod plots;
mod run;
pub(super) mod scene;
pub(super) mod see;
mod solver;
pub(super) mod speed;
pub(super) mod status;
pub(super) mod transport;

use egui::Ui;

use super::state::AppState;

pub use grabbing::{Grabbing, GrainRef};

/// A panel of the sidebar, below a heading that opens and closes it.
pub(super) struct Section {
    /// By which scripts that drive the window find it, and the window's memory of the layout.
    pub id: &'static str,
    title: &'static str,
    /// True where it is open at first.
    pub open: bool,
    pub show: fn(&mut Ui, &mut AppState),
}

/// The sidebar, from top to bottom.
pub(super) const SECTIONS: [Section; 10] = [
    section("physics", "Physics", true, physics::show),
    section("grain", "Grain", true, grain::show),
    section("run", "Run", true, run::show),
    section("hand", "By hand", false, grabbing::show),
    section("see", "See", false, see::show),
    section("spread", "Distributions", false, distributions::show),
    section("data", "Data", false, data::show),
    section("compare", "Compare", false, compare::show),
    section("solver", "Solver", false, solver::show),
    section("speed", "Speed and accuracy", false, speed::show),
];

const fn section(
    id: &'static str,
    title: &'static str,
    open: bool,
    show: fn(&mut Ui, &mut AppState),
) -> Section {
    Section { id, title, open, show }
}

impl Section {
    /// Its heading; nothing where it is not there.
    pub(super) fn heading(&self, state: &AppState) -> Option<String> {
        match self.id {
            "grain" if state.mouse.pinned.is_none() => None,
            // A name would make the panel as wide as it is long.
            "physics" | "data" if state.compares() => {
                Some(format!("{} of world {}", self.title, state.selected + 1))
            }
            _ => Some(self.title.to_owned()),
        }
    }
}
