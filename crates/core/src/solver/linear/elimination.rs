//! The order in which a sparse factorisation eliminates bodies, and the pattern of nonzero blocks in its factors.
//!
//! The order is a minimum degree order of the graph whose nodes are the bodies and whose edges are the contacts between
//! them: the body with the fewest neighbours is eliminated first, and its neighbours become neighbours of each other.
//! Contact graphs are nearly planar, so bodies get only few neighbours.
//!
//! **Postorder** puts positions whose eliminations change the same blocks next to each other. The later neighbours of a
//! position are the neighbours of its body that are eliminated after this body. The parent of a position in the
//! elimination tree is the first of its later neighbours. Every order that has each position before its parent leads to
//! the same factors with the same fill-in (additional nonzero blocks). An order that finishes a subtree before it
//! begins the next subtree changes blocks that were computed recently and are still in the cache, and puts positions
//! with the same later neighbours next to each other (J. W. H. Liu, 1990).

use smallvec::SmallVec;

use crate::solver::kinematics::Model;
use crate::solver::problem::StepProblem;

/// Neighbours of a body: the bodies with which it shares a nonzero block. A disc seldom has more than six neighbours at
/// first, and elimination seldom doubles that number; longer lists are stored on the heap.
type BodyNeighbours = SmallVec<[u32; 12]>;

/// An elimination order and the nonzero pattern of the factors. A *place* is the position of a body in this order.
#[derive(Clone, Debug, Default)]
pub(crate) struct Elimination {
    /// Index of the body that is eliminated at each position of the order.
    pub body_at: Vec<u32>,
    /// Position of each body in the elimination order.
    pub place_of: Vec<u32>,
    /// Boundaries of the lists in `later`, one list per position of the elimination order. The list of position k,
    /// `later[starts[k] .. starts[k + 1]]`, contains in rising order the positions of those neighbours of its body that
    /// are eliminated later. The index of an entry in `later` is also the number of the off-diagonal block of the two
    /// bodies.
    pub starts: Vec<u32>,
    /// For each position of the elimination order in turn, the positions of those neighbours of its body that are
    /// eliminated later.
    pub later: Vec<u32>,
    /// Numbers of the off-diagonal blocks that the elimination of each position changes. A position changes one block
    /// (a, b) for each pair a < b of the positions of its neighbours that are eliminated later; the pairs are in
    /// lexicographic order.
    pub targets: Vec<u32>,
    /// First position of each supernode, and finally the number of positions. A supernode is a run of successive
    /// positions of the elimination order whose columns of the factor have the same pattern of nonzero blocks below the
    /// run.
    pub supernodes: Vec<u32>,
    postorder: Postorder,
    neighbours: Vec<BodyNeighbours>,
    merged: BodyNeighbours,
    by_degree: Vec<Vec<u32>>,
}

impl Elimination {
    /// Computes the order and the pattern for `bodies` bodies with the given pairs of neighbours (in any order;
    /// repeated pairs are allowed).
    pub(crate) fn analyse(&mut self, bodies: usize, pairs: impl Iterator<Item = (u32, u32)>) {
        self.neighbours.resize_with(bodies.max(self.neighbours.len()), BodyNeighbours::new);
        for list in &mut self.neighbours {
            list.clear();
        }
        for (i, j) in pairs {
            self.neighbours[i as usize].push(j);
            self.neighbours[j as usize].push(i);
        }
        for list in &mut self.neighbours {
            list.sort_unstable();
            list.dedup();
        }
        self.order(bodies);
        self.rearrange();
        self.structure(bodies);
    }

    /// Returns the number of the off-diagonal block of the bodies at positions a < b of the elimination order. The two
    /// bodies must be neighbours.
    pub(crate) fn block(&self, a: u32, b: u32) -> usize {
        let row = self.row(a as usize);
        row.start + self.later[row].partition_point(|&place| place < b)
    }

