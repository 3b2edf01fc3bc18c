//! Tests of the stepper `dem`: its springs and dashpots, the numbers that define them, and the time step at which they
//! become unstable.

use slump::error::Error;

use crate::common::*;
use crate::program::*;

fn springs(run: &Simulation) -> SpringDashpot {
    let physics = run.physics();
    SpringDashpot::of(run.world(), physics.axes, run.parameters())
}

/// Takes steps until two colliding discs have separated. Returns the time during which they pushed each other, s, and
/// the ratio of their final to their initial relative speed.
fn until_parted(scene: &Scene) -> [f64; 2] {
    let mut run = start(scene);
    let (before, carried) = (relative_velocity(&run), momentum(&run));
    let (mut pushed, mut touched) = (0.0, false);
    for _ in 0..1_000_000 {
        take_steps(&mut run, 1);
        assert!(momentum(&run).distance(carried) < 1e-12 * carried.length(), "momentum is kept");
        let now = run.observables().contacts > 0;
        if touched && !now {
            return [pushed, -relative_velocity(&run).dot(before) / before.length_squared()];
        }
        touched |= now;
        if run.contacts().impulses().first().is_some_and(|impulse| impulse.normal > 0.0) {
            pushed += scene.parameters.time_step_secs;
        }
    }
    panic!("they never parted");
}

#[test]
fn springs_and_dashpots_give_the_restitution_that_is_asked_for() {
    for physics in [LINE, SMOOTH, Physics::FULL] {
        for (restitution, expected) in
            [(0.0, 0.02), (0.02, 0.02), (0.1, 0.1), (0.3, 0.3), (0.5, 0.5), (0.8, 0.8), (1.0, 1.0)]
        {
            let probe = start(&meeting(physics, restitution, 1e-3));
            let critical = springs(&probe).critical_time_step_secs(effective_mass(&probe), 1.0);
            let mut errors = [200.0, 800.0].map(|parts| {
                let scene = by(Stepper::Dem, 1, meeting(physics, restitution, critical / parts));
                until_parted(&scene)[1] - expected
            });
            println!("ρ {restitution}: off by {errors:?}");
            // The error is of first order in the time step h: a quarter of h gives about a quarter of the error.
            assert!(errors[0].abs() < 1e-2, "ρ {restitution}: off by {errors:?}");
            errors.iter_mut().for_each(|error| *error = error.abs());
            assert!(errors[1] < 0.3 * errors[0] + 2e-4, "ρ {restitution}: off by {errors:?}");
        }
    }
}

/// Returns true if the oscillation of a bonded pair after a small push grows. `dt_over_critical` is the time step
/// divided by the critical time step.
fn shakes_up(restitution: f64, dt_over_critical: f64) -> bool {
    let probe = start(&meeting(LINE, restitution, 1e-3));
    let (mass, springs) = (effective_mass(&probe), springs(&probe));
    let mut scene = meeting(LINE, restitution, 1e-3);
    scene.parameters.time_step_secs = dt_over_critical * springs.critical_time_step_secs(mass, 1.0);
    scene.parameters.bond = 1.0;
    let overlap = mass * G / springs.stiffness;
    scene.grains[1].position.x = 0.25 - overlap;
    scene.grains[0].velocity.x = 0.0;
    let push = 1e-3 * overlap * (springs.stiffness / mass).sqrt();
    scene.grains[1].velocity.x = push;
    let mut run = start(&by(Stepper::Dem, 1, scene));
    (0..3000).any(|_| {
        run.step().expect("a finite state");
        relative_velocity(&run).length() > 10.0 * push
    })
}

#[test]
fn a_pair_of_elements_blows_up_above_its_critical_step_and_not_below() {
    for restitution in [0.0, 0.1, 0.5, 1.0] {
        let stable = border(0.5, 2.0, 8, |part| !shakes_up(restitution, part));
        println!("ρ {restitution}: {stable} of the critical step");
        assert!((stable - 1.0).abs() < 0.02, "ρ {restitution}: {stable} of the critical step");
    }
    // Without damping the critical time step is 2/ω, where ω is the natural angular frequency of the contact.
    let probe = start(&meeting(LINE, 1.0, 1e-3));
    let (mass, springs) = (effective_mass(&probe), springs(&probe));
    let critical = springs.critical_time_step_secs(mass, 1.0);
    assert_close(critical, 2.0 * (mass / springs.stiffness).sqrt(), 1e-12, "2/ω");
}

