//! Tests of sheared periodic cells, whose lower and upper borders slide along each other: results do not depend on the
//! position of the borders, momentum and energy are balanced, and flows take the velocity profile of the shear.

use crate::common::*;

/// Width and height of the periodic cell, m. Neither is a multiple of the other.
pub(super) const SIZE: DVec2 = DVec2::new(0.11, 0.1);

pub(super) fn cell(shear_rate: f64) -> Periodic {
    Periodic { shear_rate, ..Periodic::along_both([0.0, SIZE.x], [0.0, SIZE.y]) }
}

/// Returns every stepper with every method that supports sheared periodic cells.
pub(super) fn ways() -> impl Iterator<Item = (Stepper, Method)> {
    let takes = |method: Method| method.info().takes_shear;
    every_way()
        .into_iter()
        .filter(move |(stepper, method)| !stepper.uses_method() || takes(*method))
}

/// Returns a scene of 80 discs with the velocities of uniform shear plus random velocities. The mean velocity along y
/// is zero.
pub(super) fn gas(shear_rate: f64, restitution: f64, friction: f64) -> Scene {
    let mut random = random(7);
    let mut grains: Vec<_> = (0..80)
        .map(|k| {
            let place =
                0.01 * DVec2::new(0.6 + 1.1 * f64::from(k % 10), 0.6 + 1.2 * f64::from(k / 10));
            let mut component = || random.random_range(-1.0..=1.0);
            moving(place, 0.0052, DVec2::new(component() + shear_rate * place.y, component()))
        })
        .collect();
    let drift: DVec2 = grains.iter().map(|grain| grain.velocity).sum::<DVec2>() / 80.0;
    grains.iter_mut().for_each(|grain| grain.velocity.y -= drift.y);
    let mut scene = without_g(parameters(0.0, 1e-4, restitution, friction), grains);
    scene.solver.tolerance = 1e-10;
    scene.periodic = Some(cell(shear_rate));
    scene
}

#[test]
fn two_discs_that_rub_across_the_border_rub_by_the_speed_of_the_image() {
    // Two discs meet across the border and have no velocity along it. They rub only because the border slides at the
    // speed U. The friction impulse is the smaller of μP (P: normal impulse) and m_t U (m_t: tangential effective
    // mass).
    let discs = [DVec2::new(0.055, 0.0099), DVec2::new(0.055, SIZE.y - 0.0099)];
    let mut scene = without_g(
        parameters(0.0, 1e-4, 0.0, 0.2),
        vec![moving(discs[0], 0.01, -0.1 * DVec2::Y), moving(discs[1], 0.01, 0.1 * DVec2::Y)],
    );
    let rate = 20.0;
    scene.periodic = Some(cell(rate));
    for (stepper, method) in ways().filter(|(stepper, _)| *stepper == Stepper::Moreau) {
        (scene.stepper, scene.solver.method) = (stepper, method);
        let run = after(&scene, 1);
        let velocities = run.velocities();
        // P = 0.1 m stops each disc along y (m: mass), so μP = 0.02 m. The image of the first disc passes at 2 m/s.
        let expected = [DVec2::new(-0.02, 0.0), DVec2::new(0.02, 0.0)];
        for (found, expected) in velocities.iter().zip(expected) {
            assert!(found.distance(expected) < 1e-12, "{method}: {found} {expected}");
        }
        let now = run.observables();
        let mass = run.grains().masses[0];
        // The work of the border is the friction impulse P_t times the speed of the image. Friction dissipates the part
        // that does not accelerate the discs.
        assert_close(
            now.border_work.expect("it shears"),
            0.02 * mass * 2.0,
            1e-12,
            "the border's work",
        );
        let turned = run.grains().angular_velocities[0] * 0.01;
        let slip = 2.0 - 0.5 * (2.0 * 0.02 + 2.0 * turned.abs());
        assert_close(-now.tangential_work, 0.02 * mass * slip, 1e-12, "what rubbing took");
    }
}

#[test]
fn nothing_hangs_on_where_the_borders_are() {
    for &stepper in Stepper::ALL {
        let mut scene = gas(10.0, 0.5, 0.3);
        scene.stepper = stepper;
        let run = |by: DVec2| {
            let mut scene = scene.clone();
            for grain in &mut scene.grains {
                grain.position += by;
            }
            let (mut run, mut touching) = (start(&scene), 0);
            for _ in 0..60 {
                take_steps(&mut run, 1);
                touching += run.observables().contacts;
            }
            assert!(touching > 50, "{stepper}: {touching}");
            run
        };
        let one = run(DVec2::ZERO);
        for by in [DVec2::new(0.03, 0.0), DVec2::new(0.0, 0.043), DVec2::new(-0.07, 0.081)] {
            let other = run(by);
            let at = |run: &Simulation, k: usize| run.place(k);
            let cell = one.world().periodic.expect("a cell");
            let mut farthest = 0f64;
            for k in 1..80 {
                let [here, there] =
                    [&one, &other].map(|run| cell.shortest(at(run, k) - at(run, 0)));
                // Only close pairs are compared. At longer distances the nearest image can be a different image in the
                // two runs.
                if here.length() < 0.03 {
                    farthest = farthest.max(here.distance(there));
                }
            }
            assert!(farthest < 1e-9, "{stepper} {by}: {farthest} m");
        }
    }
}

