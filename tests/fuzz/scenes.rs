//! Fuzzing of the simulation: runs absurd scenes with every stepper, solver method and remedy (optional correction),
//! for fifty steps.

use arbitrary::{Result, Unstructured};
use glam::DVec2;
use slump::config::{read_scene, scene_to_toml};
use slump::error::Error;
use slump::scene::{Scene, built_in};
use slump::sim::{AlarmKind, Observables, Remedies, Simulation, Stepper};
use slump::solver::{FrictionModel, METHODS, Ordering, SolverSettings, StopTest};
use slump::world::{
    Boundary, Disc, Drive, FrictionCone, Grain, Gravity, GravityTurn, Motion, MotionCourse,
    Parameters, Periodic, Physics, TurnCourse,
};

use super::Target;
use super::parsers::check;

fn number(u: &mut Unstructured<'_>, [low, high]: [f64; 2]) -> Result<f64> {
    Ok(low + (high - low) * f64::from(u.arbitrary::<u32>()?) / f64::from(u32::MAX))
}

fn ratio(u: &mut Unstructured<'_>, [low, high]: [f64; 2]) -> Result<f64> {
    Ok(number(u, [low.ln(), high.ln()])?.exp())
}

fn point(u: &mut Unstructured<'_>, size: f64) -> Result<DVec2> {
    Ok(DVec2::new(number(u, [-size, size])?, number(u, [-size, size])?))
}

fn boundary(u: &mut Unstructured<'_>, size: f64) -> Result<Boundary> {
    let (one, other) = (point(u, size)?, point(u, size)?);
    Ok(match u.int_in_range(0..=4)? {
        0 => Boundary::HalfSpace { point: one, normal: other },
        1 => Boundary::Piston {
            point: one,
            normal: other,
            speed: number(u, [-1.0, 1.0])?,
            travel: number(u, [0.0, size])?,
        },
        2 => Boundary::Segment { from: one, to: other },
        3 => Boundary::Polyline { points: vec![one, other, point(u, size)?] },
        _ => Boundary::ConvexPolygon { points: vec![one, other, point(u, size)?] },
    })
}

fn grain(u: &mut Unstructured<'_>, size: f64) -> Result<Grain> {
    let radius = ratio(u, [0.02 * size, 0.3 * size])?;
    let speed = if u.ratio(1, 4)? { 100.0 * size } else { size };
    Ok(Grain {
        velocity: point(u, speed)?,
        angular_velocity: number(u, [-10.0, 10.0])?,
        feels_gravity: u.ratio(9, 10)?,
        ..Grain::at_rest(point(u, size)?, radius)
    })
}

fn parameters(u: &mut Unstructured<'_>) -> Result<Parameters> {
    Ok(Parameters {
        bond: if u.arbitrary()? { 0.0 } else { ratio(u, [0.1, 1e3])? },
        time_step_secs: ratio(u, [1e-5, 1e-1])?,
        restitution: *u.choose(&[0.0, 0.1, 0.5, 0.9, 1.0])?,
        friction: *u.choose(&[0.0, 0.2, 0.5, 0.9, 5.0])?,
        cone: *u.choose(FrictionCone::ALL)?,
        rolling_friction: 0.0,
        restitution_threshold: *u.choose(&[0.0, 2.0])?,
        debonding_distance: ratio(u, [1e-4, 0.1])?,
        stiffness: *u.choose(&[0.0, 0.0, 10.0, 1e4])?,
        damping_ratio: *u.choose(&[0.0, 0.0, 0.05, 3.0])?,
        substeps: *u.choose(&[0, 0, 1, 7])?,
        tilt: 0.0,
        bond_acceleration: *u.choose(&[0.0, 0.0, 5.0])?,
        touch_tolerance: *u.choose(&[0.0, 0.0, 1e-5, 0.1])?,
    })
}