#[test]
fn a_step_that_blows_up_ends_in_an_error() {
    // The disc is between two walls, so it cannot escape with the energy that it gains.
    let mut scene = meeting(LINE, 0.5, 1e-3);
    scene.grains.truncate(1);
    let wall = |x: f64| plane(x * DVec2::X, -x * DVec2::X);
    scene.boundaries = vec![wall(-0.1499), wall(0.1499)];
    let critical = by(Stepper::Dem, 1, scene.clone()).simulation().expect("sound");
    let critical = critical.critical_time_step_secs().expect("springs");
    for (times, blows_up) in [(0.5, false), (3.0, true)] {
        scene.parameters.time_step_secs = times * critical;
        for substeps in [1, 10] {
            scene.parameters.time_step_secs = times * critical * f64::from(substeps);
            let mut simulation = start(&by(Stepper::Dem, substeps, scene.clone()));
            let failure = (0..2000).find_map(|_| simulation.step().err());
            assert_eq!(matches!(failure, Some(Error::NonFinite { .. })), blows_up, "{failure:?}");
        }
    }
    // A pile becomes unstable, too. The run must not panic, and its numbers may become infinite.
    let energies = |now: &Observables| [now.kinetic_energy, now.potential_energy];
    let mut pile = by(Stepper::Dem, 1, paper_pile().expect("the shipped state"));
    pile.parameters.time_step_secs = 2e-3;
    let mut simulation = start(&pile);
    let failed = (0..200).any(|_| simulation.step().is_err());
    let [kinetic, potential] = energies(simulation.observables());
    assert!(failed || kinetic > 10.0 * potential.abs(), "{kinetic} J");
    pile.parameters.substeps = 0;
    let simulation = after(&pile, 100);
    let [kinetic, potential] = energies(simulation.observables());
    assert!(kinetic < 0.5 * potential, "{kinetic} J of {potential} J");
}

const RADIUS: f64 = 2.5e-3;
/// Overlap of a bonded pair at rest, in radii.
const REST: f64 = 1e-3;

/// Returns the stiffness (N/m) with which the overlap of a bonded pair at rest is [`REST`]. `mass` is the effective
/// mass, kg.
fn stiffness(bond: f64, mass: f64) -> f64 {
    bond * mass * G / (REST * RADIUS)
}

#[test]
fn a_load_rests_at_the_overlap_that_the_stiffness_says() {
    for (bond, stiffness) in pairs([0.0, 20.0], [30.0, 1e4]) {
        let grain = Grain::at_rest(DVec2::new(2.0 * RADIUS, 0.0), RADIUS);
        let mut scene = scene(LINE, -G * DVec2::X, parameters(bond, 1e-4, 0.1, 0.0), vec![grain]);
        scene.fixed_discs = vec![fixed(DVec2::ZERO, RADIUS)];
        scene.parameters.stiffness = stiffness;
        let run = after(&by(Stepper::Dem, 0, scene), 20_000);
        let weight = run.grains().masses[0] * G;
        let overlap = 2.0 * RADIUS - run.place(0).x;
        assert_close(overlap, (1.0 + bond) * weight / stiffness, 1e-6, "overlap");
    }
}

#[test]
fn what_is_left_open_is_what_it_was_and_what_is_given_sets_the_substeps() {
    let pile = by(Stepper::Dem, 0, paper_pile().expect("the shipped state"));
    let critical = |stiffness, damping_ratio| {
        let mut scene = pile.clone();
        scene.parameters.stiffness = stiffness;
        scene.parameters.damping_ratio = damping_ratio;
        let run = start(&scene);
        (run.critical_time_step_secs().expect("springs"), run.substeps())
    };
    let (secs, substeps) = critical(0.0, 0.0);
    let weight = 138f64.sqrt() * G * start(&pile).world().grains.masses.iter().sum::<f64>() / 138.0;
    let stiffness = weight / (1e-3 * pile.mean_diameter);
    assert_close(critical(stiffness, 0.0).0, secs, 1e-12, "from the weight");
    let (four_times, more) = critical(4.0 * stiffness, 0.0);
    assert_close(four_times, 0.5 * secs, 1e-12, "a stiffer spring");
    assert!(more.abs_diff(2 * substeps) <= 1, "{substeps} and {more} substeps");
    assert!(critical(stiffness, 10.0).0 < 0.5 * secs, "a stronger dashpot");
}

