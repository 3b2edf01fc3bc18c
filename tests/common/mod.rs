//! Helpers of the physics tests: common imports, short functions that build scenes and inspect runs, and comparisons
//! whose failure message contains the difference.

#![allow(dead_code, unused_imports, reason = "every test binary uses its own part of this")]

pub mod natural_map;

pub use glam::DVec2;
pub use rand::RngExt;
use rand::SeedableRng;
use rand_pcg::Pcg64;
use slump::scene::stability::logs;

pub use slump::contact::*;
pub use slump::granular::{measure, *};
pub use slump::scene::*;
pub use slump::sim::*;
pub use slump::solver::*;
pub use slump::world::*;

/// Gravitational acceleration g of the test scenes, m/s².
pub const G: f64 = 9.8;

/// Physics of a scene: motion along the x axis only, with cohesion, without friction and rotation.
pub const LINE: Physics = Physics { axes: 1, friction: false, rotation: false, cohesion: true };
/// Physics of a scene: motion in the plane, with cohesion, without friction and rotation.
pub const SMOOTH: Physics = Physics { axes: 2, friction: false, rotation: false, cohesion: true };
/// Physics of a scene: motion in the plane, with cohesion and friction, without rotation.
pub const UNTURNING: Physics = Physics { axes: 2, friction: true, rotation: false, cohesion: true };

/// Returns parameters with this Bond number, time step (s), restitution and friction coefficient, the default
/// friction cone, which is the shifted cone (friction bounded by the normal force plus the cohesion force), and without
/// a restitution threshold: exact results then hold at every closing speed.
pub fn parameters(bond: f64, time_step_secs: f64, restitution: f64, friction: f64) -> Parameters {
    Parameters {
        bond,
        time_step_secs,
        restitution,
        friction,
        restitution_threshold: 0.0,
        ..Parameters::default()
    }
}

/// Debonding distance δ_c that [`range`] and [`ranged`] set, in mean diameters.
pub const DISTANCE_IN_DIAMETERS: f64 = 0.01;

/// Returns parameters for the stepper `range`, with restitution 0 and friction 0.5.
pub fn range(bond: f64, time_step_secs: f64) -> Parameters {
    Parameters {
        debonding_distance: DISTANCE_IN_DIAMETERS,
        ..parameters(bond, time_step_secs, 0.0, 0.5)
    }
}

/// Returns a scene with the stepper `range` and the default solver settings.
pub fn ranged(
    physics: Physics,
    gravity: DVec2,
    parameters: Parameters,
    grains: Vec<Grain>,
) -> Scene {
    Scene {
        stepper: Stepper::Range,
        solver: SolverSettings::default(),
        parameters: Parameters { debonding_distance: DISTANCE_IN_DIAMETERS, ..parameters },
        ..scene(physics, gravity, parameters, grains)
    }
}

pub fn weightless(grain: Grain) -> Grain {
    Grain { feels_gravity: false, ..grain }
}

/// Returns solver settings that solve each step by Gauss–Seidel to a residual of 1e-12, which is close to rounding
/// errors.
pub fn tight() -> SolverSettings {
    to_residual(1e-12)
}

/// Returns the default solver settings with a tolerance of 1e-10, close to rounding errors, instead of 1e-4. The
/// tolerance (dimensionless) limits the velocity error of a step as a fraction of √(g·d), with gravity g and the mean
/// diameter d, or of a larger speed if grains are fast.
pub fn certain() -> SolverSettings {
    SolverSettings { tolerance: 1e-10, ..SolverSettings::default() }
}

pub fn solved_by(method: Method, tolerance: f64) -> SolverSettings {
    SolverSettings { method, stop: StopTest::Residual, tolerance, ..SolverSettings::SWEEPS }
}

pub fn to_residual(tolerance: f64) -> SolverSettings {
    SolverSettings { max_sweeps: 20_000, ..solved_by(Method::Nsgs, tolerance) }
}

