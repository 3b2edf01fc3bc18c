//! The state and contacts of the pinned grain (the grain that the user selected), in the sidebar or in a corner of the
//! scene.

use egui::{RichText, ScrollArea, Ui};

use crate::app::context::PanelContext;
use crate::app::page::Page;
use crate::app::watched_run::WatchedRun;
use crate::live::WorldFrame;
use crate::render::numbers::si_prefix;
use crate::sim::{ContactView, Snapshot};

/// Shows the state and contacts of the pinned grain (which the user selected with a click), if a grain is pinned.
pub(super) fn show(ui: &mut Ui, run: &mut WatchedRun) {
    let Some(pinned) = run.pinned else { return };
    let Some(world) = run.frame.worlds.get(pinned.world) else { return };
    describe(ui, world, pinned.grain);
    ui.add_space(4.0);
    contacts(ui, world, pinned.grain);
    if ui.button("Unpin").clicked() {
        run.pinned = None;
    }
    ui.separator();
}

/// Shows the state of the pinned grain (which the user selected with a click) in a corner of the scene, unless the
/// sidebar shows this grain.
pub(super) fn show_over_scene(ui: &Ui, context: &mut PanelContext<'_>) {
    if context.preferences.page == Some(Page::Pile) {
        return;
    }
    let Some(pinned) = context.run.pinned else { return };
    let Some(world) = context.run.frame.worlds.get(pinned.world) else { return };
    let corner = context.controls.get("scene").map_or(egui::Pos2::ZERO, egui::Rect::right_top);
    let mut unpins = false;
    egui::Area::new(egui::Id::unique("pinned grain"))
        .pivot(egui::Align2::RIGHT_TOP)
        .fixed_pos(corner + egui::vec2(-8.0, 8.0))
        .show(ui.ctx(), |ui| {
            egui::Frame::popup(ui.style()).show(ui, |ui| {
                describe(ui, world, pinned.grain);
                let unpin = ui.button("Unpin");
                unpins = unpin.on_hover_text("Its contacts are listed under More, Pile").clicked();
            });
        });
    if unpins {
        context.run.pinned = None;
    }
}

/// Component of a velocity below which a grain counts as resting, m/s. A slower motion is assumed to be an error of the
/// solver.
const AT_REST: f64 = 1e-8;

/// Shows the state of a grain as a small table.
pub(super) fn describe(ui: &mut Ui, world: &WorldFrame, index: usize) {
    let grain = &world.snapshot.grains[index];
    let diameter = world.snapshot.surroundings.mean_diameter;
    ui.label(RichText::new(format!("Grain {index}")).strong());
    egui::Grid::new(("grain", index)).num_columns(2).spacing([10.0, 2.0]).show(ui, |ui| {
        let mut row = |name: &str, value: String| {
            ui.label(RichText::new(name).weak());
            ui.label(RichText::new(value).monospace());
            ui.end_row();
        };
        let at = grain.position / diameter;
        row("position", format!("{:.3}, {:.3} d", at.x, at.y));
        row("radius", format!("{:.3} d", grain.radius / diameter));
        let speed = |along: f64| si(if along.abs() < AT_REST { 0.0 } else { along }, "m/s");
        row("velocity", format!("{}, {}", speed(grain.velocity.x), speed(grain.velocity.y)));
        // Avoids the text "-0.000".
        row("spin", format!("{:.3} rad/s", grain.angular_velocity).replace("-0.000", "0.000"));
        row("overlap", format!("{:.3} % of d", 100.0 * grain.overlap / diameter));
        row("force Σ|N|", si(grain.force, "N"));
        row("contacts", grain.coordination.to_string());
    });
}

/// Returns the contacts of a grain, each with the number of the other grain; `None` if the other body is not a grain.
pub(super) fn contacts_of(
    snapshot: &Snapshot,
    index: usize,
) -> impl Iterator<Item = (Option<u32>, &ContactView)> {
    let number = index as u32;
    snapshot.contacts.iter().filter_map(move |contact| match contact.other_grain {
        other if contact.grain == number => Some((other, contact)),
        Some(other) if other == number => Some((Some(contact.grain), contact)),
        _ => None,
    })
}

fn contacts(ui: &mut Ui, world: &WorldFrame, index: usize) {
    let diameter = world.snapshot.surroundings.mean_diameter;
    let grid = egui::Grid::new("contacts").num_columns(4).striped(true).spacing([10.0, 2.0]);
    let rows = |ui: &mut Ui| {
        for name in ["with", "N", "T", "gap/d"] {
            ui.label(RichText::new(name).weak());
        }
        ui.end_row();
        for (other, contact) in contacts_of(&world.snapshot, index) {
            for value in [
                other.map_or_else(|| "fixed".to_owned(), |other| other.to_string()),
                si(contact.normal_force, "N"),
                si(contact.tangential_force, "N"),
                format!("{:.1e}", contact.gap / diameter),
            ] {
                ui.label(RichText::new(value).monospace());
            }
            ui.end_row();
        }
    };
    let area = ScrollArea::vertical().max_height(170.0).id_salt("contacts");
    area.show(ui, |ui| grid.show(ui, rows));
}

/// Numbers above this limit are written with an exponent.
const MOST_WRITTEN: f64 = 1e4;

/// Formats a number with three decimals, or with an exponent if the number is large.
pub(super) fn compact(number: f64) -> String {
    if number.abs() < MOST_WRITTEN { format!("{number:.3}") } else { format!("{number:.2e}") }
}

/// Formats a number with four digits and a unit with an SI prefix.
pub(super) fn si(value: f64, unit: &str) -> String {
    let (prefix, factor) = si_prefix(value);
    let number = value / factor;
    if number.abs() >= MOST_WRITTEN {
        return format!("{number:.3e} {prefix}{unit}");
    }
    let decimals = match number.abs() {
        100.0.. => 1,
        10.0.. => 2,
        _ => 3,
    };
    format!("{number:.decimals$} {prefix}{unit}")
}
