//! Tests of contact problems as files: they are written from a scene, read back, checked, and solved without the scene.

mod faults;

use slump::interchange::{ProblemFile, Solution, problem_file_at, solve_file};

use crate::common::*;
use crate::program::*;

const SICONOS: &str = "fc2d_granularflowonwall_00667_00000.dat";

fn problems() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/problems")
}

fn kept_problem(name: &str) -> ProblemFile {
    ProblemFile::read(&problems().join(name)).expect("a proper problem file")
}

/// Returns the names of the stored contact problems: first those from Slump, then a published one from Siconos.
fn kept() -> Vec<String> {
    let mut names = names_in(&problems());
    names.retain(|name| name.ends_with(".json"));
    assert_eq!(names.len(), 10);
    names.push(SICONOS.into());
    names
}

fn settings(method: Method, tolerance: f64) -> SolverSettings {
    let stop = StopTest::Residual;
    SolverSettings { method, tolerance, max_sweeps: 1_000_000, stop, ..SolverSettings::SWEEPS }
}

/// Returns scenes with every kind of motion (one or two axes, with or without friction and rotation) and both friction
/// cones (friction bounded by the normal force plus the cohesion force, or by the pushing part of the normal force
/// only), each with a name and the time at which its contact problem is written (s).
fn scenes() -> Vec<(&'static str, Scene, f64)> {
    let pile = |physics: Physics, bond: f64, cone: FrictionCone| {
        let parameters = parameters(bond, 1e-3, 0.1, 0.5);
        let mut scene = pressed_pile(40, 0.2, 3, parameters);
        scene.physics = physics;
        scene.parameters.cone = cone;
        if !physics.friction {
            scene.parameters.friction = 0.0;
        }
        if !physics.rotation {
            for grain in &mut scene.grains {
                grain.angular_velocity = 0.0;
            }
        }
        scene
    };
    let mut line = cradle();
    line.physics = LINE;
    for grain in &mut line.grains {
        // The discs are pressed together, so that contacts exist from the start.
        grain.position.x *= 0.999;
        grain.velocity = DVec2::new(-2.0 * grain.position.x, 0.0);
    }
    let (shifted, compressive) = (FrictionCone::Shifted, FrictionCone::Compressive);
    vec![
        ("full", pile(Physics::FULL, 20.0, shifted), 3e-3),
        ("compressive", pile(Physics::FULL, 20.0, compressive), 3e-3),
        ("without cohesion", pile(Physics::FULL, 0.0, shifted), 3e-3),
        ("unturning", pile(UNTURNING, 20.0, shifted), 3e-3),
        ("smooth", pile(SMOOTH, 20.0, shifted), 3e-3),
        ("line", line, 0.0),
    ]
}

/// Number of sweeps by which [`Simulation::next_problem`] solves the contact problem of the next step. The result is
/// the residual and the impulses.
struct Swept(u32);

impl ProblemVisitor for Swept {
    type Output = (f64, Vec<[f64; 2]>);

    fn visit<M: Model>(self, problem: &mut StepProblem<M>, _: &ContactList) -> Self::Output {
        if self.0 > 0 {
            let never = SolverSettings { max_sweeps: self.0, ..settings(Method::Nsgs, 1e-300) };
            solve(problem, &mut Memory::default(), &never);
        }
        let impulses = problem.rows().map(|(number, row)| {
            problem.reduced_impulse(number, row).map(|p| row.effective_mass * p)
        });
        (residual(problem), impulses.collect())
    }
}

#[test]
fn the_residual_from_w_is_the_residual_of_the_bodies() {
    for (name, scene, at_secs) in scenes() {
        let file = problem_file_at(&scene, at_secs, |_| ()).expect("a problem");
        let mut delassus = file.delassus().expect("a proper problem");
        let mut simulation = scene.simulation().expect("a proper scene");
        while simulation.time_secs() < at_secs - 1e-9 {
            simulation.step().expect("a finite state");
        }
        let mut residuals = Vec::new();
        for sweeps in [0, 1, 5] {
            let (of_bodies, impulses) = simulation.next_problem(Swept(sweeps));
            if sweeps > 0 {
                delassus.set_impulses(impulses);
            }
            assert_close(delassus.residual(), of_bodies, 1e-9, &format!("{name}, {sweeps} sweeps"));
            residuals.push(of_bodies);
        }
        assert!(residuals[0] > 1e-3, "{name}: something was left to do, {residuals:?}");
    }
}

#[test]
fn a_problem_longer_than_what_is_read_is_not_written() {
    let mut file = kept_problem("bond_0.json");
    file.comment = Some("x".repeat(256 << 20));
    let folder = folder();
    let said = file.write(&folder.path().join("problem.json")).expect_err("too long").to_string();
    assert!(said.contains("but must be at most 268435456 bytes"), "{said}");
    assert!(names_in(folder.path()).is_empty());
}

#[test]
fn a_file_reads_back_bit_for_bit_and_solves_as_the_simulation_does() {
    for (name, mut scene, at_secs) in scenes() {
        let file = problem_file_at(&scene, at_secs, |_| ()).expect("a problem");
        let again = ProblemFile::parse(&file.text()).expect("a proper problem");
        assert_eq!(file, again, "{name}");

        let mut simulation = scene.simulation().expect("a proper scene");
        while simulation.time_secs() < at_secs - 1e-9 {
            simulation.step().expect("a finite state");
        }
        let few = SolverSettings { max_sweeps: 30, ..settings(Method::Nsgs, 1e-300) };
        scene.solver = few;
        simulation.set_solver(few).expect("proper settings");
        simulation.step().expect("a finite state");
        let solution = solve_file(&again, &few, 1).expect("a solution");
        assert!(solution.on_bodies);
        let velocities = solution.velocities.expect("velocities of bodies");
        for (at, [x, y, _]) in velocities.into_iter().enumerate() {
            let found = simulation.world().grains.velocities[at];
            let expected = DVec2::new(x, if name == "line" { found.y } else { y });
            assert!((found - expected).length() < 1e-9, "{name}: {found} against {expected}");
        }
    }
}

