//! Normal and gap of a disc and another body.

use glam::DVec2;

use super::candidates::Candidates;
use super::numbering::Other;
use crate::world::World;

/// Normal and gap between a disc (centre, radius; m) and another body, or nothing where another feature tells of the
/// touched point.
#[inline(always)]
pub(super) fn approach<const AXES: usize>(
    world: &World,
    candidates: &Candidates,
    (position, radius): (DVec2, f64),
    other: Other,
) -> Option<(DVec2, f64)> {
    let (centre, other_radius) = match other {
        Other::Grain(j) => (world.grains.positions[j], world.grains.radii[j]),
        Other::FixedDisc(disc) => {
            let disc = &world.fixed_discs[disc];
            (disc.position, disc.radius)
        }
        Other::Feature(feature) => {
            let found = candidates.features()[feature].distance(position);
            return found.map(|(normal, distance)| (normal, distance - radius));
        }
    };
    Some(disc_gap::<AXES>(position, centre, radius + other_radius))
}

/// Normal (from j to i) and gap of two discs. Centres that coincide are told apart along x, so that
/// the step stays finite.
#[inline(always)]
fn disc_gap<const AXES: usize>(i: DVec2, j: DVec2, radii: f64) -> (DVec2, f64) {
    if AXES == 1 {
        let offset = i.x - j.x;
        return (DVec2::new(1f64.copysign(offset), 0.0), offset.abs() - radii);
    }
    let offset = i - j;
    let distance = offset.length();
    let normal = if distance > 0.0 { offset / distance } else { DVec2::X };
    (normal, distance - radii)
}