#[test]
fn cells_that_have_slid_by_a_width_are_cells_that_stand_straight() {
    let plain = {
        let mut scene = gas(0.0, 0.5, 0.3);
        scene.parameters.bond = 2.0;
        scene
    };
    for (stepper, method) in ways() {
        let run = |shift: f64| {
            let mut scene = plain.clone();
            (scene.stepper, scene.solver.method) = (stepper, method);
            scene.periodic = Some(Periodic { shift, ..cell(0.0) });
            after(&scene, 40)
        };
        let [straight, slid, at_the_left] = [0.0, SIZE.x, -SIZE.x].map(run);
        assert_eq!(straight.observables().border_work, None);
        for other in [slid, at_the_left] {
            let places = straight.places().iter();
            for (one, other) in places.zip(other.places()) {
                assert!(one.distance(*other) < 1e-9, "{stepper} {method}: {one} {other}");
            }
            assert_eq!(other.observables().border_work, Some(0.0));
        }
    }
}

#[test]
fn momentum_less_that_of_the_shear_stays() {
    let rate = 20.0;
    for stepper in Stepper::ALL.iter().filter(|&&stepper| stepper != Stepper::Avbd) {
        let mut scene = gas(rate, 0.95, 0.1);
        (scene.stepper, scene.parameters.time_step_secs) = (*stepper, 2e-4);
        let mut run = start(&scene);
        let momentum = |run: &Simulation| -> DVec2 {
            let grains = run.grains();
            let own = |k: usize| grains.velocities[k] - rate * grains.positions[k].y * DVec2::X;
            (0..grains.len()).map(|k| grains.masses[k] * own(k)).sum()
        };
        let (before, mut crossings) = (momentum(&run), 0);
        for _ in 0..1000 {
            let old = run.grains().positions.clone();
            take_steps(&mut run, 1);
            let now = run.places();
            crossings += old
                .iter()
                .zip(now)
                .filter(|(old, now)| (old.y - now.y).abs() > 0.5 * SIZE.y)
                .count();
        }
        assert!(crossings > 10, "{stepper}: {crossings}");
        let scale: f64 = run.grains().masses.iter().sum::<f64>() * rate * SIZE.y;
        // In all other schemes momentum is conserved less exactly: they move grains by velocities that differ from the
        // velocities at the end of a substep, or they correct only positions.
        let exact = [Stepper::Moreau, Stepper::Dem].contains(stepper);
        let allowed = if exact { 1e-12 } else { 2e-3 };
        let off = momentum(&run).distance(before) / scale;
        assert!(off < allowed, "{stepper}: {off}");
    }
}

#[test]
fn kinetic_energy_changes_by_the_works_of_contacts_and_borders() {
    for (stepper, method) in ways().filter(|way| way.0 != Stepper::Avbd) {
        let mut scene = gas(20.0, 0.5, 0.3);
        (scene.stepper, scene.solver.method) = (stepper, method);
        scene.parameters.bond = 3.0;
        let mut run = start(&scene);
        let (start_energy, mut works) = (run.observables().kinetic_energy, [0.0; 2]);
        for _ in 0..120 {
            let (now, off, _) = balance(&mut run);
            let of_border = now.border_work.expect("it shears");
            assert!(off < 1e-12 * start_energy, "{stepper} {method}, {off}: {now:?}");
            let of_contacts = now.normal_work + now.tangential_work;
            works = [works[0] + of_contacts, works[1] + of_border.abs()];
        }
        let enough = works[0] < -0.1 * start_energy && works[1] > 0.01 * start_energy;
        assert!(enough, "{works:?} J of {start_energy} J");
    }
}

#[test]
fn remedies_know_of_images_that_slide() {
    let with = |change: &dyn Fn(&mut Remedies)| {
        let mut scene = gas(20.0, 0.5, 0.3);
        change(&mut scene.remedies);
        (scene.parameters.time_step_secs, scene.solver) = (1e-3, to_residual(1e-8));
        let mut run = start(&scene);
        let mut deepest = 0f64;
        for _ in 0..200 {
            let before = run.observables().kinetic_energy;
            let (now, off, _) = balance(&mut run);
            assert!(off < 1e-12 * before, "{now:?}");
            deepest = deepest.max(now.max_overlap);
        }
        deepest
    };
    let none = with(&|_| ());
    assert!(none > 0.05, "grains run into each other: {none}");
    let cut = with(&|remedies| remedies.max_travel = 0.02);
    assert!(cut < 0.05, "{cut}");
    let ahead = with(&|remedies| remedies.speculative = true);
    // Contacts detected ahead do not include deflections by other grains within the step, so some overlap remains.
    assert!(ahead < none, "{ahead}");
    let pushed = with(&|remedies| remedies.push_out = true);
    assert!(pushed < 2.0 * none, "{pushed}");
    with(&|remedies| remedies.sequential_impacts = true);
}

