//! Validates static packings of discs: their solid fraction, coordination number, and distribution of contact forces.
//!
//! Discs fall through a medium into a box and come to rest. Let N be the number of discs that carry forces, without
//! rattlers (loose discs). Their equilibrium has 2N equations without friction and 3N with friction. Frictionless rigid
//! discs have exactly as many contacts as equations, N_c = 2N, so the number of contacts per disc is Z = 2N_c/N = 4.
//! With friction a contact carries two force components, so the smallest possible number of contacts is N_c = 3N/2, and
//! Z = 3. A contact with a wall counts like a contact between discs.
//!
//! Forces are divided by the mean force at the same height, because in a box under gravity the mean grows with depth.

use std::collections::BTreeMap;

use super::experiment::*;
use super::variants::StepVariant;
use super::watched::{loose, mean_energy, open_box, settled, solid_fraction};
use crate::error::Result;
use crate::granular::measure;
use crate::scene::stability::{DIAMETER, dry};
use crate::sim::{ContactState, Moment, OtherBody};
use crate::statistics::mean;

pub(super) const EXPERIMENT: Experiment = Experiment {
    name: "packing",
    title: "Static packings",
    about: "Discs of d (1 ± 0.2) rained into a box, without friction and with a very large one: solid fraction away \
            from walls, contacts of the discs that are no rattlers, and the tail P(f) ∝ exp(−βf) of the normal forces \
            above their mean.",
    cases: ExperimentCases::Chosen(cases),
    published: PUBLISHED,
    judge,
};

/// Friction coefficient with which packings of discs with infinite friction are simulated approximately.
const LARGE_FRICTION: f64 = 10.0;
/// Contact force above which a contact counts as bearing a force, as a fraction of the mean contact force.
const BEARS_FROM: f64 = 1e-6;
/// Width of the margin along the walls in which grains are left out of the solid fraction, in diameters. The margin
/// below the surface of the packing is twice as wide.
const MARGIN: f64 = 2.5;
/// Height of the horizontal layers over which contact forces are averaged, in diameters.
const LAYER: f64 = 3.0;

fn cases(effort: Effort, variant: StepVariant) -> Vec<ExperimentCase> {
    let (discs, width, seeds) = effort.pick((300, 18.0, 6), (2_000, 45.0, 12));
    let cost = f64::from(discs) * 30.0 / variant.time_step_secs;
    seeded(&[0.0, LARGE_FRICTION], seeds, |friction, seed| {
        let at = [("friction", friction), ("discs", f64::from(discs)), ("seed", seed as f64)];
        let run = move || pack(friction, discs as usize, width, seed, variant);
        ExperimentCase::new(&at, cost, run)
    })
}

fn pack(
    friction: f64,
    discs: usize,
    width: f64,
    seed: u64,
    variant: StepVariant,
) -> Result<RunReadings> {
    let mut scene = dry("packing", loose(discs, width, seed));
    scene.parameters.friction = friction;
    scene.boundaries = open_box(width);
    variant.apply(&mut scene);
    scene.duration_secs = 60.0;
    let run = settled(&scene)?;
    let moment = run.simulation.moment();
    // Only cells away from the walls and the surface count.
    let margin = MARGIN * DIAMETER;
    let surface = moment.grains.iter().map(|grain| grain.position.y).fold(0.0, f64::max);
    let solid_fraction = solid_fraction(&moment, |place| {
        place.x.abs() < 0.5 * width * DIAMETER - margin
            && (margin..surface - 2.0 * margin).contains(&place.y)
    });
    let is_rattler: Vec<bool> = measure(&moment).grains.iter().map(|one| one.rattler).collect();
    let bearing = bearing(&moment, &is_rattler);
    let held = is_rattler.iter().filter(|is_rattler| !**is_rattler).count();
    Ok(run.with([
        ("solid_fraction", solid_fraction),
        // The coordination number is Z = 2N_c/N, with N_c contacts and N discs without rattlers.
        ("coordination", 2.0 * bearing.len() as f64 / held as f64),
        ("tail", tail(&bearing)),
        ("energy", mean_energy(&run.simulation)),
        ("overlap", run.simulation.observables().mean_overlap),
    ]))
}

