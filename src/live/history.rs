//! The history of a live run: the records of its worlds (simulations side by side), and the earlier runs. The computed
//! steps are kept if the user resets the run, starts other worlds, or changes something at an earlier simulated time.

use std::sync::Arc;
use std::time::Duration;

use rayon::iter::{IntoParallelRefMutIterator, ParallelIterator};
use serde::{Deserialize, Serialize};

use super::stored_moments::{STORED_BYTES, StoredMoments};
use super::{Controls, Curve, LiveOptions, LoadingProgress, Tell, WorldHistory};
use crate::Instant;
use crate::error::{Result, check};
use crate::sim::{Edit, Settings, Simulation, Snapshot, Tally};

/// Largest number of earlier runs. If there are more, the oldest run is dropped. A larger number takes more memory.
const MOST_PAST: usize = 50;
/// Number of newest earlier runs that keep many keyframes (copies of the state). Older runs keep at most two keyframes
/// per simulation. They are dropped if all earlier runs have more memory of keyframes than the present run may have.
const NEWEST: usize = 4;
/// Divisor: each newest earlier run gets 1/8 of the present run's memory for keyframes (copies of the state).
const PART_OF_PAST: usize = 8;
/// Largest memory for keyframes (copies of the state) of the present run in a history that is sent or saved, bytes.
const KEYFRAME_BYTES: usize = 8 << 20;
/// Largest memory for keyframes (copies of the state) of each earlier run in a history that is sent or saved, bytes.
const PAST_KEYFRAME_BYTES: usize = 1 << 20;
/// Largest number of rows (observables after one step) of the present run in a history that is sent or saved.
const ROWS: usize = 4096;
/// Largest number of rows (observables after one step) of each earlier run in a history that is sent or saved.
const PAST_ROWS: usize = 512;
/// Longest wall-clock time between two looks for commands during a tick (one step of the simulation with the longest
/// time step). A simulation with a far shorter time step takes thousands of steps in a tick.
const SLICE: Duration = Duration::from_millis(50);
/// Number of steps of each simulation between two reports of progress. With more steps, the user can cancel only later.
const STEPS_AT_ONCE: u64 = 8;

/// A run: worlds (simulations) side by side that are kept at the same simulated time. The world with the largest time
/// step leads. Each other world follows to within half of its own time step.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct LiveRun {
    #[serde(rename = "tracks")]
    pub worlds: Vec<WorldHistory>,
    /// Number by which the window selects an earlier run.
    #[serde(skip)]
    number: u64,
    /// Simulated time that every simulation reaches in a tick (a step of the one with the longest time step), s.
    #[serde(skip)]
    goal_secs: Option<f64>,
}

/// Applies `act` to all simulations, in parallel if there are several. Returns true if all calls return true.
fn each(
    worlds: &mut [WorldHistory],
    act: impl Fn(&mut WorldHistory) -> bool + Send + Sync,
) -> bool {
    match worlds {
        [world] => act(world),
        worlds => worlds.par_iter_mut().map(act).reduce(|| true, |one, other| one && other),
    }
}

impl LiveRun {
    pub(super) fn settings(&self) -> Vec<Settings> {
        self.worlds.iter().map(|world| *world.simulation.settings()).collect()
    }

    /// True if later steps are recorded, but the next step does not repeat them, because it has other settings.
    pub(super) fn branches(&self) -> bool {
        self.worlds.iter().any(WorldHistory::branches)
    }

    /// True if the next step repeats a step that is already recorded.
    pub(super) fn replays(&self) -> bool {
        let replays = |world: &WorldHistory| world.record.replays(&world.simulation);
        !self.branches() && self.worlds.iter().any(replays)
    }

    /// True if snapshots of the steps after the present state are stored and can be shown without computing.
    pub(super) fn is_stored(&self) -> bool {
        self.worlds.iter().all(|world| world.stored.go_on_from(world.steps()))
    }

    pub(super) fn has_failed(&self) -> bool {
        self.worlds.iter().any(|world| world.failure.is_some())
    }

