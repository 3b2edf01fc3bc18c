//! A simulated user of the window. Before it looks at a result, it waits until the solver's thread has carried out all
//! commands.

pub use egui_kittest::kittest::{NodeT, Queryable};
pub use glam::DVec2;
pub use slump::app::{AppState, GrainRef, Page, Preferences};
pub use slump::config::{Config, SavedState};
pub use slump::data::{FormatName, read_grains};
pub use slump::live::{Command, Live, LiveOptions, Pace, WorldFrame};
pub use slump::scene::*;
pub use slump::sim::*;
pub use slump::solver::{FrictionModel, Method, SolverChanges, StopTest};

pub use crate::program::{
    Duration, Instant, PATIENCE, Path, PathBuf, bytes, folder, json, names_in, read, run, said,
    slump, succeed, text, write,
};

use egui::{Event, Modifiers, PointerButton, Pos2, Vec2};
use egui_kittest::{Harness, HarnessBuilder};
use slump::app::{theme, ui};

pub struct Robot {
    pub harness: Harness<'static, AppState>,
}

impl Robot {
    /// Opens a window of 1000 × 700 points with a scene, and waits until the scene is shown.
    pub fn open(config: Config) -> Self {
        Self::build(config, Preferences::default(), |window| window)
    }

    /// Opens a window and loads a saved session or run.
    pub fn open_saved(path: &Path) -> Self {
        let mut robot = Self::open(Config::of_scene("cradle"));
        robot.state_mut().load_saved(path);
        robot.settle();
        robot
    }

    /// Opens a window with the panel for saving data. The window writes its files into this folder.
    pub fn open_in(folder: &Path, config: Config) -> Self {
        let mut robot = Self::open(config);
        robot.state_mut().preferences.folder = folder.to_owned();
        robot.click("Save");
        robot
    }

    /// Opens a window like [`Self::open`], with these preferences. This window can also draw pictures of itself.
    pub fn open_with_gpu(config: Config, preferences: Preferences) -> Self {
        Self::build(config, preferences, HarnessBuilder::wgpu)
    }

    fn build(
        config: Config,
        preferences: Preferences,
        renderer: fn(HarnessBuilder<AppState>) -> HarnessBuilder<AppState>,
    ) -> Self {
        let mut robot = Self::begin(config, preferences, renderer);
        robot.until("a scene", |state| !state.run.frame.worlds.is_empty());
        // The sliders of a scene change the positions of the controls above them.
        robot.frames(2);
        robot
    }

    /// Opens a window, without waiting until its first scene is loaded.
    pub fn begin(
        config: Config,
        preferences: Preferences,
        renderer: fn(HarnessBuilder<AppState>) -> HarnessBuilder<AppState>,
    ) -> Self {
        let live = Live::spawn(LiveOptions::default()).unwrap();
        // Only tests that ask for other piles compute them, because they take much time.
        let preferences = Preferences { ensemble: false, starts_again: false, ..preferences };
        let state = AppState::new(live, config, preferences);
        let window = Harness::builder()
            .with_size(Vec2::new(1000.0, 700.0))
            .with_context_setup(theme::install);
        Self { harness: renderer(window).build_ui_state(ui, state) }
    }

    pub fn state(&self) -> &AppState {
        self.harness.state()
    }

    pub fn state_mut(&mut self) -> &mut AppState {
        self.harness.state_mut()
    }

    pub fn world(&self) -> &WorldFrame {
        self.state().run.world().unwrap()
    }

    pub fn steps(&self) -> u64 {
        self.world().snapshot.observables.step
    }

    pub fn settings(&self) -> Settings {
        self.world().controls.settings
    }

    pub fn observables(&self) -> Observables {
        self.world().snapshot.observables
    }

    pub fn notice(&self) -> String {
        self.state().notice().expect("a notice").0.text.clone()
    }

    pub fn shows(&self, words: &str) -> bool {
        self.harness.query_all_by_label_contains(words).count() > 0
    }