/// Returns the contacts that bear a force and in which neither body is a rattler (a loose grain).
fn bearing<'a>(moment: &'a Moment, is_rattler: &[bool]) -> Vec<&'a ContactState> {
    let sum: f64 = moment.contacts.iter().map(|contact| contact.force.length()).sum();
    let least = BEARS_FROM * sum / moment.contacts.len() as f64;
    let is_held = |grain: u32| !is_rattler[grain as usize];
    let bears = |contact: &&ContactState| {
        let other_is_held = match contact.other {
            OtherBody::Grain(other) => is_held(other),
            OtherBody::FixedDisc(_) | OtherBody::Boundary(_) => true,
        };
        contact.force.length() > least && is_held(contact.grain) && other_is_held
    };
    moment.contacts.iter().filter(bears).collect()
}

/// Returns the constant β of the exponential tail P(f) ∝ exp(−βf) of the probability density P of the normal forces f.
/// Forces are divided by the mean force at the same height, and the tail consists of the forces f > 1. For an
/// exponential tail the mean of f − 1 is 1/β.
fn tail(bearing: &[&ContactState]) -> f64 {
    let mut layers: BTreeMap<i64, Vec<f64>> = BTreeMap::new();
    for contact in bearing {
        let layer = (contact.point.y / (LAYER * DIAMETER)).floor() as i64;
        layers.entry(layer).or_default().push(contact.normal_force);
    }
    // The highest layer is at the surface and the lowest at the floor, so both are left out.
    let inside = layers.len().saturating_sub(2);
    let mut beyond = Vec::new();
    for forces in layers.values().skip(1).take(inside) {
        let mean = mean(forces).mean;
        beyond.extend(forces.iter().map(|force| force / mean - 1.0).filter(|more| *more > 0.0));
    }
    1.0 / mean(&beyond).mean
}

/// Table of published values as text, with one row for each quantity that the function [`judge`] computes from the
/// runs. A row has the form: name of the quantity | lower end of the band of values that agree, published value, upper
/// end of the band | kind of the source (`read`, `recalled`, `derived` or `exact`): source.
const PUBLISHED: &str = "
    φ without friction | 0.82 0.84 0.86 | read: reported for nearly monodisperse discs
    Z without friction | 3.9 4 4.1 | read: 2D = 4: isostatic
    Z at μ = 10 | 2.95 3.1 3.4 | recalled: → 3 as μ → ∞
    β without friction | 1.2 1.6 2 | recalled: 1.4 (Radjai et al. 1996) … 1.8 (experiment)
    β at μ = 10 | 1.2 1.6 2 | recalled: 1.4 (Radjai et al. 1996) … 1.8 (experiment)
";

fn judge(all: &Measurements) -> Vec<Measured> {
    let runs = all.with("friction", 0.0).0.len();
    let system = format!("{} discs, {runs} runs", all.first("discs"));
    let values = [
        (0.0, "solid_fraction"),
        (0.0, "coordination"),
        (LARGE_FRICTION, "coordination"),
        (0.0, "tail"),
        (LARGE_FRICTION, "tail"),
    ];
    let of = |(friction, reading)| all.with("friction", friction).readings(reading);
    values.map(|row| (system.clone(), of(row))).into()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sim::Stepper;
    use crate::solver::Method;
    use crate::validate::variants::SolveBudget;

    #[test]
    fn a_small_packing_at_rest_has_as_many_contacts_as_it_needs() {
        let budget = SolveBudget::Residual(1e-8);
        let variant = StepVariant {
            stepper: Stepper::Moreau,
            method: Method::Newton,
            time_step_secs: 2e-4,
            budget,
        };
        let run = pack(0.0, 60, 8.0, 2, variant).expect("a packing");
        assert!(run.reading("energy") < 1e-6, "{}", run.reading("energy"));
        assert!((run.reading("coordination") - 4.0).abs() < 0.1, "{}", run.reading("coordination"));
    }
}
