//! Rows that can be solved at the same time.

use std::ops::Range;

/// What rows of one kind, sorted by tiles and colours, can be solved at the same time.
#[derive(Clone, Debug, Default)]
pub(crate) struct Groups {
    /// Ends of the colours among the rows: those of a colour share no grain.
    pub colour_ends: Vec<usize>,
    /// Ends of the tiles among the colours: those of two tiles share no grain. The colours behind the last are
    /// of contacts between tiles.
    pub tile_ends: Vec<usize>,
}

impl Groups {
    /// The rows of each colour of a tile, or of those between tiles where it is behind the last.
    pub(crate) fn colours_of(&self, tile: usize) -> impl Iterator<Item = Range<usize>> {
        let start_of = |ends: &[usize], at: usize| at.checked_sub(1).map_or(0, |at| ends[at]);
        let (ends, tiles) = (&self.colour_ends, &self.tile_ends);
        let all = tiles.len();
        let first = start_of(tiles, tile.min(all));
        let last = if tile < all { tiles[tile] } else { ends.len() };
        (first..last).map(move |colour| start_of(ends, colour)..ends[colour])
    }

    pub(super) fn clear(&mut self) {
        self.colour_ends.clear();
        self.tile_ends.clear();
    }
}
