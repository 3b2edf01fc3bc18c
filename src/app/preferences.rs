//! What the window remembers between starts, beside egui's own memory of the layout.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use super::panels::plots::Quantity;
use crate::render::Style;
use crate::scene::Config;
use crate::sim::live::Pace;

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
    /// Whether the plots are open.
    pub plots: bool,
    /// The quantities that are plotted.
    pub quantities: Vec<Quantity>,
    /// Simulated time per time on the wall.
    pub speed: f64,
    /// As fast as the machine computes, whatever `speed` says.
    pub full_speed: bool,
    /// Size of exported pictures, pixels.
    pub picture_size: [u32; 2],
    /// Where exported files go.
    pub folder: PathBuf,
    /// The scene that was open last.
    pub scene: Config,
}

impl Default for Preferences {
    fn default() -> Self {
        Self {
            theme: egui::ThemePreference::Light,
            style: Style::default(),
            sidebar: true,
            plots: true,
            quantities: Quantity::ALL.to_vec(),
            speed: 0.2,
            full_speed: false,
            picture_size: [1600, 1000],
            folder: PathBuf::from("."),
            scene: Config::default(),
        }
    }
}

impl Preferences {
    /// The pace that the preferences ask for.
    pub fn pace(&self) -> Pace {
        if self.full_speed { Pace::Max } else { Pace::RealTime(self.speed) }
    }
}