    /// Returns all texts that the window painted in the last frame.
    pub fn painted_texts(&self) -> Vec<PaintedText> {
        let mut all = Vec::new();
        for clipped in &self.harness.output().shapes {
            note_texts(&clipped.shape, clipped.clip_rect, &mut all);
        }
        all
    }

    /// Returns the texts of the last frame that are not completely visible.
    pub fn cut_texts(&self) -> Vec<String> {
        let is_cut =
            |text: &PaintedText| text.elided || !text.within.contains_rect(text.rect.shrink(1.0));
        self.painted_texts().into_iter().filter(is_cut).map(|text| text.text).collect()
    }

    pub fn of_worlds<T>(&self, value: impl Fn(&WorldFrame) -> T) -> Vec<T> {
        self.state().run.frame.worlds.iter().map(value).collect()
    }

    pub fn bits(&self) -> Vec<[u64; 6]> {
        bits(self.world())
    }

    pub fn frames(&mut self, count: usize) {
        (0..count).for_each(|_| self.harness.step());
    }

    pub fn send(&mut self, command: Command) {
        self.state_mut().run.live.send(command);
        self.settle();
    }

    pub fn seek(&mut self, secs: f64) {
        self.send(Command::Seek(secs));
    }

    pub fn take_steps(&mut self, steps: u64) {
        (0..steps).for_each(|_| self.state_mut().run.step());
        self.settle();
    }

    pub fn change(&mut self, world: usize, settings: Settings) {
        self.state_mut().run.change(world, settings);
        self.settle();
    }

    pub fn set(&mut self, change: impl FnOnce(&mut Settings)) {
        let mut settings = self.settings();
        change(&mut settings);
        self.change(0, settings);
    }

    pub fn load(&mut self, config: Config) {
        self.state_mut().load(config);
        self.settle();
    }

    pub fn paste(&mut self, text: impl Into<String>) {
        self.harness.event(Event::Paste(text.into()));
        self.harness.step();
        self.settle();
    }

    pub fn drop(&mut self, path: &Path) {
        self.harness.input_mut().dropped_files.push(std::sync::Arc::new(File(path.to_owned())));
        self.harness.step();
        self.settle();
    }

    /// Waits until the window has written a file. Returns the window's notice about the file.
    pub fn written(&mut self) -> String {
        self.until("the file", |state| !state.is_writing());
        self.notice()
    }

    pub fn until(&mut self, what: &str, condition: impl Fn(&AppState) -> bool) {
        let start = Instant::now();
        loop {
            self.harness.step();
            if condition(self.harness.state()) {
                return;
            }
            assert!(start.elapsed() < PATIENCE, "waited in vain for {what}");
            std::thread::sleep(Duration::from_millis(2));
        }
    }

    /// Draws frames until the solver's thread has carried out all commands.
    pub fn settle(&mut self) {
        self.until("the solver's thread", |state| {
            let frame = &state.run.frame;
            frame.acknowledged == state.run.live.sent() && !frame.seeking && frame.loading.is_none()
        });
        self.harness.step();
    }

    pub fn click(&mut self, label: &str) {
        if Page::ALL.iter().any(|page| page.title() == label)
            && self.state().preferences.page.is_none()
        {
            self.click("More ▾");
        }
        // Panels may still be opening, and the control may be below the visible part of the sidebar.
        self.harness.get_by_label(label).scroll_to_me();
        for _ in 0..10 {
            self.harness.step();
        }
        self.harness.get_by_label(label).click();
        self.harness.step();
        self.settle();
    }

    pub fn clicks(&mut self, labels: &[&str]) {
        labels.iter().for_each(|label| self.click(label));
    }

    pub fn command_key(&mut self, key: egui::Key) {
        self.harness.key_press_modifiers(Modifiers::COMMAND, key);
        self.harness.step();
    }

    pub fn saved(&mut self) -> PathBuf {
        let told = self.written();
        told.strip_prefix("Saved ").unwrap_or_else(|| panic!("{told}")).into()
    }

    pub fn save_session(&mut self, folder: &Path) -> PathBuf {
        self.state_mut().preferences.folder = folder.to_owned();
        self.command_key(egui::Key::S);
        self.saved()
    }