/// Runs a collision of two discs with `parts` steps in the exact contact time. Returns four numbers: contact time (s)
/// and its exact value, ratio of final to initial relative speed and its exact value.
fn collision(physics: Physics, stiffness: f64, damping_ratio: f64, parts: f64) -> [f64; 4] {
    let mut scene = by(Stepper::Dem, 1, meeting(physics, 0.1, 1e-3));
    scene.parameters.stiffness = stiffness;
    scene.parameters.damping_ratio = damping_ratio;
    let mass = effective_mass(&start(&scene));
    let frequency = (stiffness / mass).sqrt();
    let (angle, root) = if damping_ratio < 1.0 {
        (damping_ratio.acos(), (1.0 - damping_ratio.powi(2)).sqrt())
    } else {
        (damping_ratio.acosh(), (damping_ratio.powi(2) - 1.0).sqrt())
    };
    let expected_secs = 2.0 * angle / root / frequency;
    let expected_restitution = (-damping_ratio * frequency * expected_secs).exp();

    scene.parameters.time_step_secs = expected_secs / parts;
    let [pushed, restitution] = until_parted(&scene);
    [pushed, expected_secs, restitution, expected_restitution]
}

#[test]
fn two_discs_push_each_other_for_the_contact_time_and_part_as_the_damping_ratio_says() {
    for (physics, stiffness, damping_ratio) in
        triples([LINE, SMOOTH], [50.0, 2e4], [1e-3, 0.2, 0.9, 1.5, 4.0])
    {
        let [secs, expected_secs, restitution, expected] =
            collision(physics, stiffness, damping_ratio, 4000.0);
        let what = format!("ζ {damping_ratio}, k {stiffness}");
        assert_close(secs, expected_secs, 2e-3, &format!("contact time at {what}"));
        assert!((restitution - expected).abs() < 2e-3, "{what}: {restitution}, {expected}");
    }
}

#[test]
fn the_contact_time_that_is_told_is_that_of_two_mean_grains() {
    let pile = by(Stepper::Dem, 0, paper_pile().expect("the shipped state"));
    for (damping_ratio, in_periods) in [(1e-9, 0.5), (0.5, 2.0 / 3.0 / 0.75f64.sqrt() / 2.0)] {
        let mut scene = pile.clone();
        scene.parameters.stiffness = 700.0;
        scene.parameters.damping_ratio = damping_ratio;
        let run = start(&scene);
        let mass = run.grains().masses.iter().sum::<f64>() / 138.0;
        let period = std::f64::consts::TAU * (0.5 * mass / 700.0).sqrt();
        let told = run.contact_time_secs().expect("springs");
        assert_close(told, in_periods * period, 1e-8, &format!("ζ {damping_ratio}"));
    }
}

/// Throws two equal grains, which are at rest in their bond, apart at this speed (m/s). Returns the energy of their
/// relative motion that they have lost when they are far apart (J), or `None` if they stay together.
fn thrown(mut scene: Scene, speed: f64, until_secs: f64) -> Option<f64> {
    scene.grains[1].velocity.x = speed;
    let mut run = start(&scene);
    let mass = effective_mass(&run);
    let far = 2.0 * RADIUS * (1.0 + 3.0 * DISTANCE_IN_DIAMETERS);
    while run.time_secs() < until_secs {
        take_steps(&mut run, 1);
        let positions = run.places();
        if positions[1].x - positions[0].x > far {
            let left = relative_velocity(&run).length_squared();
            return Some(0.5 * mass * (speed * speed - left));
        }
    }
    None
}

