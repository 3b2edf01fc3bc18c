//! How walls cut cells.
//!
//! A side of a boundary cuts along its line the cells of grains that stand before it, between its ends. Where a grain
//! stands before no side of a boundary, the corner that it is nearest to cuts across the line from the grain's centre. So
//! no cell reaches into a solid or through a wall, and a wall that ends takes a little of what lies around its end.

use glam::DVec2;

use super::site::{Cut, Site};
use crate::world::{Boundary, Edge};

/// The sides of each boundary.
pub(super) struct Walls(Vec<Vec<Edge>>);

/// Where a grain stands to a side.
enum Stands {
    /// Before it: the cut along its line.
    Before(Cut),
    /// Beside it: the way to the nearer end, m.
    Beside(DVec2),
}

impl Walls {
    pub(super) fn of(boundaries: &[Boundary]) -> Self {
        Self(boundaries.iter().map(Boundary::edges).collect())
    }

    /// Adds the cuts that can matter to a site's cell.
    pub(super) fn cut(&self, site: &Site, cuts: &mut Vec<Cut>) {
        for edges in &self.0 {
            let mut before = false;
            let mut corner: Option<DVec2> = None;
            for edge in edges {
                match stands(site.position, edge) {
                    Stands::Before(cut) if cut.offset < site.reach => {
                        before = true;
                        cuts.push(cut);
                    }
                    Stands::Before(_) => {}
                    Stands::Beside(way) => {
                        if corner.is_none_or(|found| way.length_squared() < found.length_squared())
                        {
                            corner = Some(way);
                        }
                    }
                }
            }
            if let (false, Some(way)) = (before, corner)
                && way.length() < site.reach
            {
                cuts.push(Cut { offset: way.length(), direction: way.normalize_or(DVec2::X) });
            }
        }
    }
}

fn stands(centre: DVec2, edge: &Edge) -> Stands {
    match *edge {
        Edge::Endless { point, normal } => {
            let normal = normal.normalize_or_zero();
            Stands::Before(Cut { offset: (centre - point).dot(normal), direction: -normal })
        }
        Edge::Wall([from, to]) | Edge::Side([from, to]) => {
            let along = to - from;
            let part = (centre - from).dot(along) / along.length_squared();
            if part > 0.0 && part < 1.0 {
                // On the line itself either side would do.
                let way = from + part * along - centre;
                let direction = way.normalize_or(-along.perp().normalize_or_zero());
                Stands::Before(Cut { offset: way.length(), direction })
            } else {
                Stands::Beside(if part >= 1.0 { to } else { from } - centre)
            }
        }
    }
}
