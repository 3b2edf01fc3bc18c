//! What is kept of contacts from one step to the next.

use serde::{Deserialize, Serialize};

use super::contact::{Contact, ContactMemory, Impulse};
use crate::contact::range::Bond;

/// What is kept of a contact as long as it lives.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Kept {
    pub contacts: Vec<Contact>,
    pub impulses: Vec<Impulse>,
    pub memories: Vec<ContactMemory>,
    pub bonds: Vec<Bond>,
    /// The step that each was first found in.
    pub found_in: Vec<u64>,
}

impl Kept {
    pub(super) fn clear(&mut self) {
        let Self { contacts, impulses, memories, bonds, found_in } = self;
        contacts.clear();
        impulses.clear();
        memories.clear();
        bonds.clear();
        found_in.clear();
    }

    /// Takes what several have, one after the other, in place of its own.
    pub(super) fn take_all(&mut self, parts: &[Self]) {
        fn join<'a, T: Copy + 'a>(all: &mut Vec<T>, parts: impl Iterator<Item = &'a Vec<T>>) {
            parts.for_each(|part| all.extend_from_slice(part));
        }
        self.clear();
        let Self { contacts, impulses, memories, bonds, found_in } = self;
        let parts = || parts.iter();
        rayon::join(
            || {
                join(contacts, parts().map(|part| &part.contacts));
                join(bonds, parts().map(|part| &part.bonds));
            },
            || {
                join(memories, parts().map(|part| &part.memories));
                join(impulses, parts().map(|part| &part.impulses));
                join(found_in, parts().map(|part| &part.found_in));
            },
        );
    }
}
