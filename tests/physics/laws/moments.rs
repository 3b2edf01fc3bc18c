//! Tests of the reported states of contacts against exact results: status, forces, ages, unsolved steps and residuals.
//! Further tests check in small piles how the time step Δt and cohesion affect the slump (Abramian & Staron 2020, §3).

use rayon::prelude::*;

use crate::common::*;
use crate::program::*;

const RADIUS: f64 = 2e-3;
/// Initial overlap of discs and floor, m. At a gap of exactly 0 no contact would be detected.
const DEPTH: f64 = 1e-10;

/// Returns a run of a disc on a floor. Gravity is inclined by `angle` (rad) against the normal of the floor.
fn disc_on_floor(angle: f64, bond: f64, friction: f64, cone: FrictionCone) -> Simulation {
    let mut scene = scene_of(&[DVec2::new(0.0, RADIUS - DEPTH)], angle);
    scene.parameters.bond = bond;
    scene.parameters.friction = friction;
    scene.parameters.cone = cone;
    start(&scene)
}

fn scene_of(centres: &[DVec2], angle: f64) -> Scene {
    let mut scene = built_in("pile").expect("the pile");
    scene.parameters.restitution = 0.0;
    scene.parameters.time_step_secs = 1e-3;
    scene.mean_diameter = 2.0 * RADIUS;
    scene.grains = centres.iter().map(|&centre| Grain::at_rest(centre, RADIUS)).collect();
    scene.fixed_discs.clear();
    scene.boundaries = vec![level()];
    scene.gravity = Gravity::Uniform { acceleration: 9.81 * DVec2::new(angle.sin(), -angle.cos()) };
    scene
}

fn only_contact(moment: &Moment) -> ContactState {
    assert_eq!(moment.contacts.len(), 1, "{:?}", moment.contacts);
    moment.contacts[0]
}

#[test]
fn a_disc_on_a_slope_sticks_or_slips_by_coulombs_law_in_either_cone() {
    // Without slip the disc needs the friction force T = ⅓ m g sin α. It slips if T is more than μ times the force that
    // bounds friction: the normal force plus the cohesion force in the shifted cone, only the pushing part of the
    // normal force in the compressive cone.
    let (angle, friction) = (0.5f64, 0.1);
    let needed = angle.sin() / 3.0;
    let cases = [
        (0.0, FrictionCone::Shifted, ContactStatus::Slip),
        (0.5, FrictionCone::Shifted, ContactStatus::Slip),
        (1.0, FrictionCone::Shifted, ContactStatus::Stick),
        (1.0, FrictionCone::Compressive, ContactStatus::Slip),
    ];
    for (bond, cone, status) in cases {
        let bound = match cone {
            FrictionCone::Shifted => friction * (angle.cos() + bond),
            FrictionCone::Compressive => friction * angle.cos(),
        };
        assert_eq!(needed > bound, status == ContactStatus::Slip, "the situation at Bond {bond}");
        let mut run = disc_on_floor(angle, bond, friction, cone);
        run.take_steps(20).expect("finite steps");
        let moment = run.moment();
        let contact = only_contact(&moment);
        assert_eq!(contact.status, status, "Bond {bond}, {cone:?}: {contact:?}");
        let weight = moment.grains[0].mass * 9.81;
        let force = contact.force / weight;
        let expected = DVec2::new(-needed.min(bound), angle.cos());
        assert!(force.distance(expected) < 1e-6, "Bond {bond}, {cone:?}: {force} of {expected}");
        assert_eq!(contact.other, OtherBody::Boundary(0));
        assert!(contact.point.distance(DVec2::new(moment.grains[0].position.x, 0.0)) < 1e-9);
        assert!(contact.branch.distance(RADIUS * DVec2::Y) < 1e-9);
    }
}

#[test]
fn a_disc_that_is_pulled_off_opens_at_its_cohesion() {
    // Gravity points upwards, away from the floor. Cohesion of half the weight does not hold the disc, cohesion of
    // twice the weight does.
    for (bond, status) in [(0.5, ContactStatus::Open), (2.0, ContactStatus::Slip)] {
        let mut run = disc_on_floor(std::f64::consts::PI, bond, 0.0, FrictionCone::Shifted);
        run.step().expect("a finite step");
        let moment = run.moment();
        let contact = only_contact(&moment);
        assert_eq!(contact.status, status, "Bond {bond}: {contact:?}");
        let pull = -contact.normal_force / (moment.grains[0].mass * 9.81);
        assert!((pull - bond.min(1.0)).abs() < 1e-9, "Bond {bond}: {pull}");
    }
}

