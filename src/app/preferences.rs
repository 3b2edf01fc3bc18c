//! Choices that the window remembers between starts.

use std::collections::BTreeMap;
use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use super::data_export::DataChoices;
use super::page::Page;
use super::plots::ChosenPlot;
use super::predictions::Prediction;
use crate::config::Config;
#[cfg(feature = "window")]
use crate::error::Result;
#[cfg(feature = "window")]
use crate::headless::HeadlessOptions;
use crate::live::Pace;
use crate::render::Style;
#[cfg(feature = "window")]
use crate::render::Theme;

/// Choices that outlive the window.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Preferences {
    /// Light, dark, or the theme of the desktop.
    pub theme: egui::ThemePreference,
    /// Style of the scene; its theme follows the window's.
    pub style: Style,
    /// The page that is open beside the scene.
    pub page: Option<Page>,
    /// True if the bars above and below the scene are hidden.
    pub folded: bool,
    /// True if moving a main slider starts the run again.
    pub starts_again: bool,
    /// True if the earlier run is drawn behind the present one.
    pub ghost: bool,
    /// True if idle cores compute the mean over other initial states.
    #[serde(rename = "other_piles")]
    pub ensemble: bool,
    /// True while the plots are open.
    pub plots: bool,
    /// Names of the plotted quantities.
    pub quantities: Vec<String>,
    /// Axes of the plot of two quantities.
    pub chosen_plot: ChosenPlot,
    /// Name of the visible histogram, as in files.
    pub histogram: String,
    /// True if an arrow always shows the direction of gravity.
    pub gravity: bool,
    /// Size of the window, points; `None` before the first window.
    pub window_points: Option<[f64; 2]>,
    /// Simulated time per wall-clock time, for films as well.
    pub speed: f64,
    /// True to compute as fast as the machine can; then `speed` is not used.
    pub full_speed: bool,
    /// Size of exported pictures, pixels.
    pub picture_size: [u32; 2],
    /// Pictures per second of exported videos.
    pub video_rate_hz: f64,
    /// Diameter of grains that the mouse adds, in mean diameters.
    pub new_grain_diameters: f64,
    /// Folder of exported files.
    pub folder: PathBuf,
    /// Settings of exported recordings.
    pub data: DataChoices,
    /// The scene that was open last.
    pub scene: Config,
    /// Progress in the lessons.
    pub lesson: LessonPlace,
}

impl Default for Preferences {
    fn default() -> Self {
        Self {
            theme: egui::ThemePreference::Light,
            style: Style::default(),
            page: None,
            folded: false,
            starts_again: true,
            ghost: true,
            ensemble: true,
            plots: true,
            quantities: vec!["slump".into()],
            chosen_plot: ChosenPlot::default(),
            histogram: "normal_force".into(),
            gravity: false,
            window_points: None,
            speed: 0.2,
            full_speed: false,
            picture_size: [1600, 1000],
            video_rate_hz: 25.0,
            new_grain_diameters: 1.0,
            folder: PathBuf::from("."),
            data: DataChoices::default(),
            scene: Config::default(),
            lesson: LessonPlace::default(),
        }
    }
}

impl Preferences {
    /// Takes over the picture options of the command line.
    #[cfg(feature = "window")]
    pub(crate) fn follow(&mut self, pictures: &HeadlessOptions) -> Result<()> {
        if pictures.size.is_some() {
            let size = pictures.size()?;
            self.picture_size = [size.width, size.height];
        }
        if let Some(colour) = pictures.colour {
            self.style.colour_by = colour;
        }
        if !pictures.show.is_empty() {
            let asked = pictures.style()?;
            self.style.show_forces = asked.show_forces;
            self.style.angles = asked.angles;
        }
        if let Some(theme) = pictures.theme {
            self.theme = match theme {
                Theme::Light => egui::ThemePreference::Light,
                Theme::Dark => egui::ThemePreference::Dark,
            };
        }
        if let Some(folder) = &pictures.frames {
            self.folder.clone_from(folder);
        }
        Ok(())
    }

    /// Pace that the preferences ask for.
    pub(crate) fn pace(&self) -> Pace {
        if self.full_speed { Pace::Max } else { Pace::RealTime(self.speed) }
    }
}

/// A user's progress in the lessons.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct LessonPlace {
    /// Index of the lesson.
    pub at: usize,
    /// True if a window without options opens the lessons.
    pub on: bool,
    /// The predictions, by lesson.
    pub predictions: BTreeMap<usize, Prediction>,
    /// The user's choices before the lessons, restored after them.
    pub(super) before: Option<Choices>,
}

impl Default for LessonPlace {
    fn default() -> Self {
        Self { at: 0, on: true, predictions: BTreeMap::new(), before: None }
    }
}

/// Preferences that a lesson sets in place of the user.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Choices {
    pub quantities: Vec<String>,
    pub speed: f64,
    pub full_speed: bool,
    pub starts_again: bool,
    pub page: Option<Page>,
    /// True if the forces of bonds and contacts are drawn.
    pub show_forces: bool,
}

impl Choices {
    /// Applies these choices and returns the previous ones.
    fn swap(self, preferences: &mut Preferences) -> Self {
        Self {
            quantities: std::mem::replace(&mut preferences.quantities, self.quantities),
            speed: std::mem::replace(&mut preferences.speed, self.speed),
            full_speed: std::mem::replace(&mut preferences.full_speed, self.full_speed),
            starts_again: std::mem::replace(&mut preferences.starts_again, self.starts_again),
            page: std::mem::replace(&mut preferences.page, self.page),
            show_forces: std::mem::replace(&mut preferences.style.show_forces, self.show_forces),
        }
    }
}

impl Preferences {
    /// Begins a lesson with its choices.
    pub(super) fn begin_lesson(&mut self, at: usize, choices: Choices) {
        let replaced = choices.swap(self);
        let before = self.lesson.before.take().unwrap_or(replaced);
        let predictions = std::mem::take(&mut self.lesson.predictions);
        self.lesson = LessonPlace { at, on: true, predictions, before: Some(before) };
    }

    /// Restores the choices from before the lessons.
    pub(super) fn put_lesson_away(&mut self) {
        if let Some(before) = self.lesson.before.take() {
            before.swap(self);
        }
    }
}

/// Everything that the window stores between starts.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(default)]
pub(crate) struct StoredWindow {
    pub preferences: Preferences,
    pub layout: egui::Memory,
}

impl StoredWindow {
    /// The present preferences and layout.
    pub(super) fn of(preferences: &Preferences, context: &egui::Context) -> Self {
        Self { preferences: preferences.clone(), layout: context.memory(Clone::clone) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_kept_reads_back() {
        // The context must have drawn something, otherwise it has no layout to store.
        let context = egui::Context::default();
        for _ in 0..2 {
            let _ = context.run_ui(egui::RawInput::default(), |ui| {
                egui::Panel::left("side").show(ui, |ui| ui.collapsing("more", |ui| ui.label("x")));
                egui::ScrollArea::vertical().show(ui, |ui| ui.label("y"));
            });
        }
        let mut stored = StoredWindow::default();
        stored.preferences.speed = 0.5;
        stored.preferences.scene.source.grains = Some(40);
        stored.layout = context.memory(Clone::clone);
        let text = ron::to_string(&stored).unwrap();
        let back: StoredWindow = ron::from_str(&text).unwrap();
        assert_eq!(back.preferences, stored.preferences);
    }
}
