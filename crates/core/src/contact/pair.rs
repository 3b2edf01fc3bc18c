//! The data of one contact: geometry, impulses, and the data that steppers keep about it.

use glam::DVec2;
use serde::{Deserialize, Serialize};

/// A pair of bodies that touch, or that may touch within the step.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Contact {
    /// Index of grain i, the first body of the contact.
    pub grain: u32,
    /// Index of body j, the second body, in the joint numbering of grains, fixed discs and features
    /// ([`Numbering`](super::Numbering)).
    pub other: u32,
    /// Unit normal n, from body j to grain i. In scenes on a line its y component is 0.
    pub normal: DVec2,
    /// Gap between the surfaces of the two bodies, m; negative for an overlap.
    pub gap: f64,
}

impl Contact {
    /// Returns the index of the grain and the index of the other body, by which contacts are sorted.
    pub(crate) fn pair(&self) -> (u32, u32) {
        (self.grain, self.other)
    }
}

/// The impulses of one contact, N·s.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Impulse {
    /// Normal impulse P_n, N·s.
    pub normal: f64,
    /// Tangential impulse P_t, N·s.
    pub tangential: f64,
}

/// Data that a stepper keeps about a contact from one step, or from one substep of a divided step, to the next. The
/// solvers of the contact problem do not use these data.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ContactMemory {
    /// Stretch of the tangential spring of the contact, m. It grows if the tangential velocity v_t is positive.
    pub tangential_displacement: f64,
    /// Normal force N in the last of the shorter steps (substeps) into which a step is divided, newton.
    pub normal_force: f64,
    /// Tangential force T in the last of the shorter steps (substeps) into which a step is divided, newton.
    pub tangential_force: f64,
    /// Stiffness of the penalty springs of the contact along the normal and along the tangent, N/m.
    pub stiffness: [f64; 2],
}
