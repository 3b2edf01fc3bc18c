//! The contents of the pages of the sidebar.

use egui::{CollapsingHeader, RichText, Ui};

use super::distributions::Distributions;
use super::gallery::Gallery;
use super::speed::StepRace;
use super::{compare, data, grabbing, grain, physics, plots, run, see, solver, speed};
use crate::app::IN_BROWSER;
use crate::app::context::PanelContext;
use crate::app::page::Page;
use crate::scene::{SceneGroup, SceneInfo};

/// The state of the panels on the pages of the sidebar.
#[derive(Default)]
pub(crate) struct Pages {
    gallery: Gallery,
    race: StepRace,
    distributions: Distributions,
}

impl Pages {
    /// Discards the measured computing times of the solvers. They belong to one step of a run that the window no longer
    /// shows.
    pub(crate) fn forget_race(&mut self) {
        self.race = StepRace::default();
    }

    /// Shows a page of the sidebar.
    pub(super) fn show(&mut self, ui: &mut Ui, context: &mut PanelContext<'_>, page: Page) {
        // The text contains the number of the world and not its name, because a long name would widen the panel.
        if context.run.compares() && matches!(page, Page::Solver | Page::Save) {
            let text = format!("For world {}", context.run.selected + 1);
            ui.label(RichText::new(text).strong());
        }
        match page {
            Page::Pile => {
                run::show(ui, context, &mut self.gallery);
                ui.separator();
                grain::show(ui, context.run);
                grabbing::show(ui, context.preferences);
            }
            Page::Solver => {
                let Some((before, start)) = context.run.wanted_and_start() else { return };
                let mut settings = before;
                physics::show(ui, context.run, &mut settings, start.settings());
                ui.separator();
                solver::show(ui, context.run, &mut settings);
                folded(ui, "Expert", |ui| {
                    solver::expert(ui, &mut settings, &start);
                    ui.separator();
                    self.expert(ui, context);
                });
                if settings != before {
                    context.run.change(context.run.selected, settings);
                }
            }
            Page::Compare => {
                compare::show(ui, context.run);
                run::earlier_runs(ui, context);
                ui.separator();
                plots::choices(ui, context);
                folded(ui, "Distributions", |ui| self.distributions.show(ui, context.run));
            }
            Page::Look => see::look(ui, context.preferences),
            Page::Save => {
                if !IN_BROWSER {
                    see::folder(ui, context);
                }
                see::pictures(ui, context);
                ui.separator();
                data::show(ui, context);
                ui.separator();
                run::command_line(ui, context);
            }
        }
    }

    /// Shows scenes and comparisons for users who study solvers.
    fn expert(&mut self, ui: &mut Ui, context: &mut PanelContext<'_>) {
        let hint =
            "Each scene has a known right answer. A line at the top compares the run with it.";
        let label = ui.label(SceneGroup::Stability.hint()).on_hover_text(hint);
        let current = context.run.config().named().to_owned();
        let groups = [SceneGroup::Stability];
        let is_hard = SceneInfo::named(&current).is_some_and(|info| groups.contains(&info.group));
        let shown = if is_hard { &current } else { "choose a scene" };
        let list = self.gallery.show(ui, context, shown, &groups).labelled_by(label.id);
        context.note_control("hard scenes", list.rect);
        compare::method_presets(ui, context.run);
        if IN_BROWSER {
            // The measurement would block the browser version for seconds.
            ui.weak(
                "Only the program measures the speed and accuracy of all solvers: slump chart.",
            );
        } else {
            let race = &mut self.race;
            folded(ui, "Speed and accuracy", |ui| speed::show(ui, context.run, race));
        }
    }
}

/// Shows a panel that the user can open and close. The contents of a closed panel are not computed.
fn folded(ui: &mut Ui, title: &'static str, show: impl FnOnce(&mut Ui)) {
    ui.separator();
    CollapsingHeader::new(title).show_unindented(ui, show);
}
