//! What is to be done, what is under way, and what has come of it.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use super::band::{Band, Series};
use crate::app::taken::Opened;
use crate::scene::NewPile;
use crate::sim::Settings;
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
enum Stage<T> {
    Waiting,
    Underway(Ticket),
    Done(T),
    Failed,
}

impl<T> Stage<T> {
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
struct World {
    /// None where the world has no others.
    settings: Option<Settings>,
    runs: Vec<Stage<Arc<Series>>>,
    band: Arc<Band>,
}

/// What is said of the other piles of a world.
#[derive(Clone, Debug)]
pub(crate) struct Told {
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
    piles: Vec<(NewPile, Stage<Vec<Grain>>)>,
    /// How far those have come that are under way.
    parts: Vec<f32>,
    worlds: Vec<World>,
}

impl Tasks {
    /// Those of what is open, with no world yet.
    pub(super) fn new(opened: Arc<Opened>, piles: Vec<NewPile>) -> Self {
        let parts = vec![0.0; piles.len()];
        let piles = piles.into_iter().map(|pile| (pile, Stage::Waiting)).collect();
        Self { opened, piles, parts, worlds: Vec::new() }
    }

    /// Has worlds with these settings. What was computed for others is forgotten.
    pub(super) fn follow(&mut self, worlds: &[Option<Settings>]) {
        let mut before = std::mem::take(&mut self.worlds);
        for &settings in worlds {
            let same = before.iter().position(|world| world.settings == settings);
            let world = same.map_or_else(
                || World {
                    settings,
                    runs: self.piles.iter().map(|_| Stage::Waiting).collect(),
                    band: Arc::default(),
                },
                |index| before.swap_remove(index),
            );
            self.worlds.push(world);
        }
        before.iter().flat_map(|world| &world.runs).for_each(Stage::cancel);
    }

    /// Has nobody go on with anything.
    pub(super) fn cancel(&self) {
        self.piles.iter().for_each(|(_, stage)| stage.cancel());
        self.worlds.iter().flat_map(|world| &world.runs).for_each(Stage::cancel);
    }

    /// What is to be done next: pile by pile, each for all worlds, so that all have as many.
    pub(super) fn next(&mut self) -> Option<Task> {
        if self.worlds.iter().all(|world| world.settings.is_none()) {
            return None;
        }
        for (index, (pile, stage)) in self.piles.iter_mut().enumerate() {
            if matches!(stage, Stage::Waiting) {
                self.parts[index] = 0.0;
                return Some(Task::Settle { pile: pile.clone(), ticket: stage.begin() });
            }
            let Some(grains) = stage.done() else { continue };
            for World { settings, runs, .. } in &mut self.worlds {
                if let (Some(settings), Stage::Waiting) = (*settings, &runs[index]) {
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
            self.worlds.iter_mut().for_each(|world| world.runs[index] = Stage::Failed);
        }
        self.piles[index].1.end(grains);
    }

    /// Notes that a run has come to its end, or that it cannot.
    pub(super) fn note_run(&mut self, ticket: &Ticket, series: Option<Series>) {
        let of_ticket = |world: &&mut World| world.runs.iter().any(|run| run.is_of(ticket));
        let Some(world) = self.worlds.iter_mut().find(of_ticket) else { return };
        if let Some(run) = world.runs.iter_mut().find(|run| run.is_of(ticket)) {
            run.end(series.map(Arc::new));
        }
        let done: Vec<Arc<Series>> = world.runs.iter().filter_map(Stage::done).cloned().collect();
        world.band = Arc::new(Band::of(&done));
    }

    /// What is said of a world's others; nothing where it has none.
    pub(super) fn told(&self, world: usize) -> Option<Told> {
        let World { settings, runs, band } = self.worlds.get(world)?;
        (*settings)?;
        let underway = |(_, stage): &(NewPile, Stage<_>)| matches!(stage, Stage::Underway(_));
        let settling = self.piles.iter().position(underway);
        Some(Told {
            band: Arc::clone(band),
            seeds: self.piles.iter().map(|(pile, _)| pile.seed).collect(),
            failed: runs.iter().filter(|run| matches!(run, Stage::Failed)).count(),
            settling: settling.map(|index| (index + 1, self.parts[index])),
        })
    }
}