fn solver(u: &mut Unstructured<'_>) -> Result<SolverSettings> {
    Ok(SolverSettings {
        method: u.choose(&METHODS)?.method,
        ordering: *u.choose(Ordering::ALL)?,
        stop: *u.choose(StopTest::ALL)?,
        tolerance: ratio(u, [1e-14, 1e-1])?,
        max_sweeps: u.int_in_range(1..=300)?,
        warm_start: u.arbitrary()?,
        friction_model: *u.choose(FrictionModel::ALL)?,
        model_solves: *u.choose(&[1, 1, 1, 3])?,
    })
}

fn gravity(u: &mut Unstructured<'_>, size: f64) -> Result<Gravity> {
    Ok(match u.int_in_range(0..=5)? {
        0 => Gravity::Uniform { acceleration: point(u, 10.0)? },
        1 => Gravity::Uniform { acceleration: DVec2::ZERO },
        2 => Gravity::Attraction { centre: point(u, size)?, magnitude: ratio(u, [1e-3, 1e3])? },
        _ => Gravity::Uniform { acceleration: DVec2::new(0.0, -9.8) },
    })
}

fn scene(u: &mut Unstructured<'_>, size: f64) -> Result<Scene> {
    let mut scene = built_in("pile").expect("the shipped state");
    scene.name = (*u.choose(&["random", "a\u{7}\u{1b}[31m red\u{202e} one"])?).into();
    scene.physics = *u.choose(&[
        Physics::FULL,
        Physics { rotation: false, ..Physics::FULL },
        Physics { rotation: false, friction: false, ..Physics::FULL },
        Physics { cohesion: false, ..Physics::FULL },
    ])?;
    scene.gravity = gravity(u, size)?;
    scene.stepper = *u.choose(Stepper::ALL)?;
    scene.parameters = parameters(u)?;
    scene.solver = solver(u)?;
    scene.remedies = Remedies {
        push_out: u.ratio(1, 4)?,
        max_travel: *u.choose(&[0.0, 0.0, 0.25])?,
        sequential_impacts: u.ratio(1, 4)?,
        speculative: u.ratio(1, 4)?,
        turning_bonds: u.ratio(1, 4)?,
    };
    if u.ratio(3, 4)? {
        scene.set_settings(scene.settings().with_only_what_is_taken());
    }
    scene.grains = (0..u.int_in_range(1..=12)?).map(|_| grain(u, size)).collect::<Result<_>>()?;
    scene.mean_diameter = 2.0 * scene.grains[0].radius;
    scene.gap_tolerance = *u.choose(&[0.0, 0.0, 1e-9, 1e-3])? * scene.mean_diameter;
    scene.view = None;
    // The duration is fifty steps, so that a run from the scene's file is not longer.
    scene.duration_secs = 50.0 * scene.parameters.time_step_secs;
    let discs = u.int_in_range(0..=3)?;
    let disc = |u: &mut Unstructured<'_>| {
        Ok(Disc { position: point(u, size)?, radius: ratio(u, [0.02 * size, 0.3 * size])? })
    };
    scene.fixed_discs = (0..discs).map(|_| disc(u)).collect::<Result<_>>()?;
    scene.boundaries =
        (0..u.int_in_range(0..=3)?).map(|_| boundary(u, size)).collect::<Result<_>>()?;
    if u.ratio(1, 3)? {
        scene.motions = vec![motion(u, size, &scene)?];
    }
    if u.ratio(1, 8)? && matches!(scene.gravity, Gravity::Uniform { .. }) {
        let course = TurnCourse::Rate { rate: number(u, [-100.0, 100.0])? };
        scene.gravity_turn = Some(GravityTurn { course, elapsed_secs: 0.0 });
    }
    if u.ratio(1, 8)? {
        let width = ratio(u, [0.5 * size, 4.0 * size])?;
        let borders = Some([-0.5 * width, 0.5 * width]);
        let one = Periodic { x: borders, ..Periodic::default() };
        let both = Periodic { y: borders, ..one };
        let upright = Periodic { y: borders, ..Periodic::default() };
        let sheared = Periodic { shear_rate: number(u, [-100.0, 100.0])?, ..both };
        scene.periodic = Some(*u.choose(&[one, upright, both, sheared])?);
    }
    if u.ratio(1, 8)? && !scene.boundaries.is_empty() && scene.motions.is_empty() {
        scene.motions = vec![driven(u, size)?];
    }
    Ok(scene)
}

