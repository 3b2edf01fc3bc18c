//! Worker threads that compute the ensemble (runs from other initial states), with the jobs that wait, run or have
//! finished.

use std::path::{Path, PathBuf};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};

use super::runs::{Band, SlumpSeries, scene_of, slump};
use crate::error::{Error, Result};
use crate::live::LiveStart;
use crate::output::check_writable;
use crate::scene::{NewPile, Settling};
use crate::sim::Settings;
use crate::study::settled_pile;
use crate::world::Grain;

/// Number of cores that the threads of the ensemble (runs from other initial states) do not use. One core is for the
/// visible run. On systems where this program cannot lower the priority of a thread, one more core is for the window,
/// which would otherwise have to wait for these threads.
const LEFT: usize = if cfg!(any(target_os = "linux", windows)) { 1 } else { 2 };

/// Returns the number of cores that are idle while a simulation runs in the window. On a machine with one core it is 0.
pub(super) fn idle_cores() -> usize {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    cores.saturating_sub(LEFT)
}

/// Gives the calling thread the lowest priority, so that other threads come first. On Linux each thread has its own
/// priority, and the process `None` (id 0) means the calling thread (setpriority(2), "C library/kernel differences").
fn give_way() {
    #[cfg(target_os = "linux")]
    {
        const NICEST: i32 = 19;
        // If the system refuses, the thread shares its core at normal priority.
        let _ = rustix::process::setpriority_process(None, NICEST);
    }
    #[cfg(windows)]
    {
        use windows_sys::Win32::System::Threading::{
            GetCurrentThread, SetThreadPriority, THREAD_PRIORITY_IDLE,
        };
        // SAFETY: the handle is a constant for the calling thread and must not be closed.
        unsafe { SetThreadPriority(GetCurrentThread(), THREAD_PRIORITY_IDLE) };
    }
}

/// Runs `work` on as many threads as there are idle cores, at least one, with the lowest priority.
pub(in crate::app) fn on_idle_cores<T: Send>(work: impl FnOnce() -> Result<T> + Send) -> Result<T> {
    let builder = rayon::ThreadPoolBuilder::new().num_threads(idle_cores().max(1));
    let pool = builder.start_handler(|_| give_way()).build();
    let refuse = |error| Error::value("threads", error, "threads that can be made");
    pool.map_err(refuse)?.install(work)
}

/// A job of a thread that computes runs from other initial states than that of the visible run: piles made from other
/// seeds. The number in a job is the index of its pile in the list of these piles.
#[derive(Clone, Copy, PartialEq)]
enum PileJob {
    /// Deposit the pile with this index: let its grains fall into the box and come to rest.
    Settle(usize),
    /// Simulate the pile with this index from its initial state to the end of the scene, with these settings.
    Run(usize, Settings),
}

/// State or result of a job.
enum JobState {
    Underway,
    Settled(Vec<Grain>),
    Ran(SlumpSeries),
    Failed,
}

/// Results of runs from other initial states with the settings of one simulation.
#[derive(Clone, Debug)]
pub(crate) struct EnsembleSummary {
    /// Slumps of the piles whose runs have finished.
    pub band: Arc<Band>,
    pub seeds: Vec<u64>,
    pub failed: usize,
    /// Number (from 1) of the pile that is being deposited.
    pub settling: Option<usize>,
}

/// Settings of a run that the user has started, and the slumps of runs with these settings from other initial states.
pub(crate) type Released = (Settings, Arc<Band>);

/// The waiting, running and finished jobs of the threads that compute runs from other initial states.
#[derive(Default)]
struct Jobs {
    /// Settings of each visible simulation; `None` for a simulation without runs from other initial states, for example
    /// because its settings changed during the run.
    worlds: Vec<Option<Settings>>,
    /// Settings of all runs that the user has started. Runs from other initial states with these settings are computed
    /// after those with the settings of the visible simulations.
    released: Vec<Settings>,
    begun: Vec<(PileJob, JobState)>,
    /// Slumps of finished runs, by their settings.
    bands: Vec<Released>,
    is_over: bool,
}

impl Jobs {
    fn state(&self, job: PileJob) -> Option<&JobState> {
        self.begun.iter().find(|(begun, _)| *begun == job).map(|(_, state)| state)
    }

    fn is_under_way(&self, job: PileJob) -> bool {
        !self.is_over && matches!(self.state(job), Some(JobState::Underway))
    }

