//! Scenes that nobody would write, with every stepper, method and remedy, for fifty steps.

use arbitrary::{Result, Unstructured};
use glam::DVec2;
use slump::error::Error;
use slump::scene::{Scene, built_in};
use slump::sim::{Remedies, Simulation, Stepper};
use slump::solver::{METHODS, Ordering, SolverSettings, StopTest};
use slump::world::{Boundary, Disc, FrictionCone, Grain, Parameters, Physics};

use super::fuzz;

const STEPS: u32 = 50;

fn number(u: &mut Unstructured<'_>, [low, high]: [f64; 2]) -> Result<f64> {
    Ok(low + (high - low) * f64::from(u.arbitrary::<u32>()?) / f64::from(u32::MAX))
}

/// Evenly in ratio.
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
        restitution_threshold: *u.choose(&[0.0, 2.0])?,
        debonding_distance: ratio(u, [1e-4, 0.1])?,
        substeps: *u.choose(&[0, 0, 1, 7])?,
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
    })
}

fn scene(u: &mut Unstructured<'_>) -> Result<Scene> {
    let size = ratio(u, [1e-3, 1e2])?;
    let mut scene = built_in("pile").expect("the shipped state");
    scene.name = "random".into();
    scene.physics = *u.choose(&[
        Physics::FULL,
        Physics { rotation: false, ..Physics::FULL },
        Physics { rotation: false, friction: false, ..Physics::FULL },
        Physics { cohesion: false, ..Physics::FULL },
    ])?;
    scene.stepper = *u.choose(Stepper::ALL)?;
    scene.parameters = parameters(u)?;
    scene.solver = solver(u)?;
    scene.remedies = Remedies {
        push_out: u.ratio(1, 4)?,
        max_travel: *u.choose(&[0.0, 0.0, 0.25])?,
        calm_unsolved: u.ratio(1, 4)?,
        sequential_impacts: u.ratio(1, 4)?,
        speculative: u.ratio(1, 4)?,
    };
    if u.ratio(3, 4)? {
        let settings = scene.settings().with_remedies_taken();
        scene.set_settings(settings);
    }
    scene.grains = (0..u.int_in_range(1..=12)?).map(|_| grain(u, size)).collect::<Result<_>>()?;
    scene.mean_diameter = 2.0 * scene.grains[0].radius;
    let discs = u.int_in_range(0..=3)?;
    let disc = |u: &mut Unstructured<'_>| {
        Ok(Disc { position: point(u, size)?, radius: ratio(u, [0.02 * size, 0.3 * size])? })
    };
    scene.fixed_discs = (0..discs).map(|_| disc(u)).collect::<Result<_>>()?;
    scene.boundaries =
        (0..u.int_in_range(0..=3)?).map(|_| boundary(u, size)).collect::<Result<_>>()?;
    Ok(scene)
}

/// Fifty steps, and what must hold after each.
fn run(scene: &Scene, mut simulation: Simulation) {
    for _ in 0..STEPS {
        let step = match simulation.step() {
            Ok(step) => *step,
            Err(Error::NonFinite { .. }) => {
                assert!(!simulation.alarms().is_empty(), "not finite in silence: {scene:?}");
                return;
            }
            Err(error) => panic!("{error}: {scene:?}"),
        };
        let SolverSettings { stop, tolerance, .. } = scene.solver;
        assert!(!step.converged || step.residual.is_finite(), "{}: {scene:?}", step.residual);
        let judged = scene.stepper == Stepper::Moreau && stop == StopTest::Residual;
        if judged && step.converged && scene.remedies.is_none() {
            let enough = tolerance * (1.0 + 1e-6) + 1e-15;
            assert!(step.residual <= enough, "{} of {tolerance}: {scene:?}", step.residual);
        }
        assert!(!(step.converged && step.stalled), "{scene:?}");
    }
}

#[test]
fn random_scenes_with_everything() {
    fuzz("scenes", |u| {
        let scene = scene(u)?;
        if let Ok(simulation) = scene.simulation() {
            run(&scene, simulation);
        }
        Ok(())
    });
}