/// Returns a motion in which a random force drives the first boundary of a scene. `size` is the size of the scene, m.
fn driven(u: &mut Unstructured<'_>, size: f64) -> Result<Motion> {
    let drive = Drive {
        direction: point(u, size)?,
        force: Some(number(u, [-1e3, 1e3])?),
        pressure: None,
        width: None,
        mass: ratio(u, [1e-6, 1e3])?,
        damping: *u.choose(&[0.0, 0.0, 1.0])?,
        speed: number(u, [-1.0, 1.0])?,
    };
    Ok(Motion { boundaries: vec![0], drive: Some(drive), ..Motion::default() })
}

/// Returns a random prescribed motion for all bodies that are not grains and may move. `size` is the size of the scene,
/// m.
fn motion(u: &mut Unstructured<'_>, size: f64, scene: &Scene) -> Result<Motion> {
    let is_free = |index: &usize| !matches!(scene.boundaries[*index], Boundary::Piston { .. });
    let (pivot, travel) = (point(u, size)?, *u.choose(&[None, None, Some(0.0), Some(0.3)])?);
    let frequency_hz = ratio(u, [1e-1, 1e4])?;
    let times_secs = vec![0.0, ratio(u, [1e-5, 1.0])?];
    let course = match u.int_in_range(0..=6)? {
        0 => MotionCourse::Straight { direction: pivot, speed: number(u, [-3.0, 3.0])?, travel },
        1 => MotionCourse::Rotation { pivot, rate: number(u, [-100.0, 100.0])?, travel },
        2 => MotionCourse::Sine { amplitude: 0.1 * pivot, frequency_hz, phase: 0.5 },
        3 => MotionCourse::Swing { pivot, amplitude: 0.5, frequency_hz, phase: 0.0 },
        4 => MotionCourse::Table { times_secs, offsets: vec![DVec2::ZERO, point(u, size)?] },
        5 => MotionCourse::AngleTable { pivot, times_secs, angles: vec![0.0, 3.0] },
        _ => {
            let boundaries = (0..scene.boundaries.len()).collect();
            return Ok(Motion { boundaries, surface_speed: 1.0, ..Motion::default() });
        }
    };
    Ok(Motion {
        boundaries: (0..scene.boundaries.len()).filter(is_free).collect(),
        fixed_discs: (0..scene.fixed_discs.len()).collect(),
        course: Some(course),
        drive: None,
        surface_speed: *u.choose(&[0.0, 0.0, 2.0])?,
        elapsed_secs: *u.choose(&[0.0, 0.0, 1.0])?,
        turned: 0.0,
    })
}

/// Returns a version of the scene in which all bodies move along the x axis only.
fn on_line(mut scene: Scene) -> Scene {
    scene.physics = Physics { axes: 1, friction: false, rotation: false, ..scene.physics };
    for grain in &mut scene.grains {
        (grain.position.y, grain.velocity.y, grain.angular_velocity) = (0.0, 0.0, 0.0);
    }
    scene.motions.clear();
    scene.gravity_turn = None;
    scene.fixed_discs.iter_mut().for_each(|disc| disc.position.y = 0.0);
    scene.boundaries.retain_mut(|boundary| match boundary {
        Boundary::HalfSpace { normal, .. } | Boundary::Piston { normal, .. } => {
            normal.y = 0.0;
            true
        }
        _ => false,
    });
    scene
}

/// Returns a closed box around the whole scene as a boundary. `size` is the size of the scene, m.
fn closed_box(size: f64) -> Boundary {
    let half = 1.5 * size;
    let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0]];
    Boundary::Polyline { points: corners.map(|corner| half * DVec2::from(corner)).into() }
}

