//! A user who waits for the solver's thread before looking.

use std::time::{Duration, Instant};

use egui::{Event, Modifiers, PointerButton, Pos2, Vec2};
use egui_kittest::kittest::Queryable;
use egui_kittest::{Harness, HarnessBuilder};
use slump::app::{AppState, Preferences, theme, ui};
use slump::config::Config;
use slump::live::{Live, LiveOptions, WorldFrame};

/// Longer than anything that these tests wait for takes.
const PATIENCE: Duration = Duration::from_secs(60);

/// A window without a screen.
pub struct Robot {
    pub harness: Harness<'static, AppState>,
}

impl Robot {
    /// A window of 1000 × 700 points with a scene open.
    pub fn open(config: Config) -> Self {
        Self::build(config, Preferences::default(), |window| window)
    }

    /// The same, able to draw pictures of itself.
    pub fn open_with_gpu(config: Config, preferences: Preferences) -> Self {
        Self::build(config, preferences, HarnessBuilder::wgpu)
    }

    fn build(
        config: Config,
        preferences: Preferences,
        renderer: fn(HarnessBuilder<AppState>) -> HarnessBuilder<AppState>,
    ) -> Self {
        let live = Live::spawn(LiveOptions::default()).unwrap();
        // What other piles do is seen by those tests that ask for them.
        let preferences = Preferences { ensemble: false, ..preferences };
        let state = AppState::new(live, config, preferences);
        let window = Harness::builder()
            .with_size(Vec2::new(1000.0, 700.0))
            .with_context_setup(theme::install);
        let harness = renderer(window).build_ui_state(ui, state);
        let mut robot = Self { harness };
        robot.until("a scene", |state| !state.frame.worlds.is_empty());
        robot
    }

    pub fn state(&self) -> &AppState {
        self.harness.state()
    }

    pub fn state_mut(&mut self) -> &mut AppState {
        self.harness.state_mut()
    }

    pub fn world(&self) -> &WorldFrame {
        self.state().world().unwrap()
    }

    pub fn steps(&self) -> u64 {
        self.world().snapshot.observables.step
    }

    /// Draws frames until the state is as wanted.
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

    /// Draws frames until every command has been carried out.
    pub fn settle(&mut self) {
        self.until("the solver's thread", |state| {
            let frame = &state.frame;
            frame.acknowledged == state.live.sent() && !frame.seeking && frame.loading.is_none()
        });
        self.harness.step();
    }

    pub fn click(&mut self, label: &str) {
        // Panels may still be opening, and the control may lie below the edge of the sidebar.
        self.harness.get_by_label(label).scroll_to_me();
        for _ in 0..10 {
            self.harness.step();
        }
        self.harness.get_by_label(label).click();
        self.harness.step();
        self.settle();
    }

    pub fn key(&mut self, key: egui::Key) {
        self.harness.key_press(key);
        self.harness.step();
        self.settle();
    }

    /// Types into the field of a number and presses enter.
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

    /// Where a control lies, as a part of its width and height.
    pub fn place(&self, control: &str, across: f32, down: f32) -> Pos2 {
        let rect = self.state().controls[control];
        rect.min + rect.size() * egui::vec2(across, down)
    }

    /// Presses the mouse at one place and moves to another, button held.
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

/// A file in the hand of the mouse.
#[derive(Debug)]
pub struct File(pub std::path::PathBuf);

impl egui::DroppedFile for File {
    fn path(&self) -> &std::path::Path {
        &self.0
    }

    fn bytes(&self) -> Result<Vec<u8>, String> {
        std::fs::read(&self.0).map_err(|error| error.to_string())
    }
}

/// Positions and velocities of all grains, bit for bit.
pub fn bits(world: &WorldFrame) -> Vec<[u64; 6]> {
    let bits = |grain: &slump::sim::GrainView| {
        [
            grain.position.x,
            grain.position.y,
            grain.velocity.x,
            grain.velocity.y,
            grain.angle,
            grain.angular_velocity,
        ]
        .map(f64::to_bits)
    };
    world.snapshot.grains.iter().map(bits).collect()
}

/// The paper's pile, solved well enough for a test.
pub fn pile() -> Config {
    let mut config = Config::default();
    (config.solver.tolerance, config.solver.max_sweeps) = (Some(1e-3), Some(500));
    config
}
