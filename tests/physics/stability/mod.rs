//! Tests of the limits of solvers and steppers, in scenes in which they fail. A quick run of the stability tests must
//! give the verdicts (the method passes or fails) of the stored table, and measured limits must agree with theory.
//!
//! After a change that improves a verdict, or worsens it for a good reason, write the table again: `cargo run --release
//! -- stability --quick --table tests/physics/stability/table.csv --overwrite`.

mod advice;
mod theory;

use std::sync::OnceLock;

use slump::scene::stability::{
    bounce, cantilever, column, heap, heap_of, lattice, mass_ratio, overlapped, squeeze,
};
use slump::scene::{SCENES, built_in};
use slump::study::stability::{CHALLENGES, StabilityTable, StabilityVerdict};

use crate::common::*;

const RENEW: &str = "cargo run --release -- stability --quick --table tests/physics/stability/table.csv --overwrite";

/// Names of the stability tests that every method passes at every level of difficulty.
const UNBROKEN: [&str; 1] = ["rest"];

fn quick() -> &'static StabilityTable {
    static TABLE: OnceLock<StabilityTable> = OnceLock::new();
    TABLE.get_or_init(|| {
        let all: Vec<_> = CHALLENGES.iter().collect();
        StabilityTable::run(&all, true, || ()).expect("sound scenes")
    })
}

#[test]
fn every_verdict_is_that_of_the_table() {
    let committed = StabilityTable::from_csv(include_str!("table.csv")).expect("a proper table");
    let mut changes = Vec::new();
    for (now, then) in quick().cells.iter().zip(&committed.cells) {
        let same = (&now.scene, &now.method) == (&then.scene, &then.method);
        assert!(same && now.level == then.level, "the table has other rows; renew it: {RENEW}");
        if now.verdict != then.verdict {
            let change = if now.verdict > then.verdict { "WORSE" } else { "better" };
            changes.push(format!(
                "{change}: {} at {} {}, {} (was {}, {})",
                now.method,
                now.scene,
                now.level,
                now.error,
                then.verdict.name(),
                then.error
            ));
        }
    }
    let (now, then) = (quick().cells.len(), committed.cells.len());
    assert_eq!(now, then, "the table has other rows; renew it: {RENEW}");
    assert!(changes.is_empty(), "{}\nIf that is right: {RENEW}", changes.join("\n"));
}

#[test]
fn every_challenge_opens_a_scene_and_no_two_scenes_share_a_name() {
    for challenge in CHALLENGES {
        assert!(built_in(challenge.name).is_ok(), "{} is no scene", challenge.name);
    }
    let mut names: Vec<_> =
        SCENES.iter().flat_map(|scene| scene.also.iter().chain([&scene.name])).collect();
    names.sort_unstable();
    let many = names.len();
    names.dedup();
    assert_eq!((names.len(), many), (many, SCENES.len() + 9));
    assert_eq!(built_in("sag").expect("a scene").name, "column");
}

#[test]
fn every_scene_breaks_a_method_at_its_last_level_and_none_at_its_first() {
    for challenge in CHALLENGES {
        let hardest = challenge.quick[challenge.quick.len() - 1];
        let of = |level: f64| {
            let here = quick().cells.iter();
            here.filter(move |cell| cell.scene == challenge.name && cell.level == level)
        };
        use StabilityVerdict::{Degrades, Fails};
        let broken = of(hardest).any(|cell| matches!(cell.verdict, Degrades | Fails));
        assert_eq!(broken, !UNBROKEN.contains(&challenge.name), "{}", challenge.name);
        let held = of(challenge.quick[0]).any(|cell| cell.verdict == StabilityVerdict::Holds);
        let recovers = challenge.name == "overlap";
        assert!(held || recovers, "{}: nobody holds at the first level", challenge.name);
    }
}

/// Largest speed with which a grain still counts as at rest after a few solved steps, in units of √(g d) (g:
/// gravitational acceleration, d: mean diameter).
const STILL: f64 = 1e-7;

fn solved(mut scene: Scene) -> Simulation {
    scene.solver = SolverSettings {
        friction_model: FrictionModel::Tresca,
        ..solved_by(Method::InteriorPoint, 1e-8)
    };
    start(&scene)
}

