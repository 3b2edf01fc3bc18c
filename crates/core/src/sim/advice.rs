//! Chooses the advice that an alarm (a warning of a failure) gives: the change of the settings or of the scene that is
//! most likely to help.

use crate::setting::words;
use crate::sim::settings::{Settings, SpringDashpot, Stepper, stable_substeps};
use crate::sim::state::State;
use crate::solver::{FrictionModel, Method, SolverSettings};
use crate::world::{FrictionCone, Periodic, Physics, World};

/// Solver tolerance that is too small for any step of a pile, because rounding errors are larger. It has the unit of
/// the quantity that the tolerance limits: m/s for the stop criterion `impulse-per-mass` (change of the impulses in a
/// sweep, divided by the mean mass), dimensionless for all other stop criteria. If the tolerance in the settings is
/// smaller than this value, the advice for unsolved steps is a larger tolerance.
const BELOW_ROUNDING: f64 = 1e-15;

words! {
    /// Change of the settings or the scene that is most likely to help against the failure that an alarm reports.
    pub enum Advice {
        TimeStep = "time-step", "try a smaller time step";
        Stiffness = "stiffness", "try a larger stiffness";
        StableSubsteps = "stable-substeps", "try 0 substeps, which takes as many as are stable";
        Sweeps = "sweeps", "try more sweeps";
        Tolerance = "tolerance", "try a larger tolerance";
        Newton = "newton", "try solver newton";
        BoundedFriction = "bounded-friction",
            "try solver auto with friction model tresca: a step under Coulomb's law may have no solution";
        RestitutionThreshold = "restitution-threshold",
            "try a restitution threshold of 2: wedged contacts ask for bounces that contradict each other";
        NoRestitution = "no-restitution",
            "try a restitution of 0: several contacts that bounce at once can create energy";
        PushOut = "push-out", "the remedy push-out moves grains apart without giving them speed";
        PlaceApart = "place-apart",
            "place grains apart, as a run by the stepper moreau with the remedy push-out does";
        OutOfWalls = "out-of-walls",
            "it no longer counts in slump; place it outside of walls and fixed polygons";
        Enclose = "enclose",
            "it no longer counts in slump; if it was to stay, put a wall or a floor in its way";
        BondAcceleration = "bond-acceleration",
            "the cohesion force is Bond·m·g, and g is 0; try a bond-acceleration above 0 m/s²";
        TurningBonds = "turning-bonds", "try the remedy turning-bonds, which keeps the bonds of grains that turn";
        BondsOfRange = "bonds-of-range", "try the stepper range without remedies: its bonds do not depend on turning";
        BondsOfDem = "bonds-of-dem", "try the stepper dem without remedies: its bonds do not depend on turning";
        Cohesion = "cohesion", "set cohesion = true in the section physics of the scene file";
    }
}

/// Returns the advice for grains that were placed in overlap. Under the stepper `moreau` it is the remedy `push-out`,
/// which moves the grains apart. Other steppers do not support this remedy, so the advice under them is to place the
/// grains without overlap.
pub(super) fn on_placed(settings: &Settings) -> Advice {
    match settings.stepper {
        Stepper::Moreau => Advice::PushOut,
        _ => Advice::PlaceApart,
    }
}

/// Returns the advice for a Bond number above 0 that has no effect, because cohesion is off, or gravity and the
/// parameter `bond_acceleration` are 0. Returns `None` if the Bond number is 0, or if it causes a cohesion force.
pub(super) fn on_no_cohesion(
    settings: &Settings,
    world: &World,
    physics: Physics,
) -> Option<Advice> {
    let parameters = &settings.parameters;
    match parameters.cohesion_acceleration(world.gravity.magnitude()) {
        _ if parameters.bond == 0.0 => None,
        _ if !physics.cohesion => Some(Advice::Cohesion),
        0.0 => Some(Advice::BondAcceleration),
        _ => None,
    }
}

/// Returns the advice for bonds that ended because their two grains circled each other, which opened the gap, although
/// the bonds could have carried the pull. Under the stepper `moreau` it is the remedy `turning-bonds`, which makes this
/// opening a part of the law. Other steppers do not support the remedy, and it may already be on. Then the advice is a
/// stepper whose bonds do not end this way: `range`, or, under the compressive friction cone (friction bounded by the
/// pushing part of the normal force only), which `range` does not support, the stepper `dem`.
pub(super) fn on_turned_bonds(settings: &Settings) -> Advice {
    match settings.parameters.cone {
        _ if settings.stepper == Stepper::Moreau && !settings.remedies.turning_bonds => {
            Advice::TurningBonds
        }
        FrictionCone::Compressive => Advice::BondsOfDem,
        FrictionCone::Shifted => Advice::BondsOfRange,
    }
}

