//! One contact, its impulses, and the data that steppers keep of it.

use glam::DVec2;
use serde::{Deserialize, Serialize};

/// One touching pair.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Contact {
    /// Grain i.
    pub grain: u32,
    /// Body j, in the joint numbering ([`Numbering`](super::Numbering)).
    pub other: u32,
    /// Normal n, from j to i. On a line its y component is 0.
    pub normal: DVec2,
    /// Gap, m; negative for an overlap.
    pub gap: f64,
}

impl Contact {
    /// The bodies (i, other), the sort key of contacts.
    pub(crate) fn pair(&self) -> (u32, u32) {
        (self.grain, self.other)
    }
}

/// The impulses of one contact, N·s.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Impulse {
    /// Normal impulse P_n.
    pub normal: f64,
    /// Tangential impulse P_t.
    pub tangential: f64,
}

/// Data that a stepper keeps of a contact from one substep to the next. Solvers of the step problem neither read nor
/// write it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ContactMemory {
    /// Stretch of the tangential spring, m; same sign as v_t.
    pub tangential_displacement: f64,
    /// Normal force N of the last substep, newton.
    pub normal_force: f64,
    /// Tangential force T of the last substep, newton.
    pub tangential_force: f64,
    /// Penalty stiffness along normal and tangent, N/m.
    pub stiffness: [f64; 2],
}
