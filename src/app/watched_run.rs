//! The run that the window shows: the handle of the solver's thread, its newest frame (the data to draw), the settings
//! that the controls show, and the selected simulation.

use std::sync::Arc;
use std::sync::mpsc::{Receiver, channel};

use glam::DVec2;

use super::file_names::stem;
use super::number_text::slump_text;
use super::titles::title_among;
use crate::config::Config;
use crate::live::{
    Command, Controls, Live, LiveFrame, LiveStart, PastRun, WorldFrame, WorldHistory,
};
use crate::sim::Settings;

/// A grain of one of the worlds (simulations side by side).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GrainRef {
    /// Index of the simulation.
    pub world: usize,
    /// Index of the grain in its simulation.
    pub grain: usize,
}

/// The run that the window shows.
pub struct WatchedRun {
    /// Handle of the solver's thread.
    pub live: Live,
    /// Newest frame (the data that the window draws) from the solver's thread.
    pub frame: LiveFrame,
    /// Settings that the controls show, one entry per simulation. While the solver's thread has not yet handled a
    /// change, these settings are newer than those in the newest frame (the data to draw).
    pub(crate) wanted: Vec<Controls>,
    /// While the user drags a main slider (Bond, Δt, ρ or μ) that restarts the run: index of the simulation and its new
    /// settings, with which the run starts again. `None` at other times.
    pub(crate) draft: Option<(usize, Settings)>,
    /// Index of the simulation that the controls change.
    pub(crate) selected: usize,
    /// The grain that the user selected with a click, whose state and contacts the window shows; `None` if no grain is
    /// selected.
    pub pinned: Option<GrainRef>,
}

/// A copy of a run's history from the solver's thread, to be written to a file.
pub(crate) struct TakenRun {
    pub start: Arc<LiveStart>,
    pub world: WorldHistory,
}

impl WatchedRun {
    /// Returns a run without an initial state.
    pub(super) fn new(live: Live) -> Self {
        Self {
            live,
            frame: LiveFrame::default(),
            wanted: Vec::new(),
            draft: None,
            selected: 0,
            pinned: None,
        }
    }

    /// Copies the settings in the newest frame (the data that the window draws) to the controls, unless the solver's
    /// thread has not yet handled a change.
    pub(super) fn follow_frame(&mut self) {
        let in_step = self.frame.acknowledged == self.live.sent() && !self.frame.seeking;
        if in_step || self.wanted.len() != self.frame.worlds.len() {
            self.wanted = self.frame.worlds.iter().map(|world| world.controls).collect();
        }
        if let Some((world, settings)) = self.draft
            && let Some(wanted) = self.wanted.get_mut(world)
        {
            wanted.settings = settings;
        }
        self.selected = self.selected.min(self.frame.worlds.len().saturating_sub(1));
        self.pinned = self.pinned.filter(|&grain| self.has(grain));
    }

    /// True if the grain exists.
    pub(super) fn has(&self, GrainRef { world, grain }: GrainRef) -> bool {
        let world = self.frame.worlds.get(world);
        world.is_some_and(|world| grain < world.snapshot.grains.len())
    }

    /// The simulation that the controls change; `None` before the first load.
    pub fn world(&self) -> Option<&WorldFrame> {
        self.frame.worlds.get(self.selected)
    }

    /// Settings that the controls show, one entry per simulation.
    pub(crate) fn all_wanted(&self) -> Vec<Settings> {
        self.wanted.iter().map(|wanted| wanted.settings).collect()
    }

    /// Settings that the controls show for the selected simulation.
    pub(crate) fn wanted_settings(&self) -> Option<Settings> {
        self.wanted.get(self.selected).map(|wanted| wanted.settings)
    }

    /// Settings that the controls show for the selected simulation, and the initial state, whose settings are the
    /// defaults of the controls.
    pub(crate) fn wanted_and_start(&self) -> Option<(Settings, Arc<LiveStart>)> {
        Some((self.wanted_settings()?, self.frame.start.clone()?))
    }

