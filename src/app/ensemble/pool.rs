//! The pool of worker threads that runs the ensemble: what is to be done, what is under way, and what has come of it.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use super::runs::{Band, SlumpSeries, scene_of, settled_part, slump};
use crate::app::opening::Opened;
use crate::error::Result;
use crate::output::check_writable;
use crate::scene::{NewPile, Settling};
use crate::sim::Settings;
use crate::study::settled_pile;
use crate::world::Grain;

/// Whoever has taken a task looks now and then whether nobody wants it any more.
pub(super) type Ticket = Arc<AtomicBool>;

/// What one thread is to do next.
pub(super) enum Task {
    /// Let a pile settle.
    Settle { pile: NewPile, ticket: Ticket },
    /// Run one with the settings of a world.
    Run {
        opened: Arc<Opened>,
        pile: NewPile,
        grains: Vec<Grain>,
        settings: Settings,
        ticket: Ticket,
    },
}

/// How far something has come.
enum TaskState<T> {
    Waiting,
    Underway(Ticket),
    Done(T),
    Failed,
}

impl<T> TaskState<T> {
    fn is_of(&self, ticket: &Ticket) -> bool {
        matches!(self, Self::Underway(own) if Arc::ptr_eq(own, ticket))
    }

    fn done(&self) -> Option<&T> {
        if let Self::Done(result) = self { Some(result) } else { None }
    }

    fn begin(&mut self) -> Ticket {
        let ticket = Ticket::default();
        *self = Self::Underway(Arc::clone(&ticket));
        ticket
    }

    fn end(&mut self, result: Option<T>) {
        *self = result.map_or(Self::Failed, Self::Done);
    }

    fn cancel(&self) {
        if let Self::Underway(ticket) = self {
            ticket.store(true, Ordering::Relaxed);
        }
    }
}

/// The runs of one world's settings.
struct EnsembleWorld {
    /// None where the world has no others.
    settings: Option<Settings>,
    runs: Vec<TaskState<Arc<SlumpSeries>>>,
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
pub(super) struct Tasks {
    opened: Arc<Opened>,
    piles: Vec<(NewPile, TaskState<Vec<Grain>>)>,
    /// How far those have come that are under way.
    parts: Vec<f32>,
    worlds: Vec<EnsembleWorld>,
}

impl Tasks {
    /// Those of what is open, with no world yet.
    pub(super) fn new(opened: Arc<Opened>, piles: Vec<NewPile>) -> Self {
        let parts = vec![0.0; piles.len()];
        let piles = piles.into_iter().map(|pile| (pile, TaskState::Waiting)).collect();
        Self { opened, piles, parts, worlds: Vec::new() }
    }

    /// Has worlds with these settings. What was computed for others is forgotten.
    pub(super) fn follow(&mut self, worlds: &[Option<Settings>]) {
        let mut before = std::mem::take(&mut self.worlds);
        for &settings in worlds {
            let same = before.iter().position(|world| world.settings == settings);
            let world = same.map_or_else(
                || EnsembleWorld {
                    settings,
                    runs: self.piles.iter().map(|_| TaskState::Waiting).collect(),
                    band: Arc::default(),
                },
                |index| before.swap_remove(index),
            );
            self.worlds.push(world);
        }
        before.iter().flat_map(|world| &world.runs).for_each(TaskState::cancel);
    }

    /// Has nobody go on with anything.
    pub(super) fn cancel(&self) {
        self.piles.iter().for_each(|(_, stage)| stage.cancel());
        self.worlds.iter().flat_map(|world| &world.runs).for_each(TaskState::cancel);
    }

    /// What is to be done next: pile by pile, each for all worlds, so that all have as many.
    pub(super) fn next(&mut self) -> Option<Task> {
        if self.worlds.iter().all(|world| world.settings.is_none()) {
            return None;
        }
        for (index, (pile, stage)) in self.piles.iter_mut().enumerate() {
            if matches!(stage, TaskState::Waiting) {
                self.parts[index] = 0.0;
                return Some(Task::Settle { pile: pile.clone(), ticket: stage.begin() });
            }
            let Some(grains) = stage.done() else { continue };
            for EnsembleWorld { settings, runs, .. } in &mut self.worlds {
                if let (Some(settings), TaskState::Waiting) = (*settings, &runs[index]) {
                    let (opened, pile) = (Arc::clone(&self.opened), pile.clone());
                    let (grains, ticket) = (grains.clone(), runs[index].begin());
                    return Some(Task::Run { opened, pile, grains, settings, ticket });
                }
            }
        }
        None
    }

