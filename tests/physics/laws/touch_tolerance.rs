//! Tests of the touch tolerance, which is the largest gap at which cohesive contacts still pull. Grains push each other
//! only at gap 0, within rounding.

use crate::common::*;

const RADIUS: f64 = 0.01;
const DIAMETER: f64 = 2.0 * RADIUS;
const BOND: f64 = 20.0;
/// Largest deviation of a gap from its expected value that the tests allow, in diameters. Slump itself treats a contact
/// with such a gap as closed, because rounding makes gaps between touching grains.
const ROUNDING: f64 = 1e-4;

/// Returns a scene of two weightless discs with the gap `gap` (in diameters) that separate at the speed `opening`
/// (m/s), under the touch tolerance `tolerance` (in diameters).
fn pair(tolerance: f64, gap: f64, opening: f64, dt: f64, restitution: f64) -> Scene {
    let place = (RADIUS + 0.5 * gap * DIAMETER) * DVec2::X;
    let grains = [-1.0, 1.0]
        .map(|side| weightless(moving(side * place, RADIUS, 0.5 * side * opening * DVec2::X)));
    let numbers =
        Parameters { touch_tolerance: tolerance, ..parameters(BOND, dt, restitution, 0.5) };
    Scene { solver: SolverSettings::default(), ..under_g(numbers, grains.to_vec()) }
}

fn gap(run: &Simulation) -> f64 {
    run.place(0).distance(run.place(1)) / DIAMETER - 1.0
}

/// Returns the speed at which the discs separate, m/s; negative if they approach.
fn opening(run: &Simulation) -> f64 {
    let velocities = &run.world().grains.velocities;
    (velocities[1] - velocities[0]).dot((run.place(1) - run.place(0)).normalize())
}

#[test]
fn discs_that_come_from_within_the_tolerance_meet_at_gap_0() {
    for (dt, speed) in pairs([1e-3, 1e-4], [0.0, -1e-3, -0.1]) {
        let run = after(&pair(0.01, 0.005, speed, dt, 0.0), (0.1 / dt) as usize);
        assert!(gap(&run).abs() <= ROUNDING, "{dt} s, {speed} m/s: {} d", gap(&run));
        // Without cohesion the discs keep their initial speed, so within 0.1 s slow pairs do not reach gap 0.
        let mut loose = pair(0.01, 0.005, speed, dt, 0.0);
        loose.parameters.bond = 0.0;
        let run = after(&loose, (0.1 / dt) as usize);
        let expected = (0.005 + 0.1 * speed / DIAMETER).max(0.0);
        assert!((gap(&run) - expected).abs() <= ROUNDING, "{dt} s, {speed} m/s: {} d", gap(&run));
    }
}

#[test]
fn discs_bounce_from_within_the_tolerance_as_from_the_surface() {
    for restitution in [0.3, 1.0] {
        let mut fast = pair(0.01, 0.005, -1.0, 1e-3, restitution);
        fast.parameters.bond = 0.0;
        let run = after(&fast, 10);
        assert_close(opening(&run), restitution, 1e-9, "speed");
    }
}

/// Checks that discs never separate faster than they approached. The pull takes from them at least the energy that it
/// gave them on the approach. At restitution 1 most pairs have the same speed after the collision as before, but some
/// slow pairs stay together, because a step ends with their gap at 0.
#[test]
fn the_pull_within_the_tolerance_gives_no_more_energy_than_it_takes() {
    let (mut kept, mut lost) = (0, 0);
    for (tolerance, dt) in pairs([1e-3, 1e-2, 0.1], [1e-3, 1e-4]) {
        let escape = (2.0 * BOND * G * tolerance * DIAMETER).sqrt();
        for part in 1..60 {
            let speed = 0.1 * f64::from(part) * escape;
            let far = 1.5 * tolerance + 2.0 * speed * dt / DIAMETER;
            let mut run = start(&pair(tolerance, far, -speed, dt, 1.0));
            let (mut steps, mut met) = (0, false);
            while steps < 100_000 && !(met && gap(&run) > far) {
                take_steps(&mut run, 1);
                steps += 1;
                met |= opening(&run) > 0.0;
                if met && opening(&run) <= 0.0 {
                    break;
                }
            }
            let left = opening(&run) / speed;
            assert!(left < 1.0 + 1e-9, "{tolerance} d, {dt} s, {part}: {left}");
            kept += u32::from(left > 1.0 - 1e-9);
            lost += u32::from(left <= 0.0);
        }
    }
    assert!(kept > 100 && lost > 0, "{kept} leave with all of their speed, {lost} are caught");
}

/// Checks the energy that breaks a bond: ½ m_ij v² = C₀ (τ + the opening within a step). Here v is the speed at which
/// the discs separate, m_ij their effective mass, τ the touch tolerance (m), C₀ = Bond m_ij g the cohesion force, and g
/// the gravitational acceleration.
#[test]
fn a_bond_takes_its_force_times_the_tolerance_to_break() {
    for tolerance in [1e-3, 0.01, 0.1] {
        let escape = (2.0 * BOND * G * tolerance * DIAMETER).sqrt();
        for (part, whole) in [(0.97, true), (1.03, false)] {
            // The time step is so short that the pair opens by little in one step.
            let dt = 1e-3 * tolerance * DIAMETER / escape;
            let run = after(&pair(tolerance, 0.0, part * escape, dt, 0.0), 5_000);
            let stays = gap(&run) < tolerance;
            assert_eq!(stays, whole, "{tolerance} d, {part} of the escape speed");
        }
    }
    // If the time step is long, cohesion removes the speed in a single step, so the escape speed is the capture speed
    // Bond·g·Δt.
    let (dt, capture) = (1e-3, BOND * G * 1e-3);
    for (part, whole) in [(0.99, true), (1.01, false)] {
        let run = after(&pair(0.0, -1e-6, part * capture, dt, 0.0), 50);
        assert_eq!(gap(&run) < 0.0, whole, "{part} of the capture speed");
    }
}

