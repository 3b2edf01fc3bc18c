//! The ensemble of a world (simulation): runs with the same settings from other initial states, which differ only in
//! their seed ("other piles" in the window). From these runs the window computes the mean slump and its confidence
//! interval.
//!
//! Piles are chaotic, so the window shows a mean over several runs. The seed of the built-in pile is never in the
//! ensemble, because it was chosen: with this seed, single runs show how slump depends on Bond number and time step in
//! Abramian & Staron (2020). Idle cores run the other piles from their initial state to the end of the scene, with
//! constant settings. A run has no ensemble if its settings changed during the run or if the user pulled a grain,
//! because such a run cannot be compared with runs under constant settings.

mod pool;
mod runs;

use std::path::PathBuf;
use std::sync::Arc;

use super::IN_BROWSER;
use super::titles::change_text;
use super::user_folder::user_folder;
use crate::live::{LiveFrame, LiveStart};
use crate::scene::NewPile;
use crate::sim::Settings;
use crate::study::Mean;
pub(crate) use pool::Released;
pub(super) use pool::on_idle_cores;
use pool::{EnsembleSummary, WorkerPool, idle_cores};
pub(crate) use runs::Band;
use runs::{LEAST_COUNT, others_of, pile_of};

/// Hover text that explains the mean slump of runs from other initial states.
const RULE: &str = "Idle cores run other piles with the present settings from their initial state on. They differ \
                    from this pile only in their seed. Thin lines show these piles, the dashed line shows their \
                    mean. ± is the 95 % interval of that mean (Student's), not the spread of the piles. They start \
                    again when the settings change. A run whose settings changed on the way, or that was pulled by \
                    hand, has no other piles: reset it. The seed of the shipped pile, which was chosen, is never \
                    among them.";

/// Hover text that replaces [`RULE`] in a browser.
const RULE_IN_BROWSER: &str = "Other piles with the same settings show how far one pile is from their mean. In a \
                               browser one thread computes, so only the program runs other piles.";

/// The ensembles of the visible simulations (runs with the same settings from other initial states), with the threads
/// that compute them.
#[derive(Default)]
pub struct Ensemble {
    /// Folder in which the computed initial states are stored; `None` if the user has no folder for such files.
    pub(super) folder: Option<PathBuf>,
    /// The open scene as the window loaded it. The field `piles` describes the other initial states: the same pile made
    /// from other seeds.
    opened: Option<Arc<LiveStart>>,
    piles: Vec<NewPile>,
    pool: Option<WorkerPool>,
    /// Settings of runs that the user has started, each with the slumps of runs with these settings from other initial
    /// states. These results can be compared, because all of them belong to one scene and one set of initial states,
    /// which `kind` describes.
    released: Vec<Released>,
    kind: Option<PileKind>,
}

/// Properties of a scene on which the slumps of runs from other initial states depend, apart from the settings. Results
/// of two scenes can be compared if these properties are equal.
#[derive(PartialEq)]
struct PileKind {
    scene: String,
    duration_secs: f64,
    base_width: Option<f64>,
    piles: Vec<NewPile>,
    /// The open pile, if the results are those of this pile.
    own: Option<NewPile>,
}

impl Ensemble {
    /// Returns an ensemble without runs, which will store its initial states in the user's cache folder.
    pub(crate) fn new() -> Self {
        let folder = user_folder("XDG_CACHE_HOME", ".cache").map(|folder| folder.join("piles"));
        Self { folder, ..Self::default() }
    }

    /// Changes the folder in which the computed initial states are stored.
    pub fn keep_in(&mut self, folder: PathBuf) {
        self.stop();
        self.folder = Some(folder);
    }

    /// Ends all threads that compute runs from other initial states. Keeps the results of started runs (`released`) as
    /// they were when the window drew its last frame.
    pub fn stop(&mut self) {
        self.pool = None;
    }

    /// True if runs from other initial states can be computed: the open scene was made from a seed and is not too
    /// large, and there are idle cores and a folder for initial states.
    pub(super) fn is_possible(&self) -> bool {
        self.folder.is_some() && idle_cores() > 0 && !self.piles.is_empty()
    }

    /// Number of threads that compute runs from other initial states.
    pub fn threads(&self) -> usize {
        self.pool.as_ref().map_or(0, WorkerPool::threads)
    }