pub fn scene_text(u: &mut Unstructured<'_>) -> Result<String> {
    let size = ratio(u, [1e-3, 1e2])?;
    let mut made = scene(u, size)?;
    if u.ratio(1, 3)? {
        made.boundaries.push(closed_box(size));
    }
    if u.ratio(1, 8)? {
        made = on_line(made);
    }
    Ok(scene_to_toml(&made).expect("numbers, words and lists"))
}

#[test]
fn random_scenes_with_everything() {
    let target = Target { name: "scenes", ending: "toml", inputs: 80 };
    target.fuzz(&target.corpus(), scene_text, |_, path| {
        let started = read_scene(path).and_then(|scene| Ok((scene.simulation()?, scene)));
        match started {
            Ok((simulation, scene)) => {
                run(&scene, simulation);
                true
            }
            Err(refusal) => {
                check(&refusal);
                false
            }
        }
    });
}

const STEPS: u32 = 50;
/// Margin for grains beyond a wall, in radii of the grain: the tests demand that Slump counts a grain as lost only if
/// the grain has passed the wall by more than this margin.
const UNSEEN_IN_RADII: f64 = 0.3;
/// Distance of a grain from the box around the initial scene beyond which Slump must count the grain as lost, in units
/// of the longer side of the box. The unit includes one mean diameter, so that it is never 0.
const FAR_IN_SIDES: f64 = 4.0;

pub fn run(scene: &Scene, mut simulation: Simulation) {
    let mut gone = vec![false; scene.grains.len()];
    let mut lost = 0;
    for _ in 0..STEPS {
        let step = match simulation.step() {
            Ok(step) => *step,
            Err(Error::NonFinite { .. }) => {
                let step = simulation.observables();
                assert!(has(&simulation, AlarmKind::NotFinite), "not finite in silence");
                assert!(!step.converged, "not finite, and solved: {step:?}");
                return;
            }
            Err(error) => panic!("{error}"),
        };
        finite(&simulation, scene.stepper, &step);
        solved(scene, &step);
        for (gone, grain) in gone.iter_mut().zip(0..) {
            *gone |= is_gone(scene, &simulation, grain);
        }
        let count = gone.iter().filter(|&&gone| gone).count() as u32;
        assert!(step.lost_grains >= count, "{count} are gone, {} lost: {step:?}", step.lost_grains);
        assert!(step.lost_grains >= lost, "{lost} were lost, and {} are", step.lost_grains);
        let is_told = [AlarmKind::GrainLost, AlarmKind::GrainLeft, AlarmKind::PlacedInOverlap]
            .iter()
            .any(|&kind| has(&simulation, kind));
        assert!(step.lost_grains == 0 || is_told, "{step:?}");
        lost = step.lost_grains;
    }
}

fn has(simulation: &Simulation, kind: AlarmKind) -> bool {
    simulation.alarms().iter().any(|alarm| alarm.kind == kind)
}

/// Checks that positions and velocities are finite, and that all measured numbers are finite unless Slump has raised a
/// warning. The residual of an unsolved step may have any value.
fn finite(simulation: &Simulation, stepper: Stepper, step: &Observables) {
    let grains = &simulation.world().grains;
    assert!(grains.positions.iter().chain(&grains.velocities).all(|v| v.is_finite()));
    assert!(grains.angular_velocities.iter().all(|spin| spin.is_finite()));
    assert!(!step.converged || step.residual.is_finite() || !stepper.uses_method(), "{step:?}");
    let some = [step.bond_work, step.bond_energy, step.broken_bond_energy, step.border_work];
    let measured = [
        step.time_secs,
        step.mean_overlap,
        step.max_overlap,
        step.kinetic_energy,
        step.potential_energy,
        step.normal_work,
        step.tangential_work,
        step.wall_work,
        step.gravity_work,
        step.slump,
    ];
    let all = measured.into_iter().chain(some.into_iter().flatten());
    assert!(all.into_iter().all(f64::is_finite) || !simulation.alarms().is_empty(), "{step:?}");
}

