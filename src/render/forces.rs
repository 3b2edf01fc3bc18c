//! Force chains: one link a contact, as wide as its normal force is large.

use super::boundaries::clip;
use super::{Camera, LinkInstance, Palette, Style};
use crate::sim::Snapshot;
use glam::DVec2;

/// Width of the widest link, in units of d.
const FULL_WIDTH: f64 = 0.4;
/// Forces below this part of the reference are left out: their links would be invisible.
const LEAST_PART: f64 = 0.004;
/// The share of contacts whose links are narrower than the full width, where no reference is given.
const REFERENCE_QUANTILE: f64 = 0.95;

/// The |N| (N) that is drawn at full width: the style's own, or the 95th percentile of the
/// snapshot, so that a single huge force does not make all others vanish. 0 without any force.
pub(crate) fn force_reference(style: &Style, snapshot: &Snapshot) -> f64 {
    style.force_reference.unwrap_or_else(|| {
        let mut forces: Vec<f64> = snapshot
            .contacts
            .iter()
            .map(|contact| contact.normal_force.abs())
            .filter(|force| *force > 0.0 && force.is_finite())
            .collect();
        forces.sort_by(f64::total_cmp);
        let index = (REFERENCE_QUANTILE * forces.len() as f64) as usize;
        forces.get(index).copied().unwrap_or(0.0)
    })
}

/// Half the width of a link at the reference force, pixels.
pub(super) fn full_half_width_px(mean_diameter: f64, camera: &Camera) -> f32 {
    camera.pixels(0.5 * FULL_WIDTH * mean_diameter)
}

/// The links of all contacts that show, the strongest on top.
pub(super) fn force_links(
    snapshot: &Snapshot,
    style: &Style,
    palette: &Palette,
    camera: &Camera,
    width: u32,
    height: u32,
) -> Vec<LinkInstance> {
    let reference = force_reference(style, snapshot);
    if !(reference > 0.0 && reference.is_finite()) {
        return Vec::new();
    }
    let full = full_half_width_px(snapshot.surroundings.mean_diameter, camera);
    let periodic = snapshot.surroundings.periodic;
    let reach = DVec2::new(f64::from(width), f64::from(height)) / 2.0 + f64::from(full) + 1.0;
    let mut shown: Vec<_> = snapshot
        .contacts
        .iter()
        .map(|contact| (contact, (contact.normal_force.abs() / reference).min(1.0)))
        .filter(|(_, part)| *part >= LEAST_PART)
        .collect();
    shown.sort_by(|(_, a), (_, b)| a.total_cmp(b));
    shown
        .into_iter()
        .flat_map(|(contact, part)| {
            // One that reaches over a periodic border shows on both sides.
            let reach = [contact.from.min(contact.to), contact.from.max(contact.to)];
            let images = periodic.into_iter().flat_map(move |periodic| periodic.images(reach));
            std::iter::once(DVec2::ZERO).chain(images).map(move |by| (contact, part, by))
        })
        .filter_map(|(contact, part, by)| {
            let ends = [camera.offset_px(contact.from + by), camera.offset_px(contact.to + by)];
            let [start, end] = clip(ends[0], ends[1], reach)?;
            Some(LinkInstance {
                start: start.as_vec2().into(),
                end: end.as_vec2().into(),
                half_width: full * part as f32,
                colour: if contact.normal_force < 0.0 { palette.pull } else { palette.push },
            })
        })
        .collect()
}