    /// Starts or continues the threads that compute runs from other initial states, with the settings of the
    /// simulations in `frame`, the newest data from the solver's thread. If `is_wanted` is false, stops all threads.
    pub(super) fn follow(&mut self, context: &egui::Context, frame: &LiveFrame, is_wanted: bool) {
        let address = |opened: &Option<Arc<LiveStart>>| opened.as_ref().map(Arc::as_ptr);
        if address(&self.opened) != address(&frame.start) {
            self.stop();
            self.piles = frame.start.as_ref().map_or_else(Vec::new, |opened| others_of(opened));
            self.opened.clone_from(&frame.start);
            self.note_kind();
        }
        let all = frame.worlds.iter().map(|world| {
            let is_from_the_start = world.recorded_from_secs == 0.0;
            (world.is_even && is_from_the_start).then_some(world.controls.settings)
        });
        let all: Vec<_> = all.collect();
        self.note_released(frame, &all);
        if !self.is_possible() {
            return self.note_own_slumps(frame, &all);
        }
        if !is_wanted {
            return self.stop();
        }
        let Self { folder: Some(folder), opened: Some(opened), piles, pool, released, .. } = self
        else {
            return;
        };
        let pool =
            pool.get_or_insert_with(|| WorkerPool::start(folder, context, opened, piles, released));
        pool.follow(all, released);
    }

    /// Discards the settings and results of started runs if they belong to another scene, another duration, another
    /// width of the base under the grains, or other initial states than the open scene. Keeps them if the open scene
    /// has no other initial states.
    fn note_kind(&mut self) {
        let Some(opened) = self.opened.as_ref().filter(|_| !self.piles.is_empty()) else { return };
        let kind = Some(PileKind {
            scene: opened.scene.name.clone(),
            duration_secs: opened.scene.duration_secs,
            base_width: opened.config.source.base_width,
            piles: self.piles.clone(),
            own: if self.is_possible() { None } else { pile_of(opened) },
        });
        if self.kind != kind {
            self.released.clear();
            self.kind = kind;
        }
    }

    /// Stores the settings of the simulations in `frame` (data from the solver's thread) that the user has started
    /// (that have taken a step). `all` contains the settings of each simulation, or `None` if it has no ensemble (runs
    /// from other initial states).
    fn note_released(&mut self, frame: &LiveFrame, all: &[Option<Settings>]) {
        for (world, settings) in frame.worlds.iter().zip(all) {
            if let Some(settings) = settings
                && world.recorded_secs > 0.0
                && !self.piles.is_empty()
                && !self.released.iter().any(|(own, _)| own == settings)
            {
                self.released.push((*settings, Arc::default()));
            }
        }
    }

    /// Stores the slump of each visible run that has reached the end of the scene, because no other piles are computed.
    fn note_own_slumps(&mut self, frame: &LiveFrame, all: &[Option<Settings>]) {
        let end_secs = self.kind.as_ref().map_or(f64::INFINITY, |kind| kind.duration_secs);
        for (world, settings) in frame.worlds.iter().zip(all) {
            let Some(row) = world.curve.last() else { continue };
            let mut released = self.released.iter_mut();
            if row.time_secs + 0.5 * row.time_step_secs >= end_secs
                && let Some((_, band)) = released.find(|(own, _)| Some(*own) == *settings)
                && band.count == 0
            {
                *band = Arc::new(Band::of(&[(0, &vec![[row.time_secs, row.slump]])]));
            }
        }
    }

    /// Removes the settings and results of all started runs from `released`, and so clears the plot of slump against
    /// Δt. When the window draws its next frame, it adds the visible runs again, with their results if the threads that
    /// compute runs from other initial states still have them. All other runs are lost.
    pub(super) fn forget_released(&mut self) {
        self.released.clear();
    }

