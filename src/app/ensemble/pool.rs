//! The pool of worker threads that runs the ensemble: what is to be done, what is under way, and what has come of it.

use std::path::{Path, PathBuf};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use super::runs::{Band, SlumpSeries, scene_of, slump};
use crate::app::opening::{Opened, settled_part};
use crate::error::Result;
use crate::output::check_writable;
use crate::scene::{NewPile, Settling};
use crate::sim::Settings;
use crate::study::settled_pile;
use crate::world::Grain;

/// Least time between two looks of the window at how far a pile has come.
const PROGRESS_INTERVAL: Duration = Duration::from_millis(250);
/// Cores that are left to what is in front; where the system is not asked for a lower priority, another one for the
/// window.
const LEFT: usize = if cfg!(target_os = "linux") { 1 } else { 2 };

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
}

/// How far something has come.
enum JobState<T> {
    Waiting,
    /// Whoever does it has this number, and has come so far, 0 … 1.
    Underway(u64, f32),
    Done(T),
    Failed,
}

impl<T> JobState<T> {
    fn is_of(&self, ticket: u64) -> bool {
        matches!(self, Self::Underway(own, _) if *own == ticket)
    }

    fn done(&self) -> Option<&T> {
        if let Self::Done(result) = self { Some(result) } else { None }
    }

    fn end(&mut self, result: Option<T>) {
        *self = result.map_or(Self::Failed, Self::Done);
    }
}

/// The runs of one world's settings.
struct EnsembleWorld {
    /// None where the world has no others.
    settings: Option<Settings>,
    runs: Vec<JobState<Arc<SlumpSeries>>>,
    band: Arc<Band>,
}

/// What is said of the other piles of a world.
#[derive(Clone, Debug)]
pub(crate) struct EnsembleSummary {
    /// Of those that have come to their end.
    pub band: Arc<Band>,
    /// The seeds of all of them.
    pub seeds: Vec<u64>,
    /// How many of them failed.
    pub failed: usize,
    /// The pile that settles at present, from 1, and how far it has come, 0 … 1.
    pub settling: Option<(usize, f32)>,
}

/// All that is to be done for what is open.
struct Jobs {
    opened: Arc<Opened>,
    piles: Vec<(NewPile, JobState<Vec<Grain>>)>,
    worlds: Vec<EnsembleWorld>,
    /// Counts what was begun.
    tickets: u64,
    /// Until when there is work to be done: what stands still for long is not computed for.
    awake_until: Instant,
    is_over: bool,
}

/// What one thread is to do next.
enum Job {
    /// Let a pile settle.
    Settle(NewPile),
    /// Run one with the settings of a world.
    Run { opened: Arc<Opened>, pile: NewPile, grains: Vec<Grain>, settings: Settings },
}

impl Jobs {
    /// Has worlds with these settings. What was computed for others is forgotten.
    fn follow(&mut self, worlds: &[Option<Settings>]) {
        let mut before = std::mem::take(&mut self.worlds);
        for &settings in worlds {
            let same = before.iter().position(|world| world.settings == settings);
            let fresh = || EnsembleWorld {
                settings,
                runs: self.piles.iter().map(|_| JobState::Waiting).collect(),
                band: Arc::default(),
            };
            self.worlds.push(same.map_or_else(fresh, |index| before.swap_remove(index)));
        }
    }

    /// What is to be done next: pile by pile, each for all worlds, so that all have as many.
    fn next(&mut self) -> Option<(Job, u64)> {
        if self.worlds.iter().all(|world| world.settings.is_none()) {
            return None;
        }
        let ticket = self.tickets + 1;
        let job = self.piles.iter_mut().enumerate().find_map(|(index, (pile, state))| {
            if matches!(state, JobState::Waiting) {
                *state = JobState::Underway(ticket, 0.0);
                return Some(Job::Settle(pile.clone()));
            }
            let grains = state.done()?;
            self.worlds.iter_mut().find_map(|EnsembleWorld { settings, runs, .. }| {
                let settings = (*settings)?;
                if !matches!(runs[index], JobState::Waiting) {
                    return None;
                }
                runs[index] = JobState::Underway(ticket, 0.0);
                let (opened, pile) = (Arc::clone(&self.opened), pile.clone());
                Some(Job::Run { opened, pile, grains: grains.clone(), settings })
            })
        })?;
        self.tickets = ticket;
        Some((job, ticket))
    }

    fn pile_of(&mut self, ticket: u64) -> Option<usize> {
        self.piles.iter().position(|(_, state)| state.is_of(ticket))
    }

    /// Whether somebody still wants what has that number.
    fn is_wanted(&self, ticket: u64) -> bool {
        let mut runs = self.worlds.iter().flat_map(|world| &world.runs);
        !self.is_over
            && (self.piles.iter().any(|(_, state)| state.is_of(ticket))
                || runs.any(|run| run.is_of(ticket)))
    }

    /// Notes how far a pile has come.
    fn note_part(&mut self, ticket: u64, now: f32) {
        for (_, state) in &mut self.piles {
            if let JobState::Underway(own, part) = state
                && *own == ticket
            {
                *part = part.max(now);
            }
        }
    }

