//! Names of body j in the tables of contacts and of pairs.

use crate::sim::{Moment, OtherBody};

/// Words of the column `kind_j`.
pub(super) const OTHER_KINDS: &[&str] = &["grain", "fixed", "boundary"];

/// Kinds, numbers and names of bodies j for tables.
pub(super) struct OtherBodies<'a> {
    moment: &'a Moment,
    first_boundary: u64,
    /// An empty name, followed by the shapes and numbers of the boundaries.
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

    /// Index of the word for its kind, number, and index of its name.
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
