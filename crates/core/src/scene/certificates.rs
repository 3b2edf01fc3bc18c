//! Test of the error bound that a solve with bounded friction (the friction model `tresca`) reports. The bound must not
//! be less than the distance of the velocities of the solve from the velocities of the exact solution. The test runs
//! over scenes, steppers, friction, restitution and time steps, and checks this for the solves that meet their
//! tolerance. For all solves it also computes the bound a second time, from the data of the contacts. The reported
//! bound must equal this number, unless contacts violate their constraint (their normal velocity is lower than the
//! contact law requires). Then the reported bound may be larger (`solver::problem::velocity_error`).

use crate::contact::ContactList;
use crate::number::Parts;
use crate::scene::{SCENES, stability};
use crate::sim::{ProblemVisitor, Settings, Simulation, Stepper};
use crate::solver::{
    Memory, Method, Model, SolverSettings, StepProblem, residual, solve, solve_within_bounds,
    velocity_distance, velocity_error,
};

/// Largest number of grains of a tested scene. Larger scenes are left out because they take longer and do not test
/// anything further.
const MOST_GRAINS: usize = 250;

/// Number of steps that the test computes before the tested steps, if a scene has walls that are driven by a force.
/// After this number of steps these walls have reached the grains.
const STEPS_TO_TOUCH: u64 = 120;

/// The default settings of the solver for bounded friction (the friction model `tresca`).
const BOUNDED: SolverSettings = SolverSettings::BOUNDED;

/// Visitor that solves a contact problem with bounded friction (the friction model `tresca`) by these solver settings,
/// and measures the error of the solve.
struct Certified(SolverSettings);

/// Errors of one solve, m/s: the error bound that the solve reports (`told`), the bound computed here from the data of
/// the contacts (`found`), and the distance of the velocities from the solution (`distance`). The distance is `None` if
/// the solve did not meet its tolerance, no solution was found, or no grain has a contact.
struct Certificate {
    told: f64,
    found: f64,
    distance: Option<f64>,
}

impl ProblemVisitor for Certified {
    type Output = Certificate;

    fn visit<M: Model>(self, problem: &mut StepProblem<M>, _: &ContactList) -> Certificate {
        let report = solve(problem, &mut Memory::default(), &self.0);
        // A solution as exact as rounding allows. Its own error is subtracted from the distance.
        let exact = [1e-9, 1e-7, 1e-6].into_iter().find_map(|tolerance| {
            let mut exact = problem.clone();
            let tight = SolverSettings { tolerance, ..SolverSettings::default() };
            solve_within_bounds(&mut exact, &tight).converged.then_some(exact)
        });
        let (gap, mass) = gap(problem);
        let told = velocity_error(problem).told;
        let found = if gap > 0.0 { (gap / mass).sqrt() } else { 0.0 };
        let distance = exact
            .filter(|_| report.converged && mass > 0.0)
            .map(|exact| velocity_distance(problem, &exact) - velocity_error(&exact).told);
        Certificate { told, found, distance }
    }
}

/// Returns the duality gap of a problem with bounded friction (the difference of the primal and the dual energy, J),
/// and the mass of all grains with contacts (kg). The gap is the sum over the contacts of
///
/// > m_ij (σ(w + 2z) + z² + g|v| + λv),
///
/// with the effective mass m_ij (kg), the shifted normal impulse σ (normal impulse plus the largest impulse of
/// cohesion, so that it is never negative) and the tangential impulse λ (both per effective mass, m/s), the normal
/// velocity w after the step plus its restitution term (restitution times the normal velocity before the step), the
/// tangential velocity v, the amount z by which w is below 0 (all in m/s), and the friction bound g (largest allowed
/// |λ|, m/s).
fn gap<M: Model>(problem: &StepProblem<M>) -> (f64, f64) {
    let spins = f64::from(u8::from(M::ROTATION));
    let coordinates = |grain: u32| M::coordinates(&problem.bodies.now[grain as usize]);
    let mut touches = vec![false; problem.bodies.now.len()];
    let mut gap = 0.0;
    for (number, row) in problem.rows() {
        let is_pair = problem.rows.is_pair(number);
        touches[row.i as usize] = true;
        let j = if is_pair { coordinates(row.j) } else { [0.0; 3] };
        touches[if is_pair { row.j } else { row.i } as usize] = true;
        let i = coordinates(row.i);
        let [x, y] = M::components(row.normal);
        let [of_image, along_image] = M::slide_along(row.normal);
        let w = x * (i[0] - j[0]) + y * (i[1] - j[1]) - of_image + row.restitution_velocity;
        let rim = spins * (i[2] + j[2]) + problem.rows.surface_speed(number);
        let v = x * (i[1] - j[1]) - y * (i[0] - j[0]) - along_image - rim;
        let [shifted, tangential] = row.impulse();
        let lacking = (-w).positive_part();
        let mut of_contact = shifted * (w + 2.0 * lacking) + lacking * lacking;
        if M::FRICTION {
            of_contact += problem.friction.now[number] * v.abs() + tangential * v;
        }
        gap += row.effective_mass * of_contact;
    }
    let masses = problem.bodies.masses.iter().zip(touches);
    (gap, masses.filter(|(_, touches)| *touches).map(|(mass, _)| mass).sum())
}

