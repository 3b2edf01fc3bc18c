//! The contents of the window as a function of the state: the panels, the keys that work everywhere, and dropped files.

use egui::{Context, Event, Key, Modifiers, Ui};

use super::IN_BROWSER;
use super::link::{RunLink, is_link};
use super::opening::Opening;
use super::panels::{front, see};
use super::state::AppState;
use crate::live::Command;

/// Draws the whole window and handles its input.
pub fn ui(ui: &mut Ui, state: &mut AppState) {
    let context = ui.ctx().clone();
    state.refresh(&context);
    state.restore_layout(&context);
    if context.options(|options| options.theme_preference) != state.preferences.theme {
        context.set_theme(state.preferences.theme);
    }
    // In a browser the page first reads the content of a dropped file and then calls `browser::open_file`.
    let dropped = context.input(|input| input.raw.dropped_files.last().cloned());
    if let Some(file) = dropped.filter(|_| !IN_BROWSER) {
        state.open_file(file.path());
    }
    act_on_keys(&context, state);
    let (mut shared, panels) = state.split();
    panels.show(ui, &mut shared);
    let requests = shared.requests;
    requests.into_iter().for_each(|request| state.carry_out(&context, request));
}

/// Performs the actions of the keys that the user pressed in this frame.
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
    // The longer key combination is checked first, because the shorter combination also matches it.
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
    // While a scene is being loaded, the keys do not change the earlier run, because the user may cancel the load.
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

/// Opens the run that a link (text that reproduces runs) describes, if the user pastes the link outside a text field.
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