/// Returns a scene with the grains `grains` under the uniform gravity `gravity` (m/s²), without walls and other bodies.
pub fn scene(
    physics: Physics,
    gravity: DVec2,
    parameters: Parameters,
    grains: Vec<Grain>,
) -> Scene {
    Scene {
        name: "test".into(),
        mean_diameter: 2.0 * grains[0].radius,
        areal_density: 1.0,
        gap_tolerance: 0.0,
        duration_secs: 1.0,
        physics,
        gravity: Gravity::Uniform { acceleration: gravity },
        stepper: Stepper::Moreau,
        parameters,
        solver: tight(),
        remedies: Remedies::default(),
        view: None,
        source: None,
        data: None,
        materials: Vec::new(),
        pairs: Vec::new(),
        boundaries: Vec::new(),
        motions: Vec::new(),
        gravity_turn: None,
        periodic: None,
        fixed_discs: Vec::new(),
        grains,
    }
}

/// Returns a scene with these grains under gravity g = 9.8 m/s² in −y direction.
pub fn under_g(parameters: Parameters, grains: Vec<Grain>) -> Scene {
    scene(Physics::FULL, -G * DVec2::Y, parameters, grains)
}

pub fn without_g(parameters: Parameters, grains: Vec<Grain>) -> Scene {
    scene(Physics::FULL, DVec2::ZERO, parameters, grains)
}

/// Returns all combinations of a stepper and a solver method. A stepper that does not use solver methods appears once.
pub fn every_way() -> Vec<(Stepper, Method)> {
    let of = |&stepper: &Stepper| {
        let count = if stepper.uses_method() { METHODS.len() } else { 1 };
        METHODS.iter().take(count).map(move |info| (stepper, info.method))
    };
    Stepper::ALL.iter().flat_map(of).collect()
}

/// Returns all combinations of a stepper and a solver method, except the stepper `avbd`, which moves grains slightly
/// further than the impulses would. All other steppers move grains only by impulses, so momentum and energy are in
/// balance.
pub fn every_way_that_balances() -> Vec<(Stepper, Method)> {
    every_way().into_iter().filter(|way| way.0 != Stepper::Avbd).collect()
}

pub fn start(scene: &Scene) -> Simulation {
    scene.simulation().expect("a proper scene")
}

/// Returns the bit patterns of the positions, angles and velocities of all grains. Bit patterns distinguish 0 from −0,
/// and two equal NaN have equal bit patterns. The operator `==` does the opposite in both cases.
pub fn bits(simulation: &Simulation) -> Vec<[u64; 6]> {
    let grains = &simulation.world().grains;
    let of = |k: usize| {
        let [at, velocity] = [grains.positions[k], grains.velocities[k]];
        let turn = [grains.angles[k], grains.angular_velocities[k]];
        [at.x, at.y, velocity.x, velocity.y, turn[0], turn[1]].map(f64::to_bits)
    };
    (0..grains.len()).map(of).collect()
}

/// Solves the first contact problem of the next step and returns its estimated velocity error, m/s. The error refers to
/// the friction model that is solved, and its measure is the same as in the stop test of the solver.
pub fn error_against_model(simulation: &Simulation) -> f64 {
    struct OfModel(SolverSettings);

    impl ProblemVisitor for OfModel {
        type Output = f64;

        fn visit<M: Model>(self, problem: &mut StepProblem<M>, _: &ContactList) -> f64 {
            solve(problem, &mut Memory::default(), &self.0);
            velocity_error(problem).told
        }
    }

    simulation.next_problem(OfModel(*simulation.solver()))
}

pub fn take_steps(simulation: &mut Simulation, count: usize) {
    for _ in 0..count {
        simulation.step().expect("a finite state");
    }
}

pub fn moving(position: DVec2, radius: f64, velocity: DVec2) -> Grain {
    Grain { velocity, ..Grain::at_rest(position, radius) }
}