/// Returns a scene of a pair at rest in its bond. Under `dem`, its time step is short for the springs.
fn bonded(stepper: Stepper, damping_ratio: f64) -> Scene {
    let bond = 20.0;
    let at = |x| weightless(moving(DVec2::new(x, 0.0), RADIUS, DVec2::ZERO));
    let mut scene =
        by(stepper, 1, scene(LINE, G * DVec2::X, parameters(bond, 1e-4, 1.0, 0.0), vec![at(0.0)]));
    let apart = if stepper == Stepper::Dem { 2.0 - REST } else { 2.0 };
    scene.grains.push(at(apart * RADIUS));
    let mass = effective_mass(&start(&scene));
    scene.parameters.stiffness = stiffness(bond, mass);
    scene.parameters.damping_ratio = damping_ratio;
    scene.parameters.debonding_distance = DISTANCE_IN_DIAMETERS;
    if stepper == Stepper::Dem {
        scene.parameters.time_step_secs = 5e-4 * (mass / scene.parameters.stiffness).sqrt();
    }
    scene
}

fn work_told(scene: &Scene) -> f64 {
    start(scene).fracture_work().expect("bonds").joules
}

#[test]
fn a_pair_thrown_apart_loses_the_work_of_fracture_that_is_told() {
    for stepper in [Stepper::Dem, Stepper::Range] {
        let scene = bonded(stepper, 0.0);
        let (work, mass) = (work_told(&scene), effective_mass(&start(&scene)));
        let escape = (2.0 * work / mass).sqrt();
        for factor in [1.01, 1.5, 4.0] {
            let lost = thrown(scene.clone(), factor * escape, 0.1);
            let lost = lost.unwrap_or_else(|| panic!("{stepper}: held at {factor}"));
            assert_close(lost, work, 4e-3, &format!("{stepper} at {factor} of the escape speed"));
        }
        assert_eq!(thrown(scene, 0.99 * escape, 0.01), None, "{stepper}");
    }
    let told = start(&bonded(Stepper::Dem, 0.0)).fracture_work().expect("bonds");
    let grain = start(&bonded(Stepper::Dem, 0.0)).world().grains.masses[0];
    assert_close(told.over_mgd, told.joules / (grain * G * 2.0 * RADIUS), 1e-12, "in m g d");
    assert_eq!(start(&bonded(Stepper::Moreau, 0.0)).fracture_work(), None);
}

#[test]
fn a_dashpot_lets_a_fast_pair_lose_twice_that_work_and_none_more() {
    for damping_ratio in [0.05, 0.5, 1.2] {
        let scene = bonded(Stepper::Dem, damping_ratio);
        let (work, mass) = (work_told(&scene), effective_mass(&start(&scene)));
        let escape = (2.0 * work / mass).sqrt();
        for factor in [1.5, 3.0, 40.0] {
            let mut scene = scene.clone();
            scene.parameters.time_step_secs /= factor;
            let lost = thrown(scene, factor * escape, 0.1).expect("it parts") / work;
            assert!((1.0..2.01).contains(&lost), "ζ {damping_ratio}, {factor}: {lost}");
            // In these cases the force γv of the dashpot (γ: damping coefficient, v: speed) exceeds C₀ during the whole
            // separation.
            if 2.0 * damping_ratio * (factor * factor - 2.0f64).max(0.0).sqrt() > 1.0 {
                assert_close(lost, 2.0, 4e-3, &format!("ζ {damping_ratio}, {factor}"));
            }
        }
    }
}

/// Pulls a bonded pair apart slowly, within the time 2000/ω₀ (ω₀: natural angular frequency). Returns the work that the
/// contact absorbs, and the work of fracture C₀²/(2k) (C₀: cohesion force, k: stiffness), both in J.
fn pulled_apart(damping_ratio: f64) -> [f64; 2] {
    let grain = weightless(Grain::at_rest(DVec2::new((2.0 - REST) * RADIUS, 0.0), RADIUS));
    let mut scene = scene(LINE, G * DVec2::X, parameters(1.0, 1e-4, 1.0, 0.0), vec![grain]);
    scene.fixed_discs = vec![fixed(DVec2::ZERO, RADIUS)];
    let mass = start(&scene).world().grains.masses[0];
    let cohesion = mass * G;
    scene.parameters.stiffness = stiffness(1.0, mass);
    scene.parameters.damping_ratio = damping_ratio;
    let unit = (mass / scene.parameters.stiffness).sqrt();
    scene.parameters.time_step_secs = 0.02 * unit;
    let mut run: Simulation = start(&by(Stepper::Dem, 1, scene.clone()));
    let (from, mut done) = (run.place(0), 0.0);
    loop {
        // The pull is forty weights per diameter of distance to the target. At 1/40 of a diameter it is one weight,
        // which is C₀.
        let part = run.time_secs() / (2000.0 * unit);
        let target = from + DVec2::X * part * 2.0 * RADIUS / 40.0;
        run.set_pull(Some(Pull { grain: 0, target }));
        done += run.step().expect("a finite state").normal_work;
        assert!(part < 1.5, "it never parted");
        if run.observables().contacts == 0 && part > 0.5 {
            return [-done, 0.5 * cohesion * cohesion / scene.parameters.stiffness];
        }
    }
}