#[test]
fn a_contact_is_as_old_as_it_has_lasted() {
    // One disc rests on the floor. The other disc starts above the floor and lands after several steps.
    let height = 1.5 * RADIUS;
    let centres = [DVec2::new(0.0, RADIUS - DEPTH), DVec2::new(6.0 * RADIUS, RADIUS + height)];
    for stepper in Stepper::ALL.iter().copied() {
        let mut scene = scene_of(&centres, 0.0);
        scene.stepper = stepper;
        let mut run = start(&scene);
        // Step in which each disc touched the floor for the first time. The resting disc already touches at the start.
        let mut touches = [Some(0), None];
        assert_eq!(only_contact(&run.moment()).age_steps, 0, "{stepper}");
        for step in 1..=60u64 {
            run.step().expect("a finite step");
            let moment = run.moment();
            for grain in 0..2 {
                let contact = moment.contacts.iter().find(|contact| contact.grain == grain);
                let found = &mut touches[grain as usize];
                *found = contact.map(|_| found.unwrap_or(step));
                let age_steps = contact.map(|contact| contact.age_steps);
                assert_eq!(age_steps, found.map(|found| step - found), "{stepper}, grain {grain}");
            }
        }
        assert_eq!(touches[0], Some(0), "{stepper}");
        assert!(touches[1].is_some_and(|step| step > 5), "{stepper}: {touches:?}");
    }
}

#[test]
fn grains_and_contacts_are_those_of_the_simulation() {
    let mut run = built_in("pile").expect("the pile").simulation().expect("a run");
    run.take_steps(30).expect("finite steps");
    let moment = run.moment();
    let snapshot = run.snapshot();
    let fastest = moment.grains.iter().map(|grain| grain.velocity.length()).fold(0.0, f64::max);
    let reach = 2.0 * fastest * run.parameters().time_step_secs + 1e-12;
    assert_eq!(moment.grains.len(), snapshot.grains.len());
    assert_eq!(moment.contacts.len(), snapshot.contacts.len());
    for (state, view) in moment.contacts.iter().zip(&snapshot.contacts) {
        assert_eq!(state.normal_force, view.normal_force);
        let on_grain = matches!(state.other, OtherBody::Grain(_));
        assert_eq!(on_grain, view.other_grain.is_some());
        // The reported contact points belong to positions at the end of the step, the forces to positions at its
        // beginning.
        assert!(state.branch.distance(view.from - view.to) <= reach, "{state:?} {view:?}");
    }
    assert!(moment.contacts.iter().any(|contact| contact.status == ContactStatus::Slip));
    assert!(moment.contacts.iter().any(|contact| contact.status == ContactStatus::Stick));
    assert!(moment.contacts.iter().any(|contact| matches!(contact.other, OtherBody::FixedDisc(_))));
}

/// Tolerance of the residual that no step of a pile can reach, because it is below the rounding error.
const OUT_OF_REACH: f64 = 1e-18;

fn pile(stepper: Stepper) -> Scene {
    let solver = SolverSettings { max_sweeps: 100_000, ..solved_by(Method::Nncg, OUT_OF_REACH) };
    let mut pile = Scene { stepper, solver, ..built_in("pile").expect("the shipped state") };
    // Without a threshold, no sweep gets any further in these steps.
    pile.parameters.restitution_threshold = 0.0;
    pile
}

#[test]
fn a_stalled_step_is_observed_as_such_under_every_stepper_with_a_method() {
    for &stepper in Stepper::ALL.iter().filter(|stepper| stepper.uses_method()) {
        let mut run = pile(stepper).simulation().expect("a sound scene");
        let mut tally = Tally::default();
        for _ in 0..5 {
            tally.add(run.step().expect("a finite state"));
        }
        assert_eq!(tally.unconverged_steps, 5, "{stepper}: nothing gets to {OUT_OF_REACH:e}");
        assert_eq!(tally.stalled_steps, 5, "{stepper}: more sweeps are of no use");
    }
}

#[test]
fn a_run_tells_of_stalled_steps_in_its_manifest_and_on_stderr() {
    let folder = folder();
    let line = "--headless --renderer cpu --size 16x16 --stepper range --solver nncg --stop residual \
                --tolerance 1e-18 --max-sweeps 100000 --dt 1e-3 --duration 5e-3 --times 5e-3 --frames";
    let said = succeed(slump(line).arg(folder.path()));
    assert!(said.contains("5 of 5 steps did not reach tolerance"), "{said}");
    assert!(said.contains("5 of them stalled"), "{said}");
    assert_eq!(manifest(folder.path())["runs"][0]["tally"]["stalled_steps"], 5);
    let rows = read(folder.path().join("observables.csv"));
    let header = rows.lines().next().expect("a header");
    let column = header.split(',').position(|name| name == "stalled").expect("a column");
    let stalled = rows.lines().skip(1).filter(|row| row.split(',').nth(column) == Some("true"));
    assert_eq!(stalled.count(), 5);
}

