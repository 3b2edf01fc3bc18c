//! Checks steps that are reported as solved: their error is computed from positions, velocities and impulses,
//! independently of all solvers.

use crate::common::natural_map::{judge, natural_map};
use crate::common::*;

/// Allowed error of a step whose solver stops when the impulses hardly change: the largest ratio of the natural map's
/// norm ‖e‖ to the change ‖ΔP‖ of the impulses in the last sweep.
const LEFT: f64 = 8.0;

/// Allowed rounding error of the natural map, relative to the norm of all contact impulses.
const ROUNDING: f64 = 1e-12;

/// Returns a scene of a disc that falls on a floor. In an earlier version, some solvers reported steps of this scene as
/// solved although they had not changed any impulse.
fn falling_disc() -> Scene {
    let disc = moving(0.006 * DVec2::Y, 5e-3, DVec2::ZERO);
    Scene { boundaries: vec![level()], ..under_g(parameters(0.0, 1e-3, 0.1, 0.5), vec![disc]) }
}

/// Returns two scenes: a disc on a belt, and a disc that a wall pushes along the floor.
fn moved_discs() -> [Scene; 2] {
    let disc = moving(0.005 * DVec2::Y, 5e-3, DVec2::ZERO);
    let still =
        Scene { boundaries: vec![level()], ..under_g(parameters(5.0, 1e-3, 0.1, 0.5), vec![disc]) };
    let belt = Motion { boundaries: vec![0], surface_speed: 0.2, ..Motion::default() };
    let wall = Boundary::HalfSpace { point: -0.005 * DVec2::X, normal: DVec2::X };
    let course = MotionCourse::Straight { direction: DVec2::X, speed: 0.1, travel: None };
    let push = Motion { boundaries: vec![1], course: Some(course), ..Motion::default() };
    let pushed = Scene { boundaries: vec![level(), wall], motions: vec![push], ..still.clone() };
    [
        Scene { name: "belt".into(), motions: vec![belt], ..still },
        Scene { name: "pushed".into(), ..pushed },
    ]
}

/// Returns scenes whose steps [`natural_map`] can check. They are chosen from all built-in scenes if `all` is true,
/// otherwise only from the scenes of Abramian & Staron (2020) and of the stability tests.
fn scenes(all: bool) -> Vec<Scene> {
    let small = [SceneGroup::Paper, SceneGroup::Stability];
    let is_small = |info: &&SceneInfo| info.name != "pile" && small.contains(&info.group);
    let infos = SCENES.iter().filter(|info| all || is_small(info));
    let scenes = infos.map(|info| (info.make)().expect(info.name));
    let is_still = |boundary: &Boundary| !matches!(boundary, Boundary::Piston { .. });
    let goes_straight = |motion: &Motion| {
        let course = motion.course.as_ref();
        let is_straight = |course| matches!(course, &MotionCourse::Straight { travel: None, .. });
        motion.drive.is_none() && course.is_none_or(is_straight)
    };
    let is_judged = |scene: &Scene| {
        scene.boundaries.iter().all(is_still)
            && scene.motions.iter().all(goes_straight)
            && scene.periodic.is_none()
            && scene.gravity_turn.is_none()
    };
    [falling_disc()].into_iter().chain(moved_discs()).chain(scenes).filter(is_judged).collect()
}

/// Returns settings for every method with every stop test, and with every friction model that the method supports.
fn solvers() -> Vec<SolverSettings> {
    let mut solvers = Vec::new();
    for ((method, model), (stop, tolerance)) in pairs(
        pairs(Method::ALL.iter().copied(), FrictionModel::ALL.iter().copied()),
        [
            (StopTest::RelativeChange, 1e-6),
            (StopTest::RelativeChange, 1e-2),
            (StopTest::ImpulsePerMass, 1e-6),
            (StopTest::Residual, 1e-6),
            (StopTest::VelocityError, 1e-4),
        ],
    ) {
        let solver = SolverSettings {
            stop,
            tolerance,
            friction_model: model,
            ..SolverSettings::to_residual(method, tolerance, 300)
        };
        solvers.extend(solver.validate().is_ok().then_some(solver));
    }
    solvers
}

/// Returns the velocity error of a step under Coulomb friction, and the velocity by which the (dimensionless) tolerance
/// is multiplied before it is compared with this error, both in m/s. Both are computed from positions, velocities and
/// impulses. `before` contains the grains before the step.
fn velocity_error(run: &Simulation, before: &Grains) -> (f64, f64) {
    let friction = if run.physics().friction { run.parameters().friction } else { 0.0 };
    let world = run.world();
    let (mut gap, mut undone) = (0.0, 0.0);
    let mut touches = vec![false; before.len()];
    let contacts = run.contacts().contacts().iter().zip(run.contacts().impulses());
    for (judged, (contact, impulse)) in judge(run, before).iter().zip(contacts) {
        let rebound = judged.rebound;
        let p = impulse.normal + judged.cohesion_impulse;
        let rubs = if run.parameters().cone == FrictionCone::Shifted { p } else { impulse.normal };
        let opening = judged.after[0] + rebound;
        gap += p * (opening + 2.0 * (-opening).max(0.0));
        undone += judged.normal_mass * (judged.free[0] + rebound).powi(2);
        if friction > 0.0 {
            gap += friction * rubs.max(0.0) * judged.after[1].abs();
            gap += impulse.tangential * judged.after[1];
            undone += judged.tangential_mass * judged.free[1].powi(2);
        }
        for body in [contact.grain as usize, contact.other as usize] {
            if let Some(touches) = touches.get_mut(body) {
                *touches = true;
            }
        }
    }
    let masses = touches.iter().zip(&before.masses).filter(|(touches, _)| **touches);
    let mass: f64 = masses.map(|(_, mass)| mass).sum();
    let fall = world.gravity.magnitude() * world.mean_diameter;
    ((gap.max(0.0) / mass).sqrt(), (fall + undone / mass).sqrt())
}

