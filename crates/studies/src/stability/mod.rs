//! Runs stability tests: scenes that are made to break solver methods. Each test has a known right answer, a measured
//! error, and a driving parameter, which makes the scene more difficult until a method fails. The scenes are in
//! `scene::stability`, the measures of error are in `rest` and `motion`, and [`CHALLENGES`] lists all tests.

mod maps;
mod motion;
mod rest;
mod seen;
mod table;

use std::sync::LazyLock;

use glam::DVec2;

pub use maps::{contraction_of_column, count_of_maps, maps};
pub use seen::SeenError;
pub use table::{StabilityCell, StabilityTable, StabilityVerdict, picture};

use crate::config::{Config, SceneSource};
use crate::contact::Numbering;
use crate::error::{Error, Result};
use crate::harness::Change;
use crate::scene::{Preset, Scene, SceneInfo};
use crate::sim::{Simulation, Snapshot, Stepper};
use crate::solver::{FrictionModel, METHODS, Method, Ordering, SolverChanges, SolverSettings};
use crate::world::World;

/// A stability test: a scene that is made to break solver methods, with a measure of the error of a run.
#[derive(Clone, Copy, Debug)]
pub struct Challenge {
    /// Name of the test on the command line and in the table.
    pub name: &'static str,
    /// Name and unit of the driving parameter: the parameter of the scene that is changed until a solver method fails.
    driver: &'static str,
    /// Values of the driving parameter in a quick pass (a pass with fewer runs), from the easiest to the most
    /// difficult.
    pub quick: &'static [f64],
    /// Values of the driving parameter that only the full pass tests, in addition to those of the quick pass (a pass
    /// with fewer runs). They are more difficult than the values of the quick pass.
    further: &'static [f64],
    /// Two limits of the error, in its unit: up to the first limit a method gets the verdict "holds", up to the second
    /// "degrades", and above the second "fails".
    limits: [f64; 2],
    error: fn(&Trial) -> Result<f64>,
    /// Right answer as a sentence, and a measure of the error at a single time of a run, for the graphical window;
    /// `None` if the window shows no error. Both refer to the scene that has the same name as the test.
    seen: Option<(&'static str, SeenError)>,
}

/// The verdict on a run of a stability test at a single simulated time.
#[derive(Clone, Copy, Debug)]
pub struct SeenVerdict {
    /// Name and unit of the measured error, as text.
    pub name: &'static str,
    /// Value of the measured error; 0 for the right answer.
    pub error: f64,
    /// Largest error with which the result counts as right.
    pub limit: f64,
}

impl SeenVerdict {
    /// True if the error is small enough for the result to count as right.
    pub fn is_right(&self) -> bool {
        self.error <= self.limit
    }
}

impl Challenge {
    /// Returns the stability test that defines the right answer of the scene with the given name; `None` if there is no
    /// such test.
    pub fn seen_in(scene: &str) -> Option<&'static Self> {
        let info = SceneInfo::named(scene)?;
        let is_of =
            |challenge: &&Self| challenge.name == info.name || info.also.contains(&challenge.name);
        CHALLENGES.iter().filter(is_of).find(|challenge| challenge.seen.is_some())
    }

    /// Returns a sentence with the right answer of the test's scene; `None` if the graphical window shows no error for
    /// the scene.
    pub fn right_answer(&self) -> Option<&'static str> {
        self.seen.map(|(right, _)| right)
    }

    /// Returns the verdict on the snapshot `now` of a run of the test's scene. `start` is the simulation at the
    /// beginning of the run. Returns `None` if it is too early for a verdict, or if the number of grains has changed.
    pub fn verdict(&self, start: &Simulation, now: &Snapshot) -> Option<SeenVerdict> {
        let (_, SeenError { name, of }) = self.seen.filter(|_| now.observables.step > 0)?;
        let is_whole = start.world().grains.len() == now.grains.len();
        let error = of(start, now).filter(|_| is_whole)?;
        // An error that is NaN counts as infinite.
        let error = if error.is_nan() { f64::INFINITY } else { error };
        Some(SeenVerdict { name, error, limit: self.limits[0] })
    }

    /// Returns the stability test with the given name.
    ///
    /// # Errors
    /// If no test has this name.
    pub fn named(name: &str) -> Result<&'static Self> {
        let names = || CHALLENGES.iter().map(|it| it.name).collect::<Vec<_>>().join(", ");
        CHALLENGES
            .iter()
            .find(|challenge| challenge.name == name)
            .ok_or_else(|| Error::value("scene", name, format!("one of {}", names())))
    }

    /// Runs this stability test with one solver variant and one value of the driving parameter (a trial), and returns
    /// the error; infinite if positions or velocities become NaN or infinite.
    fn error(&self, trial: &Trial) -> Result<f64> {
        match (self.error)(trial) {
            Ok(error) if error.is_nan() => Ok(f64::INFINITY),
            Err(Error::NonFinite { .. }) => Ok(f64::INFINITY),
            error => error,
        }
    }
}

