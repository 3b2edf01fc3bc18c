//! Panel: comparison of worlds (simulations side by side).

use egui::{Button, RichText, Ui};

use crate::app::budget::PAPER;
use crate::app::theme;
use crate::app::watched_run::WatchedRun;
use crate::live::Command;
use crate::setting::Group;
use crate::sim::{Settings, Stepper};
use crate::solver::{METHODS, MethodInfo};
use crate::study::{FIG4_BONDS, FIG4_TIME_STEPS_SECS};
use crate::world::{FrictionCone, Parameters};

/// Time steps Δt that Abramian & Staron (2020) compare, s.
const PAPER_TIME_STEPS: [f64; 6] = [1e-4, 2e-4, 5e-4, 1e-3, 2e-3, 5e-3];
/// Largest number of worlds (simulations) side by side. With more, each of them would have little space in the window.
const MOST_WORLDS: usize = 6;

pub(super) fn show(ui: &mut Ui, run: &mut WatchedRun) {
    let text = "Worlds from one initial state, kept at the same simulated time.";
    let hint = "A preset keeps the stepper and the parameters that all worlds share. It uses the scene's solver.";
    ui.label(RichText::new(text).small().weak()).on_hover_text(hint);
    line_ups(ui, run, &LINE_UPS);
    let before = run.all_wanted();
    if before.is_empty() {
        return;
    }
    let (mut all, compares) = (before.clone(), run.compares());
    let rows = (0..all.len()).filter(|_| compares).map(|index| row(ui, run, index));
    let rows: Vec<_> = rows.collect();
    ui.horizontal(|ui| {
        let add = ui.add_enabled(all.len() < MOST_WORLDS, Button::new("Add"));
        if add.on_hover_text("Add a world with the settings of the selected one.").clicked() {
            all.push(all[run.selected]);
        }
        let hint = "Keep only the selected world and start it again.";
        if compares && ui.button("One world").on_hover_text(hint).clicked() {
            all = vec![all[run.selected]];
        }
    });
    let removed = rows.into_iter().position(|is_removed| is_removed);
    if let Some(index) = removed.filter(|&index| index < all.len()) {
        all.remove(index);
    }
    if all != before {
        run.live.send(Command::Compare(all));
    }
}

/// A preset: simulations that the user can compare by one click.
struct LineUp {
    name: &'static str,
    hint: &'static str,
    /// Returns the settings of all simulations, made from the common settings that [`base`] returns.
    worlds: fn(Settings) -> Vec<Settings>,
}

const LINE_UPS: [LineUp; 4] = [
    LineUp {
        name: "Paper Fig. 4",
        hint: "Bond 20 and 100 × Δt 0.1, 1 and 2 ms, each step solved as for the figure.",
        worlds: |base| {
            let mut base = Settings { solver: PAPER.settings, ..stepped(base, Stepper::Moreau) };
            base.parameters.touch_tolerance = 0.0;
            let of_bond = |bond| FIG4_TIME_STEPS_SECS.map(|secs| base.with_bond(bond).over(secs));
            FIG4_BONDS.into_iter().flat_map(of_bond).collect()
        },
    },
    LineUp {
        name: "Six Δt",
        hint: "One Bond with the six time steps of the paper.",
        worlds: |base| PAPER_TIME_STEPS.map(|secs| base.over(secs)).into(),
    },
    LineUp {
        name: "Two laws",
        hint: "Bond 20 at Δt 0.1, 1 and 5 ms, under the laws moreau and range.",
        worlds: |base| {
            let of_law =
                |law| [1e-4, 1e-3, 5e-3].map(|secs| stepped(base.with_bond(20.0).over(secs), law));
            [Stepper::Moreau, Stepper::Range].into_iter().flat_map(of_law).collect()
        },
    },
    LineUp {
        name: "Four Bonds",
        hint: "One Δt with Bond 0, 20, 50 and 100.",
        worlds: |base| [0.0, 20.0, 50.0, 100.0].map(|bond| base.with_bond(bond)).into(),
    },
];

/// The preset that compares solvers, for users who study them.
const SOLVERS: LineUp = LineUp {
    name: "Solvers",
    hint: "As many solvers as there is room for, on the same problem.",
    worlds: |base| {
        let by = |info: &MethodInfo| Settings { solver: base.solver.by(info.method), ..base };
        METHODS.iter().take(MOST_WORLDS).map(by).collect()
    },
};

/// Returns the settings with another stepper (rule that advances the grains by Δt). Settings and remedies (corrections
/// of known weaknesses of a step) that this stepper does not support are switched off.
fn stepped(base: Settings, stepper: Stepper) -> Settings {
    let mut settings = Settings { stepper, ..base };
    settings.parameters.cone = FrictionCone::Shifted;
    settings.with_only_what_is_taken()
}

