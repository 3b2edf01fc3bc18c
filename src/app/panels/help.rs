//! The help overlay, which lists keys and mouse actions.

use egui::{Align2, RichText, Ui};

use crate::app::IN_BROWSER;

/// Keys and their actions. The last keys of the list have no effect in a browser.
const KEYS: [(&str, &str); 17] = [
    ("space", "release, pause, resume"),
    ("→  ←", "one step on, one step back"),
    ("R", "start again; this run is kept"),
    ("Ctrl Z", "undo: back to the run before"),
    ("Ctrl Y", "redo: on to the run after, as with Ctrl Shift Z"),
    ("[  ]", "slower, faster"),
    ("B", "hide the bars: the scene fills the window"),
    ("F", "show the whole scene"),
    ("S", "save a picture of the scene"),
    ("Ctrl S", "save the session: worlds, record and window"),
    ("Ctrl V", "open a copied link"),
    ("P", "present: everything twice as large, for a projector"),
    ("H", "this help"),
    ("Tab", "next control"),
    ("Ctrl +  −", "larger and smaller window contents"),
    ("Ctrl Shift G", "open the graphics device again; the run continues"),
    ("Ctrl Q", "close the window"),
];

/// Number of keys in the list that have an effect in a browser.
const KEYS_IN_BROWSER: usize = KEYS.len() - 2;

const MOUSE: [(&str, &str); 9] = [
    ("drag the ground", "move the scene"),
    ("wheel", "zoom to the cursor"),
    ("double click", "show the whole scene"),
    ("point at a grain", "its state"),
    ("click a grain", "pin it: its contacts are listed"),
    ("drag a grain", "pull it with a spring"),
    ("Shift click the ground", "add a grain, as large as New grain under Pile says"),
    ("Shift click a grain", "remove it"),
    ("Shift drag a wall", "move it while time passes"),
];

/// Height of the overlay's frame and title, points.
const FRAME: f32 = 70.0;

/// Shows the help overlay if it is open.
pub(super) fn show(ui: &mut Ui, is_open: &mut bool) {
    if !*is_open {
        return;
    }
    egui::Window::new("Help")
        .anchor(Align2::CENTER_CENTER, [0.0, 0.0])
        .collapsible(false)
        .auto_sized()
        .open(is_open)
        .show(ui.ctx(), |ui| {
            ui.set_max_width(440.0);
            // If the window is too low, the text can be scrolled.
            let room = ui.ctx().content_rect().height() - FRAME;
            egui::ScrollArea::vertical().max_height(room).show(ui, contents);
        });
}

fn contents(ui: &mut Ui) {
    ui.label(
        "A pile of cohesive grains, computed by Contact Dynamics. The time step Δt does not only set the accuracy: \
         cohesion cancels an opening speed of Bond·g·Δt in every step, so that a weakly cohesive pile holds better \
         at a larger Δt. Drag a slider and let go: the pile starts again with the new value.",
    );
    ui.label(
        "The paper is A. Abramian and L. Staron, Time Steps v.s. Cohesion (2020, hal-02570097).",
    );
    ui.add_space(8.0);
    let keys = if IN_BROWSER { &KEYS[..KEYS_IN_BROWSER] } else { &KEYS };
    for (title, rows) in [("Keys", keys), ("Mouse", &MOUSE[..])] {
        ui.heading(title);
        egui::Grid::new(title).num_columns(2).spacing([18.0, 3.0]).show(ui, |ui| {
            for (what, does) in rows {
                ui.label(RichText::new(*what).strong());
                ui.label(*does);
                ui.end_row();
            }
        });
        ui.add_space(6.0);
    }
    ui.label("Type any value into the field above a slider. To open a scene (TOML), discs (CSV), a saved run \
              (.slump) or a session, drop it on the window.");
}
