//! The pool of worker threads that runs the ensemble: what is to be done, what is under way, and what has come of it.

use std::path::{Path, PathBuf};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use super::runs::{Band, SlumpSeries, scene_of, slump};
use crate::Instant;
use crate::app::settling_progress::settled_part;
use crate::error::{Error, Result};
use crate::live::LiveStart;
use crate::output::check_writable;
use crate::scene::{NewPile, Settling};
use crate::sim::Settings;
use crate::study::settled_pile;
use crate::world::Grain;

/// Least time between two looks of the window at how far a pile has come.
const PROGRESS_INTERVAL: Duration = Duration::from_millis(250);
/// Cores that are left to what is in front; where the system is not asked for a lower priority, another one for the
/// window.
const LEFT: usize = if cfg!(any(target_os = "linux", windows)) { 1 } else { 2 };

/// How many cores are idle while a world runs: none where there is one.
pub(super) fn idle_cores() -> usize {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    cores.saturating_sub(LEFT)
}

/// Gives the thread that calls it the lowest priority. On Linux a priority is a thread's own, and that of the
/// "process" None is that of the calling thread (setpriority(2), "C library/kernel differences").
fn give_way() {
    #[cfg(target_os = "linux")]
    {
        const NICEST: i32 = 19;
        // Where it is refused, the thread shares its core as any other would.
        let _ = rustix::process::setpriority_process(None, NICEST);
    }
    #[cfg(windows)]
    {
        use windows_sys::Win32::System::Threading::{
            GetCurrentThread, SetThreadPriority, THREAD_PRIORITY_IDLE,
        };
        // SAFETY: the handle stands for the calling thread, and needs no closing.
        unsafe { SetThreadPriority(GetCurrentThread(), THREAD_PRIORITY_IDLE) };
    }
}

/// Does work on as many threads as there are idle cores, one at least, below all others.
pub(in crate::app) fn on_idle_cores<T: Send>(work: impl FnOnce() -> Result<T> + Send) -> Result<T> {
    let builder = rayon::ThreadPoolBuilder::new().num_threads(idle_cores().max(1));
    let pool = builder.start_handler(|_| give_way()).build();
    let refuse = |error| Error::value("threads", error, "threads that can be made");
    pool.map_err(refuse)?.install(work)
}

/// What a thread does with a pile, by the pile's place among the others.
#[derive(Clone, Copy, PartialEq)]
enum PileJob {
    /// Let it settle.
    Settle(usize),
    /// Run it with the settings of a world.
    Run(usize, Settings),
}

/// How far a job has come.
enum JobState {
    /// A part, 0 … 1.
    Underway(f32),
    Settled(Vec<Grain>),
    Ran(SlumpSeries),
    Failed,
}

/// What is said of the other piles of a world.
#[derive(Clone, Debug)]
pub(crate) struct EnsembleSummary {
    /// Of those that have come to their end.
    pub band: Arc<Band>,
    pub seeds: Vec<u64>,
    pub failed: usize,
    /// The pile that settles at present, from 1, and how far it has come, 0 … 1.
    pub settling: Option<(usize, f32)>,
}

/// Settings of a pile that was released, and the runs of its other piles.
pub(crate) type Released = (Settings, Arc<Band>);

/// What is to be done, and what was begun.
#[derive(Default)]
struct Jobs {
    /// None where a world has no others.
    worlds: Vec<Option<Settings>>,
    /// Settings of all piles that were released. Their runs wait for those of the worlds.
    released: Vec<Settings>,
    begun: Vec<(PileJob, JobState)>,
    /// Of runs that have come to their end, by their settings.
    bands: Vec<Released>,
    is_over: bool,
}

impl Jobs {
    fn state(&self, job: PileJob) -> Option<&JobState> {
        self.begun.iter().find(|(begun, _)| *begun == job).map(|(_, state)| state)
    }

    fn is_under_way(&self, job: PileJob) -> bool {
        !self.is_over && matches!(self.state(job), Some(JobState::Underway(_)))
    }

    /// Begins the next job: first those of the worlds, then those of earlier settings, the newest first. With it come
    /// the grains that are to run.
    fn next(&mut self, piles: usize) -> Option<(PileJob, Vec<Grain>)> {
        let worlds = self.worlds.iter().copied().flatten().collect();
        let earlier = self.released.iter().rev().map(|&settings| vec![settings]);
        let mut groups = std::iter::once(worlds).chain(earlier);
        let next = groups.find_map(|settings| self.next_of(&settings, piles))?;
        self.begun.push((next.0, JobState::Underway(0.0)));
        Some(next)
    }