    /// Limits the keyframes (copies of the state) of all simulations together to about `budget_bytes` bytes, and their
    /// stored snapshots to [`STORED_BYTES`].
    fn keep_within(&mut self, budget_bytes: usize) {
        let count = self.worlds.len().max(1);
        for world in &mut self.worlds {
            world.record.keep_within(budget_bytes / count);
            world.stored.keep_within(STORED_BYTES / count);
        }
    }

    fn leader(&self) -> Option<&WorldHistory> {
        self.worlds.iter().reduce(|best, next| {
            if next.time_step_secs() > best.time_step_secs() { next } else { best }
        })
    }

    pub(super) fn time_secs(&self) -> f64 {
        self.leader().map_or(0.0, |world| world.simulation.time_secs())
    }

    pub(super) fn time_step_secs(&self) -> f64 {
        self.leader().map_or(0.0, WorldHistory::time_step_secs)
    }

    /// Simulated time of the last recorded step of the simulation with the largest time step, s.
    pub(super) fn recorded_secs(&self) -> f64 {
        self.leader().map_or(0.0, |world| world.record.end_secs())
    }

    /// Approximate memory of the keyframes (copies of the state) of all simulations, bytes.
    fn bytes(&self) -> usize {
        self.worlds.iter().map(|world| world.record.bytes()).sum()
    }

    fn steps(&self) -> u64 {
        self.worlds.iter().map(WorldHistory::steps).sum()
    }

    /// Takes one step of the simulation with the largest time step, and the steps that bring the other simulations to
    /// the same simulated time. If this takes longer than [`SLICE`], the next call continues. Returns the number of
    /// steps of all simulations in this call, and true if all of them succeeded.
    pub(super) fn tick(&mut self) -> (u64, bool) {
        let steps_before = self.steps();
        let goal_secs = self.goal_secs.take();
        let goal_secs = goal_secs.unwrap_or_else(|| self.time_secs() + self.time_step_secs());
        let until = Instant::now() + SLICE;
        let all_well = match self.worlds.as_mut_slice() {
            [world] => world.step(),
            worlds => each(worlds, |world| world.catch_up(goal_secs, until)),
        };
        let lags = self.worlds.len() > 1 && self.worlds.iter().any(|it| it.is_before(goal_secs));
        self.goal_secs = (lags && all_well).then_some(goal_secs);
        (self.steps() - steps_before, all_well)
    }

    /// True while a tick (a step of the simulation with the longest time step) has begun but is not finished.
    pub(super) fn is_on_its_way(&self) -> bool {
        self.goal_secs.is_some()
    }

    pub(super) fn seek(&mut self, time_secs: f64) {
        self.goal_secs = None;
        self.worlds.iter_mut().for_each(|world| world.seek(time_secs));
    }

    /// Takes one step of a jump to a recorded time in each simulation. Returns true if all simulations have arrived.
    pub(super) fn advance_seek(&mut self) -> bool {
        each(&mut self.worlds, WorldHistory::advance_seek)
    }

    /// Copy of the run for the window or a file, with at most `bytes` bytes of stored states and `rows` plotted steps.
    fn thinned(&self, bytes: usize, rows: usize) -> Self {
        let mut run = Self { worlds: Vec::new(), ..self.clone() };
        run.worlds = self.worlds.iter().map(WorldHistory::handed_out).collect();
        run.keep_within(bytes);
        run.worlds.iter_mut().for_each(|world| world.curve.thin_to(rows));
        run
    }
}

/// Returns the freed memory of a run to the operating system. With GNU's allocator each thread keeps its freed memory:
/// after a hundred runs of some tens of MiB, a window occupied several times the memory in use.
fn return_freed_memory() {
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    // SAFETY: `malloc_trim` changes no memory in use, and any thread may call it at any time.
    unsafe {
        libc::malloc_trim(0);
    }
}

