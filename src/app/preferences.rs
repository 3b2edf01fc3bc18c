//! Preferences: the user's choices in the window, which the program stores between starts.

use std::collections::BTreeMap;
use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use super::data_export::DataChoices;
use super::page::Page;
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

/// The user's choices in the window, which the program stores between starts.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Preferences {
    /// Light theme, dark theme, or the theme of the desktop.
    pub theme: egui::ThemePreference,
    /// Drawing style of the scene. Its `theme` has no effect: the colours of background and text follow the theme of
    /// the window.
    pub style: Style,
    /// The page of the sidebar that is open.
    pub page: Option<Page>,
    /// True if the bars above and below the scene are hidden.
    pub folded: bool,
    /// True if moving one of the main sliders (Bond, Δt, ρ or μ) restarts the run from its initial state.
    pub starts_again: bool,
    /// True if outlines of the earlier run are drawn behind the present run.
    pub ghost: bool,
    /// True if idle cores compute the mean slump of runs from other initial states (other seeds).
    #[serde(rename = "other_piles")]
    pub ensemble: bool,
    /// True if the plots are visible.
    pub plots: bool,
    /// Names of the plotted quantities.
    pub quantities: Vec<String>,
    /// True if an arrow in the scene always shows the direction of gravity.
    pub gravity: bool,
    /// Size of the window, points; `None` if no window has been opened yet.
    pub window_points: Option<[f64; 2]>,
    /// Speed of playing: simulated time per wall-clock time. It also applies to exported animations.
    pub speed: f64,
    /// True if the run is computed as fast as the machine can; `speed` then has no effect.
    pub full_speed: bool,
    /// Size of exported pictures, pixels.
    pub picture_size: [u32; 2],
    /// Pictures per second of exported videos.
    pub video_rate_hz: f64,
    /// Diameter of grains that the user adds with the mouse, in mean diameters.
    pub new_grain_diameters: f64,
    /// Folder of exported files.
    pub folder: PathBuf,
    /// The user's choices for exported recordings of grains and contacts.
    pub data: DataChoices,
    /// Configuration of the scene that was open last.
    pub scene: Config,
    /// The user's progress in the lessons.
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
    /// Applies the picture options of the command line to the preferences.
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

    /// Returns the speed of playing, to be sent to the solver's thread: the chosen simulated time per wall-clock time,
    /// or [`Pace::Max`] if the user wants the run to be computed as fast as the machine can.
    pub(crate) fn pace(&self) -> Pace {
        if self.full_speed { Pace::Max } else { Pace::RealTime(self.speed) }
    }

    /// Restores the choices that the user had before the lessons.
    pub(super) fn put_lesson_away(&mut self) {
        if let Some(before) = self.lesson.before.take() {
            self.style.show_forces = before.style.show_forces;
            let Self { quantities, speed, full_speed, starts_again, page, .. } = *before;
            *self = Self { quantities, speed, full_speed, starts_again, page, ..self.clone() };
        }
    }
}

/// A user's progress in the lessons.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct LessonPlace {
    /// Index of the present lesson.
    pub at: usize,
    /// True if the lessons open when the program starts without options.
    pub on: bool,
    /// The user's predictions, by the index of the lesson.
    pub predictions: BTreeMap<usize, Prediction>,
    /// The preferences before the first lesson. After the lessons, those that lessons change are restored.
    pub(super) before: Option<Box<Preferences>>,
}

impl Default for LessonPlace {
    fn default() -> Self {
        Self { at: 0, on: true, predictions: BTreeMap::new(), before: None }
    }
}

/// All data that the window stores between starts.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(default)]
pub(crate) struct StoredWindow {
    pub preferences: Preferences,
    pub layout: egui::Memory,
}

impl StoredWindow {
    /// Returns the present preferences and layout for storage.
    pub(super) fn of(preferences: &Preferences, context: &egui::Context) -> Self {
        Self { preferences: preferences.clone(), layout: context.memory(Clone::clone) }
    }
}