    /// Notes that a pile has settled, or that it cannot.
    fn note_pile(&mut self, ticket: u64, grains: Option<Vec<Grain>>) {
        let Some(index) = self.pile_of(ticket) else { return };
        if grains.is_none() {
            self.worlds.iter_mut().for_each(|world| world.runs[index] = JobState::Failed);
        }
        self.piles[index].1.end(grains);
    }

    /// Notes that a run has come to its end, or that it cannot.
    fn note_run(&mut self, ticket: u64, series: Option<SlumpSeries>) {
        for world in &mut self.worlds {
            if let Some(run) = world.runs.iter_mut().find(|run| run.is_of(ticket)) {
                run.end(series.map(Arc::new));
                let done: Vec<_> = world.runs.iter().filter_map(JobState::done).cloned().collect();
                world.band = Arc::new(Band::of(&done));
                return;
            }
        }
    }

    /// What is said of a world's others; nothing where it has none.
    fn summary(&self, world: usize) -> Option<EnsembleSummary> {
        let EnsembleWorld { settings, runs, band } = self.worlds.get(world)?;
        (*settings)?;
        let mut states = self.piles.iter().map(|(_, state)| state).enumerate();
        Some(EnsembleSummary {
            band: Arc::clone(band),
            seeds: self.piles.iter().map(|(pile, _)| pile.seed).collect(),
            failed: runs.iter().filter(|run| matches!(run, JobState::Failed)).count(),
            settling: states.find_map(|(index, state)| match state {
                JobState::Underway(_, part) => Some((index + 1, *part)),
                _ => None,
            }),
        })
    }
}

/// What the threads and the window share.
struct PoolState {
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
    /// there is something new.
    pub(super) fn start(
        folder: &Path,
        context: &egui::Context,
        opened: &Arc<Opened>,
        piles: &[NewPile],
    ) -> Self {
        let jobs = Jobs {
            opened: Arc::clone(opened),
            piles: piles.iter().map(|pile| (pile.clone(), JobState::Waiting)).collect(),
            worlds: Vec::new(),
            tickets: 0,
            awake_until: Instant::now(),
            is_over: false,
        };
        let state = Arc::new(PoolState {
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

    /// Has worlds with these settings.
    pub(super) fn follow(&self, worlds: &[Option<Settings>]) {
        self.state.lock().follow(worlds);
    }

    /// What is said of the others of a world.
    pub(super) fn summary(&self, world: usize) -> Option<EnsembleSummary> {
        self.state.lock().summary(world)
    }

    /// Has the threads work for that long, unless they are told so again.
    pub(super) fn keep_awake(&self, duration: Duration) {
        self.state.lock().awake_until = Instant::now() + duration;
        self.state.news.notify_all();
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

    fn wait<'a>(&self, jobs: MutexGuard<'a, Jobs>) -> MutexGuard<'a, Jobs> {
        self.news.wait(jobs).unwrap_or_else(PoisonError::into_inner)
    }

    /// What a thread does until all is over.
    fn work(&self) {
        while let Some((job, ticket)) = self.next() {
            match job {
                Job::Settle(pile) => {
                    let settled = self.settle(&pile, ticket);
                    self.lock().note_pile(ticket, settled.ok());
                }
                Job::Run { opened, pile, grains, settings } => {
                    let scene = scene_of(&opened, &pile, grains, &settings);
                    let ran = scene.and_then(|scene| slump(&scene, || self.goes_on(ticket)));
                    if let Some(series) = ran.transpose() {
                        self.lock().note_run(ticket, series.ok());
                    }
                }
            }
            self.context.request_repaint();
        }
    }

    /// The next job, once there is one; nothing where all is over.
    fn next(&self) -> Option<(Job, u64)> {
        let mut jobs = self.lock();
        while !jobs.is_over {
            let is_awake = Instant::now() < jobs.awake_until;
            if let Some(next) = is_awake.then(|| jobs.next()).flatten() {
                return Some(next);
            }
            jobs = self.wait(jobs);
        }
        None
    }

    /// Whether a job is still wanted. Waits where nothing is to be done for the time being.
    fn goes_on(&self, ticket: u64) -> bool {
        let mut jobs = self.lock();
        while jobs.is_wanted(ticket) {
            if Instant::now() < jobs.awake_until {
                return true;
            }
            jobs = self.wait(jobs);
        }
        false
    }

    fn settle(&self, pile: &NewPile, ticket: u64) -> Result<Vec<Grain>> {
        check_writable("cache folder", &self.folder)?;
        let mut told: Option<Instant> = None;
        settled_pile(&self.folder, pile, |settling: Settling| {
            if told.is_none_or(|at| at.elapsed() >= PROGRESS_INTERVAL) {
                told = Some(Instant::now());
                self.lock().note_part(ticket, settled_part(&settling) as f32);
                self.context.request_repaint();
            }
            self.goes_on(ticket)
        })
    }
}

#[cfg(all(test, target_os = "linux"))]
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