/// Summary of an earlier run for display.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct PastRun {
    /// Number by which the window selects the run ([`Command::Return`](super::Command::Return)).
    pub number: u64,
    /// True if the user went back from this run to an earlier run, so that this run can be redone.
    pub is_undone: bool,
    /// Simulated time of the last recorded step of the run, s.
    pub recorded_secs: f64,
    /// The worlds (simulations side by side) of the run.
    pub worlds: Vec<PastWorld>,
}

/// Summary of one world (simulation) of an earlier run.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct PastWorld {
    /// The controls (settings and pull of a grain) of the world's next step.
    pub controls: Controls,
    /// Observables (measured quantities) after each recorded step of the run, for plots.
    pub curve: Curve,
}

impl PastRun {
    fn new(run: &LiveRun, is_undone: bool) -> Self {
        let of_world = |world: &WorldHistory| PastWorld {
            controls: Controls::of(&world.simulation),
            curve: world.curve.clone(),
        };
        let ends = run.worlds.iter().map(|world| world.record.end_secs());
        Self {
            number: run.number,
            is_undone,
            recorded_secs: ends.fold(0.0, f64::max),
            worlds: run.worlds.iter().map(of_world).collect(),
        }
    }
}

/// All data that a live run has computed: the present simulations with their records, and the earlier runs. A run can
/// be continued from its history, and each of its past states can be computed again.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RunHistory {
    #[serde(rename = "worlds")]
    pub(super) present: LiveRun,
    /// Earlier runs, the oldest first.
    past: Vec<LiveRun>,
    /// Runs from which the user went back. The last one is the next to be redone.
    undone: Vec<LiveRun>,
    /// Summaries of the earlier runs for display.
    #[serde(skip)]
    told: Arc<[PastRun]>,
    /// Number of runs that have become earlier runs so far. The newest of these runs has this number.
    #[serde(skip)]
    count: u64,
    #[serde(skip)]
    recording_bytes: usize,
}

/// A simulation to be computed ([`RunHistory::computed`]): its settings, their changes, and its number of steps.
#[derive(Clone, Debug, PartialEq)]
pub struct WorldPlan {
    /// Settings of the first step.
    pub settings: Settings,
    /// Changes of the settings in order of time. Each change has the number of the step after which it takes effect.
    pub changes: Vec<(u64, Settings)>,
    /// Number of steps of the simulation.
    pub steps: u64,
}

impl RunHistory {
    /// Returns a history without simulations. `recording_bytes` is the memory for keyframes (copies of states), bytes.
    pub(super) fn new(recording_bytes: usize) -> Self {
        Self { recording_bytes, ..Self::default() }
    }

    /// Replaces this history by `other`.
    pub(super) fn take_up(&mut self, other: Self) {
        self.clear();
        for run in other.past {
            self.keep(run);
        }
        self.undone = other.undone.into_iter().filter_map(|run| self.kept(run)).collect();
        self.tell();
        self.present = other.present;
        self.present.keep_within(self.recording_bytes);
        return_freed_memory();
    }

    pub(super) fn clear(&mut self) {
        self.present = LiveRun::default();
        self.past.clear();
        self.undone.clear();
        self.tell();
    }

    /// Starts one simulation from the state `start` for each of the settings `all`. The previous run is kept.
    pub(super) fn restart(&mut self, start: &Simulation, tally: Tally, all: &[Settings]) {
        let world =
            |settings: &Settings| WorldHistory::new(start, tally, settings, self.recording_bytes);
        let worlds = all.iter().map(world).collect();
        let mut run = LiveRun { worlds, ..LiveRun::default() };
        run.keep_within(self.recording_bytes);
        let before = std::mem::replace(&mut self.present, run);
        self.keep(before);
        return_freed_memory();
    }