#[test]
fn a_pair_pulled_apart_slowly_takes_the_work_of_fracture_whatever_its_dashpot() {
    for damping_ratio in [0.05, 1.2] {
        let [done, expected] = pulled_apart(damping_ratio);
        assert_close(done, expected, 1e-2, &format!("slowly, ζ {damping_ratio}"));
    }
}

#[test]
fn springs_are_set_by_options_and_the_manifest_tells_what_follows() {
    let of_options = |options: &[&str]| {
        let folder = folder();
        let line = "--headless --scene squeeze --stepper dem --bond 20 --times 0 --size 8x8 --renderer cpu --frames";
        succeed(slump(line).arg(folder.path()).args(options));
        let manifest = manifest(folder.path());
        let told = |path: &str| manifest["runs"][0].pointer(path).and_then(|value| value.as_f64());
        [
            "/contact_time_secs",
            "/critical_time_step_secs",
            "/fracture_work/joules",
            "/fracture_work/over_mgd",
        ]
        .map(|path| told(path).expect(path))
    };
    let soft = of_options(&["--stiffness", "1000", "--damping-ratio", "0.5"]);
    let stiff = of_options(&["--stiffness", "4000", "--damping-ratio", "0.5"]);
    let ratios: Vec<f64> = soft.iter().zip(stiff).map(|(soft, stiff)| soft / stiff).collect();
    for (ratio, expected) in ratios.iter().zip([2.0, 2.0, 4.0, 4.0]) {
        assert!((ratio - expected).abs() < 1e-9, "{ratios:?}");
    }
    for (option, value) in
        [("--stiffness", "-3"), ("--stiffness", "nan"), ("--damping-ratio", "-1")]
    {
        let said = sentence(slump("scene --scene squeeze").args([option, value]));
        assert!(said.contains(&option[2..]) && said.contains("≥ 0"), "{said}");
    }
}

#[test]
fn springs_that_no_number_of_substeps_keeps_stable_are_refused_with_those_that_are_not() {
    let mut scene = by(Stepper::Dem, 0, meeting(Physics::FULL, 0.5, 1e-3));
    scene.parameters.stiffness = 1e15;
    let refused = |scene: &Scene| scene.simulation().expect_err("too stiff").to_string();
    let sentence = refused(&scene);
    assert!(
        sentence.starts_with("stiffness is 1000000000000000, but must be at most "),
        "{sentence}"
    );
    assert!(sentence.ends_with("would need more than 100000 substeps"), "{sentence}");
    let number = |sentence: &str| -> f64 {
        let (_, rest) = sentence.split_once("at most ").expect("the most");
        rest.split_once(' ').expect("a unit").0.parse().expect("a number")
    };
    scene.parameters.stiffness = number(&sentence);
    let substeps = start(&scene).substeps();
    assert!((90_000..=100_000).contains(&substeps), "{substeps}");
    scene.parameters.stiffness *= 1.2;
    assert!(scene.simulation().is_err(), "a little more");

    let (mut run, stiff) = (start(&by(Stepper::Dem, 0, meeting(LINE, 0.5, 1e-3))), 1e15);
    let too_stiff = Parameters { stiffness: stiff, ..*run.parameters() };
    assert!(run.set_parameters(too_stiff).is_err(), "on the way");

    scene.parameters.stiffness = 0.0;
    (scene.duration_secs, scene.parameters.time_step_secs) = (1e6, 1e4);
    let sentence = refused(&scene);
    assert!(sentence.starts_with("dt is 10000, but must be at most "), "{sentence}");
    scene.parameters.time_step_secs = number(&sentence);
    start(&scene);
}