#[test]
fn a_method_never_converges_to_a_residual_that_is_not_finite_and_a_scheme_always_does() {
    for (stepper, method) in every_way() {
        let mut cradle = built_in("cradle").expect("the cradle");
        cradle.stepper = stepper;
        cradle.solver.method = method;
        let mut run = start(&cradle);
        for _ in 0..20 {
            let seen = *run.step().expect("a finite state");
            let is_finite = seen.residual.is_finite();
            let is_scheme = !stepper.uses_method();
            assert!(is_finite || seen.converged == is_scheme, "{stepper} {method}: {seen:?}");
            // The residual of a solver method is finite even at the start, when nothing moves and all velocities are
            // rounding errors.
            assert!(is_finite || is_scheme, "{stepper} {method}: {seen:?}");
        }
    }
}

#[test]
fn a_run_ends_where_no_number_holds_its_energy() {
    for (stepper, method) in every_way() {
        let grains = vec![moving(DVec2::ZERO, 0.1, 1e200 * DVec2::X)];
        let mut thrown = without_g(parameters(0.0, 1e-3, 0.0, 0.5), grains);
        (thrown.stepper, thrown.solver.method) = (stepper, method);
        let mut run = start(&thrown);
        let ends = run.step().is_err();
        let seen = run.observables();
        let finite = run.world().grains.velocities[0].is_finite();
        assert!(finite && seen.kinetic_energy.is_infinite(), "{stepper} {method}: the situation");
        assert!(ends && !seen.converged, "{stepper} {method}: {seen:?}");
    }
}

// Piles are chaotic: any change shifts the slump of a single pile by some hundredths. So each test is about the mean of
// paired differences over the initial states, with Student's 95 % interval.

const BOX_WIDTH_IN_DIAMETERS: f64 = 8.0;
/// Number of initial states of the pile over which results are averaged.
const STATES: u64 = 8;
/// Student's t of the 95 % interval with `STATES` − 1 degrees of freedom.
const STUDENT_T: f64 = 2.365;
/// Simulated duration of a collapse, s. A pile of this size comes to rest earlier.
const DURATION_SECS: f64 = 0.4;

fn states() -> Vec<Vec<Grain>> {
    let rain = |seed| NewPile {
        grains: 48,
        box_width_in_diameters: BOX_WIDTH_IN_DIAMETERS,
        seed,
        ..NewPile::default()
    };
    let settled = |seed| settle(&rain(seed), |_| true).expect("it comes to rest");
    (1..=STATES).into_par_iter().map(settled).collect()
}

fn slumps(states: &[Vec<Grain>], bond: f64, dt: f64) -> Vec<f64> {
    let slump = |grains: &Vec<Grain>| {
        let mut scene = pile_of(grains.clone(), BOX_WIDTH_IN_DIAMETERS).expect("a pile");
        scene.parameters.bond = bond;
        scene.parameters.time_step_secs = dt;
        scene.solver.tolerance = 1e-5;
        scene.solver.max_sweeps = 3000;
        let run = after(&scene, (DURATION_SECS / dt).round() as usize);
        run.observables().slump
    };
    states.par_iter().map(slump).collect()
}

/// Returns the mean of the paired differences between the numbers in `a` and in `b`, and half the width of its 95 %
/// interval.
fn difference(a: &[f64], b: &[f64]) -> (f64, f64) {
    let count = a.len() as f64;
    let differences: Vec<f64> = a.iter().zip(b).map(|(a, b)| a - b).collect();
    let mean = differences.iter().sum::<f64>() / count;
    let squares: f64 = differences.iter().map(|difference| (difference - mean).powi(2)).sum();
    (mean, STUDENT_T * (squares / (count - 1.0) / count).sqrt())
}

#[test]
fn without_cohesion_the_time_step_does_not_change_the_slump() {
    let states = states();
    let finest = slumps(&states, 0.0, 5e-4);
    let mean = finest.iter().sum::<f64>() / finest.len() as f64;
    assert!(finest.iter().all(|&slump| slump > 0.3), "they collapse: {finest:.3?}");
    for dt in [1e-3, 2e-3, 5e-3] {
        let (change, error) = difference(&slumps(&states, 0.0, dt), &finest);
        println!("Δt {dt}: slump {mean:.3} changes by {change:.4} ± {error:.4}");
        assert!(error < 0.1 * mean, "Δt {dt}: ± {error} tells nothing");
        assert!(change.abs() < error, "Δt {dt}: the slump changes by {change} ± {error}");
    }
}

#[test]
fn cohesion_of_bond_100_holds_what_collapses_without() {
    let states = states();
    let (loose, bonded) = (slumps(&states, 0.0, 1e-3), slumps(&states, 100.0, 1e-3));
    for (loose, bonded) in loose.iter().zip(&bonded) {
        // One of these narrow piles leans over and slumps by 0.27. All other piles with cohesion slump by less than
        // 0.12.
        assert!(bonded + 0.2 < *loose, "{bonded} with cohesion, {loose} without");
    }
    let (change, error) = difference(&bonded, &loose);
    println!("Bond 100: {bonded:.3?}, by {change:.3} ± {error:.3}");
    assert!(change + error < -0.3, "cohesion changes the slump by {change} ± {error}");
}
