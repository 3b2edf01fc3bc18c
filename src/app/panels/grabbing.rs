//! Actions of the mouse in a world (simulation): the mouse moves the view, selects ("pins") the grain whose state is
//! shown, and pulls grains. With Shift it adds grains, removes grains and moves walls.

use egui::{
    DragValue, Event, InputState, PointerButton, Pos2, Rect, Response, RichText, Stroke, Ui,
};
use glam::DVec2;

use crate::app::context::PanelContext;
use crate::app::preferences::Preferences;
use crate::app::theme;
use crate::app::watched_run::GrainRef;
use crate::live::{Command, WorldFrame};
use crate::render::Camera;
use crate::sim::{Edit, GrainView, NEW_GRAIN_DIAMETERS, Pull, place_of};
use crate::world::{Boundary, Disc, Edge};

/// Largest distance from the mouse at which a wall can be grabbed, points.
const REACH: f32 = 8.0;
/// Message if the user tries to move a wall while the run is paused.
const STANDS_STILL: &str = "Walls move only while time passes: press space, then drag on.";

/// The grain or wall that the user has grabbed with the mouse.
#[derive(Default)]
pub struct Grabbing {
    /// The grain to which the mouse is tied by a spring.
    pub grabbed: Option<GrainRef>,
    grip: Option<Grip>,
}

/// A wall that the user has grabbed with the mouse.
#[derive(Clone, Copy, Debug)]
struct Grip {
    /// Index of the simulation.
    pub world: usize,
    /// Index of the wall among the boundaries of the simulation.
    pub boundary: usize,
    /// Vector from the reference point of the wall to the grabbed point, m.
    pub from_place: DVec2,
    /// Target position of the wall's reference point, m, in the last command to the solver's thread; `None` before the
    /// first command.
    pub sent: Option<DVec2>,
}

/// A simulation as the window shows it: its rectangle, camera and data.
pub(super) struct WorldCell<'a> {
    pub index: usize,
    pub cell: Rect,
    pub camera: Camera,
    pub pixels_per_point: f64,
    pub frame: &'a WorldFrame,
    pub response: &'a Response,
}