/// Name and unit of the driving parameter (the parameter that makes the test more difficult) of those stability tests
/// in which it is the time step.
const TIME_STEP: &str = "time step (s)";
/// Name of the driving parameter (the parameter that makes the test more difficult) of those stability tests in which
/// it is the ratio of two masses.
const MASSES: &str = "ratio of masses";
/// Time steps of a quick pass (a pass with fewer runs), s, in the stability tests of a hanging chain, a cantilever and
/// a bridge.
const STEPS: &[f64] = &[2e-4, 1e-3, 5e-3, 2e-2];
/// Time steps of a quick pass (a pass with fewer runs), s, in the stability tests of heaps, arches and logs.
const LONG_STEPS: &[f64] = &[1e-3, 5e-3, 2e-2];
/// Time steps of a quick pass (a pass with fewer runs), s, in the stability tests of sliding discs.
const SHORT_STEPS: &[f64] = &[1e-4, 1e-3, 5e-3];
/// Mass ratios of a quick pass (a pass with fewer runs), in stability tests whose driving parameter is the ratio of two
/// masses.
const RATIOS: &[f64] = &[10.0, 100.0, 1e3, 1e4];

/// Makes [`CHALLENGES`]. Each row has the values of the fields of a [`Challenge`], in their order.
macro_rules! challenges {
    ($($name:literal, $driver:expr, $quick:expr, $further:expr, $limits:expr, $error:expr, $seen:expr;)*) => {
        /// All stability tests.
        pub static CHALLENGES: &[Challenge] = &[$(Challenge {
            name: $name,
            driver: $driver,
            quick: $quick,
            further: $further,
            limits: $limits,
            error: $error,
            seen: $seen,
        }),*];
    };
}

