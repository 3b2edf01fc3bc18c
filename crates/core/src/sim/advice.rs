//! Chooses the advice that an alarm (a warning of a failure) gives: the change of the settings or of the scene that is
//! most likely to help.

use crate::setting::words;
use crate::sim::settings::{Settings, SpringDashpot, Stepper, stable_substeps};
use crate::sim::state::State;
use crate::solver::{FrictionModel, Method, SolverSettings};
use crate::world::{FrictionCone, Periodic, Physics, World};

/// Solver tolerance, in the unit of the stop criterion, that no step of a pile reaches because of rounding. If the
/// tolerance of the settings is smaller, the advice on an unsolved step is a larger tolerance.
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
        BondsOfRange = "bonds-of-range", "try the stepper range without remedies: its bonds do not depend on turning";
        BondsOfDem = "bonds-of-dem", "try the stepper dem without remedies: its bonds do not depend on turning";
        Cohesion = "cohesion", "set cohesion = true in the section physics of the scene file";
    }
}

/// Returns the advice if grains were placed in overlap: under `moreau`, the remedy `push-out`, which moves the grains
/// apart; under other steppers, which do not support this remedy, to place the grains apart.
pub(super) fn on_placed(settings: &Settings) -> Advice {
    match settings.stepper {
        Stepper::Moreau => Advice::PushOut,
        _ => Advice::PlaceApart,
    }
}

/// Returns the advice if the cohesion force is 0 although the Bond number is above 0; `None` if this is not the case.
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

/// Returns the advice if bonds ended because their pairs of grains turned: a stepper whose bonds do not depend on
/// turning. This is `dem` with the compressive friction cone, which `range` does not support, and `range` otherwise.
pub(super) fn on_turned_bonds(settings: &Settings) -> Advice {
    match settings.parameters.cone {
        FrictionCone::Compressive => Advice::BondsOfDem,
        FrictionCone::Shifted => Advice::BondsOfRange,
    }
}

/// Returns the advice if a position, a velocity or the kinetic energy is no longer finite.
pub(super) fn on_overflow(state: &State, settings: &Settings) -> Advice {
    match has_too_few_substeps(state, settings) {
        true => Advice::StableSubsteps,
        false => Advice::TimeStep,
    }
}

/// Returns the advice if bodies overlap too deeply. If the springs of `dem` are too soft, also returns their present
/// stiffness, N/m. Springs yield at any time step. Under all other steppers the overlap is deep because the contact was
/// detected too late, so the advice is a shorter time step.
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

/// True if the stepper is `dem` and the number of substeps in the settings is smaller than the number for which its
/// springs are stable.
fn has_too_few_substeps(state: &State, settings: &Settings) -> bool {
    let (parameters, asked) = (&settings.parameters, settings.parameters.substeps);
    let stable = stable_substeps(&state.world, state.physics, parameters);
    settings.stepper == Stepper::Dem && asked > 0 && f64::from(asked) < stable
}

/// Returns the advice if contacts created energy in a solved step: a restitution of 0 or, if it is 0 already, a shorter
/// time step. Under `moreau` and `range` contacts can create energy only with friction.
pub(super) fn on_created_energy(settings: &Settings) -> Advice {
    match settings.parameters.restitution > 0.0 {
        true => Advice::NoRestitution,
        false => Advice::TimeStep,
    }
}

/// Returns the advice if steps are unsolved. `stalled` is true if the residual of the last unsolved step had stopped
/// decreasing.
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
