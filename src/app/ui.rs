//! The layout of the window as a function of the state alone, and the keys that act wherever the mouse is.

use egui::{CentralPanel, Context, Event, Frame, Key, Margin, Modifiers, Panel, ScrollArea, Ui};

use super::opening::Opening;
use super::page::Page;
use super::painting::fill;
use super::panels::{front, grain, help, plots, scene, see, status, trust};
use super::sharing::{RunLink, is_link};
use super::state::AppState;
use super::work::progress_bar;
use super::{lessons, opening};
use crate::live::Command;

/// Width of the sidebar, points.
const SIDEBAR: f32 = 364.0;
/// In less width than this, points, a page of the sidebar takes the place of all else, as on a telephone.
const NARROW: f32 = 600.0;
/// Height of the plots, points.
const PLOTS: f32 = 150.0;

/// The whole window.
pub fn ui(ui: &mut Ui, state: &mut AppState) {
    state.refresh();
    let context = ui.ctx().clone();
    state.restore_layout(&context);
    state.follow_link(&context);
    if context.options(|options| options.theme_preference) != state.preferences.theme {
        context.set_theme(state.preferences.theme);
    }
    state.follow_ensemble(&context);
    opening::take_dropped_files(&context, state);
    act_on_keys(&context, state);

    fill(ui, ui.max_rect(), ui.visuals().panel_fill);
    let has_page = state.preferences.page.is_some() && !state.preferences.folded;
    if has_page && ui.max_rect().width() < NARROW {
        bar(Panel::top("lesson")).show(ui, |ui| lessons::show(ui, state));
        bar(Panel::bottom("status")).show(ui, |ui| status::show(ui, state));
        let frame = Frame::new().inner_margin(Margin { left: 10, right: 4, top: 8, bottom: 4 });
        CentralPanel::default().frame(frame).show(ui, |ui| sidebar(ui, state));
        return;
    }
    if !state.preferences.folded {
        bars(ui, state);
    }
    CentralPanel::no_frame().show(ui, |ui| {
        scene::show(ui, state);
        waiting(ui, state);
    });
    if state.preferences.folded {
        unfold(ui, state);
    } else {
        lessons::light(ui, state);
    }
    grain::show_over_scene(ui, state);
    trust::show(ui, state);
    help::show(ui, state);
}

fn tight() -> Frame {
    Frame::new().inner_margin(Margin::symmetric(8, 4))
}

fn bar(panel: Panel) -> Panel {
    panel.frame(tight()).resizable(false)
}

/// All that stands around the scene.
fn bars(ui: &mut Ui, state: &mut AppState) {
    bar(Panel::top("lesson")).show(ui, |ui| lessons::show(ui, state));
    let mut is_open = state.preferences.page.is_some();
    Panel::right("sidebar")
        .frame(Frame::new().inner_margin(Margin { left: 10, right: 4, top: 8, bottom: 4 }))
        .default_size(SIDEBAR)
        .size_range(SIDEBAR..=480.0)
        .show_collapsible(ui, &mut is_open, |ui| sidebar(ui, state));
    if !is_open {
        state.preferences.page = None;
    }
    bar(Panel::bottom("status")).show(ui, |ui| status::show(ui, state));
    if state.preferences.plots {
        Panel::bottom("plots")
            .frame(tight())
            .resizable(true)
            .default_size(PLOTS)
            .size_range(100.0..=600.0)
            .show(ui, |ui| plots::show(ui, state));
    }
    bar(Panel::bottom("plot line")).show(ui, |ui| plots::header(ui, state));
    bar(Panel::bottom("front")).show(ui, |ui| front::show(ui, state));
}

/// The pages, of which one is open.
fn sidebar(ui: &mut Ui, state: &mut AppState) {
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 2.0;
        ui.spacing_mut().button_padding.x = 5.0;
        for page in Page::ALL {
            let is_open = state.preferences.page == Some(page);
            let tab = ui.selectable_label(is_open, page.title());
            state.note_control(page.title(), tab.rect);
            if tab.clicked() {
                state.preferences.page = Some(page);
            }
        }
    });
    ui.separator();
    let Some(page) = state.preferences.page else { return };
    let area = ScrollArea::vertical().id_salt(page.title()).auto_shrink([false, false]);
    area.show(ui, |ui| {
        // The scroll bar floats over the right edge.
        let frame = Frame::new().inner_margin(Margin { right: 8, ..Margin::ZERO });
        frame.show(ui, |ui| page.show(ui, state));
    });
}