/// Checks that each method solves each stored problem to a residual of 1e-6, given as bodies and given only as the
/// Delassus matrix W. Methods that need the bodies must refuse the matrix.
#[test]
fn every_method_reaches_1e_6_on_every_kept_problem_or_says_that_it_cannot() {
    let mut on_matrix = 0;
    for name in kept() {
        let file = kept_problem(&name);
        let in_matrix = ProblemFile { bodies: None, ..file.clone() };
        for info in METHODS {
            let settings = settings(info.method, 1e-6);
            let judge = |solution: Solution| {
                let Solution { residual, sweeps, .. } = solution;
                assert!(solution.converged, "{name} by {}: {residual:e}", info.name);
                assert!(residual <= 1.000_001e-6, "{name} by {}: {residual:e}", info.name);
                assert!(sweeps > 0);
            };
            if file.bodies.is_some() {
                judge(solve_file(&file, &settings, 1).expect("bodies are for every method"));
            }
            match solve_file(&in_matrix, &settings, 1) {
                Ok(solution) => {
                    on_matrix += 1;
                    judge(solution);
                }
                Err(error) => {
                    let said = error.to_string();
                    assert!(said.contains(info.name) && said.contains("works on W"), "{said}");
                }
            }
        }
    }
    assert!(on_matrix >= kept().len());
}

/// Solution of a contact problem by the program Siconos, written by `tests/problems/make_reference.py`.
#[derive(serde::Deserialize)]
struct Reference {
    residual: f64,
    u: Vec<f64>,
}

/// Checks that the velocities agree with those of Siconos to 1e-9 of the largest velocity without contact impulses.
/// Each problem is solved from the impulses of the file and from zero impulses, and also with the Delassus matrix W
/// instead of the bodies. Without friction the velocities are unique; in these problems they are unique with friction,
/// too.
#[test]
fn velocities_are_those_that_siconos_finds() {
    let with_friction = [SICONOS, "bond_0.json", "bond_20.json", "pile_138_bond_50.json"];
    for name in with_friction.into_iter().chain(["bond_0_smooth.json", "bond_5_smooth.json"]) {
        let path = problems().join("reference").join(name).with_extension("json");
        let text = read(&path);
        let reference: Reference = serde_json::from_str(&text).expect("a proper reference");
        assert!(reference.residual < 1e-11, "{name}: {}", reference.residual);
        let file = kept_problem(name);
        let fastest = |list: &[f64]| list.iter().fold(0f64, |most, u| most.max(u.abs()));
        let free = fastest(&file.q);
        assert!(fastest(&reference.u) > 0.05 * free, "{name}: the grains move");
        let bodiless = ProblemFile { bodies: None, ..file.clone() };
        let cold = ProblemFile { start: None, ..file.clone() };
        for file in [&file, &bodiless, &cold] {
            let solution = solve_file(file, &settings(Method::Nsgs, 2e-12), 1).expect("a solution");
            assert!(solution.converged && solution.residual <= 4e-12, "{}", solution.residual);
            let differences = solution.u.iter().zip(&reference.u).map(|(u, v)| (u - v).abs());
            let difference = differences.fold(0.0, f64::max) / free;
            assert!(difference < 1e-9, "{name}: velocities differ by {difference:e}");
        }
    }
}

/// Checks that methods that work on the Delassus matrix W solve contacts whose 2 × 2 block of W couples the normal and
/// the tangential component. Grains that are not discs have such contacts.
#[test]
fn methods_on_w_solve_contacts_that_couple_normal_and_tangent() {
    let mut random = random(5);
    for (cone, _) in pairs([FrictionCone::Shifted, FrictionCone::Compressive], 0..20) {
        let contacts = 12;
        let size = 2 * contacts;
        let degrees = 30;
        let gradients: Vec<f64> =
            (0..size * degrees).map(|_| random.random_range(-1.0..1.0)).collect();
        let mut matrix = Triplets::default();
        for (row, col) in pairs(0..size, 0..size) {
            let pick = |index: usize| &gradients[index * degrees..(index + 1) * degrees];
            let value = pick(row).iter().zip(pick(col)).map(|(a, b)| a * b).sum();
            matrix.row.push(row as u32);
            matrix.col.push(col as u32);
            matrix.val.push(value);
        }
        let mut list = |count: usize, from: f64, to: f64| -> Vec<f64> {
            (0..count).map(|_| random.random_range(from..to)).collect()
        };
        let q = list(size, -1.0, 1.0);
        let friction = list(contacts, 0.0, 0.6);
        let cohesion = list(contacts, 0.0, 0.1);
        let problem =
            DelassusProblem::new(&matrix, &q, &friction, &cohesion, cone).expect("a problem");
        for method in [Method::Nsgs, Method::Nncg, Method::Apgd, Method::Jacobi] {
            let mut problem = problem.clone();
            let settings = settings(method, 1e-11);
            let report = solve_delassus(&mut problem, &settings).expect("a method on W");
            let left = problem.residual();
            assert!(report.converged && left <= 1e-11, "{cone:?}, {method:?}: {left:e}");
        }
    }
}
