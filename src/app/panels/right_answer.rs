//! The known right answer of a stability scene (a scene that is hard for solvers), and the verdict on each simulation.

use egui::{RichText, Ui};

use super::grain::compact;
use crate::app::theme;
use crate::app::watched_run::WatchedRun;
use crate::scene::built_in;
use crate::sim::Settings;
use crate::study::stability::Challenge;

/// Names of the settings on which the right answer of a stability scene depends. All other settings belong to the
/// numerical method.
const PHYSICS: [&str; 6] = ["bond", "bond-acceleration", "tilt", "rho", "mu", "cone"];

/// Shows the known right answer of a scene and, for each simulation, whether its result is right. Shows nothing for
/// scenes without a known right answer.
pub(super) fn show(ui: &mut Ui, run: &WatchedRun) {
    let Some(start) = run.frame.start.as_ref().filter(|start| start.tally.steps == 0) else {
        return;
    };
    let config = run.config();
    let Some(challenge) = Challenge::seen_in(config.named()) else { return };
    let (Some(right), Ok(scene)) = (challenge.right_answer(), built_in(config.named())) else {
        return;
    };
    let own = scene.settings();
    let has_own_physics =
        |settings: &Settings| PHYSICS.iter().all(|name| settings.get(name) == own.get(name));
    ui.horizontal_wrapped(|ui| {
        ui.label(format!("Right answer: {right}"));
        for (index, world) in run.frame.worlds.iter().enumerate() {
            let number = if run.compares() { format!("{}: ", index + 1) } else { String::new() };
            if !has_own_physics(&world.controls.settings) {
                let text = format!("{number}unknown, because a parameter of the law was changed.");
                ui.label(RichText::new(text).weak());
            } else if let Some(verdict) = challenge.verdict(&start.simulation, &world.snapshot) {
                let written = |value: f64| match value.fract() == 0.0 && value.abs() < 1e4 {
                    true => value.to_string(),
                    false => compact(value),
                };
                let [error, limit] = [verdict.error, verdict.limit].map(written);
                let text = format!("{number}{}: {error} (at most {limit})", verdict.name);
                ui.label(marked(ui, verdict.is_right(), &text));
            }
        }
    });
}

/// Returns `text` with a mark and a colour that show whether a result is right.
pub(super) fn marked(ui: &Ui, is_right: bool, text: &str) -> RichText {
    let dark = ui.visuals().dark_mode;
    let (mark, colour) =
        if is_right { ("✓", theme::good(dark)) } else { ("✗", theme::warning(dark)) };
    RichText::new(format!("{mark} {text}")).color(colour)
}
