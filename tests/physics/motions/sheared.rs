//! Borders that shear: pairs across them are pairs like others, no place is marked by them, and what they would tear is
//! refused.

use super::through_a_file;
use crate::common::*;

/// Width and height of the cell, m: neither is a multiple of the other.
pub(super) const SIZE: DVec2 = DVec2::new(0.11, 0.1);

pub(super) fn cell(shear_rate: f64) -> Periodic {
    Periodic { shear_rate, ..Periodic::along_both([0.0, SIZE.x], [0.0, SIZE.y]) }
}

/// Every stepper, with every method that knows of images that slide.
pub(super) fn ways() -> impl Iterator<Item = (Stepper, Method)> {
    let takes = |method: Method| method.info().takes_shear;
    every_way()
        .into_iter()
        .filter(move |(stepper, method)| !stepper.uses_method() || takes(*method))
}

/// 80 discs with random velocities beside those of the shear, whose momentum is that of the shear alone.
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
    let parameters = parameters(0.0, 1e-4, restitution, friction);
    let mut scene = scene(Physics::FULL, DVec2::ZERO, parameters, grains);
    scene.solver.tolerance = 1e-10;
    scene.periodic = Some(cell(shear_rate));
    scene
}

/// The velocity of grain `j` as grain `i` sees it, of the image that is nearest, m/s.
fn relative_velocity(run: &Simulation, i: usize, j: usize) -> DVec2 {
    let (grains, cell) = (run.grains(), run.world().periodic.expect("a cell"));
    let above = ((grains.positions[i].y - grains.positions[j].y) / SIZE.y).round();
    let image = grains.velocities[j] + above * cell.shear_rate * SIZE.y * DVec2::X;
    image - grains.velocities[i]
}

/// Two discs that meet, moved by some way.
fn pair(shear_rate: f64, by: DVec2) -> Scene {
    let at = |x: f64, y: f64, speed: f64| moving(DVec2::new(x, y) + by, 0.01, speed * DVec2::ONE);
    let grains = vec![at(-0.0073, -0.0071, 0.3), at(0.0073, 0.0072, -0.1)];
    let mut pair = scene(Physics::FULL, DVec2::ZERO, parameters(0.0, 1e-3, 0.5, 0.4), grains);
    pair.periodic = Some(cell(shear_rate));
    pair
}

#[test]
fn a_pair_that_meets_across_a_border_that_slides_is_a_pair_that_meets_inside() {
    for (stepper, method) in ways() {
        for rate in [3.0, -3.0] {
            let run = |by: DVec2| {
                let mut scene = pair(rate, by);
                (scene.stepper, scene.solver.method) = (stepper, method);
                let run = after(&through_a_file(&scene), 20);
                run
            };
            let inside = run(0.5 * SIZE);
            let expected = relative_velocity(&inside, 0, 1);
            assert!(expected.x > -0.35, "{stepper} {method}: they met: {expected}");
            for part in [DVec2::ZERO, DVec2::new(0.5, 0.0), DVec2::new(0.5, 1.0), DVec2::ONE] {
                let across = run(part * SIZE);
                let what = format!("{stepper} {method} {rate} {part}");
                let found = relative_velocity(&across, 0, 1);
                assert!(found.distance(expected) < 1e-9, "{what}: {found} {expected}");
                let [one, other] =
                    [&inside, &across].map(|run| run.grains().angular_velocities.clone());
                for (one, other) in one.iter().zip(&other) {
                    assert!((one - other).abs() < 1e-7, "{what}: {one} {other} rad/s");
                }
                let [one, other] = [&inside, &across].map(|run| {
                    let places = run.places();
                    run.world().periodic.expect("a cell").shortest(places[0] - places[1])
                });
                assert!(one.distance(other) < 1e-10, "{what}: {one} {other}");
            }
        }
    }
}

#[test]
fn two_discs_that_rub_across_the_border_rub_by_the_speed_of_the_image() {
    // Side by side across the border and at rest each: what rubs them is the sliding of the border alone, until
    // friction's impulse μP or the slip's own mass, m_t U, is used up.
    let discs = [DVec2::new(0.055, 0.0099), DVec2::new(0.055, SIZE.y - 0.0099)];
    let mut scene = scene(
        Physics::FULL,
        DVec2::ZERO,
        parameters(0.0, 1e-4, 0.0, 0.2),
        vec![moving(discs[0], 0.01, -0.1 * DVec2::Y), moving(discs[1], 0.01, 0.1 * DVec2::Y)],
    );
    let rate = 20.0;
    scene.periodic = Some(cell(rate));
    for (stepper, method) in ways().filter(|(stepper, _)| *stepper == Stepper::Moreau) {
        (scene.stepper, scene.solver.method) = (stepper, method);
        let run = after(&scene, 1);
        let velocities = run.velocities();
        // Both stop along y with P = 0.1 m each, so that μP = 0.02 m; the image of the first goes by with 2 m/s.
        let expected = [DVec2::new(-0.02, 0.0), DVec2::new(0.02, 0.0)];
        for (found, expected) in velocities.iter().zip(expected) {
            assert!(found.distance(expected) < 1e-12, "{method}: {found} {expected}");
        }
        let now = run.observables();
        let mass = run.grains().masses[0];
        // P_t times the speed of the image, and as much less what rubbing has taken.
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
    for stepper in Stepper::ALL {
        let mut scene = gas(10.0, 0.5, 0.3);
        scene.stepper = *stepper;
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
                // Farther away the nearest image is another one where its column is.
                if here.length() < 0.03 {
                    farthest = farthest.max(here.distance(there));
                }
            }
            assert!(farthest < 1e-9, "{stepper} {by}: {farthest} m");
        }
    }
}