    pub fn key(&mut self, key: egui::Key) {
        self.harness.key_press(key);
        self.harness.step();
        self.settle();
    }

    /// Types text into a number field and presses the enter key.
    pub fn type_number(&mut self, label: &str, text: &str) {
        self.harness.get_by_role_and_label(egui::Role::TextInput, label).focus();
        self.harness.step();
        self.harness.key_press_modifiers(Modifiers::COMMAND, egui::Key::A);
        self.harness.event(Event::Text(text.to_owned()));
        self.harness.step();
        self.harness.key_press(egui::Key::Enter);
        self.harness.step();
        self.settle();
    }

    /// Returns a position within a control. `across` and `down` are fractions of its width and height.
    pub fn place(&self, control: &str, across: f32, down: f32) -> Pos2 {
        let rect = self.state().controls[control];
        rect.min + rect.size() * egui::vec2(across, down)
    }

    /// Presses the mouse button at the position `from` and moves the mouse to the position `to`, with the button still
    /// pressed.
    pub fn drag(&mut self, from: Pos2, to: Pos2) {
        self.harness.hover_at(from);
        self.button(from, true);
        for part in 1..=4 {
            self.harness.hover_at(from + (to - from) * (part as f32 / 4.0));
            self.harness.step();
        }
    }

    pub fn button(&mut self, at: Pos2, pressed: bool) {
        let (button, modifiers) = (PointerButton::Primary, Modifiers::NONE);
        self.harness.event(Event::PointerButton { pos: at, button, pressed, modifiers });
        self.harness.step();
    }
}

/// A text that the window has painted.
pub struct PaintedText {
    pub text: String,
    pub rect: egui::Rect,
    /// Area in which the text is visible. Parts of the text outside this area are cut off.
    pub within: egui::Rect,
    /// True if dots replace a part of a text that is too long.
    pub elided: bool,
}

fn note_texts(shape: &egui::Shape, within: egui::Rect, all: &mut Vec<PaintedText>) {
    match shape {
        egui::Shape::Vec(shapes) => {
            shapes.iter().for_each(|shape| note_texts(shape, within, all));
        }
        egui::Shape::Text(shape) => all.push(PaintedText {
            text: shape.galley.text().to_owned(),
            rect: shape.visual_bounding_rect(),
            within,
            elided: shape.galley.elided,
        }),
        _ => {}
    }
}

#[derive(Debug)]
struct File(PathBuf);

impl egui::DroppedFile for File {
    fn path(&self) -> &Path {
        &self.0
    }

    fn bytes(&self) -> Result<Vec<u8>, String> {
        std::fs::read(&self.0).map_err(|error| error.to_string())
    }
}

/// Returns the bit patterns of the positions, angles and velocities of all grains.
pub fn bits(world: &WorldFrame) -> Vec<[u64; 6]> {
    let bits = |grain: &GrainView| {
        let (at, velocity) = (grain.position, grain.velocity);
        [at.x, at.y, velocity.x, velocity.y, grain.angle, grain.angular_velocity].map(f64::to_bits)
    };
    world.snapshot.grains.iter().map(bits).collect()
}

/// Returns the configuration of the built-in pile (that of Abramian & Staron 2020), solved accurately enough for the
/// tests.
pub fn pile() -> Config {
    let mut config = Config::default();
    (config.solver.tolerance, config.solver.max_sweeps) = (Some(1e-3), Some(500));
    config
}

/// Writes a scene of one grain without gravity, changed by `change`. Returns the folder of its file, and the
/// configuration that opens it.
pub fn one_grain(change: impl FnOnce(&mut Scene)) -> (tempfile::TempDir, Config) {
    let folder = folder();
    let mut scene = pile().scene(|_| true).expect("a scene");
    scene.grains.truncate(1);
    scene.fixed_discs.clear();
    scene.gravity = slump::world::Gravity::Uniform { acceleration: DVec2::ZERO };
    change(&mut scene);
    let path = folder.path().join("one.toml");
    write(&path, slump::config::scene_to_toml(&scene).expect("TOML"));
    let config = Config::of_scene(text(&path));
    (folder, config)
}