    /// Returns the settings of the runs that the user has started, each with the slumps of runs with these settings
    /// from other initial states. Settings of a visible run are omitted until this run has reached the end of the
    /// scene, and all settings until two other runs have ended. If no other runs can be computed, the result is the
    /// slump of the run itself.
    pub(crate) fn released(&self, frame: &LiveFrame) -> impl Iterator<Item = &Released> {
        let end_secs = self.kind.as_ref().map_or(f64::INFINITY, |kind| kind.duration_secs);
        let is_on_its_way = move |settings: &Settings| {
            frame.worlds.iter().any(|world| {
                let next_secs = world.recorded_secs + settings.parameters.time_step_secs;
                world.controls.settings == *settings && next_secs <= end_secs
            })
        };
        let is_open = !self.piles.is_empty();
        let least = if self.is_possible() { 2 } else { 1 };
        let is_shown = move |(settings, band): &&Released| {
            is_open && band.count >= least && !is_on_its_way(settings)
        };
        self.released.iter().filter(is_shown)
    }

    /// Returns the slumps of runs with the given settings from other initial states; `None` if no started run has these
    /// settings.
    pub(crate) fn band(&self, settings: &Settings) -> Option<&Arc<Band>> {
        let mut released = self.released.iter().filter(|_| !self.piles.is_empty());
        released.find(|(own, _)| own == settings).map(|(_, band)| band)
    }

    /// Returns a sentence that compares the mean slumps of runs from other initial states at the simulated time
    /// `time_secs`, s, under two settings: `before` and `after`. `None` if no started run has one of these settings, or
    /// if fewer than [`LEAST_COUNT`] initial states ran under both.
    pub(crate) fn effect(
        &self,
        before: &Settings,
        after: &Settings,
        time_secs: f64,
    ) -> Option<String> {
        let paired = self.band(before)?.paired(self.band(after)?, time_secs)?;
        Some(format!("{}: {}", change_text(before, after), effect(&paired, self.piles.len())?))
    }

    /// Returns a text that explains the ensemble of a simulation (runs with its settings from other initial states) and
    /// lists the seeds of these initial states.
    pub(crate) fn about(&self, world: usize) -> String {
        let Some(summary) = self.summary(world) else {
            return if IN_BROWSER { RULE_IN_BROWSER } else { RULE }.into();
        };
        let EnsembleSummary { seeds, failed, .. } = summary;
        let all: Vec<String> = seeds.iter().map(u64::to_string).collect();
        let mut text = format!("{RULE}\nSeeds {}.", all.join(", "));
        if failed > 0 {
            text += &format!(" {failed} of the runs failed and are left out.");
        }
        text
    }

    /// Returns as text the mean slump of runs from other initial states with the settings of a simulation, at the
    /// displayed simulated time. `None` if the simulation has no such runs.
    pub(crate) fn said(&self, frame: &LiveFrame, world: usize) -> Option<String> {
        let row = frame.worlds.get(world)?.snapshot.observables;
        Some(said(&self.summary(world)?, row.time_secs))
    }

    /// Returns the mean slump, at a simulated time (s), of runs from other initial states with the settings of a
    /// simulation; then half the width of its 95 % confidence interval, and the number of runs. `None` if no run has a
    /// value at this time.
    pub fn mean_at(&self, world: usize, time_secs: f64) -> Option<(f64, f64, usize)> {
        let band = self.summary(world)?.band;
        let (mean, half) = band.at(time_secs)?;
        Some((mean, half, band.count))
    }

    /// Returns the results so far of runs from other initial states with the settings of a simulation; `None` if the
    /// simulation has no such runs.
    pub(crate) fn summary(&self, world: usize) -> Option<EnsembleSummary> {
        self.pool.as_ref()?.summary(world)
    }
}

/// Returns a text with the mean slump before and after a change of settings, and the mean difference, all three over
/// the same initial states. `planned` is the number of initial states that will be computed. `None` if there are fewer
/// than [`LEAST_COUNT`] so far.
fn effect([before, after, difference]: &[Mean; 3], planned: usize) -> Option<String> {
    const WORDS: [&str; 9] = ["no", "one", "two", "three", "four", "five", "six", "seven", "eight"];
    let count = difference.count;
    if count < LEAST_COUNT {
        return None;
    }
    let piles = match WORDS.get(count).filter(|_| count == planned) {
        Some(word) => format!("{word} piles"),
        None => format!("{count} of {planned} piles"),
    };
    let said = |mean: &Mean| {
        let half = mean.high - mean.mean;
        let decimals = if half >= 0.01 { 2 } else { 3 };
        format!("{:.decimals$} ± {half:.decimals$}", mean.mean).replace('-', "−")
    };
    let [before, after, difference] = [before, after, difference].map(said);
    Some(format!("slump {before} → {after}, {piles} each; difference {difference} (paired)"))
}

