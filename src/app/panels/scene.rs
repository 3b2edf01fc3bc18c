//! The middle of the window: the simulations and the actions of the mouse, or the deposition of a new pile.

use egui::{Align2, Color32, FontId, Rect, Sense, Stroke, Ui, Vec2};
use glam::DVec2;

use super::breaking::BreakingBonds;
use super::grabbing::{Grabbing, WorldCell};
use super::scene_style::{columns, shared_style};
use crate::app::context::PanelContext;
use crate::app::number_text::clock_text;
use crate::app::painting::{LegendCache, fill, scene_callback};
use crate::app::settling_progress::view_of;
use crate::app::theme;
use crate::app::titles::title_against;
use crate::app::watched_run::WatchedRun;
use crate::render::{Legend, ScaleBar, Style, scene_picture};

/// Smallest font size of the labels in a simulation, points. Present mode therefore enlarges the labels.
const LEAST_TEXT: f32 = 10.0;
/// Height of the title of a compared simulation, points.
const TITLE_HEIGHT: f32 = 22.0;
/// Largest number of grains of an earlier run whose outlines are drawn. More outlines would hide the present grains.
const MOST_OUTLINES: usize = 3_000;
/// Space between compared simulations, points.
const GAP: f32 = 6.0;

/// The panel that shows the simulations and handles the mouse.
#[derive(Default)]
pub struct ScenePanel {
    /// The grain or wall that the user has grabbed with the mouse.
    pub mouse: Grabbing,
    pub(crate) legend: LegendCache,
    /// Recently broken bonds, one entry per simulation.
    breaking: Vec<BreakingBonds>,
}

impl ScenePanel {
    /// Ends the user's pull on a grain if the grain no longer exists.
    pub(crate) fn follow(&mut self, run: &WatchedRun) {
        self.mouse.grabbed = self.mouse.grabbed.filter(|&grain| run.has(grain));
    }

    /// Shows all simulations in the remaining space.
    pub(super) fn show(&mut self, ui: &mut Ui, context: &mut PanelContext<'_>) {
        let area = ui.available_rect_before_wrap();
        ui.allocate_rect(area, Sense::hover());
        let dark = ui.visuals().dark_mode;
        let pixels_per_point = ui.ctx().pixels_per_point();
        let style = Style {
            least_text_px: LEAST_TEXT * pixels_per_point,
            ..shared_style(context.run, context.preferences, dark)
        };
        let palette = style.theme.palette();
        fill(ui, area, theme::color32(palette.ground));
        if area.width() < 20.0 || area.height() < 20.0 {
            return;
        }
        let pixels = |rect: Rect| -> [u32; 2] {
            let size = rect.size() * pixels_per_point;
            [size.x.round().max(1.0) as u32, size.y.round().max(1.0) as u32]
        };
        if show_making(ui, context, area, &style, pixels(area))
            || context.run.frame.worlds.is_empty()
        {
            return;
        }
        let [width, height] = pixels(area);
        let strip = style.legend_width(width, height) as f32 / pixels_per_point;
        let (scenes, legend_area) = area.split_left_right_at_x(area.right() - strip);
        let bare = Style { legend: false, ..style.clone() };
        self.breaking.resize_with(context.run.frame.worlds.len(), BreakingBonds::default);
        for (index, cell) in cells(scenes, context.run.frame.worlds.len()).into_iter().enumerate() {
            self.world(ui, context, index, cell, &bare, pixels(cell));
        }
        if strip > 0.0 {
            let world = &context.run.frame.worlds[context.run.selected];
            let camera = context.camera.camera(
                context.run.view(),
                &bare,
                pixels(scenes),
                f64::from(pixels_per_point),
            );
            let legend = Legend::of(&world.snapshot, &style, &camera, style.text_px(width, height));
            self.legend.paint(ui, legend_area, legend, pixels(legend_area));
        }
    }