    /// The next job of some settings: pile by pile, each for all of these settings, so that all have as many.
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

    /// Notes how far a job has come, where it is still wanted.
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

/// What the threads and the window share.
struct PoolState {
    opened: Arc<LiveStart>,
    piles: Vec<NewPile>,
    folder: PathBuf,
    context: egui::Context,
    jobs: Mutex<Jobs>,
    news: Condvar,
}

/// Threads at work. Dropped, they end after the step that they are computing.
pub(super) struct WorkerPool {
    state: Arc<PoolState>,
    // Their threads end when the work that they were given does.
    threads: Vec<rayon::ThreadPool>,
}

impl WorkerPool {
    /// Starts a thread for each idle core. Initial states are kept in `folder`; `context` is asked for a frame where
    /// there is something new. The runs of `released` are not computed again.
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
        // A pool of one thread each: what a method does in parallel stays on it, below all others.
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

    /// Computes for worlds with these settings, then for released piles with these settings. Forgets the runs of all
    /// other settings.
    pub(super) fn follow(&self, worlds: Vec<Option<Settings>>, released: Vec<Settings>) {
        let mut jobs = self.state.lock();
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

    /// Notes the runs that have come to their end.
    pub(super) fn note_runs(&self, released: &mut [Released]) {
        let jobs = self.state.lock();
        for (settings, band) in released {
            if let Some((_, newer)) = jobs.bands.iter().find(|(own, _)| own == settings) {
                band.clone_from(newer);
            }
        }
    }

    /// What is said of the others of a world; nothing where it has none.
    pub(super) fn summary(&self, world: usize) -> Option<EnsembleSummary> {
        let (jobs, piles) = (self.state.lock(), &self.state.piles);
        let settings = (*jobs.worlds.get(world)?)?;
        let has_failed = |job| matches!(jobs.state(job), Some(JobState::Failed));
        let failed = |&pile: &usize| {
            has_failed(PileJob::Settle(pile)) || has_failed(PileJob::Run(pile, settings))
        };
        let settling = |pile| match jobs.state(PileJob::Settle(pile)) {
            Some(JobState::Underway(part)) => Some((pile + 1, *part)),
            _ => None,
        };
        let band = jobs.bands.iter().find(|(own, _)| *own == settings);
        Some(EnsembleSummary {
            band: band.map(|(_, band)| Arc::clone(band)).unwrap_or_default(),
            seeds: piles.iter().map(|pile| pile.seed).collect(),
            failed: (0..piles.len()).filter(failed).count(),
            settling: (0..piles.len()).find_map(settling),
        })
    }

    /// Number of threads.
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

    /// What a thread does until all is over.
    fn work(&self) {
        while let Some((job, grains)) = self.next() {
            let came_to = match job {
                PileJob::Settle(pile) => {
                    let settled = self.settle(job, &self.piles[pile]);
                    Some(settled.map_or(JobState::Failed, JobState::Settled))
                }
                PileJob::Run(pile, settings) => {
                    let scene = scene_of(&self.opened, &self.piles[pile], grains, &settings);
                    let goes_on = || self.lock().is_under_way(job);
                    let ran = scene.and_then(|scene| slump(&scene, goes_on));
                    ran.map_or(Some(JobState::Failed), |series| series.map(JobState::Ran))
                }
            };
            // A run that was given up may have been begun by another thread since.
            came_to.into_iter().for_each(|state| self.lock().note(job, state));
            self.news.notify_all();
            self.context.request_repaint();
        }
    }

    /// The next job, once there is one; nothing where all is over.
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

    fn settle(&self, job: PileJob, pile: &NewPile) -> Result<Vec<Grain>> {
        check_writable("cache folder", &self.folder)?;
        let mut told: Option<Instant> = None;
        settled_pile(&self.folder, pile, |settling: Settling| {
            if told.is_none_or(|at| at.elapsed() >= PROGRESS_INTERVAL) {
                told = Some(Instant::now());
                let part = settled_part(&settling) as f32;
                self.lock().note(job, JobState::Underway(part));
                self.context.request_repaint();
            }
            self.lock().is_under_way(job)
        })
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