    /// Notes how far a pile has come.
    pub(super) fn note_part(&mut self, ticket: &Ticket, part: f32) {
        if let Some(index) = self.piles.iter().position(|(_, stage)| stage.is_of(ticket)) {
            self.parts[index] = self.parts[index].max(part);
        }
    }

    /// Notes that a pile has settled, or that it cannot.
    pub(super) fn note_pile(&mut self, ticket: &Ticket, grains: Option<Vec<Grain>>) {
        let Some(index) = self.piles.iter().position(|(_, stage)| stage.is_of(ticket)) else {
            return;
        };
        if grains.is_none() {
            self.worlds.iter_mut().for_each(|world| world.runs[index] = TaskState::Failed);
        }
        self.piles[index].1.end(grains);
    }

    /// Notes that a run has come to its end, or that it cannot.
    pub(super) fn note_run(&mut self, ticket: &Ticket, series: Option<SlumpSeries>) {
        let of_ticket = |world: &&mut EnsembleWorld| world.runs.iter().any(|run| run.is_of(ticket));
        let Some(world) = self.worlds.iter_mut().find(of_ticket) else { return };
        if let Some(run) = world.runs.iter_mut().find(|run| run.is_of(ticket)) {
            run.end(series.map(Arc::new));
        }
        let done: Vec<Arc<SlumpSeries>> =
            world.runs.iter().filter_map(TaskState::done).cloned().collect();
        world.band = Arc::new(Band::of(&done));
    }

    /// What is said of a world's others; nothing where it has none.
    pub(super) fn told(&self, world: usize) -> Option<EnsembleSummary> {
        let EnsembleWorld { settings, runs, band } = self.worlds.get(world)?;
        (*settings)?;
        let underway =
            |(_, stage): &(NewPile, TaskState<_>)| matches!(stage, TaskState::Underway(_));
        let settling = self.piles.iter().position(underway);
        Some(EnsembleSummary {
            band: Arc::clone(band),
            seeds: self.piles.iter().map(|(pile, _)| pile.seed).collect(),
            failed: runs.iter().filter(|run| matches!(run, TaskState::Failed)).count(),
            settling: settling.map(|index| (index + 1, self.parts[index])),
        })
    }
}

/// Least time between two looks of the window at how far a pile has come.
const PROGRESS_INTERVAL: Duration = Duration::from_millis(250);

/// Threads at work. Dropped, they end after the step that they are computing.
pub(super) struct WorkerPool {
    shared: Arc<PoolState>,
    // Their threads end when the work that they were given does.
    pools: Vec<rayon::ThreadPool>,
}

/// What the threads and the window share.
struct PoolState {
    folder: PathBuf,
    context: egui::Context,
    started: Instant,
    /// Until when there is work to be done, ms since the start: what stands still for long is not computed for.
    awake_until_ms: AtomicU64,
    work: Mutex<Jobs>,
    news: Condvar,
}

struct Jobs {
    tasks: Tasks,
    is_over: bool,
}

impl WorkerPool {
    /// Starts so many threads. Initial states are kept in `folder`; `context` is asked for a frame where there is
    /// something new.
    pub(super) fn start(
        threads: usize,
        folder: &Path,
        context: &egui::Context,
        tasks: Tasks,
    ) -> Self {
        let shared = Arc::new(PoolState {
            folder: folder.to_owned(),
            context: context.clone(),
            started: Instant::now(),
            awake_until_ms: AtomicU64::new(0),
            work: Mutex::new(Jobs { tasks, is_over: false }),
            news: Condvar::new(),
        });
        // A pool of one thread each: what a method does in parallel stays on it, below all others.
        let pool = |_| {
            let builder = rayon::ThreadPoolBuilder::new().num_threads(1);
            let builder = builder.thread_name(|_| "other piles".into()).panic_handler(|_| {});
            let pool = builder.start_handler(|_| give_way()).build().ok()?;
            let shared = Arc::clone(&shared);
            pool.spawn(move || shared.work());
            Some(pool)
        };
        let pools = (0..threads).filter_map(pool).collect();
        Self { shared, pools }
    }