/// Panics unless two numbers differ by at most `tolerance` times the larger magnitude.
#[track_caller]
pub fn assert_close(found: f64, expected: f64, tolerance: f64, what: &str) {
    let scale = found.abs().max(expected.abs());
    assert!(
        (found - expected).abs() <= tolerance * scale,
        "{what}: found {found:e}, expected {expected:e}, off by {:e} of it",
        (found - expected).abs() / scale
    );
}

pub fn random(seed: u64) -> Pcg64 {
    Pcg64::seed_from_u64(seed)
}

/// Returns a scene with `count` discs pressed together on a lattice over a rough base, so that about half of all
/// neighbours overlap. Velocities, and angular velocities times the radius, are of the size `speed` (m/s).
pub fn pressed_pile(count: usize, speed: f64, seed: u64, parameters: Parameters) -> Scene {
    let mut random = random(seed);
    let diameter = 5e-3;
    let columns = (count as f64).sqrt().ceil() as usize;
    let grains = (0..count)
        .map(|index| {
            let radius = 0.5 * diameter * random.random_range(0.9..=1.1);
            let (row, column) = (index / columns, index % columns);
            let shift = if row % 2 == 0 { 0.0 } else { 0.5 };
            let place = DVec2::new(
                column as f64 - 0.5 * columns as f64 + shift,
                0.5 + (0.75f64).sqrt() * row as f64,
            );
            let jitter =
                DVec2::new(random.random_range(-0.05..0.05), random.random_range(-0.05..0.05));
            let mut component = || speed * random.random_range(-1.0..=1.0);
            Grain {
                velocity: DVec2::new(component(), component()),
                angular_velocity: component() / radius,
                ..Grain::at_rest(diameter * (place + jitter), radius)
            }
        })
        .collect();
    Scene { fixed_discs: rough_base(columns as f64 + 2.0, diameter), ..under_g(parameters, grains) }
}

/// Returns a scene with three discs at rest (the built-in scene `logs`: two discs on a floor and one on top of them)
/// and, apart from them, three further discs: a spinning disc that falls on the floor, a disc that overlaps the floor,
/// and a disc with a stretched bond to the floor that does not break. The three further discs touch no other grain:
/// contacts with friction between several grains can have several solutions, and rounding would choose between them.
pub fn at_rest_and_falling() -> Scene {
    let mut scene = logs(1.0);
    let aside = |x: f64, y: f64| Grain::at_rest(scene.mean_diameter * DVec2::new(x, y), 0.005);
    let falling = Grain { angular_velocity: 30.0, ..aside(-5.0, 1.6) };
    let stretching = Grain { velocity: DVec2::new(0.0, 0.05), ..aside(5.0, 0.4999) };
    let overlapping = aside(-10.0, 0.45);
    scene.grains.extend([falling, overlapping, stretching]);
    scene.parameters.restitution = 0.5;
    scene.parameters.bond = 2.0;
    scene.solver.stop = StopTest::Residual;
    scene.solver.tolerance = 1e-11;
    scene.solver.max_sweeps = 20_000;
    scene
}

pub fn fixed(position: DVec2, radius: f64) -> Disc {
    Disc { position, radius }
}

pub fn plane(point: DVec2, normal: DVec2) -> Boundary {
    Boundary::HalfSpace { point, normal }
}

pub fn piston(point: DVec2, normal: DVec2, speed: f64, travel: f64) -> Boundary {
    Boundary::Piston { point, normal, speed, travel }
}

pub fn level() -> Boundary {
    plane(DVec2::ZERO, DVec2::Y)
}

pub fn goes(boundaries: &[usize], course: MotionCourse) -> Motion {
    Motion { boundaries: boundaries.to_vec(), course: Some(course), ..Motion::default() }
}

pub fn discs_go(count: usize, course: MotionCourse) -> Motion {
    Motion { fixed_discs: (0..count).collect(), course: Some(course), ..Motion::default() }
}

pub fn belt(boundaries: &[usize], surface_speed: f64) -> Motion {
    Motion { boundaries: boundaries.to_vec(), surface_speed, ..Motion::default() }
}

pub fn straight(velocity: DVec2) -> MotionCourse {
    MotionCourse::Straight { direction: velocity, speed: velocity.length(), travel: None }
}

