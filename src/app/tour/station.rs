//! What one stop of the tour is.

use crate::sim::Settings;

/// What one stop shows.
#[derive(Debug)]
pub struct Station {
    /// What it is about.
    pub title: &'static str,
    /// What to do, and what to watch.
    pub watch: &'static str,
    /// Its scene.
    pub scene: &'static str,
    /// Its worlds, made of the settings that the window gives that scene.
    pub worlds: fn(Settings) -> Vec<Settings>,
    /// Simulated time per time on the wall.
    pub speed: f64,
    /// The quantities that are plotted.
    pub plots: &'static [&'static str],
    /// The panel that is opened for it.
    pub panel: Option<&'static str>,
}