    /// Has worlds with these settings.
    pub(super) fn follow(&self, worlds: &[Option<Settings>]) {
        self.shared.lock().tasks.follow(worlds);
    }

    /// What is said of the others of a world.
    pub(super) fn told(&self, world: usize) -> Option<EnsembleSummary> {
        self.shared.lock().tasks.told(world)
    }

    /// Has the threads work for that long, unless they are told so again.
    pub(super) fn keep_awake(&self, duration: Duration) {
        let until = (self.shared.started.elapsed() + duration).as_millis() as u64;
        // Under the lock, so that no thread goes to sleep between its look and the news.
        let _work = self.shared.lock();
        self.shared.awake_until_ms.store(until, Ordering::Relaxed);
        self.shared.news.notify_all();
    }

    /// Number of threads.
    pub(super) fn threads(&self) -> usize {
        self.pools.len()
    }
}

impl Drop for WorkerPool {
    fn drop(&mut self) {
        let mut work = self.shared.lock();
        work.is_over = true;
        work.tasks.cancel();
        self.shared.news.notify_all();
    }
}

impl PoolState {
    fn lock(&self) -> MutexGuard<'_, Jobs> {
        self.work.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// What a thread does until all is over.
    fn work(&self) {
        while let Some(task) = self.next() {
            match task {
                Task::Settle { pile, ticket } => {
                    let settled = self.settle(&pile, &ticket);
                    self.lock().tasks.note_pile(&ticket, settled.ok());
                }
                Task::Run { opened, pile, grains, settings, ticket } => {
                    let scene = scene_of(&opened, &pile, grains, &settings);
                    let ran = scene.and_then(|scene| slump(&scene, || self.goes_on(&ticket)));
                    if let Some(series) = ran.transpose() {
                        self.lock().tasks.note_run(&ticket, series.ok());
                    }
                }
            }
            self.context.request_repaint();
        }
    }

    fn is_awake(&self) -> bool {
        let now = self.started.elapsed().as_millis() as u64;
        now < self.awake_until_ms.load(Ordering::Relaxed)
    }

    /// The next task, once there is one; nothing where all is over.
    fn next(&self) -> Option<Task> {
        let mut work = self.lock();
        loop {
            if work.is_over {
                return None;
            }
            if let Some(task) = self.is_awake().then(|| work.tasks.next()).flatten() {
                return Some(task);
            }
            work = self.news.wait(work).unwrap_or_else(PoisonError::into_inner);
        }
    }

    /// Whether a task is still wanted. Waits where nothing is to be done for the time being.
    fn goes_on(&self, ticket: &Ticket) -> bool {
        while !ticket.load(Ordering::Relaxed) {
            if self.is_awake() {
                return true;
            }
            let work = self.lock();
            // Who cancels a task alone does not tell: hence the second.
            let waited = self.news.wait_timeout(work, Duration::from_secs(1));
            drop(waited.unwrap_or_else(PoisonError::into_inner));
        }
        false
    }

    fn settle(&self, pile: &NewPile, ticket: &Ticket) -> Result<Vec<Grain>> {
        check_writable("cache folder", &self.folder)?;
        let mut told: Option<Instant> = None;
        settled_pile(&self.folder, pile, |settling: Settling| {
            if told.is_none_or(|at| at.elapsed() >= PROGRESS_INTERVAL) {
                told = Some(Instant::now());
                self.lock().tasks.note_part(ticket, settled_part(&settling));
                self.context.request_repaint();
            }
            self.goes_on(ticket)
        })
    }
}

/// Cores that are left to what is in front.
#[cfg(target_os = "linux")]
const LEFT: usize = 1;
/// Where the system is not asked for a lower priority, another one for the window.
#[cfg(not(target_os = "linux"))]
const LEFT: usize = 2;

/// How many cores are idle while a world runs: none where there is one.
pub(super) fn idle_cores() -> usize {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    cores.saturating_sub(LEFT)
}

/// Gives the thread that calls it the lowest priority. On Linux a priority is a thread's own, and that of the
/// "process" None is that of the calling thread (setpriority(2), "C library/kernel differences").
#[cfg(target_os = "linux")]
pub(super) fn give_way() {
    const NICEST: i32 = 19;
    // Where it is refused, the thread shares its core as any other would.
    let _ = rustix::process::setpriority_process(None, NICEST);
}

#[cfg(not(target_os = "linux"))]
pub(super) fn give_way() {}

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