    /// Goes back to the earlier run of this number, or forward to the undone run of this number. The runs between them
    /// and the present run are kept in their order. Returns false if no run has this number.
    pub(super) fn go_to(&mut self, number: u64) -> bool {
        let has = |runs: &[LiveRun]| runs.iter().any(|run| run.number == number);
        let is_back = has(&self.past);
        if !is_back && !has(&self.undone) {
            return false;
        }
        while self.present.number != number {
            let next = if is_back { self.past.pop() } else { self.undone.pop() };
            let Some(next) = next else { break };
            let before = std::mem::replace(&mut self.present, next);
            let before = self.kept(before);
            if is_back { self.undone.extend(before) } else { self.past.extend(before) }
        }
        self.present.keep_within(self.recording_bytes);
        self.limit();
        self.tell();
        return_freed_memory();
        true
    }

    /// Keeps a copy of the present run if the next step, with changed settings, will replace recorded later steps.
    pub(super) fn keep_before_tick(&mut self) {
        if self.present.branches() {
            let mut before = self.present.clone();
            // The recorded steps had other settings than the steps that branch off.
            for world in &mut before.worlds {
                world.record.restore_controls(&mut world.simulation);
            }
            self.keep_copy(before);
        }
    }

    /// Applies a user's edit (for example, a moved grain) to a simulation. If later steps were already recorded, the
    /// run before the edit is kept as an earlier run.
    pub(super) fn edit(&mut self, world: usize, edit: Edit) -> Result<()> {
        let Some(edited) = self.present.worlds.get(world) else { return Ok(()) };
        let branches = edited.record.is_before_end(&edited.simulation);
        let before = branches.then(|| self.present.clone());
        self.present.worlds[world].edit(edit)?;
        before.into_iter().for_each(|before| self.keep_copy(before));
        Ok(())
    }

    /// Makes `before`, the run before a change, an earlier run. The present run becomes a new run.
    fn keep_copy(&mut self, before: LiveRun) {
        self.keep(before);
        self.present.number = 0;
    }

    /// Snapshots of the newest earlier run, one per simulation, each the last stored snapshot up to the simulated time
    /// `secs`, s. The list is empty if a simulation has no such snapshot.
    pub(super) fn ghosts(&self, secs: f64) -> Vec<Arc<Snapshot>> {
        let worlds = self.past.last().map_or(&[][..], |run| &run.worlds);
        let snapshots =
            worlds.iter().map(|world| Some(Arc::clone(&world.stored.at(secs)?.snapshot)));
        snapshots.collect::<Option<_>>().unwrap_or_default()
    }

    /// Keeps a run as the newest earlier run. Undone runs (from which the user went back) also become earlier runs.
    fn keep(&mut self, run: LiveRun) {
        self.past.extend(self.undone.drain(..).rev());
        let run = self.kept(run);
        self.past.extend(run);
        self.limit();
        self.tell();
    }

    /// Gives a run a number and limits its memory, so that it can be kept. `None` if the run has no recorded step.
    fn kept(&mut self, mut run: LiveRun) -> Option<LiveRun> {
        if !run.worlds.iter().any(|world| world.record.has_steps()) {
            return None;
        }
        run.keep_within(self.recording_bytes / PART_OF_PAST);
        let bytes = STORED_BYTES / PART_OF_PAST / run.worlds.len();
        run.worlds.iter_mut().for_each(|world| world.stored.keep_within(bytes));
        if run.number == 0 {
            self.count += 1;
            run.number = self.count;
        }
        Some(run)
    }

    /// Limits the memory of all runs but the present one. Only the newest earlier run keeps its stored snapshots.
    fn limit(&mut self) {
        let older = self.past.len().saturating_sub(1);
        let older = self.past[..older].iter_mut().chain(&mut self.undone);
        let worlds = older.flat_map(|run| &mut run.worlds);
        worlds.for_each(|world| world.stored = StoredMoments::default());
        let old = self.past.len().saturating_sub(NEWEST);
        for run in &mut self.past[..old] {
            run.keep_within(0);
            run.worlds.iter_mut().for_each(|world| world.curve.thin_to(PAST_ROWS));
        }
        let mut bytes: usize = self.past.iter().map(LiveRun::bytes).sum();
        while self.past.len() > MOST_PAST
            || (self.past.len() > NEWEST && bytes > self.recording_bytes)
        {
            bytes -= self.past.remove(0).bytes();
        }
    }

