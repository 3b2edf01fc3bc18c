//! The layout of the window.

use egui::{CentralPanel, Frame, Margin, Panel, ScrollArea, Ui};

use super::lesson_bar::LessonBar;
use super::pages::Pages;
use super::scene::ScenePanel;
use super::trust::TrustPanel;
use super::{front, grain, help, lesson_bar, plots, status};
use crate::app::context::PanelContext;
use crate::app::page::Page;
use crate::app::painting::fill;
use crate::app::work::progress_bar;
use crate::live::Command;

/// Smallest width of the sidebar, and its width when it opens, points.
const SIDEBAR: f32 = 364.0;
/// Width of the window, points, below which a page of the sidebar fills the whole window, as on a telephone.
const NARROW: f32 = 600.0;
/// Height of the plots when their panel opens, points.
const PLOTS: f32 = 150.0;

/// All panels of the window.
#[derive(Default)]
pub struct Panels {
    /// The panel in the middle of the window, which shows the simulations.
    pub scene: ScenePanel,
    pub(crate) lesson_bar: LessonBar,
    pub(crate) pages: Pages,
    /// True while the help overlay is open.
    pub(crate) help: bool,
    pub(crate) trust: TrustPanel,
    /// The page of the sidebar that was open in the previous frame.
    page: Option<Page>,
}

impl Panels {
    /// Draws all panels.
    pub(crate) fn show(&mut self, ui: &mut Ui, context: &mut PanelContext<'_>) {
        fill(ui, ui.max_rect(), ui.visuals().panel_fill);
        // If the user opens a page, the page replaces the panel "Can I trust this?".
        let page = context.preferences.page;
        self.trust.is_open &= page.is_none() || page == self.page;
        self.page = page;
        let has_page = (context.preferences.page.is_some() || self.trust.is_open)
            && !context.preferences.folded;
        if has_page && ui.max_rect().width() < NARROW {
            self.lesson_line(ui, context);
            self.status_line(ui, context);
            let frame = CentralPanel::default().frame(sidebar_frame());
            frame.show(ui, |ui| self.side(ui, context));
            self.trust.follow(ui, context);
            return;
        }
        if !context.preferences.folded {
            self.bars(ui, context);
        }
        CentralPanel::no_frame().show(ui, |ui| {
            self.scene.show(ui, context);
            waiting(ui, context);
        });
        if context.preferences.folded {
            unfold(ui, context);
        } else {
            lesson_bar::light(ui, context);
        }
        grain::show_over_scene(ui, context);
        self.trust.follow(ui, context);
        help::show(ui, &mut self.help);
    }

    fn lesson_line(&mut self, ui: &mut Ui, context: &mut PanelContext<'_>) {
        let lesson_bar = &mut self.lesson_bar;
        bar(Panel::top("lesson")).show(ui, |ui| lesson_bar.show(ui, context));
    }

    fn status_line(&mut self, ui: &mut Ui, context: &mut PanelContext<'_>) {
        let (trust, help) = (&mut self.trust, &mut self.help);
        bar(Panel::bottom("status")).show(ui, |ui| status::show(ui, context, trust, help));
    }

    /// Draws the bars, the sidebar and the plots around the scene.
    fn bars(&mut self, ui: &mut Ui, context: &mut PanelContext<'_>) {
        self.lesson_line(ui, context);
        let mut is_open = context.preferences.page.is_some() || self.trust.is_open;
        Panel::right("sidebar")
            .frame(sidebar_frame())
            .default_size(SIDEBAR)
            .size_range(SIDEBAR..=480.0)
            .show_collapsible(ui, &mut is_open, |ui| self.side(ui, context));
        if !is_open {
            context.preferences.page = None;
            self.trust.is_open = false;
        }
        self.status_line(ui, context);
        if context.preferences.plots {
            Panel::bottom("plots")
                .frame(tight())
                .resizable(true)
                .default_size(PLOTS)
                .size_range(100.0..=600.0)
                .show(ui, |ui| plots::show(ui, context));
        }
        bar(Panel::bottom("plot line")).show(ui, |ui| plots::header(ui, context));
        bar(Panel::bottom("front")).show(ui, |ui| front::show(ui, context));
    }

    /// Shows the contents of the sidebar: the panel "Can I trust this?" if it is open, otherwise the open page.
    fn side(&mut self, ui: &mut Ui, context: &mut PanelContext<'_>) {
        match self.trust.is_open {
            true => self.trust.show(ui, context),
            false => self.sidebar(ui, context),
        }
    }

    /// Shows the tabs of the sidebar and the open page.
    fn sidebar(&mut self, ui: &mut Ui, context: &mut PanelContext<'_>) {
        ui.horizontal(|ui| {
            ui.spacing_mut().item_spacing.x = 2.0;
            ui.spacing_mut().button_padding.x = 5.0;
            for page in Page::ALL {
                let is_open = context.preferences.page == Some(page);
                let tab = ui.selectable_label(is_open, page.title());
                context.note_control(page.title(), tab.rect);
                if tab.clicked() {
                    context.preferences.page = Some(page);
                }
            }
        });
        ui.separator();
        let Some(page) = context.preferences.page else { return };
        let area = ScrollArea::vertical().id_salt(page.title()).auto_shrink([false, false]);
        area.show(ui, |ui| {
            // The scroll bar covers the right edge, so the contents have a margin there.
            let frame = Frame::new().inner_margin(Margin { right: 8, ..Margin::ZERO });
            frame.show(ui, |ui| self.pages.show(ui, context, page));
        });
    }
}

fn tight() -> Frame {
    Frame::new().inner_margin(Margin::symmetric(8, 4))
}

fn bar(panel: Panel) -> Panel {
    panel.frame(tight()).resizable(false)
}

fn sidebar_frame() -> Frame {
    Frame::new().inner_margin(Margin { left: 10, right: 4, top: 8, bottom: 4 })
}

/// Shows the button by which the user makes the hidden bars visible again.
fn unfold(ui: &Ui, context: &mut PanelContext<'_>) {
    let area = egui::Area::new(egui::Id::unique("unfold"));
    area.anchor(egui::Align2::RIGHT_TOP, [-8.0, 8.0]).show(ui.ctx(), |ui| {
        let button = ui.button("▾").on_hover_text("Show the bars (B)");
        button.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, "Unfold"));
        context.preferences.folded &= !button.clicked();
    });
}

/// While a scene is being loaded, shows the progress and a button that cancels the loading.
fn waiting(ui: &mut Ui, context: &mut PanelContext<'_>) {
    let Some(progress) = context.run.frame.loading.clone() else { return };
    let area = egui::Area::new(egui::Id::unique("loading"));
    area.anchor(egui::Align2::CENTER_TOP, [0.0, 40.0]).show(ui.ctx(), |ui| {
        Frame::popup(ui.style()).show(ui, |ui| {
            ui.set_max_width(360.0);
            ui.label(if progress.text.is_empty() { "Loading" } else { &progress.text });
            ui.horizontal(|ui| {
                let cancel = ui.button("Cancel");
                context.note_control("cancel", cancel.rect);
                if cancel.clicked() {
                    context.run.live.send(Command::CancelLoading);
                }
                progress_bar(ui, "Loading", progress.part);
            });
        });
    });
}