    /// Configuration of the visible run. If a load is cancelled or fails, the configuration does not change.
    pub(crate) fn config(&self) -> Config {
        self.frame.start.as_ref().map_or_else(Config::default, |start| start.config.clone())
    }

    /// True if the scene is a heap, so that its slump (relative drop of the mean height) is meaningful.
    pub(crate) fn slumps(&self) -> bool {
        self.frame.start.as_ref().is_some_and(|start| start.slumps)
    }

    /// True if the window compares several simulations.
    pub(crate) fn compares(&self) -> bool {
        self.frame.worlds.len() > 1
    }

    /// True if there are simulations and no initial state is being loaded.
    pub(crate) fn is_ready(&self) -> bool {
        !self.frame.worlds.is_empty() && self.frame.loading.is_none()
    }

    /// Lower left and upper right corner of the scene, m.
    pub(crate) fn view(&self) -> [DVec2; 2] {
        self.frame.start.as_ref().map_or([DVec2::ZERO, DVec2::ONE], |start| start.view)
    }

    /// Duration of the scene, simulated seconds.
    pub(crate) fn duration_secs(&self) -> f64 {
        self.frame.start.as_ref().map_or(1.0, |start| start.scene.duration_secs)
    }

    /// True if the displayed simulated time is the end of the scene, or later.
    pub(crate) fn has_ended(&self) -> bool {
        let last = self.world().map(|world| world.snapshot.observables).unwrap_or_default();
        self.frame.time_secs() + 0.5 * last.time_step_secs >= self.duration_secs()
    }

    /// Title of a simulation: the settings in which it differs from the other simulations.
    pub(crate) fn title(&self, world: usize) -> String {
        title_among(&self.all_wanted(), world)
    }

    /// Returns the title of a simulation with its number in front.
    pub(crate) fn numbered_title(&self, world: usize) -> String {
        format!("{}: {}", world + 1, self.title(world))
    }

    /// Returns the slump of a simulation as text; empty if the scene is not a heap.
    pub(crate) fn slump_text(&self, world: usize) -> String {
        let world = self.frame.worlds.get(world).filter(|_| self.slumps());
        world.map_or_else(String::new, |world| slump_text(world.snapshot.observables.slump))
    }

    /// First part of the names of saved files, which contains the scene, the settings and the displayed simulated time.
    pub(crate) fn file_stem(&self) -> String {
        let name = self.frame.start.as_ref().map_or("scene", |start| start.scene.name.as_str());
        let worlds = self.frame.worlds.iter();
        let settings: Vec<_> = worlds.map(|world| world.controls.settings).collect();
        stem(name, &settings, self.frame.time_secs())
    }

    /// Returns the run to which Undo goes back, as the "ghost" that is drawn behind the present run for comparison.
    /// `None` if this earlier run has another number of simulations, or if more than one simulation has other settings
    /// in it, because the results could then not be compared.
    pub(crate) fn ghost(&self) -> Option<&PastRun> {
        let (last, worlds) = (self.undo_target()?, &self.frame.worlds);
        let others = last.worlds.iter().zip(worlds.iter());
        let others = others.filter(|(past, now)| past.controls.settings != now.controls.settings);
        (last.worlds.len() == worlds.len() && others.count() <= 1).then_some(last)
    }

    /// Goes back to the previous run.
    pub(crate) fn undo(&mut self) {
        self.go_to(self.undo_target().map(|run| run.number));
    }

    /// Returns to the run that the user left with Undo.
    pub(crate) fn redo(&mut self) {
        let undone = self.frame.past.iter().find(|run| run.is_undone);
        self.go_to(undone.map(|run| run.number));
    }

    fn go_to(&mut self, number: Option<u64>) {
        if let Some(number) = number {
            self.draft = None;
            self.live.send(Command::Return(number));
        }
    }