impl WorldCell<'_> {
    /// Returns the position of the mouse if the mouse is over this simulation, or if the user pressed a mouse button
    /// over this simulation and still holds it down.
    fn pointer(&self) -> Option<Pos2> {
        self.response.hover_pos().or_else(|| self.response.interact_pointer_pos())
    }

    fn to_world(&self, at: Pos2) -> DVec2 {
        let offset = (at - self.cell.center()) * self.pixels_per_point as f32;
        self.camera.unproject(DVec2::new(f64::from(offset.x), -f64::from(offset.y)))
    }

    fn to_screen(&self, position: DVec2) -> Pos2 {
        let [x, y] = self.camera.project(position);
        self.cell.center() + egui::vec2(x, -y) / self.pixels_per_point as f32
    }

    /// Converts a length in the scene, m, to a length on the screen, points.
    fn points(&self, metres: f64) -> f32 {
        self.camera.pixels(metres) / self.pixels_per_point as f32
    }

    /// Draws a circle with the given centre and radius, m.
    pub(super) fn ring(&self, ui: &Ui, centre: DVec2, radius: f64, stroke: Stroke) {
        let painter = ui.painter().with_clip_rect(self.cell);
        painter.circle_stroke(self.to_screen(centre), self.points(radius), stroke);
    }

    /// Converts a length on the screen, points, to a length in the scene, m.
    fn metres(&self, points: f32) -> f64 {
        f64::from(points) * self.pixels_per_point * self.camera.metres_per_pixel
    }

    fn grain_at(&self, at: Pos2) -> Option<GrainRef> {
        let point = self.to_world(at);
        let inside = |grain: &GrainView| grain.position.distance(point) <= grain.radius;
        let grain = self.frame.snapshot.grains.iter().rposition(inside)?;
        Some(GrainRef { world: self.index, grain })
    }

    /// Draws rings around the pinned grain (which the user selected with a click) and the grains in contact with it,
    /// the grain that the mouse pulls, and the grain under the mouse.
    pub(super) fn marks(&self, ui: &Ui, mouse: &Grabbing, context: &PanelContext<'_>) {
        let painter = ui.painter().with_clip_rect(self.cell);
        let accent = theme::accent(ui.visuals().dark_mode);
        let ring = |grain: &GrainView, width: f32| {
            self.ring(ui, grain.position, grain.radius, Stroke::new(width, accent));
        };
        let grains = &self.frame.snapshot.grains;
        if let Some(pinned) = context.run.pinned.filter(|pinned| pinned.world == self.index) {
            let contacts = super::grain::contacts_of(&self.frame.snapshot, pinned.grain);
            for other in contacts.filter_map(|(other, _)| other) {
                ring(&grains[other as usize], 1.5);
            }
            ring(&grains[pinned.grain], 3.0);
        }
        if let Some(grabbed) = mouse.grabbed.filter(|grabbed| grabbed.world == self.index) {
            let grain = &grains[grabbed.grain];
            ring(grain, 2.0);
            if let Some(at) = self.response.interact_pointer_pos() {
                let stroke = Stroke::new(2.0, accent);
                painter.line_segment([self.to_screen(grain.position), at], stroke);
                painter.circle_filled(at, 4.0, accent);
            }
            return;
        }
        let changes = ui.input(|input| input.modifiers.shift);
        if let Some(at) = self.response.hover_pos().filter(|_| changes || mouse.grip.is_some()) {
            return self.marks_of_hand(ui, mouse.grip, context.preferences, at);
        }
        let hovered = self.response.hover_pos().and_then(|at| self.grain_at(at));
        if let Some(hovered) = hovered {
            ring(&grains[hovered.grain], 1.5);
            let describe = |ui: &mut Ui| super::grain::describe(ui, self.frame, hovered.grain);
            self.response.clone().on_hover_ui_at_pointer(describe);
        }
    }

    /// Performs the actions that the user requests with the mouse in this simulation.
    pub(super) fn act(&self, ui: &Ui, mouse: &mut Grabbing, context: &mut PanelContext<'_>) {
        let (response, pointer) = (self.response, self.pointer());
        let changes = ui.input(has_shift);
        if response.drag_started_by(PointerButton::Primary) {
            let pressed = ui.input(|input| input.pointer.press_origin());
            if changes {
                mouse.grip = pressed.and_then(|at| self.grip_at(at));
            } else {
                mouse.grabbed = pressed.and_then(|at| self.grain_at(at));
            }
        }
        if mouse.grip.is_some_and(|grip| grip.world == self.index) {
            self.draw_wall(mouse, context);
        } else {
            self.pull_or_pan(mouse, context);
        }
        match (response.double_clicked(), response.clicked(), changes) {
            (_, true, true) => self.change_grains(context),
            (true, _, false) => context.camera.frame_scene(),
            (false, true, false) => {
                context.run.selected = self.index;
                let clicked = pointer.and_then(|at| self.grain_at(at));
                context.run.pinned = clicked.filter(|grain| context.run.pinned != Some(*grain));
            }
            _ => {}
        }
        if let Some(at) = pointer.filter(|_| response.contains_pointer()) {
            let (scroll, pinch) =
                ui.input(|input| (input.smooth_scroll_delta().y, input.zoom_delta()));
            let factor = f64::from(pinch) * (f64::from(scroll) / 200.0).exp();
            if factor != 1.0 {
                context.camera.zoom(factor, at - self.cell.center());
            }
        }
    }

    fn pull_or_pan(&self, mouse: &mut Grabbing, context: &mut PanelContext<'_>) {
        let (response, run) = (self.response, &mut *context.run);
        let held = mouse.grabbed.filter(|grabbed| grabbed.world == self.index);
        if let (Some(held), Some(at)) = (held, self.pointer()) {
            if response.dragged() {
                let pull = Pull { grain: held.grain as u32, target: self.to_world(at) };
                let wanted = run.wanted.get_mut(self.index);
                if let Some(wanted) = wanted.filter(|wanted| wanted.pull != Some(pull)) {
                    wanted.pull = Some(pull);
                    run.live.send(Command::SetPull(self.index, Some(pull)));
                }
            }
        } else if response.dragged() {
            context.camera.pan(response.drag_delta());
        }
        if held.is_some() && !response.dragged() {
            mouse.grabbed = None;
            run.live.send(Command::SetPull(self.index, None));
        }
    }

    /// Moves the grabbed wall to the mouse, if the run plays. If the user no longer drags, ends the motion of the wall.
    fn draw_wall(&self, mouse: &mut Grabbing, context: &mut PanelContext<'_>) {
        let Some(mut grip) = mouse.grip else { return };
        if !self.response.dragged() {
            mouse.grip = None;
            if grip.sent.is_some() {
                context.run.live.send(Command::Edit(self.index, Edit::LetGo));
            }
            return;
        }
        let boundaries = &self.frame.snapshot.surroundings.boundaries;
        let boundary = boundaries.get(grip.boundary);
        let (Some(at), Some(boundary)) = (self.pointer(), boundary) else { return };
        if !context.run.frame.playing {
            return context.warn(STANDS_STILL);
        }
        let to = goal(boundary, self.to_world(at) - grip.from_place);
        if grip.sent.is_none_or(|sent| sent.distance(to) > self.metres(0.5)) {
            grip.sent = Some(to);
            mouse.grip = Some(grip);
            let edit = Edit::Draw { boundary: grip.boundary as u32, to };
            context.run.live.send(Command::Edit(self.index, edit));
        }
    }

    /// Removes the grain under the mouse, or adds a grain if the mouse is over no grain.
    fn change_grains(&self, context: &mut PanelContext<'_>) {
        let Some(at) = self.pointer() else { return };
        context.run.selected = self.index;
        let edit = match self.grain_at(at) {
            Some(found) => Edit::Remove(found.grain as u32),
            None => Edit::Add(self.new_grain(context.preferences, at)),
        };
        // Grains may have other numbers from now on.
        context.run.pinned = None;
        context.run.live.send(Command::Edit(self.index, edit));
    }

    fn new_grain(&self, preferences: &Preferences, at: Pos2) -> Disc {
        let diameter = self.frame.snapshot.surroundings.mean_diameter;
        let radius = 0.5 * preferences.new_grain_diameters * diameter;
        Disc { position: self.to_world(at), radius }
    }

    fn grip_at(&self, at: Pos2) -> Option<Grip> {
        let boundary = self.boundary_at(at)?;
        let place = place_of(&self.frame.snapshot.surroundings.boundaries[boundary]);
        let from_place = self.to_world(at) - place;
        Some(Grip { world: self.index, boundary, from_place, sent: None })
    }

    /// Returns the index of the wall nearest to the mouse, if the wall is close enough to be grabbed.
    fn boundary_at(&self, at: Pos2) -> Option<usize> {
        let point = self.to_world(at);
        let boundaries = self.frame.snapshot.surroundings.boundaries.iter();
        let distances = boundaries.map(|boundary| distance(boundary, point)).enumerate();
        let near = distances.filter(|(_, distance)| *distance <= self.metres(REACH));
        near.min_by(|one, other| one.1.total_cmp(&other.1)).map(|(index, _)| index)
    }

    /// While Shift is pressed, shows which grain a click would add or remove, or which wall the mouse would move.
    fn marks_of_hand(&self, ui: &Ui, grip: Option<Grip>, preferences: &Preferences, at: Pos2) {
        let painter = ui.painter().with_clip_rect(self.cell);
        let dark = ui.visuals().dark_mode;
        if let Some(found) = self.grain_at(at) {
            let grain = &self.frame.snapshot.grains[found.grain];
            let (middle, arm) = (self.to_screen(grain.position), 0.6 * self.points(grain.radius));
            let stroke = Stroke::new(2.0, theme::warning(dark));
            for side in [-1.0, 1.0] {
                let end = egui::vec2(arm, side * arm);
                painter.line_segment([middle - end, middle + end], stroke);
            }
            return;
        }
        let stroke = Stroke::new(1.5, theme::accent(dark));
        let boundaries = &self.frame.snapshot.surroundings.boundaries;
        let held = grip.map(|grip| grip.boundary).or_else(|| self.boundary_at(at));
        if let Some(boundary) = held.and_then(|it| boundaries.get(it)) {
            for edge in boundary.edges() {
                let ends = match edge {
                    Edge::Wall(ends) | Edge::Side(ends) => ends.map(|end| self.to_screen(end)),
                    Edge::Endless { point, normal } => {
                        let along = normal.normalize_or_zero().perp();
                        let reach = self.metres(self.cell.width() + self.cell.height());
                        let foot = point + along * along.dot(self.to_world(at) - point);
                        [foot - reach * along, foot + reach * along].map(|end| self.to_screen(end))
                    }
                };
                painter.line_segment(ends, Stroke { width: 3.0, ..stroke });
            }
        } else {
            let disc = self.new_grain(preferences, at);
            self.ring(ui, disc.position, disc.radius, stroke);
        }
    }
}

