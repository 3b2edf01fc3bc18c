//! Tests of bonded pairs that circle about their common centre. If bonds have a length, a pair breaks at the angular
//! velocity √(Bond·g/(2r)), where r is the radius and g the gravitational acceleration that defines the cohesion force.
//! If a bond ends at a gap of zero, the pair breaks at a lower angular velocity, and Slump warns.

use crate::common::*;

const RADIUS: f64 = 0.01;
/// Overlap of the two discs at the start, in radii.
const OVERLAP: f64 = 1e-3;

/// Returns a scene of two weightless discs that touch and circle about their common centre at `rate` (rad/s).
fn doublet(stepper: Stepper, bond: f64, rate: f64, dt: f64) -> Scene {
    let place = RADIUS * (1.0 - OVERLAP) * DVec2::X;
    let grains = [-place, place].map(|place| Grain {
        angular_velocity: rate,
        ..weightless(moving(place, RADIUS, RADIUS * rate * (place / RADIUS).perp()))
    });
    let numbers = parameters(bond, dt, 0.0, 0.5);
    Scene { stepper, solver: SolverSettings::default(), ..under_g(numbers, grains.to_vec()) }
}

fn is_whole(run: &Simulation) -> bool {
    run.place(0).distance(run.place(1)) < 2.1 * RADIUS
}

fn warning(run: &Simulation) -> Option<Alarm> {
    run.alarms().iter().find(|alarm| alarm.kind == AlarmKind::TurnedBonds).copied()
}

/// Returns the largest angular velocity ω at which the bond holds the pair together, rad/s. At this ω, the centripetal
/// force m ω² r of a disc (mass m, radius r) equals the cohesion force Bond·½m·g, where ½m is the effective mass and g
/// the gravitational acceleration.
fn break_up(bond: f64) -> f64 {
    (bond * G / (2.0 * RADIUS)).sqrt()
}

#[test]
fn a_pair_breaks_at_the_spin_that_its_bond_bears_where_bonds_have_a_length() {
    let bond = 20.0;
    for (stepper, (part, whole)) in pairs(
        [Stepper::Range, Stepper::Dem],
        [(0.02, true), (0.9, true), (0.98, true), (1.03, false)],
    ) {
        let rate = part * break_up(bond);
        let run = after(&doublet(stepper, bond, rate, 1e-4), 4000);
        assert_eq!(is_whole(&run), whole, "{stepper} at {part} of the break-up spin");
        assert_eq!(warning(&run), None, "{stepper} at {part}");
    }
}

/// Checks that a bond can break although the circular motion of its pair needs only 2e-4 of the strength of the bond: a
/// bond that ends at a gap of zero breaks, and Slump warns. With the change that the warning recommends, the pair stays
/// together.
#[test]
fn a_bond_that_turning_ends_is_counted_and_the_advice_helps() {
    let (bond, rate) = (1000.0, 10.0);
    let cases = [
        (Stepper::Moreau, FrictionCone::Shifted, "remedy turning-bonds"),
        (Stepper::Moreau, FrictionCone::Compressive, "remedy turning-bonds"),
        (Stepper::Avbd, FrictionCone::Shifted, "stepper range"),
        (Stepper::Avbd, FrictionCone::Compressive, "stepper dem"),
    ];
    for ((stepper, cone, advice), dt) in pairs(cases, [1e-3, 5e-4]) {
        let mut scene = doublet(stepper, bond, rate, dt);
        scene.parameters.cone = cone;
        let steps = (0.5 / dt) as usize;
        let run = after(&scene, steps);
        let what = format!("{stepper}, {cone}, {dt} s");
        let Some(alarm) = warning(&run) else { panic!("{what}: no warning, {:?}", run.alarms()) };
        assert!(!is_whole(&run), "{what}");
        assert_eq!(alarm.count, Some(1), "{what}");
        let said = alarm.message(&scene.settings());
        assert!(said.contains("1 so far") && said.contains(advice), "{said}");
        match advice {
            "remedy turning-bonds" => scene.remedies.turning_bonds = true,
            "stepper range" => scene.stepper = Stepper::Range,
            _ => scene.stepper = Stepper::Dem,
        }
        let advised = after(&scene, steps);
        assert!(is_whole(&advised), "{what}");
        assert_eq!(warning(&advised), None, "{what}");
    }
}

