//! Keys that act wherever the mouse is, unless a control takes them.

use egui::{Context, Event, Key, KeyboardShortcut, Modifiers};

use super::link::LINK_START;
use super::panels::picture;
use super::state::AppState;

/// Acts on the keys of this frame.
pub(super) fn act(context: &Context, state: &mut AppState) {
    let escape = context.input(|input| input.key_pressed(Key::Escape));
    if escape {
        state.help = false;
    }
    // A focused field or slider has a use of its own for letters and arrows.
    if context.egui_wants_keyboard_input() {
        return;
    }
    let restart = KeyboardShortcut::new(Modifiers::COMMAND | Modifiers::SHIFT, Key::G);
    state.restart_graphics |= context.input_mut(|input| input.consume_shortcut(&restart));
    let quit = KeyboardShortcut::new(Modifiers::COMMAND, Key::Q);
    if context.input_mut(|input| input.consume_shortcut(&quit)) {
        context.send_viewport_cmd(egui::ViewportCommand::Close);
    }
    let undo = KeyboardShortcut::new(Modifiers::COMMAND, Key::Z);
    if context.input_mut(|input| input.consume_shortcut(&undo)) {
        state.undo();
    }
    let save = KeyboardShortcut::new(Modifiers::COMMAND, Key::S);
    if context.input_mut(|input| input.consume_shortcut(&save)) {
        state.save_session(context);
    }
    take_link(context, state);
    let pressed = |key: Key| context.input_mut(|input| input.consume_key(Modifiers::NONE, key));
    // While a start is made there is nothing to play; what was there waits for how that ends.
    let is_ready = state.frame.loading.is_none();
    let asked = [Key::Space, Key::ArrowRight, Key::ArrowLeft, Key::R].map(pressed);
    if let (true, [space, right, left, reset]) = (is_ready, asked) {
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
            state.reset();
        }
    }
    if pressed(Key::F) {
        state.camera.frame_scene();
    }
    if pressed(Key::S) {
        picture::save_picture(context, state);
    }
    if pressed(Key::H) {
        state.help = !state.help;
    }
}

/// Opens a link that is pasted where no field takes it.
fn take_link(context: &Context, state: &mut AppState) {
    let pasted = context.input(|input| {
        input.events.iter().rev().find_map(|event| match event {
            Event::Paste(text) => Some(text.clone()),
            _ => None,
        })
    });
    if let Some(text) = pasted.filter(|text| text.trim_start().starts_with(LINK_START))
        && let Err(refusal) = state.open_link(&text)
    {
        state.warn(refusal.to_string());
    }
}
