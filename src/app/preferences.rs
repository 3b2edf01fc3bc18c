//! What the window remembers between starts, beside egui's own memory of the layout.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use super::chosen_plot::ChosenPlot;
use super::data_choices::DataChoices;
use super::tour::Tour;
use crate::config::Config;
use crate::error::Result;
use crate::headless::HeadlessOptions;
use crate::live::Pace;
use crate::render::{Style, Theme};
use crate::sim::QUANTITIES;

/// Choices that outlive the window.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Preferences {
    /// Light, dark, or what the desktop says.
    pub theme: egui::ThemePreference,
    /// How the scene is drawn; its theme follows the window's.
    pub style: Style,
    /// Whether the sidebar is open.
    pub sidebar: bool,
    /// Whether the run before shows behind the present one.
    pub ghost: bool,
    /// Whether idle cores compute the mean over other piles.
    pub other_piles: bool,
    /// Whether the plots are open.
    pub plots: bool,
    /// The quantities that are plotted, by their names.
    pub quantities: Vec<String>,
    /// What is plotted against what besides.
    pub chosen_plot: ChosenPlot,
    /// The histogram that shows, by its name in files.
    pub histogram: String,
    /// Whether an arrow says where gravity points.
    pub gravity: bool,
    /// Size of the window, points; none before the first.
    pub window_points: Option<[f64; 2]>,
    /// Simulated time per time on the wall.
    pub speed: f64,
    /// As fast as the machine computes, whatever `speed` says.
    pub full_speed: bool,
    /// Size of exported pictures, pixels.
    pub picture_size: [u32; 2],
    /// Pictures in a second of exported videos.
    pub video_rate_hz: f64,
    /// Simulated time per time of exported videos.
    pub video_speed: f64,
    /// Diameter of grains that the mouse adds, in mean diameters.
    pub new_grain_diameters: f64,
    /// Where exported files go.
    pub folder: PathBuf,
    /// What recordings are like that are exported.
    pub data: DataChoices,
    /// The scene that was open last.
    pub scene: Config,
    /// How far the tour has come.
    pub tour: Tour,
}

impl Default for Preferences {
    fn default() -> Self {
        Self {
            theme: egui::ThemePreference::Light,
            style: Style::default(),
            sidebar: true,
            ghost: true,
            other_piles: true,
            plots: true,
            quantities: QUANTITIES.iter().map(|quantity| quantity.name.to_owned()).collect(),
            chosen_plot: ChosenPlot::default(),
            histogram: "normal_force".into(),
            gravity: false,
            window_points: None,
            speed: 0.2,
            full_speed: false,
            picture_size: [1600, 1000],
            video_rate_hz: 25.0,
            video_speed: 1.0,
            new_grain_diameters: 1.0,
            folder: PathBuf::from("."),
            data: DataChoices::default(),
            scene: Config::default(),
            tour: Tour::default(),
        }
    }
}

impl Preferences {
    /// Takes over what the command line says of pictures.
    ///
    /// # Errors
    /// Where the size of a picture is none, or a scale.
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

    /// The pace that the preferences ask for.
    pub(crate) fn pace(&self) -> Pace {
        if self.full_speed { Pace::Max } else { Pace::RealTime(self.speed) }
    }
}