/// Checks that the gap of two discs of radius r that circle at the angular velocity ω grows by ω²Δt² r in each time
/// step Δt. So a bond that ends at a gap of zero and begins with the overlap s lasts s/(ω²Δt² r) steps.
#[test]
fn the_gap_of_a_pair_grows_by_its_turning_in_each_step() {
    let (rate, dt) = (10.0, 1e-3);
    let mut run = start(&doublet(Stepper::Moreau, 1000.0, rate, dt));
    take_steps(&mut run, 1);
    let gap = |run: &Simulation| run.place(0).distance(run.place(1)) - 2.0 * RADIUS;
    let before = gap(&run);
    take_steps(&mut run, 10);
    assert_close(
        (gap(&run) - before) / 10.0,
        0.5 * (rate * dt).powi(2) * 2.0 * RADIUS,
        1e-2,
        "gap",
    );
}

#[test]
fn nothing_is_counted_without_a_bond_that_bears() {
    // Two cases without a warning: no cohesion, and a motion that needs more than the strength of the bond.
    for (bond, part) in [(0.0, 0.1), (20.0, 3.0)] {
        let run = after(&doublet(Stepper::Moreau, bond, part * break_up(20.0), 1e-4), 1000);
        assert!(!is_whole(&run));
        assert_eq!(warning(&run), None, "Bond {bond} at {part}");
    }
    let loose = pressed_pile(60, 0.3, 7, parameters(0.0, 1e-3, 0.3, 0.5));
    for stepper in [Stepper::Moreau, Stepper::TgsSoft, Stepper::Avbd] {
        assert_eq!(warning(&after(&Scene { stepper, ..loose.clone() }, 200)), None, "{stepper}");
    }
}

/// Checks that with the remedy `turning-bonds` a pair keeps its bond up to the angular velocity at which the cohesion
/// force holds it, at touch tolerance 0, and without gaining or losing energy.
#[test]
fn with_the_remedy_a_pair_turns_for_good_up_to_the_spin_that_its_bond_bears() {
    let bond = 20.0;
    for (dt, part) in pairs([1e-4, 1e-3], [0.05, 0.5, 0.97, 1.03]) {
        let rate = part * break_up(bond);
        let mut scene = doublet(Stepper::Moreau, bond, rate, dt);
        scene.parameters.touch_tolerance = 0.0;
        let turns = 10.0;
        let steps = (turns * std::f64::consts::TAU / (rate * dt)) as usize;
        assert!(!is_whole(&after(&scene, steps)), "without the remedy: {dt} s, {part}");
        scene.remedies.turning_bonds = true;
        let mut run = after(&scene, 1);
        let energy = |run: &Simulation| run.observables().kinetic_energy;
        let first = energy(&run);
        take_steps(&mut run, steps);
        assert_eq!(is_whole(&run), part < 1.0, "{dt} s, {part}");
        if part < 1.0 {
            assert_close(energy(&run) / first, 1.0, 1e-5, "energy");
            assert_eq!(warning(&run), None, "{dt} s, {part}");
        }
    }
}

#[test]
fn with_the_remedy_a_grain_circles_a_fixed_disc_and_keeps_its_bond() {
    let (bond, dt) = (20.0, 1e-3);
    for (part, whole) in [(0.5, true), (0.9, true), (1.1, false)] {
        // The grain has twice the effective mass of a pair of such grains, and circles at twice the distance. So the
        // force Bond·m·g holds it up to the same angular velocity.
        let rate = part * break_up(bond);
        let mut scene = doublet(Stepper::Moreau, bond, rate, dt);
        scene.parameters.touch_tolerance = 0.0;
        scene.remedies.turning_bonds = true;
        scene.grains.truncate(1);
        let place = 2.0 * RADIUS * (1.0 - OVERLAP) * DVec2::X;
        scene.grains[0].position = place;
        scene.grains[0].velocity = rate * place.perp();
        scene.fixed_discs = vec![Disc { position: DVec2::ZERO, radius: RADIUS }];
        let run = after(&scene, 1000);
        assert_eq!(run.place(0).length() < 2.1 * RADIUS, whole, "{part}");
        scene.remedies.turning_bonds = false;
        assert!(after(&scene, 1000).place(0).length() > 2.1 * RADIUS, "{part}: it leaves");
    }
}

/// Checks that the remedy `turning-bonds` has no effect without cohesion: trajectories are bitwise the same.
#[test]
fn without_cohesion_the_remedy_for_turning_bonds_changes_nothing() {
    for bond in [0.0, 20.0] {
        let mut scene = pressed_pile(60, 0.1, 3, parameters(bond, 1e-3, 0.1, 0.5));
        let places = |scene: &Scene| after(scene, 200).world().grains.positions.clone();
        let plain = places(&scene);
        scene.remedies.turning_bonds = true;
        assert_eq!(plain == places(&scene), bond == 0.0, "Bond {bond}");
    }
}