    /// Returns the range of the numbers of the off-diagonal blocks in the row of a position of the elimination order.
    /// The row has one block for each neighbour of the position's body that is eliminated later.
    #[inline(always)]
    pub(super) fn row(&self, place: usize) -> std::ops::Range<usize> {
        self.starts[place] as usize..self.starts[place + 1] as usize
    }

    fn order(&mut self, bodies: usize) {
        self.body_at.clear();
        self.place_of.clear();
        self.place_of.resize(bodies, NONE);
        for list in &mut self.by_degree {
            list.clear();
        }
        for body in (0..bodies as u32).rev() {
            self.file(body);
        }
        let mut degree = 0;
        while self.body_at.len() < bodies {
            // Outdated entries are skipped: a body is listed again under its new degree when its degree changes.
            let Some(body) = self.by_degree.get_mut(degree).and_then(Vec::pop) else {
                degree += 1;
                continue;
            };
            let at = body as usize;
            if self.place_of[at] != NONE || self.neighbours[at].len() != degree {
                continue;
            }
            self.place_of[at] = self.body_at.len() as u32;
            self.body_at.push(body);
            let clique = std::mem::take(&mut self.neighbours[at]);
            for &neighbour in &clique {
                self.join(neighbour, body, &clique);
                self.file(neighbour);
                degree = degree.min(self.neighbours[neighbour as usize].len());
            }
            self.neighbours[at] = clique;
        }
    }

    /// Renumbers the positions of the elimination order in postorder: every subtree of the elimination tree becomes a
    /// range of successive positions, with its root last.
    fn rearrange(&mut self) {
        let Self { body_at, place_of, neighbours, postorder, .. } = self;
        // All neighbours that a body had when it was eliminated come later in the order.
        postorder.arrange(body_at.iter().map(|&body| {
            let later = &neighbours[body as usize];
            (later.iter().map(|&body| place_of[body as usize]).min(), later.len())
        }));
        let before = std::mem::take(body_at);
        body_at.extend(postorder.reversed.iter().rev().map(|&place| before[place as usize]));
        for (place, &body) in body_at.iter().enumerate() {
            place_of[body as usize] = place as u32;
        }
    }

    /// Makes `body` a neighbour of all other bodies of `clique`, and no longer a neighbour of the body `eliminated`,
    /// which is being eliminated. `clique` contains all neighbours of `eliminated`.
    fn join(&mut self, body: u32, eliminated: u32, clique: &[u32]) {
        let own = &mut self.neighbours[body as usize];
        self.merged.clear();
        // Both lists are sorted, so they can be merged in one pass.
        let (mut a, mut b) = (own.iter().copied().peekable(), clique.iter().copied().peekable());
        loop {
            let next = match (a.peek(), b.peek()) {
                (Some(x), Some(y)) if x < y => a.next(),
                (Some(x), Some(y)) if x == y => {
                    a.next();
                    b.next()
                }
                (Some(_), None) => a.next(),
                (_, Some(_)) => b.next(),
                (None, None) => break,
            };
            self.merged.extend(next.filter(|&other| other != body && other != eliminated));
        }
        std::mem::swap(own, &mut self.merged);
    }

    fn file(&mut self, body: u32) {
        let degree = self.neighbours[body as usize].len();
        if self.by_degree.len() <= degree {
            self.by_degree.resize_with(degree + 1, Vec::new);
        }
        self.by_degree[degree].push(body);
    }