/// Returns the settings with which the test runs a scene, derived from the settings `settings` of the scene: two
/// steppers, each with four combinations of friction, restitution and time step.
fn variants(settings: Settings) -> impl Iterator<Item = Settings> {
    let steppers = [Stepper::Moreau, Stepper::Range];
    let numbers = [(0.0, 1.0), (0.2, 1.0), (0.9, 1.0), (0.5, 8.0)];
    steppers.into_iter().flat_map(move |stepper| {
        numbers.into_iter().map(move |(number, longer)| {
            let mut settings = Settings { stepper, solver: BOUNDED, ..settings };
            let parameters = &mut settings.parameters;
            (parameters.friction, parameters.restitution) = (number, 0.9 - number);
            parameters.time_step_secs *= longer;
            settings.with_only_what_is_taken()
        })
    })
}

#[test]
fn no_certificate_is_wrong() {
    let loose = |method, tolerance| SolverSettings { method, tolerance, max_sweeps: 3, ..BOUNDED };
    let (mut problems, mut driven, mut nearest) = (0, 0, 0f64);
    let (mut all, mut more) = (0, 0);
    for info in SCENES {
        let scene = (info.make)().expect("a scene");
        if scene.grains.len() > MOST_GRAINS {
            continue;
        }
        for settings in variants(scene.settings()) {
            let mut scene = scene.clone();
            scene.set_settings(settings);
            // Some steppers do not support the scene. Such a combination is skipped.
            let Ok(mut run): Result<Simulation, _> = scene.simulation() else { continue };
            let is_driven = scene.motions.iter().any(|motion| motion.drive.is_some());
            if is_driven && run.take_steps(STEPS_TO_TOUCH).is_err() {
                continue;
            }
            for step in 0..3 {
                for solver in [BOUNDED, loose(Method::Nsgs, 1e-9)] {
                    let Certificate { told, found, distance } = run.next_problem(Certified(solver));
                    let Settings { stepper, parameters, .. } = settings;
                    let what = format!("{}, {stepper}, {parameters:?}, step {step}", info.name);
                    let rounding = 1e-6 * told + 1e-7;
                    assert!(told >= found - rounding, "{what}: {told:e}, {found:e}");
                    more += u32::from(told > found + rounding);
                    all += 1;
                    let Some(distance) = distance else { continue };
                    let rounding = 1e-9 * (1.0 + told);
                    assert!(distance <= told + rounding, "{what}: {distance:e} off, {told:e} told");
                    problems += 1;
                    driven += u32::from(is_driven);
                    nearest = nearest.max(if told > 1e-6 { distance / told } else { 0.0 });
                }
                if run.step().is_err() {
                    break;
                }
            }
        }
    }
    println!("{more} of {all} solves report more than their gap");
    assert!(10 * more < all, "{more} of {all}: only contacts that lack something add to the gap");
    println!(
        "{problems} problems, {driven} of them driven, distances up to {nearest} of what is told"
    );
    assert!(problems > 500 && driven > 20, "{problems} problems with contacts, {driven} driven");
    assert!(nearest > 0.5, "{nearest}: bounds that are twice too small would not be seen");
}

/// Visitor that solves a contact problem until the velocity error is below this tolerance, in units of √(g d) (g:
/// gravity, d: mean diameter). It returns whether the solve converged, and the residual.
struct Pressed(f64);

impl ProblemVisitor for Pressed {
    type Output = (bool, f64);

    fn visit<M: Model>(self, problem: &mut StepProblem<M>, _: &ContactList) -> (bool, f64) {
        let asked = SolverSettings { tolerance: self.0, ..SolverSettings::default() };
        let report = solve(problem, &mut Memory::default(), &asked);
        (report.converged, residual(problem))
    }
}

#[test]
fn a_solve_that_is_asked_for_more_than_there_is_keeps_the_best_that_it_came_to() {
    let mut scene = stability::press();
    (scene.parameters.friction, scene.parameters.restitution) = (0.0, 0.9);
    let run = scene.simulation().expect("a sound scene");
    let (converged, left) = run.next_problem(Pressed(1e-4));
    assert!(converged && left < 1e-6, "{left:e}");
    let (converged, left) = run.next_problem(Pressed(1e-13));
    assert!(!converged, "that much there is");
    assert!(left < 1e-6, "{left:e}: worse than where less was asked for");
}