/// Takes some steps and checks that each step is solved, that no contact is lost, and that all grains come to rest.
fn stays(mut run: Simulation, what: &str) {
    let contacts = {
        assert!(error_against_model(&run) < 1e-4, "{what}");
        let row = *run.step().expect("a finite state");
        assert!(row.converged, "{what}");
        row.contacts
    };
    for _ in 0..5 {
        let row = *run.step().expect("a finite state");
        assert!(row.converged, "{what}");
        assert_eq!(row.contacts, contacts, "{what}");
    }
    let world = run.world();
    let fastest = world.grains.velocities.iter().map(|v| v.length()).fold(0.0, f64::max);
    let scale = (world.gravity.magnitude() * world.mean_diameter).sqrt();
    assert!(fastest < STILL * scale, "{what}: {fastest:e} m/s");
}

#[test]
fn the_lattice_is_hyperstatic_and_at_rest_however_little_its_normals_are_off() {
    for perturbation in [1e-6, 1e-4, 1e-2] {
        let scene = lattice(37, 36, perturbation);
        let mut first = start(&scene);
        let contacts = first.step().expect("a finite state").contacts;
        assert_eq!(scene.grains.len(), 1314);
        // Contacts: pairs side by side in long and short rows, 72 in each of the 35 gaps between rows, the floor, and
        // two walls.
        let beside = 18 * 36 + 18 * 35;
        assert_eq!(contacts, beside + 35 * 72 + 37 + 2 * 18, "{perturbation}");
        stays(solved(scene), &format!("displaced by {perturbation} d"));
    }
}

#[test]
fn heaps_of_any_size_are_at_rest() {
    for (count, grains) in [(1, 1), (5, 3), (138, 136), (500, 496), (2000, 1953)] {
        let scene = heap_of(count);
        assert_eq!(scene.grains.len(), grains);
        stays(solved(scene), &format!("{count} grains"));
    }
    assert_eq!(heap_of(10_000).grains.len(), 9870);
}

/// Overlap at which the remedy `push_out` (an optional correction, which pushes overlapping grains apart) stops, in
/// diameters.
const LEFT: f64 = 2e-4;

#[test]
fn there_is_no_remedy_unless_asked_for() {
    assert!(Remedies::default().is_none());
    let mut robust = heap(2);
    Preset::Robust.apply(&mut robust);
    let asked = robust.remedies;
    assert!(asked.push_out && asked.sequential_impacts);
    assert!(asked.max_travel == 0.25 && !asked.speculative, "pieces of a step keep bounces");
}

#[test]
fn overlap_is_pushed_out_without_speed_and_down_to_what_is_left() {
    let mut scene = overlapped(0.3);
    scene.gravity = Gravity::Uniform { acceleration: DVec2::ZERO };
    let run = after(&scene, 200);
    let stays = run.observables().max_overlap;
    assert!((stays - 0.3).abs() < 1e-12, "without the remedy the overlap stays: {stays}");

    scene.remedies.push_out = true;
    let mut run = start(&scene);
    let mut before = 0.3;
    for step in 0..200 {
        let now = *run.step().expect("a finite state");
        assert_eq!(now.kinetic_energy, 0.0, "step {step}");
        assert!(now.max_overlap <= before + 1e-12, "step {step}: {}", now.max_overlap);
        before = now.max_overlap;
    }
    assert!((before - LEFT).abs() < 0.01 * LEFT, "left: {before}");
}

#[test]
fn steps_whose_bounces_contradict_each_other_are_solved_with_shocks_in_sequence() {
    let mut scene = squeeze(1e-2);
    Preset::Robust.apply(&mut scene);
    scene.solver.max_sweeps = 1000;
    for sequential_impacts in [false, true] {
        scene.remedies.sequential_impacts = sequential_impacts;
        let mut run = start(&scene);
        let steps = (0..20).map(|_| run.step().expect("a finite state").converged);
        let solved = steps.filter(|converged| *converged).count();
        assert_eq!(solved == 20, sequential_impacts, "{solved} of 20 steps solved");
    }
}