/// Returns the common settings on which the presets for comparisons are based: the settings of the scene, but with the
/// stepper and the physical parameters on which all present simulations `worlds` agree. The solver, the remedies
/// (corrections of known weaknesses of a step) and the touch tolerance are those of the scene, because the user might
/// not notice that a preset contains earlier choices of them.
fn base(scene: &Settings, worlds: &[Settings]) -> Settings {
    let mut base = *scene;
    let physics = Parameters::ABOUT.iter().filter(|about| about.name != "touch-tolerance");
    for name in physics.chain([&Settings::STEPPER]).map(|about| about.name) {
        let mut values = worlds.iter().map(|settings| settings.get(name));
        let shared =
            values.next().flatten().filter(|&first| values.all(|value| value == Some(first)));
        if let Some(value) = shared {
            base.set(name, value);
        }
    }
    if base.stepper == scene.stepper { base } else { base.with_only_what_is_taken() }
}

/// Shows the preset that compares solvers.
pub(super) fn method_presets(ui: &mut Ui, run: &mut WatchedRun) {
    ui.label("Side by side")
        .on_hover_text("Worlds from one initial state, kept at the same simulated time.");
    line_ups(ui, run, &[SOLVERS]);
}

fn line_ups(ui: &mut Ui, run: &mut WatchedRun, all: &[LineUp]) {
    let Some(start) = run.frame.start.as_ref() else { return };
    let base = base(start.settings(), &run.all_wanted());
    ui.horizontal_wrapped(|ui| {
        for LineUp { name, hint, worlds } in all {
            if ui.button(*name).on_hover_text(*hint).clicked() {
                run.live.send(Command::Compare(worlds(base)));
            }
        }
    });
}

/// Shows the row of one simulation in the list of compared simulations. Returns true if the user removes the
/// simulation.
fn row(ui: &mut Ui, run: &mut WatchedRun, index: usize) -> bool {
    let mut removed = false;
    ui.horizontal(|ui| {
        // The name of a world is in the text colour, because the colour of the world would not always be readable.
        let colour = theme::world_colour(index, ui.visuals().dark_mode);
        ui.label(RichText::new("■").color(colour));
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            removed = ui.small_button("✖").on_hover_text("Remove this world.").clicked();
            let name = run.numbered_title(index);
            let left = egui::Layout::left_to_right(egui::Align::Center);
            ui.with_layout(left, |ui| {
                let chosen = Button::selectable(run.selected == index, name.as_str());
                let hint = format!(
                    "{name}\nClick it: the sliders and Law, solver then change this world."
                );
                if ui.add(chosen.truncate()).on_hover_text(hint).clicked() {
                    run.selected = index;
                }
            });
        });
    });
    removed
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::titles::title_among;
    use crate::solver::{Method, SolverSettings};

    fn titles(all: &[Settings]) -> Vec<String> {
        (0..all.len()).map(|index| title_among(all, index)).collect()
    }

    #[test]
    fn presets_keep_the_physics_that_all_worlds_share_and_solve_as_the_scene_does() {
        let scene = Settings::default().with_bond(20.0);
        let mut dragged = scene.with_bond(35.0).over(2e-3);
        dragged.parameters.friction = 0.3;
        assert_eq!(base(&scene, &[dragged]), dragged, "one world");
        for LineUp { name, worlds, .. } in LINE_UPS.iter().chain(&[SOLVERS]) {
            let made = base(&scene, &worlds(dragged));
            assert_eq!(made.solver, scene.solver, "{name}");
            assert_eq!(made.parameters.touch_tolerance, scene.parameters.touch_tolerance, "{name}");
            let Parameters { bond, friction, .. } = made.parameters;
            assert!(bond > 0.0 && friction == 0.3, "{name}: {bond}, {friction}");
            assert_eq!(made.stepper, scene.stepper, "{name}");
        }
        let by_range = stepped(dragged, Stepper::Range);
        assert_eq!(base(&scene, &[by_range, by_range.over(1e-3)]).stepper, Stepper::Range);
    }

    #[test]
    fn titles_say_what_differs_and_are_never_alike_where_anything_does() {
        let base = Settings::default().with_bond(20.0).over(1e-3);
        assert_eq!(titles(&[base, base]), ["Bond 20, Δt 1 ms"; 2]);
        assert_eq!(titles(&[base, base.over(5e-3)]), ["Δt 1 ms", "Δt 5 ms"]);
        let range = stepped(base, Stepper::Range);
        assert_eq!(titles(&[base, range.over(1e-4)]), ["moreau, Δt 1 ms", "range, Δt 0.1 ms"]);
        let few = SolverSettings { method: Method::Nsgs, max_sweeps: 5, ..SolverSettings::PAPER };
        let few = Settings { solver: few, ..base };
        assert_eq!(titles(&[few, base]), ["nsgs, 5 sweeps", "Solved"]);
        let mut other = base;
        (other.parameters.restitution, other.parameters.friction) = (0.5, 0.3);
        assert_eq!(titles(&[base, other]), ["ρ 0, μ 0", "ρ 0.5, μ 0.3"]);
        let mut cone = base;
        cone.parameters.cone = FrictionCone::Compressive;
        assert_eq!(titles(&[base, cone]), ["cone shifted", "cone compressive"]);
        for LineUp { name, worlds, .. } in LINE_UPS.iter().chain(&[SOLVERS]) {
            let mut all = titles(&worlds(base));
            let count = all.len();
            all.sort();
            all.dedup();
            assert_eq!(all.len(), count, "{name}: {all:?}");
        }
    }
}
