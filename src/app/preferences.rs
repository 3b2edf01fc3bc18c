//! What the window remembers between starts, and the file that keeps it.
//!
//! A file that cannot be read, be it of another version, counts as none: nobody should have to
//! repair it. What cannot be written is not kept, and nothing else is lost.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use serde::{Deserialize, Serialize};

use super::data_export::DataChoices;
use super::lessons::LessonPlace;
use super::panels::Page;
use super::plots::ChosenPlot;
use crate::config::Config;
use crate::error::Result;
use crate::headless::HeadlessOptions;
use crate::live::Pace;
use crate::render::{Style, Theme};

/// Choices that outlive the window.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Preferences {
    /// Light, dark, or what the desktop says.
    pub theme: egui::ThemePreference,
    /// How the scene is drawn; its theme follows the window's.
    pub style: Style,
    /// The page that is open beside the scene.
    pub page: Option<Page>,
    /// True while the bars above and below the scene are folded.
    pub folded: bool,
    /// True where a slider of the front starts the run again.
    pub starts_again: bool,
    /// True where the run before shows behind the present one.
    pub ghost: bool,
    /// True where idle cores compute the mean over other piles.
    #[serde(rename = "other_piles")]
    pub ensemble: bool,
    /// True while the plots are open.
    pub plots: bool,
    /// The quantities that are plotted, by their names.
    pub quantities: Vec<String>,
    /// What is plotted against what besides.
    pub chosen_plot: ChosenPlot,
    /// The histogram that shows, by its name in files.
    pub histogram: String,
    /// True where an arrow always says where gravity points.
    pub gravity: bool,
    /// Size of the window, points; none before the first.
    pub window_points: Option<[f64; 2]>,
    /// Simulated time per time on the wall, of films as well.
    pub speed: f64,
    /// As fast as the machine computes, whatever `speed` says.
    pub full_speed: bool,
    /// Size of exported pictures, pixels.
    pub picture_size: [u32; 2],
    /// Pictures in a second of exported videos.
    pub video_rate_hz: f64,
    /// Diameter of grains that the mouse adds, in mean diameters.
    pub new_grain_diameters: f64,
    /// Where exported files go.
    pub folder: PathBuf,
    /// What recordings are like that are exported.
    pub data: DataChoices,
    /// The scene that was open last.
    pub scene: Config,
    /// How far the lessons have come.
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
    /// Takes over what the command line says of pictures.
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

/// What is kept.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(default)]
pub(crate) struct StoredWindow {
    pub preferences: Preferences,
    pub layout: egui::Memory,
}

impl StoredWindow {
    /// As it is at present.
    pub(super) fn of(preferences: &Preferences, context: &egui::Context) -> Self {
        Self { preferences: preferences.clone(), layout: context.memory(Clone::clone) }
    }
}

/// The program's folder in the one of the user that a variable of the environment names, or that lies in their home.
pub(super) fn user_folder(variable: &str, in_home: &str) -> Option<PathBuf> {
    let named = std::env::var_os(variable).map(PathBuf::from).filter(|path| path.is_absolute());
    let home = || std::env::home_dir().map(|home| home.join(in_home));
    Some(named.or_else(home)?.join("slump"))
}

/// Where the file lies: in the user's configuration folder.
fn path() -> Option<PathBuf> {
    Some(user_folder("XDG_CONFIG_HOME", ".config")?.join("window.ron"))
}

/// Reads what was kept.
pub(super) fn load() -> StoredWindow {
    let text = path().and_then(|path| std::fs::read_to_string(path).ok());
    text.and_then(|text| ron::from_str(&text).ok()).unwrap_or_default()
}

/// Forgets what was kept.
pub(super) fn forget() {
    if let Some(path) = path() {
        let _ = std::fs::remove_file(path);
    }
}

/// Least time between two looks at what has changed: a window that is killed loses no more than that.
const INTERVAL: Duration = Duration::from_secs(2);

/// Keeps what changes while the window is open.
pub(super) struct Keeper {
    looked: Instant,
    kept: Preferences,
    text: String,
}

impl Keeper {
    /// With what was loaded.
    pub(super) fn new(kept: Preferences) -> Self {
        Self { looked: Instant::now(), kept, text: String::new() }
    }

    /// Keeps what has changed, if it is time to look. Otherwise, where something has, how long until then.
    pub(super) fn look(
        &mut self,
        preferences: &Preferences,
        context: &egui::Context,
    ) -> Option<Duration> {
        let left = INTERVAL.saturating_sub(self.looked.elapsed());
        if !left.is_zero() {
            return (*preferences != self.kept).then_some(left);
        }
        self.keep(preferences, context);
        None
    }

    /// Keeps what has changed.
    pub(super) fn keep(&mut self, preferences: &Preferences, context: &egui::Context) {
        self.looked = Instant::now();
        self.kept.clone_from(preferences);
        let stored = StoredWindow::of(preferences, context);
        let Ok(text) = ron::to_string(&stored) else { return };
        if let Some(path) = path().filter(|_| text != self.text) {
            let _ = path.parent().map(std::fs::create_dir_all);
            replace_file(&path, &text);
            self.text = text;
        }
    }
}

/// Writes a file beside and moves it, so that a crash leaves the old one or the new one, and a reader sees a whole one.
pub(super) fn replace_file(path: &Path, text: &str) {
    let fresh = path.with_extension("new");
    if std::fs::write(&fresh, text).is_ok() {
        let _ = std::fs::rename(fresh, path);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_kept_reads_back() {
        // A context that has drawn something, so that there is a layout to be kept.
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