#[test]
fn an_elastic_gas_keeps_all_the_work_of_the_borders() {
    let mut scene = gas(20.0, 1.0, 0.0);
    scene.solver.tolerance = 1e-12;
    let mut run = start(&scene);
    let (before, mut work) = (run.observables().kinetic_energy, 0.0);
    for _ in 0..2000 {
        take_steps(&mut run, 1);
        work += run.observables().border_work.expect("it shears");
    }
    let gained = run.observables().kinetic_energy - before;
    assert_close(gained, work, 1e-8, "what it has gained");
    assert!(gained > 0.2 * before, "it is heated: {gained} {before}");
}

#[test]
fn a_dense_flow_takes_the_profile_of_the_borders_from_rest() {
    let rate = 20.0;
    let mut scene = gas(rate, 0.1, 0.5);
    for grain in &mut scene.grains {
        // The grains nearly fill the cell. The velocity of the shear is removed, so at the start no grain moves with
        // the borders.
        (grain.radius, grain.velocity) =
            (0.0058, grain.velocity - rate * grain.position.y * DVec2::X);
    }
    scene.solver.tolerance = 1e-6;
    scene.parameters.time_step_secs = 2e-4;
    let mut run = start(&scene);
    let slope = |run: &Simulation| {
        let grains = run.grains();
        let of = |k: usize| (grains.positions[k].y - 0.5 * SIZE.y, grains.velocities[k].x);
        let pairs: Vec<_> = (0..grains.len()).map(of).collect();
        let squares: f64 = pairs.iter().map(|(y, _)| y * y).sum();
        let mean = pairs.iter().map(|(_, speed)| speed).sum::<f64>() / pairs.len() as f64;
        pairs.iter().map(|(y, speed)| y * (speed - mean)).sum::<f64>() / squares
    };
    assert!(slope(&run).abs() < 0.2 * rate, "{}", slope(&run));
    take_steps(&mut run, 500);
    let mut mean = 0.0;
    for _ in 0..20 {
        take_steps(&mut run, 25);
        mean += slope(&run) / 20.0;
    }
    assert!((mean / rate - 1.0).abs() < 0.15, "{mean} 1/s");
    assert_eq!(run.observables().lost_grains, 0);
}

#[test]
fn a_flow_twice_as_fast_takes_the_same_way_and_bears_four_times_as_much() {
    let run = |factor: f64| {
        let mut scene = gas(20.0 * factor, 0.5, 0.4);
        for grain in &mut scene.grains {
            let rest = grain.velocity - 20.0 * factor * grain.position.y * DVec2::X;
            (grain.radius, grain.velocity) = (0.0055, grain.velocity + (factor - 1.0) * rest);
        }
        scene.parameters.time_step_secs = 2e-4 / factor;
        scene.solver = to_residual(1e-8);
        after(&scene, 400)
    };
    let [one, other] = [1.0, 2.0].map(run);
    assert!(one.world().periodic.expect("a cell").shift != 0.0);
    let places = one.places().iter().zip(other.places());
    let farthest = places.map(|(one, other)| one.distance(*other)).fold(0.0, f64::max);
    assert!(farthest < 1e-9, "{farthest} m");
    let [one, other] = [one, other].map(|run| measure(&run.moment()).pile);
    assert!(one.stress_xy != 0.0);
    assert_close(other.stress_xy, 4.0 * one.stress_xy, 1e-6, "Bagnold's square");
}

#[test]
fn an_image_that_slides_towards_discs_at_rest_is_found() {
    // Both discs are at rest, so only the movement of the border can show that the list of near pairs is out of date.
    for &stepper in Stepper::ALL {
        let at = |x: f64, y: f64| moving(DVec2::new(x, y), 0.01, DVec2::ZERO);
        let grains = vec![at(0.03, 0.005), at(0.08, SIZE.y - 0.005)];
        let mut scene = without_g(parameters(0.0, 1e-4, 0.0, 0.2), grains);
        (scene.stepper, scene.periodic) = (stepper, Some(cell(1.0)));
        let mut run = start(&scene);
        // The image moves at 0.1 m/s. After a third of a second it has moved three centimetres and meets the other
        // disc.
        take_steps(&mut run, 2000);
        assert_eq!(run.observables().contacts, 0, "{stepper}: not yet");
        let mut met = 0;
        for _ in 0..2500 {
            take_steps(&mut run, 1);
            met = met.max(run.observables().contacts);
        }
        assert_eq!(met, 1, "{stepper}: they meet");
        let speeds = run.velocities();
        assert!(speeds[0].length() > 1e-3 && speeds[1].length() > 1e-3, "{stepper}: {speeds:?}");
    }
}
