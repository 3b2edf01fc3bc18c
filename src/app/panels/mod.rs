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
    /// Its heading; nothing where it is not there.
    pub title: fn(&AppState) -> Option<String>,
    /// Whether it is open at first.
    pub open: bool,
    /// What is in it.
    pub show: fn(&mut Ui, &mut AppState),
}

/// The sidebar, from top to bottom.
pub(super) const SECTIONS: &[Section] = &[
    Section {
        id: "physics",
        title: |state| Some(of_one_world("Physics", state)),
        open: true,
        show: physics::show,
    },
    Section { id: "grain", title: grain::title, open: true, show: grain::show },
    Section { id: "run", title: |_| Some("Run".into()), open: true, show: run::show },
    Section { id: "hand", title: |_| Some("By hand".into()), open: false, show: grabbing::show },
    Section { id: "see", title: |_| Some("See".into()), open: false, show: see::show },
    Section {
        id: "spread",
        title: |_| Some("Distributions".into()),
        open: false,
        show: distributions::show,
    },
    Section {
        id: "data",
        title: |state| Some(of_one_world("Data", state)),
        open: false,
        show: data::show,
    },
    Section { id: "compare", title: |_| Some("Compare".into()), open: false, show: compare::show },
    Section { id: "solver", title: |_| Some("Solver".into()), open: false, show: solver::show },
    Section {
        id: "speed",
        title: |_| Some("Speed and accuracy".into()),
        open: false,
        show: speed::show,
    },
];

/// The title of a panel that is about the selected world.
fn of_one_world(title: &str, state: &AppState) -> String {
    match state.compares() {
        // A name would make the panel as wide as it is long.
        true => format!("{title} of world {}", state.selected + 1),
        false => title.into(),
    }
}