challenges! {
    "column", "discs", &[5.0, 20.0, 80.0, 200.0], &[500.0], [0.01, 0.2], rest::column, None;
    "sag", "sweeps a step", &[2000.0, 200.0, 20.0, 4.0], &[], [0.01, 0.2], rest::sag,
        Some(("The floor carries the column, and no disc sinks.", seen::MOVED));
    "mass-ratio", MASSES, RATIOS, &[], [0.01, 0.2], rest::mass_ratio,
        Some(("The light disc carries the heavy disc, and neither sinks.", seen::MOVED));
    "size-ratio", "ratio of radii", &[2.0, 5.0, 20.0, 100.0], &[], [0.01, 0.2], rest::size_ratio,
        Some(("The small discs carry the large disc, and none moves.", seen::MOVED));
    "chain", TIME_STEP, STEPS, &[], [0.02, 0.2], rest::chain,
        Some(("The chain holds: its Bond is 1.2 times the one that breaks it.", seen::MOVED));
    "cantilever", TIME_STEP, STEPS, &[], [0.1, 1.0], rest::cantilever,
        Some(("The two rows hold at the wall.", seen::MOVED));
    "bridge", TIME_STEP, STEPS, &[], [0.1, 1.0], rest::bridge,
        Some(("The two rows hold between the walls.", seen::MOVED));
    "shock", "tolerance (m/s)", &[1e-12, 1e-6, 2.2e-3], &[], [0.01, 0.1], rest::shock, None;
    "overlap", "overlap (d)", &[0.01, 0.1, 0.5], &[], [0.05, 1.1], rest::overlap,
        Some(("The overlap disappears without a jump of the discs.", seen::OVERLAP));
    "squeeze", "strain", &[1e-4, 1e-2, 5e-2], &[], [1e-3, 0.1], rest::squeeze,
        Some(("The discs come to rest, although the box is too small for them.", seen::RESTLESS));
    "moving-walls", TIME_STEP, &[5e-4, 3e-3, 2e-2], &[], [0.05, 0.5], rest::moving_walls,
        Some(("The walls push each disc to its one possible place.", seen::PRESSED));
    "friction-limit", TIME_STEP, LONG_STEPS, &[], [0.05, 0.3], rest::friction_limit, None;
    "arch", TIME_STEP, LONG_STEPS, &[], [0.05, 0.3], rest::arch,
        Some(("The arch stands: its friction is 1.05 times the least that holds it.", seen::MOVED));
    "leaning-column", "discs", &[2.0, 5.0, 20.0, 80.0], &[], [0.05, 0.3], rest::leaning_column,
        Some(("The column holds: its rolling friction is 1.05 times the least that holds it.", seen::MOVED));
    "repose", TIME_STEP, LONG_STEPS, &[], [0.01, 0.2], rest::repose, Some(("The heap stands still.", seen::MOVED));
    "repose-angle", "rows", &[2.0, 6.0, 12.0], &[24.0], [0.02, 0.2], rest::repose_angle,
        Some(("The heap stands still: up to 30 degrees it holds.", seen::MOVED));
    "rest", "steps", &[300.0, 10000.0], &[1e5], [0.01, 0.2], rest::rest, None;
    "bounce", "restitution", &[0.0, 0.5, 0.9, 1.0], &[], [0.01, 0.1], motion::bounce,
        Some(("Each bounce leaves ρ² of the energy.", seen::BOUNCED));
    "newtons-cradle", "balls", &[2.0, 3.0, 20.0], &[], [0.05, 0.5], motion::newtons_cradle,
        Some(("The last ball flies off alone, as fast as the first ball came.", seen::LAST_BALL));
    "thin-wall", "travel a step (d)", &[0.4, 1.0, 4.0], &[], [0.0, 0.3], motion::thin_wall,
        Some(("The disc does not pass the wall.", seen::THROUGH));
    "far", "distance from the origin (d)", &[1e3, 1e6, 1e9, 1e13], &[], [0.01, 0.2], motion::far,
        Some(("The heap stands still, as at the origin.", seen::MOVED));
    "shuffle", "tolerance", &[1e-9, 1e-6, 1e-3, 1e-1], &[], [1e-4, 0.1], motion::shuffle, None;
    "lift-off", MASSES, RATIOS, &[], [1e-3, 0.1], motion::lift_off,
        Some(("The column carries the heavy disc, and no disc jumps.", seen::KINETIC));
    "time-step-switch", "factor on 2e-4 s", &[2.0, 10.0, 50.0, 200.0], &[], [0.01, 0.2], motion::time_step_switch, None;
    "sliders", "seconds of sliders at random", &[0.5, 2.0, 8.0], &[60.0], [0.0, 0.0], motion::sliders, None;
    "dilatancy", TIME_STEP, SHORT_STEPS, &[2e-2], [0.01, 0.1], motion::dilatancy,
        Some(("Friction does not lift the disc: it slides on the floor.", seen::OFF_LEVEL));
    "blow", TIME_STEP, SHORT_STEPS, &[], [0.01, 0.1], motion::blow,
        Some(("Friction takes μ times the impulse of the blow, in the step of the blow.", seen::BLOWN));
    "hyperstatic", "displacement (d)", &[1e-4], &[1e-6], [0.01, 0.2], rest::hyperstatic,
        Some(("The discs stay at rest.", seen::MOVED));
    "size", "grains", &[138.0, 500.0], &[2000.0, 10000.0], [1e-3, 0.1], rest::size, None;
}

/// Name of the variant that runs a scene with its own settings.
const DEFAULT: &str = "default";