    /// Shows one simulation with its labels and performs the actions of the mouse.
    fn world(
        &mut self,
        ui: &mut Ui,
        context: &mut PanelContext<'_>,
        index: usize,
        cell: Rect,
        style: &Style,
        size: [u32; 2],
    ) {
        let pixels_per_point = f64::from(ui.ctx().pixels_per_point());
        let camera = context.camera.camera(context.run.view(), style, size, pixels_per_point);
        let response =
            ui.interact(cell, ui.scope_id().with(("world", index)), Sense::click_and_drag());
        let frame = context.run.frame.worlds[index].clone();
        let place =
            WorldCell { index, cell, camera, pixels_per_point, frame: &frame, response: &response };
        place.act(ui, &mut self.mouse, context);

        // The mouse may have moved the camera.
        let camera = context.camera.camera(context.run.view(), style, size, pixels_per_point);
        let place = WorldCell { camera, ..place };
        let picture = scene_picture(&frame.snapshot, style, &camera, size[0], size[1]);
        ui.painter().with_clip_rect(cell).add(scene_callback(index, cell, picture));
        if style.show_forces {
            let colour = theme::color32(style.theme.palette().pull);
            self.breaking[index].show(ui, context.run.frame.loads, &place, colour);
        } else {
            // Bonds that break while forces are not drawn do not flash later.
            self.breaking[index] = BreakingBonds::default();
        }
        place.ghost(ui, context);
        place.words(ui, context, style, size);
        paint_gravity(ui, context, index, cell);
        place.marks(ui, &self.mouse, context);
        if index == context.run.selected {
            context.note_control("scene", cell);
        }
    }
}

/// Returns the rectangles of `count` simulations, in rows of up to three.
fn cells(area: Rect, count: usize) -> Vec<Rect> {
    let columns = columns(count).max(1);
    let rows = count.div_ceil(columns);
    let across = (area.width() - GAP * (columns - 1) as f32) / columns as f32;
    let down = (area.height() - GAP * (rows - 1) as f32) / rows as f32;
    let cell = |index: usize| {
        let (column, row) = ((index % columns) as f32, (index / columns) as f32);
        let corner = area.min + egui::vec2(column * (across + GAP), row * (down + GAP));
        Rect::from_min_size(corner, egui::vec2(across, down))
    };
    (0..count).map(cell).collect()
}

impl WorldCell<'_> {
    /// Draws the grains of the earlier run, for the same simulation at the same simulated time, as grey outlines with a
    /// label that states the settings.
    fn ghost(&self, ui: &Ui, context: &PanelContext<'_>) {
        let Some(run) = context.ghost() else { return };
        let Some(world) = run.worlds.get(self.index) else { return };
        let Some(snapshot) = context.run.frame.ghosts.get(self.index) else { return };
        let grains = &snapshot.grains;
        if grains.len() > MOST_OUTLINES {
            return;
        }
        let painter = ui.painter().with_clip_rect(self.cell);
        let title = title_against(&world.controls.settings, &self.frame.controls.settings);
        let time = clock_text(snapshot.observables.time_secs);
        let text = format!("earlier run (grey): {title}, at {time}");
        let lines = if context.run.compares() { 2.0 } else { 0.0 };
        let at = self.cell.min + egui::vec2(8.0, 0.5 * TITLE_HEIGHT + 16.0 * lines);
        let ink = ui.visuals().weak_text_color();
        painter.text(at, Align2::LEFT_CENTER, text, FontId::proportional(11.0), ink);
        let stroke = Stroke::new(1.0, Color32::from_gray(128).gamma_multiply(0.55));
        for grain in grains {
            self.ring(ui, grain.position, grain.radius, stroke);
        }
    }

    /// Draws the texts of a simulation. If the drawing style has a scale bar, this is the label of the scale bar. If
    /// simulations are compared, the title, the slump, and the mean slump of runs from other initial states are drawn,
    /// too, and a frame around the simulation.
    fn words(&self, ui: &Ui, context: &PanelContext<'_>, style: &Style, size: [u32; 2]) {
        let painter = ui.painter().with_clip_rect(self.cell);
        let ink = theme::color32(style.theme.palette().ink);
        if style.scale_bar {
            let bar = ScaleBar::new(style, &self.camera, size[0], size[1]);
            let scale = self.pixels_per_point as f32;
            let offset = egui::vec2(bar.end[0] + 0.5 * bar.text_px, -bar.end[1]) / scale;
            let font = FontId::proportional(bar.text_px / scale);
            let at = self.cell.center() + offset;
            painter.text(at, Align2::LEFT_CENTER, bar.label, font, ink);
        }
        if context.run.compares() {
            let colour = theme::world_colour(self.index, ui.visuals().dark_mode);
            let at = self.cell.min + egui::vec2(8.0, 0.5 * TITLE_HEIGHT);
            painter.circle_filled(at + egui::vec2(4.0, 0.0), 4.5, colour);
            let title = context.run.numbered_title(self.index);
            let font = FontId::proportional(13.0);
            painter.text(at + egui::vec2(14.0, 0.0), Align2::LEFT_CENTER, title, font, ink);
            let has_others = context.ensemble.mean_at(self.index, 0.0).is_some();
            let others = context.ensemble.said(&context.run.frame, self.index);
            if let Some(others) = others.filter(|_| has_others) {
                let below = at + egui::vec2(14.0, 16.0);
                let font = FontId::proportional(11.0);
                painter.text(below, Align2::LEFT_CENTER, others, font, ink);
            }
            if context.run.slumps() {
                let slump = context.run.slump_text(self.index);
                let at = self.cell.right_bottom() - egui::vec2(8.0, 0.5 * TITLE_HEIGHT);
                painter.text(at, Align2::RIGHT_CENTER, slump, FontId::monospace(12.0), ink);
            }
            let stroke = match self.index == context.run.selected {
                true => Stroke::new(2.0, colour),
                false => Stroke::new(1.0, ui.visuals().widgets.noninteractive.bg_stroke.color),
            };
            painter.rect_stroke(self.cell, 0.0, stroke, egui::StrokeKind::Inside);
        }
    }
}

