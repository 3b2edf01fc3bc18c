//! The gallery of built-in scenes: a picture of each scene in its initial state, in the style that the user chose.

use egui::{
    Align2, Color32, ColorImage, ComboBox, CursorIcon, FontId, Rect, Response, RichText, Role,
    Sense, Stroke, StrokeKind, TextureHandle, TextureOptions, Ui, WidgetInfo,
};

use super::scene_style::own_style;
use crate::app::context::{PanelContext, Request};
use crate::app::preferences::Preferences;
use crate::app::theme;
use crate::config::Config;
use crate::error::Result;
use crate::render::{Renderer, RendererChoice, Style, draw_scene};
use crate::scene::{SCENES, SceneGroup, SceneInfo};

/// Size of the picture of a scene, points.
const PICTURE: egui::Vec2 = egui::vec2(128.0, 76.0);
/// Height of the scene's name below its picture, points.
const NAME_HEIGHT: f32 = 18.0;
/// Largest number of pictures in a row.
const MOST_COLUMNS: usize = 4;
/// Largest height of the list of scenes, points.
const HEIGHT: f32 = 470.0;

/// Pictures of scenes that have been drawn, and their style.
#[derive(Default)]
pub(super) struct Gallery {
    style: Option<Style>,
    pictures: Vec<Option<TextureHandle>>,
    /// Number of the pass of egui (one frame) in which the last picture was drawn.
    drawn_in: u64,
}

impl Gallery {
    /// Shows a list of the scenes of the given groups, which is closed until the user opens it. A click on a scene
    /// opens the scene.
    pub(super) fn show(
        &mut self,
        ui: &mut Ui,
        context: &mut PanelContext<'_>,
        current: &str,
        groups: &[SceneGroup],
    ) -> Response {
        let list = ComboBox::from_id_salt(("scene", groups.len()))
            .width(150.0)
            .height(HEIGHT)
            .selected_text(current);
        let shown = list.show_ui(ui, |ui| {
            self.follow_style(ui, context.preferences);
            let side = PICTURE.x + ui.spacing().item_spacing.x;
            let room = ui.ctx().content_rect().width() - 40.0;
            let columns = ((room / side) as usize).clamp(1, MOST_COLUMNS);
            ui.set_min_width(columns as f32 * side);
            for &group in groups {
                ui.label(RichText::new(group.hint()).strong());
                egui::Grid::new(group.hint()).num_columns(columns).show(ui, |ui| {
                    let scenes = SCENES.iter().enumerate().filter(|(_, info)| info.group == group);
                    for (place, (index, info)) in scenes.enumerate() {
                        if place > 0 && place % columns == 0 {
                            ui.end_row();
                        }
                        if self.entry(ui, context, index, info, info.name == current).clicked() {
                            context.ask(Request::Load(Config::of_scene(info.name).into()));
                        }
                    }
                });
            }
        });
        shown.response
    }

    /// Discards the pictures of scenes if the drawing style has changed, so that they are drawn again.
    fn follow_style(&mut self, ui: &Ui, preferences: &Preferences) {
        let style = Style {
            scale_bar: false,
            legend: false,
            show_forces: false,
            show_velocities: false,
            ..own_style(preferences, ui.visuals().dark_mode)
        };
        if self.style.as_ref() != Some(&style) {
            *self = Self { style: Some(style), pictures: vec![None; SCENES.len()], drawn_in: 0 };
        }
    }

    /// Shows one scene: its picture and its name.
    fn entry(
        &mut self,
        ui: &mut Ui,
        context: &mut PanelContext<'_>,
        index: usize,
        info: &SceneInfo,
        is_open: bool,
    ) -> Response {
        let size = PICTURE + egui::vec2(0.0, NAME_HEIGHT);
        let (cell, response) = ui.allocate_exact_size(size, Sense::click());
        response.widget_info(|| WidgetInfo::selected(Role::Button, true, is_open, info.name));
        context.note_control(&format!("scene {}", info.name), cell);
        if ui.is_rect_visible(cell) {
            let (picture, below) = cell.split_top_bottom_at_y(cell.top() + PICTURE.y);
            self.paint(ui, index, info, picture);
            let visuals = ui.style().interact_selectable(&response, is_open);
            let stroke = if is_open || response.hovered() {
                Stroke::new(2.0, theme::accent(ui.visuals().dark_mode))
            } else {
                ui.visuals().widgets.noninteractive.bg_stroke
            };
            ui.painter().rect_stroke(picture, 2.0, stroke, StrokeKind::Inside);
            let (font, ink) = (FontId::proportional(12.0), visuals.text_color());
            let ink = if is_open { ui.visuals().strong_text_color() } else { ink };
            ui.painter().text(below.center(), Align2::CENTER_CENTER, info.name, font, ink);
        }
        response.on_hover_text(info.summary).on_hover_cursor(CursorIcon::PointingHand)
    }

    /// Paints the picture of a scene into a rectangle. If pictures are missing, one of them is drawn per frame.
    fn paint(&mut self, ui: &Ui, index: usize, info: &SceneInfo, cell: Rect) {
        let Self { style: Some(style), pictures, drawn_in } = self else { return };
        if pictures[index].is_none() {
            ui.ctx().request_repaint();
            let pass = ui.ctx().cumulative_pass_nr();
            if std::mem::replace(drawn_in, pass) == pass {
                return;
            }
            let size = (PICTURE * ui.pixels_per_point()).round();
            // If a scene cannot be drawn, only its name is shown.
            let image = picture(info, style, [size.x as u32, size.y as u32])
                .unwrap_or_else(|_| ColorImage::filled([1, 1], Color32::TRANSPARENT));
            pictures[index] = Some(ui.ctx().load_texture(info.name, image, TextureOptions::LINEAR));
        }
        if let Some(texture) = &pictures[index] {
            let whole = Rect::from_min_max(egui::pos2(0.0, 0.0), egui::pos2(1.0, 1.0));
            ui.painter().image(texture.id(), cell, whole, Color32::WHITE);
        }
    }
}

/// Returns a picture of the initial state of a scene, `width` × `height` pixels.
fn picture(info: &SceneInfo, style: &Style, [width, height]: [u32; 2]) -> Result<ColorImage> {
    let scene = (info.make)()?;
    let view = scene.view();
    let camera = style.camera(view.min, view.max, width, height);
    let snapshot = scene.simulation()?.snapshot();
    let mut renderer = Renderer::new(RendererChoice::Cpu)?;
    let image = draw_scene(&mut renderer, &snapshot, style, &camera, width, height)?;
    let size = [width as usize, height as usize];
    Ok(ColorImage::from_rgba_unmultiplied(size, image.as_raw()))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Checks that each scene is visible in its picture: more than 40 pixels differ from the background.
    #[test]
    fn every_scene_is_seen_on_its_picture() {
        let style = Style { scale_bar: false, legend: false, ..Style::default() };
        for info in SCENES {
            let image = picture(info, &style, [128, 76]).unwrap();
            let ground = image.pixels[0];
            let inked = image.pixels.iter().filter(|&&pixel| pixel != ground).count();
            assert!(inked > 40, "{}: {inked} pixels", info.name);
        }
    }
}
