//! The rows of a problem in blocks, tile by tile, and the bodies that they act on.

use std::ops::Range;

use super::block::{Block, LANES, Slot};
use crate::solver::problem::{Kinematics, Model, Row, StepProblem};

/// A slot that no grain is in, and a grain that has no slot.
const NOBODY: u32 = u32::MAX;

/// What one thread at a time works on: contacts whose grains no other tile's have.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Tile {
    /// Its blocks.
    pub blocks: usize,
    /// How many of these, the first, are of contacts with fixed bodies.
    pub singles: usize,
    /// Its slots.
    pub slots: usize,
}

/// What is known of a grain while blocks are made.
#[derive(Clone, Copy, Debug)]
struct Mark {
    slot: u32,
    /// Number of its tile from 1.
    tile: u32,
    /// The last colour that it was seen in.
    colour: u32,
}

const UNSEEN: Mark = Mark { slot: NOBODY, tile: 0, colour: 0 };

/// Where blocks are added.
#[derive(Clone, Copy)]
struct Corner {
    /// Number of the tile from 1; 0 between tiles.
    tile: u32,
    /// The slot that indices are counted from.
    first_slot: u32,
}

/// The rows of a problem in blocks. Memory is kept between steps.
#[derive(Clone, Debug, Default)]
pub(super) struct Layout {
    /// Tiles in the order of their blocks and slots.
    pub tiles: Vec<Tile>,
    /// Blocks tile by tile, each colour by colour; the indices of a tile's are into its own slots. Then those
    /// between tiles, whose indices are into all slots.
    pub blocks: Vec<Block>,
    /// How many blocks between tiles are of contacts with fixed bodies.
    pub singles_between: usize,
    /// Bodies tile by tile, in the order in which blocks first meet them. The first of a tile stands in where a
    /// lane is idle.
    pub slots: Vec<Slot>,
    /// Rows of each block, numbered as in the problem.
    pub places: Vec<Range<u32>>,
    /// Grain of each slot.
    grains: Vec<u32>,
    marks: Vec<Mark>,
    colours: u32,
}

impl Layout {
    /// Lays out a problem. Nothing where its grains do not all exist, or a colour or two tiles share one.
    pub(super) fn fill<K: Kinematics>(&mut self, problem: &StepProblem<K>) -> Option<()> {
        self.tiles.clear();
        self.blocks.clear();
        self.places.clear();
        self.grains.clear();
        self.marks.clear();
        self.marks.resize(problem.bodies.len(), UNSEEN);
        self.colours = 0;
        let kinds = &problem.groups;
        let rows = [problem.fixed_rows.len(), problem.pair_rows.len()];
        if kinds.each_ref().map(|groups| groups.colour_ends.last().copied().unwrap_or(0)) != rows {
            return None;
        }
        let tiles = kinds.each_ref().map(|groups| groups.tile_ends.len());
        let tiles = tiles[0].max(tiles[1]);
        for tile in 0..tiles {
            let (first_block, first_slot) = (self.blocks.len(), self.grains.len());
            let corner = Corner { tile: tile as u32 + 1, first_slot: first_slot as u32 };
            self.grains.push(NOBODY);
            let singles = self.add_all(problem, corner, tile)?;
            let blocks = self.blocks.len() - first_block;
            let slots = self.grains.len() - first_slot;
            self.tiles.push(Tile { blocks, singles, slots });
        }
        self.singles_between = self.add_all(problem, Corner { tile: 0, first_slot: 0 }, tiles)?;
        self.slots.clear();
        self.slots.extend(self.grains.iter().map(|&grain| {
            problem.bodies.get(grain as usize).map_or_else(Slot::default, Slot::of::<K>)
        }));
        Some(())
    }

    /// Adds the blocks of a tile, or those between tiles behind the last, and tells how many are of contacts
    /// with fixed bodies.
    fn add_all<K: Kinematics>(
        &mut self,
        problem: &StepProblem<K>,
        corner: Corner,
        tile: usize,
    ) -> Option<usize> {
        let first_block = self.blocks.len();
        let fixed = problem.fixed_rows.len();
        for rows in problem.groups[0].colours_of(tile) {
            self.add::<K, false>(problem.fixed_rows.get(rows.clone())?, rows.start, corner)?;
        }
        let singles = self.blocks.len() - first_block;
        for rows in problem.groups[1].colours_of(tile) {
            let number = fixed + rows.start;
            self.add::<K, true>(problem.pair_rows.get(rows)?, number, corner)?;
        }
        Some(singles)
    }

    /// Adds the blocks of a colour, whose rows are numbered from `first`.
    fn add<K: Kinematics, const PAIR: bool>(
        &mut self,
        rows: &[Row<K>],
        first: usize,
        Corner { tile, first_slot }: Corner,
    ) -> Option<()> {
        self.colours += 1;
        for row in rows {
            for grain in [row.i, row.j].into_iter().take(if PAIR { 2 } else { 1 }) {
                let mark = self.marks.get_mut(grain as usize)?;
                if std::mem::replace(&mut mark.colour, self.colours) == self.colours {
                    return None;
                }
                if mark.slot == NOBODY {
                    (mark.slot, mark.tile) = (self.grains.len() as u32, tile);
                    self.grains.push(grain);
                }
                if tile > 0 && mark.tile != tile {
                    return None;
                }
            }
        }
        let marks = &self.marks;
        let slot = |grain: u32| marks[grain as usize].slot - first_slot;
        let slots = |row: &Row<K>| [slot(row.i), slot(if PAIR { row.j } else { row.i })];
        self.blocks.extend(rows.chunks(LANES).map(|rows| Block::of(rows, slots)));
        let end = first + rows.len();
        let starts = (first..end).step_by(LANES);
        self.places.extend(starts.map(|start| start as u32..(start + LANES).min(end) as u32));
        Some(())
    }

    /// Gives rows and bodies what became of them.
    pub(super) fn store<M: Model>(&self, problem: &mut StepProblem<M::Kinematics>) {
        let StepProblem { bodies, fixed_rows, pair_rows, .. } = problem;
        let fixed = fixed_rows.len();
        for (block, place) in self.blocks.iter().zip(&self.places) {
            let [start, end] = [place.start as usize, place.end as usize];
            block.store::<M>(match start.checked_sub(fixed) {
                None => &mut fixed_rows[start..end],
                Some(start) => &mut pair_rows[start..end - fixed],
            });
        }
        for (slot, &grain) in self.slots.iter().zip(&self.grains) {
            if let Some(body) = bodies.get_mut(grain as usize) {
                slot.store::<M::Kinematics>(body);
            }
        }
    }
}