#[test]
fn a_step_in_pieces_is_one_step_that_keeps_the_balance_of_energy() {
    let mut scene = bounce(0.5);
    scene.parameters.time_step_secs = 0.02;
    scene.remedies.max_travel = 0.1;
    let mut run = start(&scene);
    // The potential energy at the start is the total energy: weight times height of fall.
    let scale = run.observables().potential_energy;
    let (mut energy, mut touched) = (0.0, false);
    for step in 1..=30 {
        let now = *run.step().expect("a finite state");
        assert_eq!((now.step, now.time_step_secs), (step, 0.02));
        assert!((now.time_secs - 0.02 * step as f64).abs() < 1e-12);
        let change = now.kinetic_energy - energy;
        let work = now.normal_work + now.tangential_work + now.gravity_work;
        assert!((change - work).abs() <= 1e-13 * scale, "step {step}: {change} by {work}");
        touched |= now.normal_work != 0.0;
        energy = now.kinetic_energy;
    }
    assert!(touched, "it has bounced");
}

#[test]
fn a_step_is_cut_into_no_more_than_a_hundred_pieces() {
    for stepper in [Stepper::Moreau, Stepper::Range] {
        let mut scene = built_in("pile").expect("a scene");
        scene.stepper = stepper;
        scene.parameters.time_step_secs = 0.1;
        let travel = scene.gravity.magnitude() * 0.1 * 0.1 / scene.mean_diameter;
        let mut sweeps_in = |pieces: f64| {
            scene.remedies.max_travel = travel / (pieces - 0.5);
            // With one sweep per solve, the number of sweeps is proportional to the number of substeps.
            scene.solver = SolverSettings { max_sweeps: 1, ..solved_by(Method::Nsgs, 1e-9) };
            start(&scene).step().expect("a finite state").sweeps
        };
        let [ten, hundred, many] = [10.0, 100.0, 20_000.0].map(&mut sweeps_in);
        assert!(ten >= 10 && hundred > 2 * ten, "{stepper}: {ten} and {hundred} sweeps");
        assert_eq!(many, hundred, "{stepper}: work");
    }
}

/// Stability tests (scene and level of difficulty) that fail with every remedy (an optional correction of the
/// simulation). In the scene `far` the grains are 10¹³ d away from the origin (d: mean diameter). There neighbouring
/// floating-point numbers are 2·10⁻³ d apart, so positions are too coarse.
const UNMENDED: [(&str, f64); 1] = [("far", 1e13)];

#[test]
fn the_robust_preset_holds_everywhere_but_where_nothing_could() {
    for cell in quick().cells.iter().filter(|cell| cell.method == "robust") {
        let unmended = UNMENDED.contains(&(cell.scene.as_str(), cell.level));
        let holds = cell.verdict == StabilityVerdict::Holds;
        assert_eq!(holds, !unmended, "{} at {}: {}", cell.scene, cell.level, cell.error);
    }
}

/// Runs a scene for `steps` steps, or until a step fails. Returns the kinds and messages of the warnings that Slump has
/// raised.
fn alarms(scene: &Scene, steps: u32) -> Vec<(AlarmKind, String)> {
    let mut run = start(scene);
    for _ in 0..steps {
        if run.step().is_err() {
            break;
        }
    }
    let said = run.alarms().iter();
    said.map(|alarm| (alarm.kind, alarm.message(&scene.settings()))).collect()
}

#[test]
fn a_run_that_is_well_says_nothing() {
    assert_eq!(alarms(&heap(5), 300), []);
    assert_eq!(alarms(&cantilever(4), 300), []);
}

#[test]
fn an_overlap_of_more_than_a_twentieth_is_told_of_at_once() {
    let said = alarms(&overlapped(0.06), 1);
    assert_eq!(said[0].0, AlarmKind::PlacedInOverlap);
    assert!(said[0].1.contains("step 0,") && said[0].1.contains("push-out"));
    assert_eq!(alarms(&overlapped(0.04), 50), []);
}

#[test]
fn a_hundred_steps_at_the_sweep_limit_are_told_of_and_ninety_nine_are_not() {
    let mut scene = mass_ratio(1e3);
    scene.solver.max_sweeps = 2;
    scene.solver.tolerance = 1e-15;
    // Both methods must recommend more sweeps.
    for (method, advice) in
        [(Method::Auto, "more than 2 sweeps"), (Method::Nsgs, "more than 2 sweeps")]
    {
        scene.solver.method = method;
        let limit = |steps| {
            let said = alarms(&scene, steps).into_iter();
            said.filter(|(kind, _)| *kind == AlarmKind::SweepLimit).collect::<Vec<_>>()
        };
        assert_eq!(limit(99), []);
        let said = limit(100);
        assert!(said[0].1.contains("step 100,") && said[0].1.contains(advice), "{said:?}");
    }
}

