//! Where methods fail: scenes made to break them, each with a right answer, what was measured on it,
//! and the parameter that drives it into failure. A scene is in `scene::stability`, its measure in `rest` or `motion`
//! here, and [`CHALLENGES`] lists all.

mod maps;
mod motion;
mod rest;
mod table;

use std::sync::LazyLock;

pub use maps::{contraction_of_column, count_of_maps, maps};
pub use table::{StabilityCell, StabilityTable, StabilityVerdict, picture};

use crate::config::{Config, SceneSource};
use crate::contact::Numbering;
use crate::error::{Error, Result};
use crate::harness::Change;
use crate::scene::{Preset, Scene};
use crate::sim::{Simulation, Stepper};
use crate::solver::{FrictionModel, METHODS, Method, Ordering, SolverChanges, SolverSettings};

/// A scene made to break methods, and what is measured on it.
#[derive(Clone, Copy, Debug)]
pub struct Challenge {
    /// Its name on the command line and in the table.
    pub name: &'static str,
    /// What drives it into failure, with its unit.
    driver: &'static str,
    /// The values of the driver that a quick pass tries, from harmless to harmful.
    pub quick: &'static [f64],
    /// Further values of a full pass, more harmful still.
    further: &'static [f64],
    /// Up to the first error it holds, above the second it fails; between the two it degrades.
    limits: [f64; 2],
    error: fn(&Trial) -> Result<f64>,
}

impl Challenge {
    /// The challenge of that name.
    ///
    /// # Errors
    /// Where there is none.
    pub fn named(name: &str) -> Result<&'static Self> {
        let names = || CHALLENGES.map(|challenge| challenge.name).join(", ");
        CHALLENGES
            .iter()
            .find(|challenge| challenge.name == name)
            .ok_or_else(|| Error::value("scene", name, format!("one of {}", names())))
    }

    const fn further(self, further: &'static [f64]) -> Self {
        Self { further, ..self }
    }

    /// The error of a trial; infinite where the state is no longer finite.
    fn error(&self, trial: &Trial) -> Result<f64> {
        match (self.error)(trial) {
            Ok(error) if error.is_nan() => Ok(f64::INFINITY),
            Err(Error::NonFinite { .. }) => Ok(f64::INFINITY),
            error => error,
        }
    }
}

/// Drivers and levels of several challenges.
const TIME_STEP: &str = "time step (s)";
const MASSES: &str = "ratio of masses";
const STEPS: &[f64] = &[2e-4, 1e-3, 5e-3, 2e-2];
const LONG_STEPS: &[f64] = &[1e-3, 5e-3, 2e-2];
const SHORT_STEPS: &[f64] = &[1e-4, 1e-3, 5e-3];
const RATIOS: &[f64] = &[10.0, 100.0, 1e3, 1e4];

const fn challenge(
    name: &'static str,
    driver: &'static str,
    quick: &'static [f64],
    limits: [f64; 2],
    error: fn(&Trial) -> Result<f64>,
) -> Challenge {
    Challenge { name, driver, quick, further: &[], limits, error }
}