/// Returns the target position of a wall's reference point, m, if the user moves this point to `to`, m. A plane moves
/// only along its normal, because a motion in its own plane changes nothing.
fn goal(boundary: &Boundary, to: DVec2) -> DVec2 {
    match boundary {
        Boundary::HalfSpace { point, normal } | Boundary::Piston { point, normal, .. } => {
            let normal = normal.normalize_or_zero();
            *point + normal * normal.dot(to - *point)
        }
        Boundary::Segment { .. } | Boundary::Polyline { .. } | Boundary::ConvexPolygon { .. } => to,
    }
}

/// Distance of a point from the surface of a wall, m.
fn distance(boundary: &Boundary, point: DVec2) -> f64 {
    let of_edge = |edge: &Edge| match edge {
        Edge::Endless { point: on_it, normal } => {
            normal.normalize_or_zero().dot(point - *on_it).abs()
        }
        Edge::Wall([from, to]) | Edge::Side([from, to]) => {
            let along = *to - *from;
            let part = (point - *from).dot(along) / along.length_squared().max(f64::MIN_POSITIVE);
            point.distance(*from + part.clamp(0.0, 1.0) * along)
        }
    };
    boundary.edges().iter().map(of_edge).fold(f64::INFINITY, f64::min)
}

pub(super) fn show(ui: &mut Ui, preferences: &mut Preferences) {
    ui.label(
        RichText::new(
            "With Shift held, a click on the ground adds a grain, a click on a grain removes it, and a drag moves \
             a wall while time passes. The record and sessions contain these changes; command lines and links do \
             not.",
        )
        .small()
        .weak(),
    );
    ui.horizontal(|ui| {
        let hint = "Diameter of a grain that Shift and a click add, in mean diameters.";
        let label = ui.label("New grain").on_hover_text(hint);
        let value = DragValue::new(&mut preferences.new_grain_diameters);
        let value = value
            .range(NEW_GRAIN_DIAMETERS[0]..=NEW_GRAIN_DIAMETERS[1])
            .speed(0.01)
            .max_decimals(3);
        ui.add(value.suffix(" d")).labelled_by(label.id);
    });
}