/// Returns the advice for a position, a velocity or a kinetic energy that is no longer finite: more substeps (equal
/// parts of a step) if the stepper `dem` has too few for stable springs, otherwise a shorter time step.
pub(super) fn on_overflow(state: &State, settings: &Settings) -> Advice {
    match has_too_few_substeps(state, settings) {
        true => Advice::StableSubsteps,
        false => Advice::TimeStep,
    }
}

/// Returns the advice for bodies that overlap too deeply, and the present stiffness of the contact springs, N/m, if the
/// advice is a larger stiffness. Only the stepper `dem` has contact springs. Under it the advice is more substeps
/// (equal parts of a step) if there are too few for stable springs. Otherwise the springs are too soft, which no
/// shorter time step mends, so the advice is a larger stiffness. Under all other steppers the overlap is deep because
/// the contact was detected too late, so the advice is a shorter time step.
pub(super) fn on_depth(state: &State, settings: &Settings) -> (Advice, Option<f64>) {
    if settings.stepper != Stepper::Dem {
        return (Advice::TimeStep, None);
    }
    if has_too_few_substeps(state, settings) {
        return (Advice::StableSubsteps, None);
    }
    let (world, axes) = (&state.world, state.physics.axes);
    let SpringDashpot { stiffness, .. } = SpringDashpot::of(world, axes, &settings.parameters);
    (Advice::Stiffness, Some(stiffness))
}

/// True if the stepper is `dem` and the number of substeps (equal parts of a step) in the settings is smaller than the
/// number for which its springs are stable.
fn has_too_few_substeps(state: &State, settings: &Settings) -> bool {
    let (parameters, asked) = (&settings.parameters, settings.parameters.substeps);
    let stable = stable_substeps(&state.world, state.physics, parameters);
    settings.stepper == Stepper::Dem && asked > 0 && f64::from(asked) < stable
}

/// Returns the advice for contacts that created energy in a solved step: a restitution of 0 or, if the restitution is 0
/// already, a shorter time step.
pub(super) fn on_created_energy(settings: &Settings) -> Advice {
    match settings.parameters.restitution > 0.0 {
        true => Advice::NoRestitution,
        false => Advice::TimeStep,
    }
}

/// Returns the advice for unsolved steps, which miss the tolerance of the solver. `stalled` is true if the residual of
/// the last unsolved step had stopped decreasing.
pub(super) fn on_unsolved(state: &State, settings: &Settings, stalled: bool) -> Advice {
    let Settings { stepper, parameters, solver, .. } = settings;
    if !stalled && solver.max_sweeps < SolverSettings::DEFAULT.max_sweeps {
        return Advice::Sweeps;
    }
    if solver.tolerance < BELOW_ROUNDING {
        return Advice::Tolerance;
    }
    let may_bounce = parameters.restitution > 0.0 && parameters.restitution_threshold == 0.0;
    if stalled && may_bounce && stepper.reads("restitution-threshold") {
        return Advice::RestitutionThreshold;
    }
    // This advice is for Coulomb friction only: with another friction model, solver `newton` would solve another law.
    if solver.friction_model == FrictionModel::Coulomb {
        let newton = Method::Newton.info();
        let is_driven = state.world.motions.iter().any(|motion| motion.drive.is_some());
        let is_sheared = state.world.periodic.is_some_and(Periodic::is_sheared);
        let is_taken = (newton.takes_drives || !is_driven) && (newton.takes_shear || !is_sheared);
        if is_taken && solver.method != Method::Newton {
            return Advice::Newton;
        }
        // With walls driven by a force, solver `auto` stops before the sweep limit, so more sweeps would not help.
        let gives_up = solver.method == Method::Auto;
        // Largest coefficients of any contact, because pairs of materials may have their own coefficients.
        let [friction, rolling] = state.largest_friction(parameters);
        let is_taken = state.physics.friction && friction > 0.0 && rolling == 0.0;
        if (stalled || gives_up) && is_taken {
            return Advice::BoundedFriction;
        }
    }
    if stalled { Advice::Tolerance } else { Advice::Sweeps }
}