    /// The run to which Undo goes back.
    fn undo_target(&self) -> Option<&PastRun> {
        self.frame.past.iter().rfind(|run| !run.is_undone)
    }

    /// Changes the settings of a simulation.
    pub fn change(&mut self, world: usize, settings: Settings) {
        if let Some(wanted) = self.wanted.get_mut(world) {
            wanted.settings = settings;
            self.live.send(Command::Change(world, settings));
        }
    }

    /// Restarts from the initial state with the settings that the user chose with a slider, and plays.
    pub(crate) fn start_again_with_draft(&mut self) {
        let Some((world, settings)) = self.draft.take() else { return };
        let Some(wanted) = self.wanted.get_mut(world) else { return };
        wanted.settings = settings;
        self.live.send(Command::Compare(self.all_wanted()));
        self.live.send(Command::Play);
    }

    /// Plays or pauses the run. The first play removes the walls of a pile.
    pub(crate) fn toggle_play(&mut self) {
        let command = if self.frame.playing { Command::Pause } else { Command::Play };
        self.live.send(command);
    }

    /// Takes one step and pauses.
    pub fn step(&mut self) {
        self.live.send(Command::Step);
    }

    /// Goes back by one recorded step.
    pub(crate) fn step_back(&mut self) {
        let steps = self.frame.worlds.iter().map(|world| world.snapshot.observables.time_step_secs);
        let time_secs = self.frame.time_secs() - steps.fold(0.0, f64::max);
        self.live.send(Command::Seek(time_secs.max(0.0)));
    }

    /// Requests a copy of a simulation's history from the solver's thread, which sends it between two steps. If the
    /// simulation no longer exists, the channel stays empty.
    pub(crate) fn take(&mut self, world: usize) -> Receiver<TakenRun> {
        let (sender, receiver) = channel();
        let hand_on = move |start, world| {
            // The receiver may no longer exist.
            let _ = sender.send(TakenRun { start, world });
        };
        self.live.send(Command::Take(world, Box::new(hand_on)));
        receiver
    }

    /// Requests copies of the histories of all simulations from the solver's thread.
    pub(crate) fn take_all(&mut self) -> Vec<Receiver<TakenRun>> {
        (0..self.frame.worlds.len()).map(|world| self.take(world)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::scene_start::start as scene_start;
    use crate::live::LiveOptions;

    #[test]
    fn a_ghost_stands_beside_worlds_of_which_one_was_changed_and_no_others() {
        let mut run = WatchedRun::new(Live::spawn(LiveOptions::default()).unwrap());
        let settle = |run: &mut WatchedRun| {
            while run.frame.acknowledged < run.live.sent() || run.frame.loading.is_some() {
                run.frame = run.live.latest().clone();
            }
        };
        let config = Config::default();
        let start = scene_start(&config.without_settling().unwrap(), config).unwrap();
        run.live.send(Command::Load(Box::new(start)));
        settle(&mut run);
        let settings = *run.frame.start.as_ref().unwrap().settings();
        run.step();
        run.live.send(Command::Reset);
        settle(&mut run);
        assert!(run.ghost().is_some(), "of the run before");
        let mut compare = |worlds: &[Settings]| {
            run.step();
            run.live.send(Command::Compare(worlds.to_vec()));
            settle(&mut run);
            assert!(!run.frame.past.is_empty(), "the situation");
            run.ghost().is_some()
        };
        let [weak, strong] = [0.0, 50.0].map(|bond| settings.with_bond(bond));
        assert!(!compare(&[settings, weak]), "of one world beside two");
        assert!(compare(&[settings, strong]), "one slider was moved");
        assert!(compare(&[settings, strong]), "none was");
        assert!(!compare(&[weak, settings]), "of another experiment");
        assert!(!compare(&[settings]), "of two worlds beside one");
        assert!(compare(&[strong]), "its slider was moved");
    }
}