    /// Marks the next job as running and returns it with the grains of its pile. Jobs with the settings of visible
    /// simulations come first, then jobs with the settings of earlier runs, the newest run first.
    fn next(&mut self, piles: usize) -> Option<(PileJob, Vec<Grain>)> {
        let worlds = self.worlds.iter().copied().flatten().collect();
        let earlier = self.released.iter().rev().map(|&settings| vec![settings]);
        let mut groups = std::iter::once(worlds).chain(earlier);
        let next = groups.find_map(|settings| self.next_of(&settings, piles))?;
        self.begun.push((next.0, JobState::Underway));
        Some(next)
    }

    /// Returns the next job for these settings. Each pile is run with all settings before the next pile is begun, so
    /// that the results under all settings are from the same piles.
    fn next_of(&self, settings: &[Settings], piles: usize) -> Option<(PileJob, Vec<Grain>)> {
        if settings.is_empty() {
            return None;
        }
        (0..piles).find_map(|pile| match self.state(PileJob::Settle(pile)) {
            None => Some((PileJob::Settle(pile), Vec::new())),
            Some(JobState::Settled(grains)) => {
                let mut runs = settings.iter().map(|&settings| PileJob::Run(pile, settings));
                runs.find(|&run| self.state(run).is_none()).map(|run| (run, grains.clone()))
            }
            Some(_) => None,
        })
    }

    /// Stores `state` as the new state of a running job; does nothing if the job was cancelled. After a finished run,
    /// computes the mean slump of all runs with the same settings again.
    fn note(&mut self, job: PileJob, state: JobState) {
        if !self.is_under_way(job) {
            return;
        }
        let is_run = matches!(state, JobState::Ran(_));
        if let Some(begun) = self.begun.iter_mut().find(|(begun, _)| *begun == job) {
            begun.1 = state;
        }
        if let PileJob::Run(_, settings) = job
            && is_run
        {
            let done = self.begun.iter().filter_map(|(job, state)| match (job, state) {
                (PileJob::Run(pile, own), JobState::Ran(series)) if *own == settings => {
                    Some((*pile, series))
                }
                _ => None,
            });
            let band = Arc::new(Band::of(&done.collect::<Vec<_>>()));
            self.bands.retain(|(own, _)| *own != settings);
            self.bands.push((settings, band));
        }
    }
}

/// State that the window shares with the threads that compute runs from other initial states.
struct PoolState {
    opened: Arc<LiveStart>,
    piles: Vec<NewPile>,
    folder: PathBuf,
    context: egui::Context,
    jobs: Mutex<Jobs>,
    news: Condvar,
}

/// The worker threads that compute runs from other initial states. When this value is dropped, the threads end after
/// their present step.
pub(super) struct WorkerPool {
    state: Arc<PoolState>,
    // Each thread runs one loop and ends when this loop ends.
    threads: Vec<rayon::ThreadPool>,
}

impl WorkerPool {
    /// Starts one thread per idle core. The initial states `piles` are stored in `folder` after their deposition. When
    /// a thread has a result, it requests a new frame from `context`. Results that `released` contains are not computed
    /// again.
    pub(super) fn start(
        folder: &Path,
        context: &egui::Context,
        opened: &Arc<LiveStart>,
        piles: &[NewPile],
        released: &[Released],
    ) -> Self {
        let mut jobs = Jobs { bands: released.to_vec(), ..Jobs::default() };
        for (settings, band) in released {
            let begun = |(pile, series): &(usize, SlumpSeries)| {
                (PileJob::Run(*pile, *settings), JobState::Ran(series.clone()))
            };
            jobs.begun.extend(band.runs.iter().map(begun));
        }
        let state = Arc::new(PoolState {
            opened: Arc::clone(opened),
            piles: piles.to_vec(),
            folder: folder.to_owned(),
            context: context.clone(),
            jobs: Mutex::new(jobs),
            news: Condvar::new(),
        });
        // Each rayon pool has one thread, so that the parallel parts of a solver stay on this thread, which has low
        // priority.
        let thread = |_| {
            let builder = rayon::ThreadPoolBuilder::new().num_threads(1);
            let builder = builder.thread_name(|_| "other piles".into()).panic_handler(|_| {});
            let thread = builder.start_handler(|_| give_way()).build().ok()?;
            let state = Arc::clone(&state);
            thread.spawn(move || state.work());
            Some(thread)
        };
        let threads = (0..idle_cores()).filter_map(thread).collect();
        Self { state, threads }
    }