#[test]
fn every_pair_in_touch_is_found_across_borders_that_slide_and_none_twice() {
    let mut scene = gas(30.0, 0.9, 0.3);
    for (k, grain) in scene.grains.iter_mut().enumerate() {
        grain.radius *= if k % 3 == 0 { 0.2 } else { 1.0 };
    }
    let mut run = start(&scene);
    let mut found_across = [0; 2];
    for _ in 0..1500 {
        let (grains, cell) = (run.grains().clone(), run.world().periodic.expect("a cell"));
        take_steps(&mut run, 1);
        let mut expected = Vec::new();
        for i in 0..grains.len() {
            for j in i + 1..grains.len() {
                let reach = grains.radii[i] + grains.radii[j];
                for above in [-1.0, 0.0, 1.0] {
                    for beside in [-2.0, -1.0, 0.0, 1.0, 2.0] {
                        let image =
                            DVec2::new(beside * SIZE.x + above * cell.shift, above * SIZE.y);
                        if (grains.positions[i] - grains.positions[j] - image).length() < reach {
                            found_across[0] += u32::from(above == 0.0 && beside != 0.0);
                            found_across[1] += u32::from(above != 0.0);
                            expected.push((i as u32, j as u32));
                        }
                    }
                }
            }
        }
        let contacts = run.contacts().contacts().iter();
        let found: Vec<_> = contacts.map(|contact| (contact.grain, contact.other)).collect();
        assert_eq!(found, expected);
    }
    assert!(found_across.iter().all(|count| *count > 20), "{found_across:?}");
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
            let run = after(&scene, 40);
            run
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
fn what_borders_that_slide_would_tear_is_refused_in_one_sentence() {
    let refused = |change: &dyn Fn(&mut Scene)| {
        let mut scene = gas(1.0, 0.5, 0.3);
        change(&mut scene);
        scene.simulation().map(|_| ()).expect_err("it cannot be").to_string()
    };
    assert_eq!(
        refused(&|scene| scene.periodic = Some(Periodic { y: None, ..cell(2.0) })),
        "periodic.shear_rate is 2, but must be 0 unless both periodic.x and periodic.y are given"
    );
    assert_eq!(
        refused(&|scene| scene.periodic = Some(cell(f64::NAN))),
        "periodic.shear_rate is NaN, but must be a finite number"
    );
    assert_eq!(
        refused(&|scene| scene.periodic = Some(Periodic { shift: 0.2, ..cell(0.0) })),
        "periodic.shift is 0.2, but must be from -0.11 to 0.11 m, a width of the cell"
    );
    assert_eq!(
        refused(&|scene| {
            scene.physics = Physics { friction: false, rotation: false, ..Physics::FULL }
        }),
        "periodic.shear_rate is 1, but must be 0 unless physics has friction and rotation; mu = 0 is no matter"
    );
    let said = refused(&|scene| scene.fixed_discs = vec![crate::common::fixed(DVec2::ZERO, 0.001)]);
    assert_eq!(
        said,
        "periodic.shear_rate is 1, but must be 0 where there are boundaries or fixed discs, which cannot go with it"
    );
    assert!(refused(&|scene| scene.boundaries = vec![level()]).starts_with("periodic.shear_rate"));
    refused(&|scene| {
        scene.motions = vec![Motion { course: Some(straight(DVec2::X)), ..Motion::default() }]
    });
    for info in METHODS.iter().filter(|info| !info.takes_shear) {
        let said = refused(&|scene| scene.solver.method = info.method);
        assert!(
            said.starts_with(&format!("solver is {}, but must be nsgs or ", info.name)),
            "{said}"
        );
        let mut run = start(&gas(1.0, 0.5, 0.3));
        let mut settings = *run.settings();
        settings.solver.method = info.method;
        run.change(settings).expect_err("not while it runs either");
    }
}