    fn structure(&mut self, bodies: usize) {
        self.starts.clear();
        self.later.clear();
        self.starts.push(0);
        for place in 0..bodies {
            let start = self.later.len();
            // All neighbours that a body had when it was eliminated come later in the order.
            let neighbours = &self.neighbours[self.body_at[place] as usize];
            self.later.extend(neighbours.iter().map(|&body| self.place_of[body as usize]));
            self.later[start..].sort_unstable();
            self.starts.push(self.later.len() as u32);
        }
        self.supernodes.clear();
        for place in 0..bodies {
            let follows = place > 0 && {
                let [first, second, end] = [place - 1, place, place + 1].map(|at| self.starts[at]);
                end - second + 1 == second - first && self.later[first as usize] == place as u32
            };
            if !follows {
                self.supernodes.push(place as u32);
            }
        }
        self.supernodes.push(bodies as u32);
        self.targets.clear();
        for place in 0..bodies {
            let range = self.row(place);
            for first in range.clone() {
                // A position that is later than `first` and `second` is a later neighbour of `first`, and both lists
                // are in rising order.
                let mut block = self.starts[self.later[first] as usize] as usize;
                for second in first + 1..range.end {
                    while self.later[block] < self.later[second] {
                        block += 1;
                    }
                    self.targets.push(block as u32);
                }
            }
        }
    }
}

/// Value that marks a body that has no position in the elimination order yet, or a missing child in the elimination
/// tree.
const NONE: u32 = u32::MAX;

/// Work memory for computing a postorder: an order of the elimination tree in which each subtree is complete before the
/// next subtree begins. The memory is reused for the next elimination order.
#[derive(Clone, Debug, Default)]
struct Postorder {
    /// For each position, the first entry of the linked list of its children in the elimination tree, or [`NONE`].
    first_child: Vec<u32>,
    /// For each position, the next child of the same parent in the linked list of that parent's children, or [`NONE`].
    next_child: Vec<u32>,
    /// For each position, its child with the most neighbours that are eliminated later, or [`NONE`] without children.
    /// In the new order this child comes right before its parent.
    heir: Vec<u32>,
    /// For each position, the number of neighbours of the child in `heir` that are eliminated later than this child.
    most: Vec<usize>,
    stack: Vec<u32>,
    /// The positions of the elimination order in postorder, last position first.
    reversed: Vec<u32>,
}

impl Postorder {
    /// Computes the postorder of the positions. For each position `parents` gives its parent in the elimination tree
    /// (`None` for a root), and the number of its neighbours that are eliminated later.
    fn arrange(&mut self, parents: impl ExactSizeIterator<Item = (Option<u32>, usize)>) {
        let Self { first_child, next_child, heir, most, stack, reversed } = self;
        for links in [&mut *first_child, next_child, heir] {
            links.clear();
            links.resize(parents.len(), NONE);
        }
        most.clear();
        most.resize(parents.len(), 0);
        stack.clear();
        reversed.clear();
        for (place, (parent, neighbours)) in parents.enumerate() {
            let child = place as u32;
            let Some(parent) = parent else {
                stack.push(child);
                continue;
            };
            let parent = parent as usize;
            next_child[place] = std::mem::replace(&mut first_child[parent], child);
            if heir[parent] == NONE || neighbours >= most[parent] {
                (heir[parent], most[parent]) = (child, neighbours);
            }
        }
        // A depth-first walk visits each position before its children, and the child `heir` before the other children.
        // The new order is the reverse of the walk.
        while let Some(place) = stack.pop() {
            reversed.push(place);
            let heir = heir[place as usize];
            let mut child = first_child[place as usize];
            while child != NONE {
                if child != heir {
                    stack.push(child);
                }
                child = next_child[child as usize];
            }
            if heir != NONE {
                stack.push(heir);
            }
        }
    }
}

/// The elimination order of grains and walls driven by a force, for their present contacts. It is kept as long as these
/// contacts stay the same. Driven walls are numbered after the grains.
#[derive(Clone, Debug, Default)]
pub(crate) struct ContactGraph {
    /// The elimination order, and the pattern of nonzero blocks in the factors.
    pub elimination: Elimination,
    /// For each contact between two moving bodies (grains or walls driven by a force), the number of its block, an
    /// index in [`Elimination::later`].
    pub pair_blocks: Vec<u32>,
    /// Number of bodies for which `elimination` was computed.
    bodies: usize,
    /// Pairs of bodies in contact for which `elimination` was computed.
    pairs: Vec<(u32, u32)>,
}

