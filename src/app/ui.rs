//! The window as a function of its state: the panels, the keys that work everywhere, and dropped files.

use egui::{Context, Event, Key, Modifiers, Ui};

use super::IN_BROWSER;
use super::link::{RunLink, is_link};
use super::opening::Opening;
use super::panels::{front, see};
use super::state::AppState;
use crate::live::Command;

/// The whole window.
pub fn ui(ui: &mut Ui, state: &mut AppState) {
    let context = ui.ctx().clone();
    state.refresh(&context);
    state.restore_layout(&context);
    if context.options(|options| options.theme_preference) != state.preferences.theme {
        context.set_theme(state.preferences.theme);
    }
    take_dropped_files(&context, state);
    act_on_keys(&context, state);
    let (mut shared, panels) = state.split();
    panels.show(ui, &mut shared);
    let requests = shared.requests;
    requests.into_iter().for_each(|request| state.carry_out(&context, request));
}

/// Opens the last file that was dropped in this frame. A browser has to wait for the content of the file.
fn take_dropped_files(context: &Context, state: &mut AppState) {
    let dropped = context.input(|input| input.raw.dropped_files.last().cloned());
    let Some(file) = dropped.filter(|_| !IN_BROWSER) else { return };
    state.open_file(file.path());
}

/// Acts on the keys of this frame.
fn act_on_keys(context: &Context, state: &mut AppState) {
    if context.input(|input| input.key_pressed(Key::Escape)) {
        state.panels.help = false;
        state.panels.trust.is_open = false;
        state.panels.lesson_bar.shows_summary = false;
    }
    // A focused field or slider uses letters and arrow keys itself.
    if context.egui_wants_keyboard_input() {
        return;
    }
    let pressed = |modifiers, key| context.input_mut(|input| input.consume_key(modifiers, key));
    state.restart_graphics |= pressed(Modifiers::COMMAND | Modifiers::SHIFT, Key::G);
    if pressed(Modifiers::COMMAND, Key::Q) {
        context.send_viewport_cmd(egui::ViewportCommand::Close);
    }
    // The longer combination comes first: the shorter one also matches it.
    let redo = [(Modifiers::COMMAND | Modifiers::SHIFT, Key::Z), (Modifiers::COMMAND, Key::Y)];
    if redo.into_iter().any(|(modifiers, key)| pressed(modifiers, key)) {
        state.run.redo();
    }
    if pressed(Modifiers::COMMAND, Key::Z) {
        state.run.undo();
    }
    if pressed(Modifiers::COMMAND, Key::S) {
        state.save_session(context);
    }
    take_link(context, state);
    let pressed = |key| pressed(Modifiers::NONE, key);
    let asked = [Key::Space, Key::ArrowRight, Key::ArrowLeft, Key::R].map(pressed);
    // While a scene is being loaded the earlier run must wait: the load may be cancelled.
    if let (None, [space, right, left, reset]) = (&state.run.frame.loading, asked) {
        if space {
            state.run.toggle_play();
        }
        if right {
            state.run.step();
        }
        if left {
            state.run.step_back();
        }
        if reset {
            state.run.live.send(Command::Reset);
        }
    }
    if pressed(Key::F) {
        state.camera.frame_scene();
    }
    if pressed(Key::S) {
        see::save_picture(context, &mut state.split().0);
    }
    if pressed(Key::B) {
        state.preferences.folded = !state.preferences.folded;
    }
    for (key, is_faster) in [(Key::OpenBracket, false), (Key::CloseBracket, true)] {
        if pressed(key) {
            front::change_pace(&mut state.split().0, is_faster);
        }
    }
    if pressed(Key::P) {
        see::present(context, &mut state.preferences);
    }
    if pressed(Key::H) {
        state.panels.help = !state.panels.help;
    }
}

/// Opens a link that is pasted outside of a text field.
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
