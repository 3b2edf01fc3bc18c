//! Close pairs of discs by parry's bounding volume hierarchy, for discs of very different sizes.
//!
//! A grid's cells are as wide as the largest disc, so that each of many small ones looks at very
//! many others. The tree has no such length. It is built once and then refitted to the moved discs
//! and put in better order bit by bit: built anew each time it loses to the grid
//! (`cargo bench --bench broad_phase`).

use glam::DVec2;
use parry2d_f64::bounding_volume::Aabb;
use parry2d_f64::partitioning::{Bvh, BvhBuildStrategy, BvhWorkspace};

/// A tree over discs. Which pairs it finds depends on the discs alone, not on how it came about.
#[derive(Clone, Default)]
pub(crate) struct Tree {
    tree: Bvh,
    workspace: BvhWorkspace,
}

impl std::fmt::Debug for Tree {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.debug_struct("Tree").finish_non_exhaustive()
    }
}

impl Tree {
    /// Brings the tree up to date with discs (centre, radius; m), always the same number of them.
    pub(crate) fn update(&mut self, discs: impl Iterator<Item = (DVec2, f64)>) {
        let boxes = discs
            .map(|(centre, radius)| Aabb::from_half_extents(centre, DVec2::splat(radius)))
            .enumerate();
        if self.tree.is_empty() {
            self.tree = Bvh::from_iter(BvhBuildStrategy::Binned, boxes);
            return;
        }
        for (index, reach) in boxes {
            self.tree.insert_or_update_partially(reach, index as u32, 0.0);
        }
        self.tree.refit_without_opt();
        self.tree.optimize_incremental(&mut self.workspace);
    }

    /// Calls `found` once with every pair of discs whose bounding squares overlap.
    pub(crate) fn pairs(&mut self, mut found: impl FnMut(u32, u32)) {
        self.tree.traverse_bvtt_single_tree::<false>(&mut self.workspace, &mut found);
    }
}
