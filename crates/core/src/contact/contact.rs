//! One contact, its impulses, and the memory that schemes keep of it.

use glam::DVec2;
use serde::{Deserialize, Serialize};

/// One touching pair.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Contact {
    /// Grain i.
    pub grain: u32,
    /// Body j, numbered through ([`Numbering`](super::Numbering)).
    pub other: u32,
    /// n, from j to i. On a line its y component is 0.
    pub normal: DVec2,
    /// m; negative is overlap.
    pub gap: f64,
}

impl Contact {
    /// The bodies (i, other), which contacts are sorted by.
    pub(crate) fn pair(&self) -> (u32, u32) {
        (self.grain, self.other)
    }
}

/// The impulses of one contact, N·s.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Impulse {
    /// P_n.
    pub normal: f64,
    /// P_t.
    pub tangential: f64,
}

/// What a stepping scheme keeps of a contact from one substep to the next, whatever its length. A
/// method that solves the step's problem neither reads nor writes it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ContactMemory {
    /// How far the tangential spring is stretched, m; positive as v_t is.
    pub tangential_displacement: f64,
    /// N of the last substep, newton.
    pub normal_force: f64,
    /// T of the last substep, newton.
    pub tangential_force: f64,
    /// Stiffness of the penalty along normal and tangent, N/m.
    pub stiffness: [f64; 2],
}
