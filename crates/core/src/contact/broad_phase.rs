//! Which discs are near each other: by the grid, or by the tree where their sizes differ much.

use glam::DVec2;

use super::grid::Grid;
use super::tree::Tree;

/// Where the largest disc, with or without its skin, is more than this many times as large as the
/// smallest, the tree finds the pairs, else the grid. At 1:1.5 the two take about the same time, at
/// 1:20 the grid takes 1.2 to 18 times as long (`cargo bench --bench broad_phase`).
const SIZE_RATIO_OF_TREE: f64 = 4.0;

/// What finds the pairs of discs of given radii.
#[derive(Clone, Debug, Default)]
pub struct BroadPhase {
    radii_differ: bool,
    kind: Kind,
}

#[derive(Clone, Debug)]
enum Kind {
    Grid(Grid),
    Tree(Box<Tree>),
}

impl Default for Kind {
    fn default() -> Self {
        Self::Grid(Grid::default())
    }
}

impl BroadPhase {
    /// Suits discs of these radii, m.
    pub fn of(radii: &[f64]) -> Self {
        let (radii_differ, _) = spread(radii.iter().copied());
        Self { radii_differ, ..Self::default() }
    }

    /// Has the next search begin anew, of another number of discs.
    pub(crate) fn forget_discs(&mut self) {
        if matches!(self.kind, Kind::Tree(_)) {
            self.kind = Kind::default();
        }
    }

    /// Calls `found` once with every pair of discs that are nearer to each other than their extents
    /// together: radii with skins, m. And with some others.
    pub fn pairs<const AXES: usize>(
        &mut self,
        centres: &[DVec2],
        extents: impl Iterator<Item = f64> + Clone,
        found: impl FnMut(u32, u32),
    ) {
        let (extents_differ, largest) = spread(extents.clone());
        let by_tree = self.radii_differ || extents_differ;
        if by_tree != matches!(self.kind, Kind::Tree(_)) {
            self.kind = if by_tree { Kind::Tree(Box::default()) } else { Kind::default() };
        }
        match &mut self.kind {
            Kind::Grid(grid) => {
                grid.rebuild::<AXES>(centres, 2.0 * largest);
                grid.pairs::<AXES>(found);
            }
            Kind::Tree(tree) => {
                let on_axes = |&centre: &DVec2| match AXES {
                    1 => DVec2::new(centre.x, 0.0),
                    _ => centre,
                };
                tree.update(centres.iter().map(on_axes).zip(extents));
                tree.pairs(found);
            }
        }
    }
}

/// Whether sizes differ so much that the tree is to be taken, and the largest.
fn spread(sizes: impl Iterator<Item = f64> + Clone) -> (bool, f64) {
    let largest = sizes.clone().fold(0.0, f64::max);
    let smallest = sizes.fold(f64::INFINITY, f64::min);
    (largest > SIZE_RATIO_OF_TREE * smallest, largest)
}
