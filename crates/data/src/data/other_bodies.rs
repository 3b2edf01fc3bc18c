//! Describes body j of a contact, the body that grain i touches, in the tables of contacts and pairs.

use crate::sim::{Moment, OtherBody};

/// Words of the column `kind_j`, the kind of body j, which is the body that grain i touches.
pub(super) const OTHER_KINDS: &[&str] = &["grain", "fixed", "boundary"];

/// Kinds, ids and names of the bodies that grains touch (body j of each contact) in a snapshot, for tables.
pub(super) struct OtherBodies<'a> {
    moment: &'a Moment,
    first_boundary: u64,
    /// List of names: first the empty name, which all grains and fixed discs have, then a name with shape and number
    /// for each boundary.
    pub names: Vec<String>,
}

impl<'a> OtherBodies<'a> {
    pub(super) fn of(moment: &'a Moment) -> Self {
        let boundaries = moment.surroundings.boundaries.iter().enumerate();
        let names = boundaries.map(|(number, boundary)| format!("{} {number}", boundary.word()));
        let discs = moment.surroundings.fixed_discs.len() as u64;
        Self {
            moment,
            first_boundary: u64::from(moment.first_fixed_id) + discs,
            names: std::iter::once(String::new()).chain(names).collect(),
        }
    }

    /// Returns, for a body j, the index of its kind in [`OTHER_KINDS`], its id, and the index of its name in `names`.
    pub(super) fn told(&self, other: OtherBody) -> (u32, u64, u32) {
        match other {
            OtherBody::Grain(number) => (0, self.moment.id(number).into(), 0),
            OtherBody::FixedDisc(number) => {
                (1, u64::from(self.moment.first_fixed_id) + u64::from(number), 0)
            }
            OtherBody::Boundary(number) => (2, self.first_boundary + u64::from(number), 1 + number),
        }
    }
}
