//! Static packings: how dense they are, how many contacts hold a disc, and how forces are distributed.
//!
//! Discs fall through a medium into a box and come to rest. N discs that are held, less rattlers, have 2N equations of
//! balance without friction and 3N with it. Rigid discs without friction have just as many contacts as that needs,
//! N_c = 2N, so Z = 2N_c/N = 4; the least that friction can do with is N_c = 3N/2, Z = 3, since a contact then carries
//! two forces. A contact with a wall counts as one between discs does.
//!
//! Forces are taken relative to their mean at the same height, as in a box under gravity that grows with depth.

use std::collections::BTreeMap;
use std::f64::consts::PI;

use glam::DVec2;

use super::experiment::{Case, Cases, Experiment, Found, Measured, with};
use super::quantity::{Provenance, Quantity};
use super::start::{loose, settle, wall};
use super::trial::Trial;
use super::way::Way;
use crate::error::Result;
use crate::granular::{MomentMeasures as Moments, measure};
use crate::scene::stability::{DIAMETER, dry};
use crate::sim::{ContactState, Moment, OtherBody};
use crate::statistics::mean;

pub(super) const EXPERIMENT: Experiment = Experiment {
    name: "packing",
    title: "Static packings",
    about: "Discs of d (1 ± 0.2) rained into a box, without friction and with a very large one: solid fraction away \
            from walls, contacts of the discs that are no rattlers, and the tail P(f) ∝ exp(−βf) of the normal forces \
            above their mean.",
    cases: Cases::Chosen(cases),
    judge,
};

/// What stands for μ → ∞.
const LARGE_FRICTION: f64 = 10.0;
/// A contact bears a force where that is more than so much of the mean.
const BEARS_FROM: f64 = 1e-6;
/// What is nearer to a wall or the surface says nothing of the inside, in diameters.
const MARGIN: f64 = 2.5;
/// Height of the layers in which mean forces are taken, in diameters.
const LAYER: f64 = 3.0;

fn cases(quick: bool, way: Way) -> Vec<Case> {
    let (discs, width, seeds) = if quick { (300, 18.0, 6u32) } else { (2_000, 45.0, 12) };
    let mut cases = Vec::new();
    for friction in [0.0, LARGE_FRICTION] {
        for seed in 1..=seeds {
            let at = vec![
                ("friction", friction),
                ("discs", f64::from(discs)),
                ("seed", f64::from(seed)),
            ];
            let run = move || pack(friction, discs as usize, (width, u64::from(seed)), way);
            let cost = f64::from(discs) * 30.0 / way.time_step_secs;
            cases.push(Case { at, cost, run: Box::new(run) });
        }
    }
    cases
}

fn pack(friction: f64, discs: usize, (width, seed): (f64, u64), way: Way) -> Result<Measured> {
    let mut scene = dry("packing", loose(discs, width, seed));
    scene.parameters.friction = friction;
    scene.boundaries = vec![
        wall(0.0, 0.0, DVec2::Y),
        wall(-0.5 * width, 0.0, DVec2::X),
        wall(0.5 * width, 0.0, -DVec2::X),
    ];
    way.take(&mut scene);
    scene.duration_secs = 60.0;
    let mut trial = Trial::start(&scene)?;
    settle(&mut trial)?;
    let moment = trial.simulation.moment();
    let measured = measure(&moment);
    Ok(trial.measured([
        ("solid_fraction", solid_fraction(&moment, &measured, width)),
        ("coordination", coordination(&moment, &measured)),
        ("tail", tail(&moment)),
        ("energy", super::start::energy(&trial.simulation)),
        ("overlap", trial.simulation.observables().mean_overlap),
    ]))
}

/// Solid fraction of the cells away from walls and surface.
fn solid_fraction(moment: &Moment, measured: &Moments, width: f64) -> f64 {
    let margin = MARGIN * DIAMETER;
    let surface = moment.grains.iter().map(|grain| grain.position.y).fold(0.0, f64::max);
    let (mut discs, mut cells) = (0.0, 0.0);
    for (grain, measures) in moment.grains.iter().zip(&measured.grains) {
        let place = grain.position;
        let is_inside = place.x.abs() < 0.5 * width * DIAMETER - margin
            && (margin..surface - 2.0 * margin).contains(&place.y);
        if is_inside && measures.solid_fraction.is_finite() {
            discs += PI * grain.radius * grain.radius;
            cells += measures.cell_area;
        }
    }
    discs / cells
}