pub fn round(pivot: DVec2, rate: f64) -> MotionCourse {
    MotionCourse::Rotation { pivot, rate, travel: None }
}

pub fn after(scene: &Scene, steps: usize) -> Simulation {
    let mut run = start(scene);
    take_steps(&mut run, steps);
    run
}

/// Checks that Slump refuses to simulate a scene. Returns the error message.
#[track_caller]
pub fn refused(scene: &Scene) -> String {
    let said = scene.simulation().map(|_| ()).expect_err("a scene with a fault").to_string();
    assert!(!said.contains('\n'), "one sentence: {said}");
    said
}

/// Returns a copy of the scene for each of the combinations `ways` of a stepper and a solver method, together with the
/// name of the combination.
pub fn in_each_way(
    scene: &Scene,
    ways: Vec<(Stepper, Method)>,
) -> impl Iterator<Item = (String, Scene)> {
    let of = |(stepper, method)| {
        let solver = SolverSettings { method, ..scene.solver };
        (format!("{stepper}, {method}"), Scene { stepper, solver, ..scene.clone() })
    };
    ways.into_iter().map(of)
}

/// Takes one step. Returns the measured quantities of the step, the change of kinetic energy that the work of gravity,
/// contacts and borders does not explain (J), and the sum of the magnitudes of the work of gravity and contacts and of
/// the kinetic energies before and after the step (J).
pub fn balance(run: &mut Simulation) -> (Observables, f64, f64) {
    let before = run.observables().kinetic_energy;
    let after = *run.step().expect("a finite state");
    let works = [after.gravity_work, after.normal_work, after.tangential_work];
    let border = after.border_work.unwrap_or(0.0);
    let off = (after.kinetic_energy - before - works.iter().sum::<f64>() - border).abs();
    let sizes = works.iter().map(|work| work.abs()).sum::<f64>();
    (after, off, before + after.kinetic_energy + sizes)
}

pub trait Look {
    fn grains(&self) -> &Grains;

    fn place(&self, grain: usize) -> DVec2 {
        self.grains().positions[grain]
    }

    fn velocity(&self, grain: usize) -> DVec2 {
        self.grains().velocities[grain]
    }

    fn places(&self) -> &[DVec2] {
        &self.grains().positions
    }

    fn velocities(&self) -> &[DVec2] {
        &self.grains().velocities
    }

    /// Returns the speed of the fastest grain, m/s.
    fn fastest(&self) -> f64 {
        self.velocities().iter().map(|velocity| velocity.length()).fold(0.0, f64::max)
    }
}

impl Look for Simulation {
    fn grains(&self) -> &Grains {
        &self.world().grains
    }
}

pub fn farthest(one: &[DVec2], other: &[DVec2]) -> f64 {
    one.iter().zip(other).map(|(one, other)| one.distance(*other)).fold(0.0, f64::max)
}

/// Steppers that move grains by impulses only, but do not solve one contact problem for the whole step.
pub const SCHEMES: [Stepper; 2] = [Stepper::TgsSoft, Stepper::Dem];

/// The steppers [`SCHEMES`], which move grains by impulses only, and `avbd`, which also moves overlapping grains apart
/// without changing their velocities. None of them solves one contact problem for the whole step.
pub const ALL_SCHEMES: [Stepper; 3] = [Stepper::TgsSoft, Stepper::Avbd, Stepper::Dem];

pub fn by(stepper: Stepper, substeps: u32, mut scene: Scene) -> Scene {
    scene.parameters.substeps = substeps;
    Scene { stepper, ..scene }
}

/// Returns a scene of two unequal discs shortly before they collide. In two dimensions, the line between the centres is
/// tilted against both axes.
pub fn meeting(physics: Physics, restitution: f64, dt: f64) -> Scene {
    let direction = if physics.axes == 1 { DVec2::X } else { DVec2::new(0.6, 0.8) };
    let grains = [(0.0, 0.15, 0.7), (0.25 + 1e-9, 0.1, -0.3)].map(|(place, radius, speed)| Grain {
        feels_gravity: false,
        ..moving(place * direction, radius, speed * direction)
    });
    scene(physics, -G * direction, parameters(0.0, dt, restitution, 0.5), grains.into())
}