/// All challenges.
pub static CHALLENGES: [Challenge; 28] = [
    challenge("column", "discs", &[5.0, 20.0, 80.0, 200.0], [0.01, 0.2], rest::column)
        .further(&[500.0]),
    challenge("sag", "sweeps a step", &[2000.0, 200.0, 20.0, 4.0], [0.01, 0.2], rest::sag),
    challenge("mass-ratio", MASSES, RATIOS, [0.01, 0.2], rest::mass_ratio),
    challenge(
        "size-ratio",
        "ratio of radii",
        &[2.0, 5.0, 20.0, 100.0],
        [0.01, 0.2],
        rest::size_ratio,
    ),
    challenge("chain", TIME_STEP, STEPS, [0.02, 0.2], rest::chain),
    challenge("cantilever", TIME_STEP, STEPS, [0.1, 1.0], rest::cantilever),
    challenge("bridge", TIME_STEP, STEPS, [0.1, 1.0], rest::bridge),
    challenge("shock", "tolerance (m/s)", &[1e-12, 1e-6, 2.2e-3], [0.01, 0.1], rest::shock),
    challenge("overlap", "overlap (d)", &[0.01, 0.1, 0.5], [0.05, 1.1], rest::overlap),
    challenge("squeeze", "strain", &[1e-4, 1e-2, 5e-2], [1e-3, 0.1], rest::squeeze),
    challenge("moving-walls", TIME_STEP, &[5e-4, 3e-3, 2e-2], [0.05, 0.5], rest::moving_walls),
    challenge("friction-limit", TIME_STEP, LONG_STEPS, [0.05, 0.3], rest::friction_limit),
    challenge("arch", TIME_STEP, LONG_STEPS, [0.05, 0.3], rest::arch),
    challenge("repose", TIME_STEP, LONG_STEPS, [0.01, 0.2], rest::repose),
    challenge("repose-angle", "rows", &[2.0, 6.0, 12.0], [0.02, 0.2], rest::repose_angle)
        .further(&[24.0]),
    challenge("rest", "steps", &[300.0, 10000.0], [0.01, 0.2], rest::rest).further(&[1e5]),
    challenge("bounce", "restitution", &[0.0, 0.5, 0.9, 1.0], [0.01, 0.1], motion::bounce),
    challenge("newtons-cradle", "balls", &[2.0, 3.0, 20.0], [0.05, 0.5], motion::newtons_cradle),
    challenge("thin-wall", "travel a step (d)", &[0.4, 1.0, 4.0], [0.0, 0.3], motion::thin_wall),
    challenge(
        "far",
        "distance from the origin (d)",
        &[1e3, 1e6, 1e9, 1e13],
        [0.01, 0.2],
        motion::far,
    ),
    challenge("shuffle", "tolerance", &[1e-9, 1e-6, 1e-3, 1e-1], [1e-4, 0.1], motion::shuffle),
    challenge("lift-off", MASSES, RATIOS, [1e-3, 0.1], motion::lift_off),
    challenge(
        "time-step-switch",
        "factor on 2e-4 s",
        &[2.0, 10.0, 50.0, 200.0],
        [0.01, 0.2],
        motion::time_step_switch,
    ),
    challenge(
        "sliders",
        "seconds of sliders at random",
        &[0.5, 2.0, 8.0],
        [0.0, 0.0],
        motion::sliders,
    )
    .further(&[60.0]),
    challenge("dilatancy", TIME_STEP, SHORT_STEPS, [0.01, 0.1], motion::dilatancy).further(&[2e-2]),
    challenge("blow", TIME_STEP, SHORT_STEPS, [0.01, 0.1], motion::blow),
    challenge("hyperstatic", "displacement (d)", &[1e-4], [0.01, 0.2], rest::hyperstatic)
        .further(&[1e-6]),
    challenge("size", "grains", &[138.0, 500.0], [1e-3, 0.1], rest::size)
        .further(&[2000.0, 10000.0]),
];

/// The name of the variant that leaves scenes as they are stepped by default.
const DEFAULT: &str = "default";

/// Has a scene stepped by a variant.
fn step_by(variant: &Change, scene: &mut Scene) {
    if variant.name != DEFAULT {
        sweep_instead(&mut scene.solver);
    }
    variant.apply(scene);
}

/// Stops by the change of a sweep where a scene leaves it to the default, so that methods are told apart by what they do
/// rather than by what is asked of them.
fn sweep_instead(solver: &mut SolverSettings) {
    let (default, sweeps) = (SolverSettings::DEFAULT, SolverSettings::SWEEPS);
    if solver.stop == default.stop {
        solver.stop = sweeps.stop;
        if solver.tolerance == default.tolerance {
            solver.tolerance = sweeps.tolerance;
        }
    }
    if solver.friction_model == default.friction_model {
        (solver.friction_model, solver.model_solves) = (sweeps.friction_model, sweeps.model_solves);
    }
}