/// Applies a variant, which is a named change of the stepper or the solver, to the settings of a scene.
fn step_by(variant: &Change, scene: &mut Scene) {
    if variant.name != DEFAULT {
        sweep_instead(&mut scene.solver);
    }
    variant.apply(scene);
}

/// Replaces the default stopping test, tolerance and friction model of a scene by those for Gauss–Seidel sweeps. Then
/// all solver methods solve the same problem to the same tolerance, and their results are comparable.
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

/// All solver variants with which the stability tests are run: the default solver, every solver method, every stepper
/// without a solver method, further friction models, and settings that prevent a known failure.
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

/// A trial: one run of a stability test, with one solver variant and one value of the driving parameter (the parameter
/// that makes the test more difficult).
#[derive(Clone, Copy, Debug)]
pub struct Trial {
    variant: &'static Change,
    /// Value of the driving parameter (the parameter that makes the test more difficult), in its unit.
    level: f64,
}

impl Trial {
    fn start(&self, mut scene: Scene) -> Result<Simulation> {
        step_by(self.variant, &mut scene);
        scene.simulation()
    }

    /// Returns the simulation of the trial in its initial state, with at most `sweeps` sweeps per step, even if the
    /// solver variant sets another number.
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

/// Returns the longest displacement of any grain since the initial state in `scene`, in mean diameters d.
fn longest_way(simulation: &Simulation, scene: &Scene) -> f64 {
    let now = simulation.world().grains.positions.iter().copied();
    longest_way_to(scene.grains.iter().map(|grain| grain.position).zip(now), scene.mean_diameter)
}

/// Returns the longest displacement, in mean diameters, from pairs of positions (before, now). `diameter` is the mean
/// diameter, m.
fn longest_way_to(places: impl Iterator<Item = (DVec2, DVec2)>, diameter: f64) -> f64 {
    places.map(|(before, now)| before.distance(now)).fold(0.0, f64::max) / diameter
}

/// Returns the root mean square speed of the grains, √(2 E_kin/M), in units of √(g d), with the kinetic energy E_kin
/// and the mass M of all grains, gravity g and mean diameter d.
fn jitter(simulation: &Simulation) -> f64 {
    jitter_of(simulation.world(), simulation.observables().kinetic_energy)
}

/// Returns the root mean square speed of the grains, √(2 E_kin/M), in units of √(g d), from their kinetic energy E_kin
/// (J). The total mass M, gravity g and the mean diameter d are taken from `world`.
fn jitter_of(world: &World, kinetic_energy: f64) -> f64 {
    let mass: f64 = world.grains.masses.iter().sum();
    let scale = world.gravity.magnitude() * world.mean_diameter;
    (2.0 * kinetic_energy / (mass * scale)).sqrt()
}

/// Returns the unit of energy of the stability tests, m g d, J, with the mass m of the first disc, gravity g and mean
/// diameter d.
fn energy_scale(simulation: &Simulation) -> f64 {
    let world = simulation.world();
    world.grains.masses[0] * world.gravity.magnitude() * world.mean_diameter
}

/// Returns a measure of motion, which is 0 for a scene at rest: the larger of the longest displacement of any grain
/// since the initial state in `scene`, in mean diameters d, and the root mean square speed, in √(g d) with gravity g.
fn unrest(simulation: &Simulation, scene: &Scene) -> f64 {
    longest_way(simulation, scene).max(jitter(simulation))
}

/// Returns the vertical force with which all bodies that are not grains, such as the floor, push the grains, N;
/// positive upwards. It is the sum of normal force times y component of the normal over the contacts with these bodies.
fn force_on_ground(simulation: &Simulation) -> f64 {
    let numbering = Numbering::of(simulation.world());
    let list = simulation.contacts();
    let pairs = list.contacts().iter().zip(list.impulses());
    let of_ground = pairs.filter(|(contact, _)| numbering.other(contact.other).grain().is_none());
    let impulse: f64 = of_ground.map(|(contact, impulse)| impulse.normal * contact.normal.y).sum();
    impulse / simulation.parameters().time_step_secs
}

/// Returns the number above which `holds` returns true and below which it returns false. The number is searched between
/// `low` and `high` by `halvings` bisections on a logarithmic scale.
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