/// The way back from the scene alone.
fn unfold(ui: &Ui, state: &mut AppState) {
    let area = egui::Area::new(egui::Id::unique("unfold"));
    area.anchor(egui::Align2::RIGHT_TOP, [-8.0, 8.0]).show(ui.ctx(), |ui| {
        let button = ui.button("▾").on_hover_text("Show the bars (B)");
        button.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, "Unfold"));
        state.preferences.folded &= !button.clicked();
    });
}

/// What the middle says while a start is made, and the button that gives it up.
fn waiting(ui: &mut Ui, state: &mut AppState) {
    let Some(progress) = state.frame.loading.clone() else { return };
    let area = egui::Area::new(egui::Id::unique("loading"));
    area.anchor(egui::Align2::CENTER_TOP, [0.0, 40.0]).show(ui.ctx(), |ui| {
        Frame::popup(ui.style()).show(ui, |ui| {
            ui.set_max_width(360.0);
            ui.label(if progress.text.is_empty() { "Loading" } else { &progress.text });
            ui.horizontal(|ui| {
                let cancel = ui.button("Cancel");
                state.note_control("cancel", cancel.rect);
                if cancel.clicked() {
                    state.live.send(Command::CancelLoading);
                }
                progress_bar(ui, "Loading", progress.part);
            });
        });
    });
}

/// Acts on the keys of this frame.
fn act_on_keys(context: &Context, state: &mut AppState) {
    state.shown.help &= !context.input(|input| input.key_pressed(Key::Escape));
    // A focused field or slider has a use of its own for letters and arrows.
    if context.egui_wants_keyboard_input() {
        return;
    }
    let pressed = |modifiers, key| context.input_mut(|input| input.consume_key(modifiers, key));
    state.shown.restart_graphics |= pressed(Modifiers::COMMAND | Modifiers::SHIFT, Key::G);
    if pressed(Modifiers::COMMAND, Key::Q) {
        context.send_viewport_cmd(egui::ViewportCommand::Close);
    }
    if pressed(Modifiers::COMMAND, Key::Z)
        && let Some(last) = state.frame.past.last()
    {
        state.live.send(Command::Return(last.number));
    }
    if pressed(Modifiers::COMMAND, Key::S) {
        state.save_session(context);
    }
    take_link(context, state);
    let pressed = |key| pressed(Modifiers::NONE, key);
    let asked = [Key::Space, Key::ArrowRight, Key::ArrowLeft, Key::R].map(pressed);
    // While a start is made there is nothing to play; what was there waits for how that ends.
    if let (None, [space, right, left, reset]) = (&state.frame.loading, asked) {
        if space {
            state.toggle_play();
        }
        if right {
            state.step();
        }
        if left {
            state.step_back();
        }
        if reset {
            state.live.send(Command::Reset);
        }
    }
    if pressed(Key::F) {
        state.camera.frame_scene();
    }
    if pressed(Key::S) {
        see::save_picture(context, state);
    }
    if pressed(Key::B) {
        state.preferences.folded = !state.preferences.folded;
    }
    for (key, is_faster) in [(Key::OpenBracket, false), (Key::CloseBracket, true)] {
        if pressed(key) {
            front::change_pace(state, is_faster);
        }
    }
    if pressed(Key::H) {
        state.shown.help = !state.shown.help;
    }
}

/// Opens a link that is pasted where no field takes it.
fn take_link(context: &Context, state: &mut AppState) {
    let pasted = context.input(|input| {
        input.events.iter().rev().find_map(|event| match event {
            Event::Paste(text) if is_link(text) => Some(text.clone()),
            _ => None,
        })
    });
    let Some(text) = pasted else { return };
    match RunLink::read(&text) {
        Ok(_) => state.open(Opening::Link(text)),
        Err(refusal) => state.warn(refusal.to_string()),
    }
}