impl ContactGraph {
    /// Computes the elimination order, unless bodies and contacts are the same as at the last call.
    pub(crate) fn analyse<M: Model>(&mut self, problem: &StepProblem<M>) {
        let grains = problem.bodies.now.len();
        let bodies = grains + problem.walls.driven.len();
        let pairs = || {
            let of_walls = problem.walls.driven_rows.iter().map(|known| {
                (problem.rows.fixed[known.number as usize].i, grains as u32 + known.by.wall)
            });
            of_walls.chain(problem.rows.pairs.iter().map(|row| (row.i, row.j)))
        };
        if self.bodies == bodies && pairs().eq(self.pairs.iter().copied()) {
            return;
        }
        self.bodies = bodies;
        self.pairs.clear();
        self.pairs.extend(pairs());
        self.elimination.analyse(bodies, self.pairs.iter().copied());
        let Self { elimination, pair_blocks, pairs, .. } = self;
        let places = pairs
            .iter()
            .map(|&(i, j)| (elimination.place_of[i as usize], elimination.place_of[j as usize]));
        pair_blocks.clear();
        pair_blocks.extend(places.map(|(i, j)| elimination.block(i.min(j), i.max(j)) as u32));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solver::linear::tests::grid;

    #[test]
    fn every_fill_in_has_its_block() {
        let side = 9;
        let pairs = grid(side);
        let mut elimination = Elimination::default();
        elimination.analyse((side * side) as usize, pairs.iter().copied());
        for (place, &body) in elimination.body_at.iter().enumerate() {
            assert_eq!(elimination.place_of[body as usize] as usize, place);
        }
        for (i, j) in pairs {
            let (a, b) = (elimination.place_of[i as usize], elimination.place_of[j as usize]);
            let block = elimination.block(a.min(b), a.max(b));
            assert_eq!(elimination.later[block], a.max(b));
        }
        for place in 0..(side * side) as usize {
            // In a postorder, a subtree is finished before the next subtree begins.
            let parent = elimination.later[elimination.row(place)].first();
            let children =
                |at: usize| elimination.later[elimination.row(at)].first() == Some(&(place as u32));
            let before = place.checked_sub(1).filter(|_| (0..place).any(children));
            assert!(before.is_none_or(children), "{place} comes right after one of its children");
            assert!(parent.is_none_or(|&parent| parent as usize > place));
        }
        let within = |ends: &[u32]| {
            let (start, end) = (ends[0] as usize, ends[1] as usize);
            (start..end).map(move |place| end - 1 - place)
        };
        let rows: Vec<usize> = elimination.supernodes.windows(2).flat_map(within).collect();
        for (place, &within) in rows.iter().enumerate() {
            let row = &elimination.later[elimination.row(place)];
            let end = place + within;
            let inside: Vec<u32> = (place as u32 + 1..=end as u32).collect();
            assert_eq!(row[..within], inside, "the rest of its supernode");
            assert_eq!(row[within..], elimination.later[elimination.row(end)], "and what that has");
        }
        assert_eq!(rows.len(), (side * side) as usize);
        let mut targets = elimination.targets.iter();
        for place in 0..(side * side) as usize {
            let range = elimination.row(place);
            for first in range.clone() {
                for second in first + 1..range.end {
                    let target = *targets.next().expect("a target for every pair") as usize;
                    assert_eq!(elimination.later[target], elimination.later[second]);
                }
            }
        }
        // Minimum degree gives about 400 blocks on a 9 × 9 grid (n = 81 bodies); a bad order gives of the order of n²
        // blocks.
        assert!(elimination.later.len() < 500, "{} blocks", elimination.later.len());
    }
}