/// Returns a text with the mean slump of runs from other initial states at a simulated time, s, and the number of these
/// runs; without a mean, a text that states the reason.
fn said(summary: &EnsembleSummary, time_secs: f64) -> String {
    let (planned, count) = (summary.seeds.len() - summary.failed, summary.band.count);
    let mean = summary.band.at(time_secs);
    let of = if count < planned { format!("{count} of {planned}") } else { count.to_string() };
    match (mean, summary.settling) {
        (Some(_), _) if time_secs == 0.0 => format!("other piles: {of} computed"),
        (Some((mean, half)), _) if half.is_finite() => {
            format!("other piles {mean:.3} ± {half:.3} (n = {of})")
        }
        (Some((mean, _)), _) => format!("other piles {mean:.3} (n = {of})"),
        (None, _) if count > 0 => "other piles end earlier".into(),
        (None, Some(number)) => {
            format!("other piles: making pile {number} of {}", summary.seeds.len())
        }
        (None, None) => "other piles: none yet".into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn told(slumps: &[f64], settling: Option<usize>) -> EnsembleSummary {
        let runs: Vec<_> = slumps.iter().map(|&slump| vec![[0.0, 0.0], [1.0, slump]]).collect();
        EnsembleSummary {
            band: Arc::new(Band::of(&runs.iter().enumerate().collect::<Vec<_>>())),
            seeds: vec![1, 2, 3],
            failed: 0,
            settling,
        }
    }

    #[test]
    fn the_effect_of_a_change_is_a_sentence() {
        let band = |slumps: &[f64]| Band::clone(&told(slumps, None).band);
        let settings = Settings::default().with_bond(20.0);
        let released = [(1e-3, [0.2, 0.3, 0.25]), (1e-4, [0.4, 0.42, 0.41])];
        let released =
            released.map(|(secs, slumps)| (settings.over(secs), Arc::new(band(&slumps))));
        let piles = vec![NewPile::default(); 3];
        let mut ensemble = Ensemble { released: released.into(), piles, ..Ensemble::default() };
        let said =
            |ensemble: &Ensemble| ensemble.effect(&settings.over(1e-3), &settings.over(1e-4), 1.0);
        let sentence = "Δt 1 ms → 0.1 ms: slump 0.25 ± 0.12 → 0.41 ± 0.02, three piles each; \
                        difference 0.16 ± 0.10 (paired)";
        assert_eq!(said(&ensemble).as_deref(), Some(sentence));
        assert_eq!(
            ensemble.effect(&settings.over(1e-3), &settings.over(5e-3), 1.0),
            None,
            "never released"
        );
        ensemble.piles.push(NewPile::default());
        assert!(said(&ensemble).is_some_and(|said| said.contains(", 3 of 4 piles each;")));
        ensemble.released[1].1 = Arc::new(band(&[0.4, 0.42]));
        assert_eq!(said(&ensemble), None, "two piles have no interval");
    }

    #[test]
    fn numbers_come_with_their_interval_and_how_many_piles_they_are_of() {
        // Tables: t(0.975; 2) = 4.302653, and the standard error of 0.2, 0.3, 0.4 is 0.1/√3.
        assert_eq!(said(&told(&[0.2, 0.3, 0.4], None), 1.0), "other piles 0.300 ± 0.248 (n = 3)");
        assert_eq!(said(&told(&[0.3, 0.3], None), 1.0), "other piles 0.300 (n = 2 of 3)");
        assert_eq!(said(&told(&[0.3; 3], None), 1.0), "other piles 0.300 ± 0.000 (n = 3)");
        assert_eq!(said(&told(&[0.25], None), 1.0), "other piles 0.250 (n = 1 of 3)");
        assert_eq!(said(&told(&[], Some(2)), 0.0), "other piles: making pile 2 of 3");
        assert_eq!(said(&told(&[], None), 0.0), "other piles: none yet");
        assert_eq!(said(&told(&[0.25], None), 9.0), "other piles end earlier");
        assert_eq!(said(&told(&[0.25], None), 0.0), "other piles: 1 of 3 computed");
    }
}