    /// Summaries for display: the earlier runs, the newest last, then the undone runs (from which the user went back),
    /// starting with the next one to redo.
    pub(super) fn told(&self) -> Arc<[PastRun]> {
        Arc::clone(&self.told)
    }

    fn tell(&mut self) {
        let past = self.past.iter().map(|run| PastRun::new(run, false));
        let undone = self.undone.iter().rev().map(|run| PastRun::new(run, true));
        self.told = past.chain(undone).collect();
    }

    /// Copy of the history for the window or a file: fewer stored states and plotted steps, no failed earlier runs.
    pub(super) fn thinned(&self) -> Self {
        let thinned = |runs: &[LiveRun]| {
            let kept = runs.iter().filter(|run| !run.has_failed());
            kept.map(|run| run.thinned(PAST_KEYFRAME_BYTES, PAST_ROWS)).collect()
        };
        Self {
            present: self.present.thinned(KEYFRAME_BYTES, ROWS),
            past: thinned(&self.past),
            undone: thinned(&self.undone),
            ..Self::default()
        }
    }

    /// Computes simulations in parallel, one for each of `plans`, from the state `start`. `tally` contains sums (such
    /// as unsolved steps) over the steps before `start`. `tell` receives the progress and returns false to cancel.
    ///
    /// # Errors
    /// If a setting is invalid, or if the computation is cancelled.
    pub fn computed(
        start: &Simulation,
        tally: Tally,
        plans: &[WorldPlan],
        tell: Tell<'_>,
    ) -> Result<Self> {
        let bytes = LiveOptions::default().recording_bytes / plans.len().max(1);
        let mut planned = Vec::with_capacity(plans.len());
        for plan in plans {
            start.clone().change(plan.settings)?;
            planned.push((WorldHistory::new(start, tally, &plan.settings, bytes), plan));
        }
        let all = plans.iter().map(|plan| plan.steps).fold(0, u64::saturating_add);
        loop {
            let goes_on = planned.par_iter_mut().map(|(world, plan)| advance(world, plan));
            let goes_on = goes_on.try_reduce(|| false, |one, other| Ok(one || other))?;
            let taken: u64 = planned.iter().map(|(world, _)| world.steps()).sum();
            let part = taken as f32 / all.max(1) as f32;
            let text = format!("Computing the run of the link: {taken} of {all} steps");
            if !goes_on {
                break;
            }
            let is_wanted = tell(LoadingProgress { part, text, preview: None });
            check(is_wanted, "link", "given up", "computed to its end")?;
        }
        let worlds = planned.into_iter().map(|(world, _)| world).collect();
        Ok(Self { present: LiveRun { worlds, ..LiveRun::default() }, ..Self::default() })
    }

    /// The worlds (simulations side by side) of the present run.
    pub fn worlds(&self) -> &[WorldHistory] {
        &self.present.worlds
    }

    /// True if a history that was read from a file is consistent: each run has a world, and all records are consistent.
    pub fn is_sound(&self) -> bool {
        let is_sound = |run: &LiveRun| {
            !run.worlds.is_empty() && run.worlds.iter().all(|world| world.record.is_sound())
        };
        is_sound(&self.present) && self.past.iter().chain(&self.undone).all(is_sound)
    }

    /// The reason why one of the present simulations cannot continue; `None` if all can continue.
    pub fn failure(&self) -> Option<&str> {
        self.present.worlds.iter().find_map(|world| world.failure.as_deref())
    }
}

/// Takes up to [`STEPS_AT_ONCE`] steps of the simulation that `plan` describes. Returns true if more steps remain.
fn advance(world: &mut WorldHistory, plan: &WorldPlan) -> Result<bool> {
    for _ in 0..STEPS_AT_ONCE {
        let step = world.steps();
        if let Some((_, settings)) = plan.changes.iter().find(|(after, _)| *after == step) {
            world.simulation.change(*settings)?;
        }
        if step >= plan.steps || !world.step() {
            return Ok(false);
        }
    }
    Ok(true)
}
