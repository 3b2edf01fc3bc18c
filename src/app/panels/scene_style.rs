//! Drawing style of the worlds (simulations side by side), and their arrangement in rows.

use crate::app::preferences::Preferences;
use crate::app::watched_run::WatchedRun;
use crate::render::{Style, Theme, automatic_range, force_reference, speed_reference};

/// Returns the drawing style that the user chose, with the theme of the window. All simulations have the same scales of
/// colours, forces and velocities.
pub(super) fn shared_style(run: &WatchedRun, preferences: &Preferences, dark: bool) -> Style {
    let mut style = own_style(preferences, dark);
    if run.compares() {
        let worlds = || run.frame.worlds.iter().map(|world| &world.snapshot);
        if style.colour_by.has_scale() {
            let ends = worlds().map(|snapshot| automatic_range(style.colour_by, snapshot).1);
            style.range = Some((0.0, ends.fold(0.0, f64::max)));
        }
        let references = worlds().map(|snapshot| force_reference(&style, snapshot));
        style.force_reference = Some(references.fold(0.0, f64::max));
        let speeds = worlds().map(|snapshot| speed_reference(&style, snapshot));
        style.speed_reference = Some(speeds.fold(0.0, f64::max));
    }
    style
}

/// Returns the drawing style that the user chose, with the theme (light or dark) of the window.
pub(super) fn own_style(preferences: &Preferences, dark: bool) -> Style {
    let theme = if dark { Theme::Dark } else { Theme::Light };
    Style { theme, ..preferences.style.clone() }
}

/// Returns the number of simulations in a row of the window, if there are `count` simulations.
pub(super) fn columns(count: usize) -> usize {
    if count == 4 { 2 } else { count.min(3) }
}