/// The contacts that bear a force and lead to no rattler.
fn bearing<'a>(
    moment: &'a Moment,
    measured: &'a Moments,
) -> impl Iterator<Item = &'a ContactState> {
    let sum: f64 = moment.contacts.iter().map(|contact| contact.force().length()).sum();
    let least = BEARS_FROM * sum / moment.contacts.len() as f64;
    let is_held = |grain: u32| !measured.grains[grain as usize].rattler;
    moment.contacts.iter().filter(move |contact| {
        let other_is_held = match contact.other {
            OtherBody::Grain(other) => is_held(other),
            OtherBody::FixedDisc(_) | OtherBody::Boundary(_) => true,
        };
        contact.force().length() > least && is_held(contact.grain) && other_is_held
    })
}

/// Z = 2N_c/N without rattlers.
fn coordination(moment: &Moment, measured: &Moments) -> f64 {
    let held = measured.grains.iter().filter(|grain| !grain.rattler).count();
    2.0 * bearing(moment, measured).count() as f64 / held as f64
}

/// β of the forces f > 1: of an exponential tail the mean of f − 1 is 1/β.
fn tail(moment: &Moment) -> f64 {
    let measured = measure(moment);
    let layer = |contact: &ContactState| (contact.point.y / (LAYER * DIAMETER)).floor() as i64;
    let mut layers: BTreeMap<i64, Vec<f64>> = BTreeMap::new();
    for contact in bearing(moment, &measured) {
        layers.entry(layer(contact)).or_default().push(contact.normal_force);
    }
    // The highest layer is the surface, the lowest the floor.
    let inside = layers.len().saturating_sub(2);
    let mut beyond = Vec::new();
    for forces in layers.values().skip(1).take(inside) {
        let mean = mean(forces).mean;
        beyond.extend(forces.iter().map(|force| force / mean - 1.0).filter(|more| *more > 0.0));
    }
    1.0 / mean(&beyond).mean
}

fn judge(found: &[Found]) -> Vec<Quantity> {
    let discs = found.first().map_or(0.0, |one| one.at("discs"));
    let runs = with(found, "friction", 0.0).count();
    let system = format!("{discs} discs, {runs} runs");
    let quantity = |name: &str, (friction, reading): (f64, &str), band, of| {
        let of_friction = with(found, "friction", friction).map(|one| one.reading(reading));
        Quantity::new(name, &system, mean(&of_friction.collect::<Vec<_>>()), band, of)
    };
    vec![
        quantity(
            "φ without friction",
            (0.0, "solid_fraction"),
            [0.82, 0.84, 0.86],
            (Provenance::Read, "reported for nearly monodisperse discs"),
        ),
        quantity(
            "Z without friction",
            (0.0, "coordination"),
            [3.9, 4.0, 4.1],
            (Provenance::Read, "2D = 4: isostatic"),
        ),
        quantity(
            "Z at μ = 10",
            (LARGE_FRICTION, "coordination"),
            [2.95, 3.1, 3.4],
            (Provenance::Memory, "→ 3 as μ → ∞"),
        ),
        quantity(
            "β without friction",
            (0.0, "tail"),
            [1.2, 1.6, 2.0],
            (Provenance::Memory, "1.4 (Radjai et al. 1996) … 1.8 (experiment)"),
        ),
        quantity(
            "β at μ = 10",
            (LARGE_FRICTION, "tail"),
            [1.2, 1.6, 2.0],
            (Provenance::Memory, "1.4 (Radjai et al. 1996) … 1.8 (experiment)"),
        ),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solver::Method;
    use crate::validate::way::Effort;

    #[test]
    fn a_small_packing_at_rest_has_as_many_contacts_as_it_needs() {
        let effort = Effort::Residual(1e-8);
        let way = Way { method: Method::Newton, time_step_secs: 2e-4, effort };
        let measured = pack(0.0, 60, (8.0, 2), way).expect("a packing");
        let reading = |name: &str| {
            measured.readings.iter().find(|one| one.name == name).expect("a reading").value
        };
        assert!(reading("energy") < 1e-6, "{}", reading("energy"));
        assert!((reading("coordination") - 4.0).abs() < 0.1, "{}", reading("coordination"));
    }
}
