//! Colour scales: the quantity that the colours of grains show, and the range of its values.

use super::colour::{Colour, MATERIALS, map_colour};
use super::numbers::{round_above, si_prefix};
use super::{ColourBy, Style};
use crate::sim::{GrainView, Snapshot};

/// Number of contacts at the upper end of the colour scale. A grain with more contacts has the same colour.
pub(super) const MOST_CONTACTS: u32 = 6;

/// A quantity that the colours of grains show, and its values at the two ends of the colour scale.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ColourScale {
    pub colour_by: ColourBy,
    /// Value at the lower end of the colour scale, in the unit that [`ColourBy`] states.
    pub low: f64,
    pub high: f64,
}

impl ColourScale {
    /// Returns the colour scale of a style. Its range of values is the range that the style states; if the style states
    /// none, the range contains the values of all grains of the snapshot. The scale of the number of contacts always
    /// has the range 0 to [`MOST_CONTACTS`].
    pub(crate) fn new(style: &Style, snapshot: &Snapshot) -> Self {
        let (low, high) = match (style.colour_by, style.range) {
            (ColourBy::Coordination, _) => (0.0, f64::from(MOST_CONTACTS)),
            (_, Some(range)) => range,
            (colour_by, None) => automatic_range(colour_by, snapshot),
        };
        Self { colour_by: style.colour_by, low, high }
    }

    /// Returns the colour of a grain; `mean_diameter` is the mean diameter of all grains, m.
    pub(crate) fn colour(&self, grain: &GrainView, mean_diameter: f64) -> Colour {
        match self.colour_by {
            ColourBy::PaperGreys => Colour::grey(grain.tone),
            ColourBy::Coordination => contact_colour(grain.coordination),
            ColourBy::Material => material_colour(grain.material.into()),
            _ => {
                let span = self.high - self.low;
                let above = quantity(self.colour_by, grain, mean_diameter) - self.low;
                map_colour(if span > 0.0 { above / span } else { 0.0 })
            }
        }
    }

    /// Returns the name of the quantity for the legend, with its unit, and the factor that converts the scale's values
    /// to this unit.
    pub(crate) fn label(&self) -> (String, f64) {
        let (prefix, factor) = si_prefix(self.low.abs().max(self.high.abs()));
        match self.colour_by {
            ColourBy::PaperGreys => (String::new(), 1.0),
            ColourBy::Speed => (format!("speed ({prefix}m/s)"), 1.0 / factor),
            ColourBy::Overlap => ("overlap (% of d)".to_owned(), 100.0),
            ColourBy::Force => (format!("force ΣN ({prefix}N)"), 1.0 / factor),
            ColourBy::Coordination => ("contacts".to_owned(), 1.0),
            ColourBy::Material => ("material".to_owned(), 1.0),
        }
    }
}

pub(crate) fn contact_colour(contacts: u32) -> Colour {
    map_colour(f64::from(contacts.min(MOST_CONTACTS)) / f64::from(MOST_CONTACTS))
}

/// Returns the colour of the material with this number. If there are more materials than colours, the colours repeat.
pub(crate) fn material_colour(number: usize) -> Colour {
    MATERIALS[number % MATERIALS.len()]
}

/// Returns a range of values from zero to a round number that contains the values of all grains of the snapshot. The
/// pictures of an animation all use the largest range of any of them.
pub(crate) fn automatic_range(colour_by: ColourBy, snapshot: &Snapshot) -> (f64, f64) {
    let mean_diameter = snapshot.surroundings.mean_diameter;
    let largest = snapshot
        .grains
        .iter()
        .map(|grain| quantity(colour_by, grain, mean_diameter))
        .filter(|value| value.is_finite())
        .fold(0.0, f64::max);
    // If all values are zero, every range shows them at its lower end.
    let idle = if colour_by == ColourBy::Overlap { 0.01 } else { 1.0 };
    (0.0, if largest > 0.0 { round_above(largest) } else { idle })
}

fn quantity(colour_by: ColourBy, grain: &GrainView, mean_diameter: f64) -> f64 {
    match colour_by {
        ColourBy::PaperGreys => f64::from(grain.tone),
        ColourBy::Speed => grain.velocity.length(),
        ColourBy::Overlap => grain.overlap / mean_diameter,
        ColourBy::Force => grain.force,
        ColourBy::Coordination => f64::from(grain.coordination),
        ColourBy::Material => f64::from(grain.material),
    }
}