    /// Copies the slumps of finished runs to the entries of `released` with the same settings. Gives the threads their
    /// jobs: runs from other initial states, first with the settings of the visible simulations (`worlds`), then with
    /// the settings in `released`. Discards the results with all other settings.
    pub(super) fn follow(&self, worlds: Vec<Option<Settings>>, released: &mut [Released]) {
        let mut jobs = self.state.lock();
        for (settings, band) in released.iter_mut() {
            if let Some((_, newer)) = jobs.bands.iter().find(|(own, _)| own == settings) {
                band.clone_from(newer);
            }
        }
        let released: Vec<_> = released.iter().map(|(settings, _)| *settings).collect();
        if (&jobs.worlds, &jobs.released) == (&worlds, &released) {
            return;
        }
        let is_wanted =
            |settings: &Settings| worlds.contains(&Some(*settings)) || released.contains(settings);
        jobs.begun.retain(|(job, _)| match job {
            PileJob::Settle(_) => true,
            PileJob::Run(_, settings) => is_wanted(settings),
        });
        jobs.bands.retain(|(settings, _)| is_wanted(settings));
        (jobs.worlds, jobs.released) = (worlds, released);
        self.state.news.notify_all();
    }

    /// Returns the results of runs from other initial states with the settings of a simulation; `None` if the
    /// simulation has no such runs.
    pub(super) fn summary(&self, world: usize) -> Option<EnsembleSummary> {
        let (jobs, piles) = (self.state.lock(), &self.state.piles);
        let settings = (*jobs.worlds.get(world)?)?;
        let has_failed = |job| matches!(jobs.state(job), Some(JobState::Failed));
        let failed = |&pile: &usize| {
            has_failed(PileJob::Settle(pile)) || has_failed(PileJob::Run(pile, settings))
        };
        let settles =
            |pile: &usize| matches!(jobs.state(PileJob::Settle(*pile)), Some(JobState::Underway));
        let band = jobs.bands.iter().find(|(own, _)| *own == settings);
        Some(EnsembleSummary {
            band: band.map(|(_, band)| Arc::clone(band)).unwrap_or_default(),
            seeds: piles.iter().map(|pile| pile.seed).collect(),
            failed: (0..piles.len()).filter(failed).count(),
            settling: (0..piles.len()).find(settles).map(|pile| pile + 1),
        })
    }

    /// Number of worker threads.
    pub(super) fn threads(&self) -> usize {
        self.threads.len()
    }
}

impl Drop for WorkerPool {
    fn drop(&mut self) {
        self.state.lock().is_over = true;
        self.state.news.notify_all();
    }
}

impl PoolState {
    fn lock(&self) -> MutexGuard<'_, Jobs> {
        self.jobs.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Main loop of a worker thread: takes and performs jobs until the window has dropped the worker threads.
    fn work(&self) {
        while let Some((job, grains)) = self.next() {
            self.context.request_repaint();
            let came_to = match job {
                PileJob::Settle(pile) => {
                    let goes_on = |_: Settling| self.lock().is_under_way(job);
                    let settled = check_writable("cache folder", &self.folder)
                        .and_then(|()| settled_pile(&self.folder, &self.piles[pile], goes_on));
                    Some(settled.map_or(JobState::Failed, JobState::Settled))
                }
                PileJob::Run(pile, settings) => {
                    let scene = scene_of(&self.opened, &self.piles[pile], grains, &settings);
                    let goes_on = || self.lock().is_under_way(job);
                    let ran = scene.and_then(|scene| slump(&scene, goes_on));
                    ran.map_or(Some(JobState::Failed), |series| series.map(JobState::Ran))
                }
            };
            // If a run was cancelled, another thread may have begun the same run again in the meantime.
            came_to.into_iter().for_each(|state| self.lock().note(job, state));
            self.news.notify_all();
            self.context.request_repaint();
        }
    }

    /// Waits for the next job and returns it with the grains of its pile. Returns `None` if the window has dropped the
    /// worker threads.
    fn next(&self) -> Option<(PileJob, Vec<Grain>)> {
        let mut jobs = self.lock();
        while !jobs.is_over {
            if let Some(next) = jobs.next(self.piles.len()) {
                return Some(next);
            }
            jobs = self.news.wait(jobs).unwrap_or_else(PoisonError::into_inner);
        }
        None
    }
}

#[cfg(target_os = "linux")]
#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_thread_gives_way_and_the_others_stay() {
        let nice = || rustix::process::getpriority_process(None).unwrap();
        let before = nice();
        let lowest = std::thread::spawn(move || {
            give_way();
            nice()
        });
        assert_eq!(lowest.join().unwrap(), 19);
        assert_eq!(nice(), before);
    }
}
