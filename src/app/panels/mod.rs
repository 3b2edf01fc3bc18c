//! The panels of the window, one a file. Each is a function of the user interface and the state.

#![deny(dead_code, reason = "a panel that nothing shows would not be missed")]

pub(super) mod compare;
mod data;
pub(super) mod distributions;
pub(super) mod front;
pub(super) mod gallery;
mod grabbing;
pub(super) mod grain;
pub(super) mod help;
mod physics;
pub(super) mod plots;
mod run;
pub(super) mod scene;
pub(super) mod see;
mod solver;
pub(super) mod speed;
pub(super) mod status;
pub(super) mod table;
pub(super) mod trust;

use egui::{CollapsingHeader, RichText, Ui};

use super::IN_BROWSER;
use super::page::Page;
use super::state::AppState;

pub use front::FRONT_SETTINGS;
pub use grabbing::{Grabbing, GrainRef};

impl Page {
    /// Shows what is on it.
    pub(super) fn show(self, ui: &mut Ui, state: &mut AppState) {
        // A name would make the panel as wide as it is long.
        if state.compares() && matches!(self, Self::Solver | Self::Save) {
            ui.label(RichText::new(format!("Of world {}", state.selected + 1)).strong());
        }
        match self {
            Self::Pile => {
                run::show(ui, state);
                ui.separator();
                grain::show(ui, state);
                grabbing::show(ui, state);
            }
            Self::Solver => {
                physics::show(ui, state);
                ui.separator();
                solver::show(ui, state);
                // It would keep a page waiting for seconds.
                if !IN_BROWSER {
                    folded(ui, state, "Speed and accuracy", speed::show);
                }
            }
            Self::Compare => {
                compare::show(ui, state);
                run::earlier_runs(ui, state);
                ui.separator();
                plots::choices(ui, state);
                folded(ui, state, "Distributions", distributions::show);
                folded(ui, state, "Grains and contacts", table::show);
            }
            Self::Look => see::look(ui, state),
            Self::Save => {
                if !IN_BROWSER {
                    see::folder(ui, state);
                }
                see::pictures(ui, state);
                ui.separator();
                data::show(ui, state);
                ui.separator();
                run::command_line(ui, state);
            }
        }
    }
}

/// What is computed only for those who ask for it.
fn folded(
    ui: &mut Ui,
    state: &mut AppState,
    title: &'static str,
    show: fn(&mut Ui, &mut AppState),
) {
    ui.separator();
    CollapsingHeader::new(title).show_unindented(ui, |ui| show(ui, state));
}