/// Checks up to which angular velocity ω two bonded discs of diameter d that circle about their common centre stay
/// together. In a time step Δt their gap opens by ½ω²Δt²d. If the bond is only a little stronger than the circular
/// motion requires, the pull needs some steps to reverse this opening. Meanwhile the gap grows by at most
/// ω⁴Δt²d/(8(ω_b² − ω²)), where ω_b is the largest angular velocity at which the bond can hold the pair. The touch
/// tolerance must be larger than this gap.
#[test]
fn a_pair_turns_for_good_up_to_the_spin_that_its_bond_bears() {
    let break_up = (BOND * G / DIAMETER).sqrt();
    for (dt, tolerance) in [(1e-4, 1e-4), (1e-4, 1e-2), (1e-3, 2e-2)] {
        for part in [0.02, 0.5, 0.85, 0.97, 1.03] {
            let rate: f64 = part * break_up;
            let left = break_up.powi(2) - rate.powi(2);
            let grows = 0.5 * (rate * dt).powi(2) + (rate.powi(2) * dt).powi(2) / (8.0 * left);
            let whole = left > 0.0;
            if whole && grows > tolerance {
                continue;
            }
            let mut scene = pair(tolerance, -1e-3, 0.0, dt, 0.0);
            for (grain, side) in scene.grains.iter_mut().zip([-1.0, 1.0]) {
                grain.velocity = RADIUS * rate * side * DVec2::Y;
                grain.angular_velocity = rate;
            }
            let turns = 20.0;
            let steps = (turns * std::f64::consts::TAU / (rate * dt)) as usize;
            let run = after(&scene, steps.min(50_000));
            assert_eq!(gap(&run) < 0.05, whole, "{dt} s, {tolerance} d, {part}: {} d", gap(&run));
            let held = run.alarms().iter().all(|alarm| alarm.kind != AlarmKind::TurnedBonds);
            assert!(held, "{dt} s, {tolerance} d, {part}");
            if part > 0.1 {
                scene.parameters.touch_tolerance = 0.0;
                assert!(gap(&after(&scene, steps.min(50_000))) > 0.05, "without it, it parts");
            }
        }
    }
}

/// Checks how many steps a bond survives turning at touch tolerance 0, however strong it is. Each step opens the gap by
/// ½ω²Δt²d (angular velocity ω, time step Δt, diameter d), so the bond ends when the openings of all steps together
/// exceed the initial overlap. With a touch tolerance that is larger than the opening of one step, the bond survives.
#[test]
fn without_a_tolerance_turning_uses_up_the_overlap_of_a_bond() {
    let break_up = (BOND * G / DIAMETER).sqrt();
    for ((dt, overlap), part) in pairs(pairs([1e-4, 1e-3], [1e-4, 1e-3, 5e-3]), [0.05, 0.2, 0.5]) {
        let turn = part * break_up * dt;
        let opens = 0.5 * turn * turn;
        let expected = overlap / opens;
        if !(2.0..20_000.0).contains(&expected) {
            continue;
        }
        let turning = |tolerance| {
            let mut scene = pair(tolerance, -overlap, 0.0, dt, 0.0);
            for (grain, side) in scene.grains.iter_mut().zip([-1.0, 1.0]) {
                grain.velocity = 0.5 * (1.0 - overlap) * DIAMETER * turn / dt * side * DVec2::Y;
                grain.angular_velocity = turn / dt;
            }
            scene
        };
        let mut run = start(&turning(0.0));
        let mut steps = 0.0;
        while gap(&run) <= 0.0 && steps < 3.0 * expected {
            take_steps(&mut run, 1);
            steps += 1.0;
        }
        let differs = (steps - expected).abs();
        assert!(
            differs <= 1.0 + 0.01 * expected,
            "{dt} s, {overlap} d, {part}: {steps}, {expected}"
        );
        let later = (2.0 * expected + 100.0) as usize;
        assert!(gap(&after(&turning(0.0), later)) > 2.0 * opens, "{dt} s, {overlap} d, {part}");
        let whole = gap(&after(&turning(2.0 * opens), later));
        assert!(whole <= 2.0 * opens, "{dt} s, {overlap} d, {part}: {whole}");
    }
}

/// Checks that discs that touch according to a file are bonded under the default touch tolerance. The numbers in a file
/// are rounded, so their gaps are about ±1e-16 diameters.
#[test]
fn discs_that_are_written_as_touching_are_bonded_by_default() {
    let mut random = random(9);
    let (mut apart, mut without) = (0, 0);
    for _ in 0..200 {
        let angle: f64 = random.random_range(0.0..std::f64::consts::TAU);
        let first = DVec2::new(random.random_range(-1.0..1.0), random.random_range(-1.0..1.0));
        let along = DVec2::from_angle(angle);
        let mut scene = pair(Parameters::default().touch_tolerance, 0.0, 0.0, 1e-3, 0.0);
        for (grain, side) in scene.grains.iter_mut().zip([0.0, 1.0]) {
            grain.position = first + side * DIAMETER * along;
            grain.velocity = 0.5 * BOND * G * 1e-3 * (side - 0.5) * along;
        }
        let is_bonded = |scene: &Scene| opening(&after(scene, 1)).abs() < 1e-12;
        apart += u32::from(!is_bonded(&scene));
        scene.parameters.touch_tolerance = 0.0;
        without += u32::from(!is_bonded(&scene));
    }
    assert_eq!(apart, 0);
    assert!(without > 50, "rounding decides at a tolerance of 0: {without} of 200 are not bonded");
}