/// Takes a step. Returns true if the step is reported as solved and meets its tolerance, false if it is not reported as
/// solved, and an error if the report is wrong.
fn step_is_what_it_says(run: &mut Simulation, solver: &SolverSettings) -> Result<bool, String> {
    let before = run.grains().clone();
    let Ok(&row) = run.step() else { return Ok(false) };
    if !row.converged || run.contacts().contacts().is_empty() {
        return Ok(false);
    }
    let (error, scale, _) = natural_map(run, &before);
    // The residual of the friction model has the same scale as the residual under Coulomb friction.
    let error = row.model_residual.map_or(error, |left| left * scale);
    let carried = |shift: f64| -> f64 {
        let judged = judge(run, &before);
        let both = judged.iter().zip(run.contacts().impulses());
        let squared = both.map(|(judged, impulse)| {
            (impulse.normal + shift * judged.cohesion_impulse).powi(2) + impulse.tangential.powi(2)
        });
        squared.sum::<f64>().sqrt()
    };
    let masses = &run.grains().masses;
    let mean_mass = masses.iter().sum::<f64>() / masses.len() as f64;
    let tolerance = solver.tolerance;
    let (left, allowed) = match solver.stop {
        StopTest::RelativeChange => (error, LEFT * tolerance * carried(0.0)),
        StopTest::ImpulsePerMass => (error, LEFT * tolerance * mean_mass),
        StopTest::Residual => (error, tolerance * scale),
        StopTest::VelocityError => {
            let (bound, scale) = velocity_error(run, &before);
            (row.model_residual.map_or(bound, |_| row.velocity_error), tolerance * scale)
        }
    };
    if left <= (1.0 + 1e-6) * allowed + ROUNDING * carried(1.0) {
        return Ok(true);
    }
    Err(format!("solved with {left:e} left of at most {allowed:e}; residual {:e}", row.residual))
}

/// Runs every `nth` combination of scene and solver settings for `steps` steps. Returns the number of steps that are
/// reported as solved, and a description of each wrong report.
fn look(scenes: Vec<Scene>, nth: usize, steps: usize) -> (usize, Vec<String>) {
    let (mut solved, mut wrong) = (0, Vec::new());
    for (scene, solver) in pairs(scenes, solvers()).into_iter().step_by(nth) {
        let name = format!("{}, {solver:?}", scene.name);
        let scene = Scene { solver, stepper: Stepper::Moreau, ..scene };
        let Ok(mut run) = scene.simulation() else { continue };
        for step in 1..=steps {
            match step_is_what_it_says(&mut run, &solver) {
                Ok(is_solved) => solved += usize::from(is_solved),
                Err(what) => wrong.push(format!("step {step}: {what}: {name}")),
            }
        }
    }
    (solved, wrong)
}

#[test]
fn no_step_is_called_solved_that_is_not() {
    let (solved, wrong) = look(scenes(false), 5, 40);
    assert!(wrong.is_empty(), "{} of {solved}: {:#?}", wrong.len(), &wrong[..wrong.len().min(20)]);
    assert!(solved > 1000, "{solved} steps were called solved");
}

/// Checks that no step of the stepper `range` is reported as solved if its reported residual is above the tolerance.
/// Such a step consists of substeps with contact problems of their own, which cannot be checked from the state at the
/// end of the whole step. The reported residual is the largest residual of all substeps, under Coulomb friction or the
/// friction model that was solved.
#[test]
fn no_step_of_range_is_called_solved_whose_pieces_are_not() {
    let is_by_residual = |solver: &SolverSettings| solver.stop == StopTest::Residual;
    let solvers = solvers().into_iter().filter(is_by_residual);
    let (mut solved, mut unsolved) = (0, 0);
    for (scene, solver) in pairs(scenes(false), solvers.collect::<Vec<_>>()) {
        let name = format!("{}, {solver:?}", scene.name);
        // With this few sweeps, some substeps are unsolved.
        let solver = SolverSettings { max_sweeps: 20, ..solver };
        let Ok(mut run) = Scene { solver, stepper: Stepper::Range, ..scene }.simulation() else {
            continue;
        };
        for step in 1..=20 {
            let Ok(&row) = run.step() else { break };
            let left = row.model_residual.unwrap_or(row.residual);
            let is_small = left <= solver.tolerance * (1.0 + 1e-9);
            assert!(is_small || !row.converged, "step {step}: {left:e} is left: {name}");
            solved += usize::from(row.converged);
            unsolved += usize::from(!row.converged);
        }
    }
    assert!(solved > 1000 && unsolved > 50, "{solved} solved, {unsolved} not");
}

#[test]
#[ignore = "minutes: all scenes"]
fn no_step_of_any_scene_is_called_solved_that_is_not() {
    let (solved, wrong) = look(scenes(true), 1, 200);
    println!("{solved} steps were called solved");
    assert!(wrong.is_empty(), "{} of {solved}: {:#?}", wrong.len(), &wrong[..wrong.len().min(20)]);
}
