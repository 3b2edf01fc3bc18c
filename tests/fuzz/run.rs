//! Fifty steps of a scene, and what must hold after each.

use glam::DVec2;
use slump::error::Error;
use slump::scene::Scene;
use slump::sim::{AlarmKind, Observables, Simulation};
use slump::solver::StopTest;
use slump::world::{Boundary, Periodic};

const STEPS: u32 = 50;
/// Of its radius, what a grain may be beyond a wall before anyone looks.
const UNSEEN_IN_RADII: f64 = 0.3;
/// Sides of the box of all that is there at the start: surely out of the world.
const FAR_IN_SIDES: f64 = 4.0;

/// Takes the steps.
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
        finite(&simulation, &step);
        solved(scene, &step);
        for (gone, grain) in gone.iter_mut().zip(0..) {
            *gone |= is_gone(scene, &simulation, grain);
        }
        let count = gone.iter().filter(|&&gone| gone).count() as u32;
        assert!(step.lost_grains >= count, "{count} are gone, {} lost: {step:?}", step.lost_grains);
        assert!(step.lost_grains >= lost, "{lost} were lost, and {} are", step.lost_grains);
        assert_eq!(step.lost_grains > 0, has(&simulation, AlarmKind::GrainLost), "{step:?}");
        lost = step.lost_grains;
    }
}

fn has(simulation: &Simulation, kind: AlarmKind) -> bool {
    simulation.alarms().iter().any(|alarm| alarm.kind == kind)
}

/// What is told to be finite is: all that moves, and all that is measured, unless there is an alarm, but the
/// residual of a step that was not solved.
fn finite(simulation: &Simulation, step: &Observables) {
    let grains = &simulation.world().grains;
    assert!(grains.positions.iter().chain(&grains.velocities).all(|v| v.is_finite()));
    assert!(grains.angular_velocities.iter().all(|spin| spin.is_finite()));
    assert!(!step.converged || step.residual.is_finite(), "{step:?}");
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

/// A step that is said to be solved has a residual, of what was solved, that says so.
fn solved(scene: &Scene, step: &Observables) {
    assert!(!(step.converged && step.stalled), "{step:?}");
    let to_residual = scene.solver.stop == StopTest::Residual && scene.stepper.uses_method();
    if to_residual && step.converged {
        let enough = scene.solver.tolerance * (1.0 + 1e-6) + 1e-14;
        let left = step.model_residual.unwrap_or(step.residual);
        assert!(left <= enough, "{left} of {enough}: {step:?}");
    }
}

/// Whether a grain is where none can come to, as far as what is fixed stays.
fn is_gone(scene: &Scene, simulation: &Simulation, grain: usize) -> bool {
    if !scene.motions.is_empty() {
        return false;
    }
    let (from, to) = (scene.grains[grain].position, simulation.world().grains.positions[grain]);
    let unseen = UNSEEN_IN_RADII * scene.grains[grain].radius;
    let beyond = |boundary: &Boundary| match boundary {
        Boundary::HalfSpace { point, normal } => {
            (to - point).dot(normal.normalize_or_zero()) < -scene.mean_diameter - unseen
        }
        Boundary::Polyline { points } if points.first() == points.last() => {
            is_within(points, from) && !is_within(points, to) && distance(points, to) > unseen
        }
        _ => false,
    };
    scene.boundaries.iter().any(beyond) || is_far(scene, to)
}

/// Whether a place is far from all that was there at the start, where there is an end to that.
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
    // A cell whose borders wrap belongs to the box: a wide one has a world as wide, and as high.
    let Periodic { x, y, .. } = scene.periodic.unwrap_or_default();
    let [left, right] = x.unwrap_or([min.x, max.x]);
    let [below, above] = y.unwrap_or([min.y, max.y]);
    let min = min.min(DVec2::new(left, below));
    let max = max.max(DVec2::new(right, above));
    let room = FAR_IN_SIDES * ((max - min).max_element() + scene.mean_diameter);
    !((min - room).cmple(place).all() && (max + room).cmpge(place).all())
}

/// Whether a place is within a closed line: a ray from it cuts the line an odd number of times.
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