/// All variants: the default, every method, every stepper without one, every model of friction that neither it nor these
/// have, and settings that mend a known failure.
static VARIANTS: LazyLock<Vec<Change>> = LazyLock::new(|| {
    let solver = |name, method, ordering, friction_model| {
        let default = SolverChanges::default();
        let solver = SolverChanges { method: Some(method), ordering, friction_model, ..default };
        Change::new(name, Config { solver, ..Config::default() })
    };
    let mut all = vec![Change::new(DEFAULT, Config::default())];
    all.extend(METHODS.iter().map(|info| solver(info.name, info.method, None, None)));
    for stepper in Stepper::ALL.iter().filter(|stepper| !stepper.uses_method()) {
        let config = Config { stepper: Some(*stepper), ..Config::default() };
        all.push(Change::new(stepper.name(), config));
    }
    for model in [FrictionModel::Associated, FrictionModel::Desaxce] {
        all.push(solver(model.name(), Method::InteriorPoint, None, Some(model)));
    }
    all.push(solver("nsgs bottom-up", Method::Nsgs, Some(Ordering::BottomUp), None));
    let source = SceneSource { preset: Some(Preset::Robust), ..SceneSource::default() };
    all.push(Change::new("robust", Config { source, ..Config::default() }));
    all
});

/// One variant at one level of a challenge.
#[derive(Clone, Copy, Debug)]
pub struct Trial {
    variant: &'static Change,
    /// The value of the parameter that drives the scene into failure.
    level: f64,
}

impl Trial {
    fn start(&self, mut scene: Scene) -> Result<Simulation> {
        step_by(self.variant, &mut scene);
        scene.simulation()
    }

    /// The same with so many sweeps a step, whatever the variant says of them.
    fn start_within(&self, sweeps: u32, mut scene: Scene) -> Result<Simulation> {
        step_by(self.variant, &mut scene);
        scene.solver.max_sweeps = sweeps;
        scene.simulation()
    }

    fn count(&self) -> usize {
        self.level as usize
    }
}

fn advance(simulation: &mut Simulation, secs: f64) -> Result<()> {
    simulation.take_steps(simulation.parameters().steps_in(secs))
}

/// The longest way that any grain has gone since `scene`, in d.
fn longest_way(simulation: &Simulation, scene: &Scene) -> f64 {
    let now = &simulation.world().grains.positions;
    let ways = scene.grains.iter().zip(now).map(|(grain, now)| grain.position.distance(*now));
    ways.fold(0.0, f64::max) / scene.mean_diameter
}

/// √(2 E_kin/M), in √(g d).
fn jitter(simulation: &Simulation) -> f64 {
    let world = simulation.world();
    let mass: f64 = world.grains.masses.iter().sum();
    let scale = world.gravity.magnitude() * world.mean_diameter;
    (2.0 * simulation.observables().kinetic_energy / (mass * scale)).sqrt()
}

/// m g d of the first disc, J.
fn energy_scale(simulation: &Simulation) -> f64 {
    let world = simulation.world();
    world.grains.masses[0] * world.gravity.magnitude() * world.mean_diameter
}

/// The longest way of any grain since `scene`, in d, or the speed that is left, in √(g d), whichever is
/// larger: 0 for what stays at rest.
fn unrest(simulation: &Simulation, scene: &Scene) -> f64 {
    longest_way(simulation, scene).max(jitter(simulation))
}

/// What the fixed bodies carry along the y axis, N: the sum of N n_y over their contacts.
fn force_on_ground(simulation: &Simulation) -> f64 {
    let numbering = Numbering::of(simulation.world());
    let list = simulation.contacts();
    let pairs = list.contacts().iter().zip(list.impulses());
    let of_ground = pairs.filter(|(contact, _)| numbering.other(contact.other).grain().is_none());
    let impulse: f64 = of_ground.map(|(contact, impulse)| impulse.normal * contact.normal.y).sum();
    impulse / simulation.parameters().time_step_secs
}

/// Where a property that holds above a threshold begins, searched between `low` and `high` in
/// ratio, with so many halvings.
fn threshold(
    [mut low, mut high]: [f64; 2],
    halvings: u32,
    mut holds: impl FnMut(f64) -> Result<bool>,
) -> Result<f64> {
    for _ in 0..halvings {
        let middle = (low * high).sqrt();
        if holds(middle)? {
            high = middle;
        } else {
            low = middle;
        }
    }
    Ok((low * high).sqrt())
}