/// True if Shift was pressed when a mouse button was last pressed or released in this frame. Without such an event,
/// true if Shift is pressed at the end of the frame. The time of the event counts, because in a long frame the user
/// often releases Shift before the frame ends.
fn has_shift(input: &InputState) -> bool {
    let of_mouse = input.events.iter().rev().find_map(|event| match event {
        Event::PointerButton { modifiers, .. } => Some(modifiers.shift),
        _ => None,
    });
    of_mouse.unwrap_or(input.modifiers.shift)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn planes_go_along_their_normal_and_other_walls_anywhere() {
        let plane =
            Boundary::HalfSpace { point: DVec2::new(1.0, 2.0), normal: DVec2::new(0.0, 3.0) };
        assert_eq!(goal(&plane, DVec2::new(7.0, 5.0)), DVec2::new(1.0, 5.0));
        assert_eq!(distance(&plane, DVec2::new(-40.0, 1.5)), 0.5);
        let wall = Boundary::Segment { from: DVec2::ZERO, to: DVec2::new(0.0, 2.0) };
        assert_eq!(goal(&wall, DVec2::new(7.0, 5.0)), DVec2::new(7.0, 5.0));
        assert_eq!(distance(&wall, DVec2::new(3.0, 1.0)), 3.0);
        assert_eq!(distance(&wall, DVec2::new(0.0, 4.0)), 2.0, "beyond its end");
    }
}
