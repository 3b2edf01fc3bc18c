//! Where a world is in the window, and what lies under the mouse there.

use egui::{Color32, Pos2, Rect, Response, Stroke, Ui};
use glam::DVec2;

use crate::app::held::GrainRef;
use crate::app::state::AppState;
use crate::app::theme;
use crate::live::WorldFrame;
use crate::render::Camera;
use crate::sim::GrainView;

/// Where a world is in the window.
pub(super) struct Place<'a> {
    pub index: usize,
    pub cell: Rect,
    pub camera: Camera,
    pub pixels_per_point: f64,
    pub frame: &'a WorldFrame,
}

impl Place<'_> {
    pub(super) fn to_world(&self, at: Pos2) -> DVec2 {
        let offset = (at - self.cell.center()) * self.pixels_per_point as f32;
        self.camera.unproject(DVec2::new(f64::from(offset.x), -f64::from(offset.y)))
    }

    pub(super) fn to_screen(&self, position: DVec2) -> Pos2 {
        let [x, y] = self.camera.project(position);
        self.cell.center() + egui::vec2(x, -y) / self.pixels_per_point as f32
    }

    pub(super) fn grain_at(&self, at: Pos2) -> Option<GrainRef> {
        let point = self.to_world(at);
        let inside = |grain: &GrainView| grain.position.distance(point) <= grain.radius;
        let grain = self.frame.snapshot.grains.iter().rposition(inside)?;
        Some(GrainRef { world: self.index, grain })
    }

    /// Rings around the grains that are hovered, pinned and grabbed.
    pub(super) fn marks(&self, ui: &Ui, state: &AppState, response: &Response) {
        let painter = ui.painter().with_clip_rect(self.cell);
        let accent = theme::accent(ui.visuals().dark_mode);
        let ring = |grain: &GrainView, width: f32, colour: Color32| {
            let radius = self.camera.pixels(grain.radius) / self.pixels_per_point as f32;
            painter.circle_stroke(
                self.to_screen(grain.position),
                radius,
                Stroke::new(width, colour),
            );
        };
        let grains = &self.frame.snapshot.grains;
        if let Some(pinned) = state.pinned.filter(|pinned| pinned.world == self.index) {
            for partner in super::grain::partners(&self.frame.snapshot, pinned.grain) {
                ring(&grains[partner], 1.5, accent);
            }
            ring(&grains[pinned.grain], 3.0, accent);
        }
        if let Some(grabbed) = state.grabbed.filter(|grabbed| grabbed.world == self.index) {
            let grain = &grains[grabbed.grain];
            ring(grain, 2.0, accent);
            if let Some(at) = response.interact_pointer_pos() {
                let stroke = Stroke::new(2.0, accent);
                painter.line_segment([self.to_screen(grain.position), at], stroke);
                painter.circle_filled(at, 4.0, accent);
            }
            return;
        }
        let changes = ui.input(|input| input.modifiers.shift);
        if let Some(at) = response.hover_pos().filter(|_| changes || state.grip.is_some()) {
            return self.marks_of_hand(ui, state, at);
        }
        let hovered = response.hover_pos().and_then(|at| self.grain_at(at));
        if let Some(hovered) = hovered {
            ring(&grains[hovered.grain], 1.5, accent);
            response
                .clone()
                .on_hover_ui_at_pointer(|ui| super::grain::describe(ui, self.frame, hovered.grain));
        }
    }
}