/// Shows a pile during its deposition instead of the simulations. Returns false if no pile is being deposited.
fn show_making(
    ui: &Ui,
    context: &mut PanelContext<'_>,
    area: Rect,
    style: &Style,
    size: [u32; 2],
) -> bool {
    let preview = context.run.frame.loading.as_ref().and_then(|it| it.preview.clone());
    let Some(preview) = preview else { return false };
    let [lower, upper] = view_of(&preview);
    // Forces and velocities during a deposition do not belong to the run. The scale bar would change, because the view
    // shrinks while the grains fall.
    let style = Style {
        show_forces: false,
        show_velocities: false,
        legend: false,
        scale_bar: false,
        ..style.clone()
    };
    let camera = style.camera(lower, upper, size[0], size[1]);
    let picture = scene_picture(&preview, &style, &camera, size[0], size[1]);
    ui.painter().with_clip_rect(area).add(scene_callback(0, area, picture));
    context.note_control("pile in the making", area);
    true
}

/// Length of the arrow of gravity, points.
const LENGTH: f32 = 34.0;
/// Distance of the arrow of gravity from the upper and right edge of the simulation, points.
const MARGIN: f32 = 30.0;
/// Largest ratio of the horizontal to the total acceleration of gravity at which gravity counts as vertical and needs
/// no arrow.
const STRAIGHT: f64 = 1e-9;

/// Draws an arrow in the direction of gravity, if the user wants an arrow or if gravity does not point straight down.
fn paint_gravity(ui: &Ui, context: &PanelContext<'_>, world: usize, cell: Rect) {
    let shows = |gravity: &DVec2| {
        let is_tilted = gravity.y > 0.0 || gravity.x.abs() > STRAIGHT * gravity.length();
        *gravity != DVec2::ZERO && (context.preferences.gravity || is_tilted)
    };
    let gravity = context.run.frame.worlds.get(world).and_then(|world| world.gravity);
    let Some(gravity) = gravity.filter(shows) else { return };
    let along = gravity.normalize();
    let along = Vec2::new(along.x as f32, -along.y as f32);
    let middle = cell.right_top() + Vec2::new(-MARGIN, MARGIN);
    let ink = ui.visuals().text_color();
    let stroke = Stroke::new(1.8, ink);
    let painter = ui.painter().with_clip_rect(cell);
    painter.arrow(middle - 0.5 * LENGTH * along, LENGTH * along, stroke);
    // The letter is beside the arrow, whatever the arrow's direction.
    let aside = middle + 12.0 * Vec2::new(along.y, -along.x);
    painter.text(aside, Align2::CENTER_CENTER, "g", FontId::proportional(13.0), ink);
}
