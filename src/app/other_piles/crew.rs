//! The threads that do it.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use super::lowest::give_way;
use super::part::{settled_part, slump};
use super::piles::scene_of;
use super::tasks::{Task, Tasks, Ticket, Told};
use crate::error::Result;
use crate::output::check_writable;
use crate::scene::{NewPile, Settling};
use crate::sim::Settings;
use crate::study::settled_pile;
use crate::world::Grain;

/// Least time between two looks of the window at how far a pile has come.
const PROGRESS_INTERVAL: Duration = Duration::from_millis(250);

/// Threads at work. Dropped, they end after the step that they are computing.
pub(super) struct Crew {
    shared: Arc<Shared>,
    // Their threads end when the work that they were given does.
    pools: Vec<rayon::ThreadPool>,
}

/// What the threads and the window share.
struct Shared {
    folder: PathBuf,
    context: egui::Context,
    started: Instant,
    /// Until when there is work to be done, ms since the start: what stands still for long is not computed for.
    awake_until_ms: AtomicU64,
    work: Mutex<Work>,
    news: Condvar,
}

struct Work {
    tasks: Tasks,
    is_over: bool,
}

impl Crew {
    /// Starts so many threads. Initial states are kept in `folder`; `context` is asked for a frame where there is
    /// something new.
    pub(super) fn start(
        threads: usize,
        folder: &Path,
        context: &egui::Context,
        tasks: Tasks,
    ) -> Self {
        let shared = Arc::new(Shared {
            folder: folder.to_owned(),
            context: context.clone(),
            started: Instant::now(),
            awake_until_ms: AtomicU64::new(0),
            work: Mutex::new(Work { tasks, is_over: false }),
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
    pub(super) fn told(&self, world: usize) -> Option<Told> {
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

impl Drop for Crew {
    fn drop(&mut self) {
        let mut work = self.shared.lock();
        work.is_over = true;
        work.tasks.cancel();
        self.shared.news.notify_all();
    }
}

impl Shared {
    fn lock(&self) -> MutexGuard<'_, Work> {
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