/// Returns the velocity of the second grain relative to the first, m/s.
pub fn relative_velocity(simulation: &Simulation) -> DVec2 {
    let velocities = &simulation.world().grains.velocities;
    velocities[1] - velocities[0]
}

pub fn momentum(simulation: &Simulation) -> DVec2 {
    let grains = &simulation.world().grains;
    grains.masses.iter().zip(&grains.velocities).map(|(&mass, &velocity)| mass * velocity).sum()
}

pub fn effective_mass(simulation: &Simulation) -> f64 {
    let masses = &simulation.world().grains.masses;
    1.0 / (1.0 / masses[0] + 1.0 / masses[1])
}

/// Panics unless the error message `said` is equal to `expected`. If `expected` ends with an ellipsis, `said` only has
/// to begin with the text before the ellipsis.
#[track_caller]
pub fn assert_said(said: &str, expected: &str) {
    match expected.strip_suffix('…') {
        Some(begin) => assert!(said.starts_with(begin), "{said}\nbegins not as\n{expected}"),
        None => assert_eq!(said, expected),
    }
}

/// An expected error message, and a function that changes a valid scene so that Slump must refuse it with this message.
pub type Refusal<'a> = (&'a str, &'a dyn Fn(&mut Scene));

/// Checks that Slump refuses impossible scenes. Each element of `cases` has a change and an error message: the change
/// is applied to a copy of the valid scene `good`, and Slump must refuse the changed scene with this message.
#[track_caller]
pub fn refuses(good: &Scene, cases: &[Refusal]) {
    for (expected, spoil) in cases {
        let mut scene = good.clone();
        spoil(&mut scene);
        assert_said(&refused(&scene), expected);
    }
}

/// Checks a property for `cases` random inputs. The seed is fixed, so the inputs are the same in each run of the tests.
pub fn for_random<S: proptest::strategy::Strategy>(
    cases: u32,
    inputs: S,
    property: impl Fn(S::Value) -> Result<(), proptest::test_runner::TestCaseError>,
) {
    use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};
    let config = Config { cases, failure_persistence: None, ..Config::default() };
    let random = TestRng::deterministic_rng(RngAlgorithm::ChaCha);
    let mut runner = TestRunner::new_with_rng(config, random);
    runner.run(&inputs, property).unwrap_or_else(|failure| panic!("{failure}"));
}

/// Returns the value up to which the condition `holds` is true, found by bisection between `low` (true) and `high`
/// (false).
#[track_caller]
pub fn border(mut low: f64, mut high: f64, halvings: u32, holds: impl Fn(f64) -> bool) -> f64 {
    assert!(holds(low) && !holds(high), "the border is between {low} and {high}");
    for _ in 0..halvings {
        let middle = 0.5 * (low + high);
        *(if holds(middle) { &mut low } else { &mut high }) = middle;
    }
    low
}

/// Returns all pairs of an item of the first collection and an item of the second collection.
pub fn pairs<A: Clone, B: Clone>(
    some: impl IntoIterator<Item = A>,
    others: impl IntoIterator<Item = B>,
) -> Vec<(A, B)> {
    let others: Vec<B> = others.into_iter().collect();
    let with_others = |one: A| others.clone().into_iter().map(move |other| (one.clone(), other));
    some.into_iter().flat_map(with_others).collect()
}

/// Returns all triples of an item of each of three collections.
pub fn triples<A: Clone, B: Clone, C: Clone>(
    some: impl IntoIterator<Item = A>,
    others: impl IntoIterator<Item = B>,
    more: impl IntoIterator<Item = C>,
) -> Vec<(A, B, C)> {
    pairs(pairs(some, others), more).into_iter().map(|((a, b), c)| (a, b, c)).collect()
}