/// Checks that a step that is reported as solved has a residual within its tolerance. The residual refers to the
/// friction model that was solved.
fn solved(scene: &Scene, step: &Observables) {
    assert!(!(step.converged && step.stalled), "{step:?}");
    let to_residual = scene.solver.stop == StopTest::Residual && scene.stepper.uses_method();
    if to_residual && step.converged {
        let enough = scene.solver.tolerance * (1.0 + 1e-6) + 1e-14;
        let left = step.model_residual.unwrap_or(step.residual);
        assert!(left <= enough, "{left} of {enough}: {step:?}");
    }
}

/// Returns true if a grain is at a position that it can only reach through a wall or by leaving the scene. Always false
/// if walls or other bodies have prescribed motions.
fn is_gone(scene: &Scene, simulation: &Simulation, grain: usize) -> bool {
    if !scene.motions.is_empty() {
        return false;
    }
    let (from, to) = (scene.grains[grain].position, simulation.world().grains.positions[grain]);
    let radius = scene.grains[grain].radius;
    let unseen = UNSEEN_IN_RADII * radius;
    let beyond = |boundary: &Boundary| match boundary {
        Boundary::HalfSpace { point, normal } => {
            (to - point).dot(normal.normalize_or_zero()) < -2.0 * radius - unseen
        }
        Boundary::Polyline { points } if points.first() == points.last() => {
            is_within(points, from) && !is_within(points, to) && distance(points, to) > unseen
        }
        _ => false,
    };
    scene.boundaries.iter().any(beyond) || is_far(scene, to)
}

/// Returns true if a position is far from the initial scene. Always false if the scene has an infinite wall, or if it
/// consists only of grains.
fn is_far(scene: &Scene, place: DVec2) -> bool {
    let mut fixed: Vec<DVec2> = scene.fixed_discs.iter().map(|disc| disc.position).collect();
    for boundary in &scene.boundaries {
        match boundary {
            Boundary::HalfSpace { .. } | Boundary::Piston { .. } => return false,
            Boundary::Segment { from, to } => fixed.extend([from, to]),
            Boundary::Polyline { points } | Boundary::ConvexPolygon { points } => {
                fixed.extend(points);
            }
        }
    }
    if fixed.is_empty() {
        return false;
    }
    fixed.extend(scene.grains.iter().map(|grain| grain.position));
    let min = fixed.iter().copied().fold(DVec2::INFINITY, DVec2::min);
    let max = fixed.iter().copied().fold(DVec2::NEG_INFINITY, DVec2::max);
    // A periodic cell is a part of the box. If the cell is wide, the allowed distance is large, in y, too.
    let Periodic { x, y, .. } = scene.periodic.unwrap_or_default();
    let [left, right] = x.unwrap_or([min.x, max.x]);
    let [below, above] = y.unwrap_or([min.y, max.y]);
    let min = min.min(DVec2::new(left, below));
    let max = max.max(DVec2::new(right, above));
    let room = FAR_IN_SIDES * ((max - min).max_element() + scene.mean_diameter);
    !((min - room).cmple(place).all() && (max + room).cmpge(place).all())
}

/// Returns true if a position is inside a closed line, because a ray from the position crosses the line an odd number
/// of times.
fn is_within(line: &[DVec2], place: DVec2) -> bool {
    let cuts = line.windows(2).filter(|ends| {
        let [a, b] = [ends[0] - place, ends[1] - place];
        (a.y > 0.0) != (b.y > 0.0) && (a.x - a.y * (b.x - a.x) / (b.y - a.y)) > 0.0
    });
    cuts.count() % 2 == 1
}

fn distance(line: &[DVec2], place: DVec2) -> f64 {
    let to_piece = |ends: &[DVec2]| {
        let (a, along) = (ends[0], ends[1] - ends[0]);
        let share = ((place - a).dot(along) / along.length_squared()).clamp(0.0, 1.0);
        (a + share * along).distance(place)
    };
    line.windows(2).map(to_piece).fold(f64::INFINITY, f64::min)
}
