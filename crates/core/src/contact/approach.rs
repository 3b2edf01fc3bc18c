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
            let found = candidates.distance(world, feature, position);
            return found.map(|(normal, distance)| (normal, distance - radius));
        }
    };
    let offset = world.shortest(position - centre);
    Some(disc_gap::<AXES>(offset, radius + other_radius))
}

/// Normal (from j to i) and gap of two discs, i being off j by `offset`. Centres that coincide are told apart along x, so that
/// the step stays finite.
#[inline(always)]
fn disc_gap<const AXES: usize>(offset: DVec2, radii: f64) -> (DVec2, f64) {
    if AXES == 1 {
        return (DVec2::new(1f64.copysign(offset.x), 0.0), offset.x.abs() - radii);
    }
    let distance = offset.length();
    let normal = if distance > 0.0 { offset / distance } else { DVec2::X };
    (normal, distance - radii)
}
