//! Sets of grains that contacts join. Bodies that no grain moves join none: what lies on one floor is not one set.

use ena::unify::{InPlaceUnificationTable, UnifyKey};

/// A grain in the table of sets.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Member(u32);

impl UnifyKey for Member {
    type Value = ();

    fn index(&self) -> u32 {
        self.0
    }

    fn from_index(index: u32) -> Self {
        Self(index)
    }

    fn tag() -> &'static str {
        "grain"
    }
}

/// Grains in sets.
pub(crate) struct JoinedGrains(InPlaceUnificationTable<Member>);

impl JoinedGrains {
    /// So many grains, each by itself.
    pub(crate) fn apart(grains: usize) -> Self {
        let mut sets = InPlaceUnificationTable::new();
        (0..grains).for_each(|_| _ = sets.new_key(()));
        Self(sets)
    }

    /// Joins the sets of two grains.
    pub(crate) fn join(&mut self, one: u32, other: u32) {
        self.0.union(Member(one), Member(other));
    }

    /// The grain that stands for the set of a grain.
    pub(crate) fn of(&mut self, grain: u32) -> u32 {
        self.0.find(Member(grain)).0
    }
}
