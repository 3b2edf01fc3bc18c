//! The layout of the window as a function of the state alone, and the keys that act wherever the mouse is.

use egui::{
    CentralPanel, CollapsingHeader, Context, Event, Frame, Key, Margin, Modifiers, Panel, RichText,
    ScrollArea, Ui,
};

use super::painting::fill;
use super::panels::{SECTIONS, help, plots, scene, see, status, transport};
use super::sharing::{LINK_START, RunLink};
use super::state::AppState;
use super::work::progress_bar;
use super::{budget, opening, tour};
use crate::config::Config;
use crate::live::Command;

/// Width of the sidebar, points.
const SIDEBAR: f32 = 296.0;
/// Height of the plots, points.
const PLOTS: f32 = 176.0;

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
    let tight = Frame::new().inner_margin(Margin::symmetric(8, 4));
    Panel::bottom("status").frame(tight).resizable(false).show(ui, |ui| status::show(ui, state));
    if state.touring {
        Panel::top("tour").frame(tight).resizable(false).show(ui, |ui| tour::show(ui, state));
    }
    let mut sidebar = state.preferences.sidebar;
    Panel::left("sidebar")
        .frame(Frame::new().inner_margin(Margin { left: 10, right: 4, top: 8, bottom: 4 }))
        .default_size(SIDEBAR)
        .size_range(SIDEBAR - 26.0..=460.0)
        .show_collapsible(ui, &mut sidebar, |ui| {
            ScrollArea::vertical().auto_shrink([false, false]).show(ui, |ui| {
                // The scroll bar floats over the right edge.
                Frame::new().inner_margin(Margin { right: 8, ..Margin::ZERO }).show(ui, |ui| {
                    sidebar_contents(ui, state);
                });
            });
        });
    state.preferences.sidebar = sidebar;
    let mut shown = state.preferences.plots;
    Panel::bottom("plots")
        .frame(tight)
        .resizable(true)
        .default_size(PLOTS)
        .size_range(120.0..=600.0)
        .show_collapsible(ui, &mut shown, |ui| plots::show(ui, state));
    state.preferences.plots = shown;
    Panel::bottom("timeline").frame(tight).resizable(false).show(ui, |ui| {
        transport::timeline(ui, state);
    });
    CentralPanel::no_frame().show(ui, |ui| {
        scene::show(ui, state);
        waiting(ui, state);
    });
    help::show(ui, state);
}

fn sidebar_contents(ui: &mut Ui, state: &mut AppState) {
    transport::release_button(ui, state);
    if !state.touring {
        // Other scenes say under their name what there is to watch.
        let is_pile = state.frame.start.as_ref().is_some_and(|it| it.name == Config::DEFAULT_SCENE);
        let world = state.world().filter(|_| is_pile);
        if let Some(hint) = world.map(|world| budget::what_to_try(&world.controls.settings)) {
            ui.label(RichText::new(hint).small().weak());
        }
        tour::resume_button(ui, state);
    }
    let asked = state.shown.panel.take();
    ui.add_space(2.0);
    for section in SECTIONS {
        let Some(heading) = section.heading(state) else { continue };
        ui.separator();
        let shown = CollapsingHeader::new(RichText::new(heading).heading())
            .id_salt(section.id)
            .default_open(section.open)
            .open((asked == Some(section.id)).then_some(true))
            .show_unindented(ui, |ui| (section.show)(ui, state));
        state.note_control(section.id, shown.header_response.rect);
    }
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
                if ui.button("Cancel").clicked() {
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
    if pressed(Key::H) {
        state.shown.help = !state.shown.help;
    }
}

/// Opens a link that is pasted where no field takes it.
fn take_link(context: &Context, state: &mut AppState) {
    let is_link = |text: &str| text.trim_start().starts_with(LINK_START);
    let pasted = context.input(|input| {
        input.events.iter().rev().find_map(|event| match event {
            Event::Paste(text) if is_link(text) => Some(text.clone()),
            _ => None,
        })
    });
    match pasted.map(|text| RunLink::read(&text)) {
        Some(Ok(link)) => state.load_link(link),
        Some(Err(refusal)) => state.warn(refusal.to_string()),
        None => {}
    }
}
