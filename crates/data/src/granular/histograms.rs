//! Counts the contact forces, contact directions, contacts per grain and overlaps of a pile in histograms.
//!
//! The bins are the same for all piles and for all frames, so that counts of several frames and runs can be added.

use super::MomentParts;
use super::stress::axis_degrees;
use crate::sim::Moment;

/// Width of a bin of contact directions, degrees. The first bin is centred at 0, so that the contact directions of
/// square and triangular packings are in the centres of their bins.
const DEGREES: f64 = 5.0;
/// Number of bins of normal forces per mean force: a bin is 1/5 of the mean force wide.
const FORCE_BINS_IN_ONE: i32 = 5;
/// Largest tensile normal force, in units of the mean force, up to which the histogram of normal forces has bins of
/// equal width. One more bin contains all stronger tensile forces.
const FORCES_PULLING: i32 = 4;
/// Largest compressive normal force, in units of the mean force, up to which the histogram of normal forces has bins of
/// equal width. One more bin contains all stronger compressive forces.
const FORCES_PUSHING: i32 = 8;
/// Number of contacts per grain at which the last bin of their histogram begins. This bin includes all larger numbers.
/// Equal discs have at most 6 contacts.
const CONTACTS: u32 = 12;
/// Edges of the bins of overlaps, in mean diameters: 0, and then three per decade from 1e-7 to 0.1.
const OVERLAPS: [f64; 20] = [
    0.0, 1e-7, 2e-7, 5e-7, 1e-6, 2e-6, 5e-6, 1e-5, 2e-5, 5e-5, 1e-4, 2e-4, 5e-4, 1e-3, 2e-3, 5e-3,
    1e-2, 2e-2, 5e-2, 1e-1,
];

/// Histogram of a quantity: the number of values in each bin.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Histogram {
    /// Name of the quantity, one word such as `overlap`.
    pub quantity: &'static str,
    /// Unit of the edges; `1` for a dimensionless quantity.
    pub unit: &'static str,
    /// Edges of the bins. Bin k reaches from `edges[k]`, which belongs to the bin, to `edges[k + 1]`. The first and
    /// last edges may be infinite.
    pub edges: Vec<f64>,
    /// Number of values of the quantity in each bin.
    pub counts: Vec<u64>,
}

/// Computes the histograms of a pile:
///
/// * `normal_force`: the normal force N of each contact that bears a force, divided by the mean of |N|, in bins of 0.2
///   from −4 to 8. Two more bins contain the values below −4 and above 8.
/// * `contact_orientation`: the directions of the normals of all contacts, degrees anticlockwise from the x axis, in
///   bins of 5 from −2.5 to 177.5. A normal counts as an axis without a sign, so directions from 177.5 to 180 count in
///   the bin from −2.5 to 2.5.
/// * `coordination`: the number of contacts of each grain, in bins of one. The last bin has no upper limit.
/// * `overlap`: the overlap of each contact in mean diameters. The first bin contains the contacts with a gap, which
///   have a negative overlap. The next bin reaches from 0 to 1e-7. Then there are three bins per decade (1, 2, 5) up to
///   0.1, and a bin for larger overlaps.
pub fn histograms(moment: &Moment) -> Vec<Histogram> {
    of_parts(&MomentParts::of(moment), moment)
}

pub(super) fn of_parts(parts: &MomentParts, moment: &Moment) -> Vec<Histogram> {
    let MomentParts { network, coordination, forces, .. } = parts;
    let links = &network.links;
    let lower_half = 0.5 * DEGREES;
    let angles = links.iter().map(|link| {
        let angle = axis_degrees(link.normal.to_angle());
        if angle >= 180.0 - lower_half { angle - 180.0 } else { angle }
    });
    let contacts = network.grains().map(|(index, _)| f64::from(coordination.of_grains[index]));
    let diameter = moment.surroundings.mean_diameter;
    let overlaps = links.iter().map(|link| -link.gap / diameter);
    let directions =
        (0..=(180.0 / DEGREES) as i32).map(|bin| f64::from(bin) * DEGREES - lower_half);
    vec![
        Histogram::of("normal_force", "1", edges_of_forces(), forces.over_mean.iter().copied()),
        Histogram::of("contact_orientation", "degree", directions.collect(), angles),
        Histogram::of("coordination", "1", edges_of_contacts(), contacts),
        Histogram::of("overlap", "1", without_ends(OVERLAPS.into_iter()), overlaps),
    ]
}

impl Histogram {
    fn of(
        quantity: &'static str,
        unit: &'static str,
        edges: Vec<f64>,
        values: impl Iterator<Item = f64>,
    ) -> Self {
        let mut counts = vec![0; edges.len() - 1];
        for value in values {
            // Number of edges that are not above the value. NaN compares false, so NaN is in no bin.
            let edges_below = edges.partition_point(|&edge| edge <= value);
            if let Some(count) = edges_below.checked_sub(1).and_then(|bin| counts.get_mut(bin)) {
                *count += 1;
            }
        }
        Self { quantity, unit, edges, counts }
    }
}

fn edges_of_forces() -> Vec<f64> {
    let bins = -FORCES_PULLING * FORCE_BINS_IN_ONE..=FORCES_PUSHING * FORCE_BINS_IN_ONE;
    without_ends(bins.map(|bin| f64::from(bin) / f64::from(FORCE_BINS_IN_ONE)))
}

fn edges_of_contacts() -> Vec<f64> {
    (0..=CONTACTS).map(f64::from).chain([f64::INFINITY]).collect()
}

fn without_ends(edges: impl Iterator<Item = f64>) -> Vec<f64> {
    [f64::NEG_INFINITY].into_iter().chain(edges).chain([f64::INFINITY]).collect()
}
