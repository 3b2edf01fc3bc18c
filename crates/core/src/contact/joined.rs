//! Sets of grains that contacts join. Bodies that no grain moves join none: what lies on one floor is not one set.

use ena::unify::{InPlaceUnificationTable, UnifyKey};

use super::Contact;

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
pub struct JoinedGrains(InPlaceUnificationTable<Member>);

impl JoinedGrains {
    /// So many grains, each by itself.
    pub fn apart(grains: usize) -> Self {
        let mut sets = InPlaceUnificationTable::new();
        (0..grains).for_each(|_| _ = sets.new_key(()));
        Self(sets)
    }

    /// Joins the sets of two grains.
    pub fn join(&mut self, one: u32, other: u32) {
        self.0.union(Member(one), Member(other));
    }

    /// The grain that stands for the set of a grain.
    pub fn of(&mut self, grain: u32) -> u32 {
        self.0.find(Member(grain)).0
    }
}

/// Contacts of the set of grains that has most of them, among so many grains.
pub fn most_contacts_joined(contacts: &[Contact], grains: usize) -> usize {
    let mut sets = JoinedGrains::apart(grains);
    for contact in contacts.iter().filter(|contact| (contact.other as usize) < grains) {
        sets.join(contact.grain, contact.other);
    }
    let mut counts = vec![0; grains];
    for contact in contacts {
        counts[sets.of(contact.grain) as usize] += 1;
    }
    counts.into_iter().max().unwrap_or(0)
}
