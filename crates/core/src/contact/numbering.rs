//! The joint numbering of all bodies: grains first, then fixed discs, then features (half-spaces, segments, polygons)
//! of the boundaries.

use crate::world::World;

/// The second body of a contact, as its type and its index among the bodies of this type.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Other {
    /// A grain.
    Grain(usize),
    /// A fixed disc: a disc that is at rest or has a prescribed or force-driven motion.
    FixedDisc(usize),
    /// A feature of a boundary: a half-space, segment or polygon.
    Feature(usize),
}

impl Other {
    /// Returns the index of the grain, or `None` if the body is not a grain.
    #[inline(always)]
    pub fn grain(self) -> Option<usize> {
        if let Self::Grain(index) = self { Some(index) } else { None }
    }
}

/// Converts the number of a body in the joint numbering to its type and its index among the bodies of this type, and
/// back. The joint numbering has grains first, then fixed discs, then features of the boundaries.
#[derive(Clone, Copy, Debug)]
pub struct Numbering {
    grains: usize,
    fixed_discs: usize,
}

impl Numbering {
    /// Returns the joint numbering of the bodies of a world.
    pub fn of(world: &World) -> Self {
        Self { grains: world.grains.len(), fixed_discs: world.fixed_discs.len() }
    }

    /// Returns the joint numbering of a world with this many grains and without fixed discs, for callers that need
    /// not distinguish fixed discs from features (parts of boundaries).
    pub(crate) fn of_grains(grains: usize) -> Self {
        Self { grains, fixed_discs: 0 }
    }

    /// Returns the type of the body that has this number in the joint numbering, with its index among the bodies of
    /// this type.
    #[inline(always)]
    pub fn other(self, number: u32) -> Other {
        let index = number as usize;
        if index < self.grains {
            return Other::Grain(index);
        }
        let fixed = index - self.grains;
        if fixed < self.fixed_discs {
            Other::FixedDisc(fixed)
        } else {
            Other::Feature(fixed - self.fixed_discs)
        }
    }

    /// Returns the number of a body in the joint numbering.
    #[inline(always)]
    pub(crate) fn number(self, other: Other) -> u32 {
        let index = match other {
            Other::Grain(index) => index,
            Other::FixedDisc(index) => self.grains + index,
            Other::Feature(index) => self.grains + self.fixed_discs + index,
        };
        index as u32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_tells_what_it_was_made_of() {
        let numbering = Numbering { grains: 3, fixed_discs: 2 };
        let bodies = [
            Other::Grain(0),
            Other::Grain(2),
            Other::FixedDisc(0),
            Other::FixedDisc(1),
            Other::Feature(0),
            Other::Feature(7),
        ];
        for (body, number) in bodies.into_iter().zip([0, 2, 3, 4, 5, 12]) {
            assert_eq!(numbering.number(body), number);
            assert_eq!(numbering.other(number), body);
        }
    }
}
