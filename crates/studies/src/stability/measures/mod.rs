//! What is measured on each scene: an error that is 0 where the answer is right. One file a subject.

mod cohesion;
mod columns;
mod friction;
mod impacts;
mod numbering;
mod piles;
mod size;
mod squeezed;
mod sudden;

pub(super) use cohesion::{bridge, cantilever, chain, shock};
pub(super) use columns::{column, mass_ratio, sag, sagging, size_ratio, sunk};
pub(super) use friction::{blow, dilatancy};
pub(super) use impacts::{bounce, newtons_cradle, thin_wall};
pub(super) use numbering::{far, shuffle};
pub(super) use piles::{arch, friction_limit, repose, repose_angle, rest};
pub(super) use size::{hyperstatic, size};
pub(super) use squeezed::{moving_walls, overlap, squeeze};
pub(super) use sudden::{lift_off, sliders, time_step_switch};