#[test]
fn a_state_that_is_not_finite_is_told_of_with_what_helps() {
    let mut scene = column(20);
    scene.stepper = Stepper::Dem;
    scene.parameters.substeps = 1;
    scene.parameters.time_step_secs = 1.0;
    scene.gravity = Gravity::Uniform { acceleration: DVec2::new(0.0, -1e150) };
    let said = alarms(&scene, 1000);
    let (_, words) =
        said.iter().find(|(kind, _)| *kind == AlarmKind::NotFinite).expect("it blows up");
    assert!(words.contains("try 0 substeps"), "{words}");
}

/// Returns the scene under the contact law `range` (a bond breaks when it has opened by the debonding distance), with
/// parameters with which bonds break within a short time.
fn brittle(mut scene: Scene, bond: f64, time_step_secs: f64) -> Scene {
    scene.stepper = Stepper::Range;
    scene.solver.method = Method::Newton;
    scene.solver.stop = StopTest::Residual;
    scene.solver.tolerance = 1e-6;
    scene.parameters.bond = bond;
    scene.parameters.debonding_distance = 1e-4;
    scene.parameters.time_step_secs = time_step_secs;
    scene
}

#[test]
fn a_break_that_a_step_is_too_long_to_see_is_told_of_with_the_step_that_is_not() {
    // Runs until bonds have broken, or for 0.1 s. Returns the warnings about breaking bonds, and true if bonds broke.
    let run = |scene: &Scene| {
        let mut simulation = start(scene);
        let mut broken = 0.0;
        while simulation.time_secs() < 0.1 && broken == 0.0 {
            let step = simulation.step().expect("finite");
            broken = step.broken_bond_energy.unwrap_or_default();
        }
        let alarms = simulation.alarms().iter();
        let unseen = alarms.filter(|alarm| alarm.kind == AlarmKind::BreakUnseen).copied();
        (unseen.collect::<Vec<_>>(), broken > 0.0)
    };
    let pile = paper_pile().expect("the shipped state");
    let long = brittle(pile.clone(), 20.0, 5e-3);
    let (said, broke) = run(&long);
    assert!(broke && said.len() == 1, "{said:?}");
    // The breaking time √(2 δ_c d/(Bond g)) is 7.14e-5 s here. A substep may take 0.4 of this time, so the longest
    // resolved step has sixteen substeps and takes 4.57e-4 s.
    let bond_time = (2.0 * 1e-4 * pile.mean_diameter / (20.0 * 9.8f64)).sqrt();
    let longest = said[0].longest_time_step_secs.expect("the step that can");
    assert!((longest - 6.4 * bond_time).abs() < 1e-12, "{longest}");
    let words = said[0].message(&long.settings());
    assert!(words.contains("time step of at most 4.5e-4 s"), "{words}");
    // With this time step, breaking bonds are resolved. Without bonds, or if no bond is about to break, longer steps
    // raise no warning either.
    assert_eq!(run(&brittle(pile.clone(), 20.0, 4.5e-4)), (Vec::new(), true));
    assert_eq!(run(&brittle(pile, 0.0, 5e-3)), (Vec::new(), false));
    assert_eq!(run(&brittle(heap(5), 20.0, 5e-3)), (Vec::new(), false));
}

#[test]
fn a_grain_that_falls_out_of_the_world_is_told_of() {
    // Grains fall off the end of the base.
    let mut scene = heap(3);
    scene.grains[0].position.x += 100.0 * scene.mean_diameter;
    scene.fixed_discs.truncate(3);
    let side = 100.0 * scene.mean_diameter;
    let secs = (2.0 * 5.0 * side / scene.gravity.magnitude()).sqrt();
    let steps = (secs / scene.parameters.time_step_secs) as u32;
    let said = alarms(&scene, steps);
    assert!(said.iter().any(|(kind, _)| *kind == AlarmKind::GrainLeft), "{said:?}");
}
