//! Tests of changes that a user makes between two steps: added and removed grains, dragged walls, and forces on grains.

use crate::common::*;

const RADIUS: f64 = 2.5e-3;
const GRAVITY: DVec2 = DVec2::new(0.0, -9.8);

/// Returns a scene with three rows of cohesive grains that fall on a floor between walls.
fn heap() -> Scene {
    let grains = (0..12).map(|number| {
        let (row, column) = (number / 4, number % 4);
        let shift = if row % 2 == 0 { 0.0 } else { 0.4 };
        let at = DVec2::new(2.05 * f64::from(column) + shift, 1.01 + 1.9 * f64::from(row));
        Grain::at_rest(RADIUS * at, RADIUS)
    });
    let mut heap = scene(Physics::FULL, GRAVITY, parameters(5.0, 1e-3, 0.0, 0.4), grains.collect());
    let plane = |point, normal| Boundary::HalfSpace { point, normal };
    heap.boundaries = vec![
        plane(DVec2::ZERO, DVec2::Y),
        plane(DVec2::new(-1.2 * RADIUS, 0.0), DVec2::X),
        plane(DVec2::new(8.0 * RADIUS, 0.0), DVec2::NEG_X),
    ];
    heap
}

/// Returns the scene [`heap`] with every combination of stepper and method that supports the scene, each with the name
/// of the combination.
fn in_every_way() -> Vec<(String, Scene)> {
    let mut heap = heap();
    heap.solver.max_sweeps = 200;
    in_each_way(&heap, every_way()).filter(|(_, scene)| scene.simulation().is_ok()).collect()
}

/// Returns the bit patterns of positions, angles and velocities of the grains in this range of indices.
fn bits(run: &Simulation, grains: std::ops::Range<usize>) -> Vec<[u64; 6]> {
    crate::common::bits(run)[grains].to_vec()
}

fn far(radius: f64) -> Disc {
    Disc { position: RADIUS * DVec2::new(3.0, 60.0), radius }
}

#[test]
fn a_grain_that_is_added_at_the_start_is_one_of_the_scene() {
    for (way, scene) in in_every_way() {
        let mut listed = scene.clone();
        let Disc { position, radius } = far(1.5 * RADIUS);
        listed.grains.push(Grain::at_rest(position, radius));
        let (mut added, mut listed) = (start(&scene), start(&listed));
        added.edit(&Edit::Add(far(1.5 * RADIUS))).expect("there is room");
        for run in [&mut added, &mut listed] {
            take_steps(run, 40);
        }
        assert_eq!(bits(&added, 0..13), bits(&listed, 0..13), "{way}");
        let [one, other] = [&added, &listed].map(|it| it.observables().slump);
        assert!((one - other).abs() < 1e-12, "{way}: {one} {other}");
    }
}

#[test]
fn forces_and_bonds_of_the_others_outlive_a_grain_that_comes_and_goes() {
    for (way, scene) in in_every_way() {
        let mut alone = after(&scene, 60);
        let contacts = alone.contacts().contacts().len();
        assert!(contacts > 10, "the situation: a heap that touches, {contacts}, {way}");
        let mut visited = alone.clone();
        visited.edit(&Edit::Add(far(RADIUS))).expect("there is room");
        visited.edit(&Edit::Remove(12)).expect("it is there");
        assert_eq!(visited.contacts().contacts().len(), contacts, "{way}");
        for run in [&mut alone, &mut visited] {
            take_steps(run, 30);
        }
        assert_eq!(bits(&visited, 0..12), bits(&alone, 0..12), "{way}");
    }
}

#[test]
fn the_grains_after_one_that_is_taken_out_keep_what_they_have() {
    for (way, scene) in in_every_way() {
        // Under `dem` the stiffness depends on the weight of all grains, so the two scenes differ.
        if scene.stepper == Stepper::Dem {
            continue;
        }
        // One scene has an additional first grain without contacts.
        let mut with = scene.clone();
        let Disc { position, radius } = far(RADIUS);
        with.grains.insert(0, Grain::at_rest(position, radius));
        let (mut with, mut without) = (start(&with), start(&scene));
        for run in [&mut with, &mut without] {
            take_steps(run, 10);
        }
        with.edit(&Edit::Remove(0)).expect("it is there");
        assert_eq!(bits(&with, 0..12), bits(&without, 0..12), "the situation: {way}");
        for run in [&mut with, &mut without] {
            take_steps(run, 50);
        }
        assert_eq!(bits(&with, 0..12), bits(&without, 0..12), "{way}");
    }
}

#[test]
fn what_finds_no_room_or_is_not_there_is_refused_and_changes_nothing() {
    let mut run = after(&heap(), 5);
    let before = bits(&run, 0..12);
    let disc = |x: f64, y: f64, radius: f64| Disc { position: RADIUS * DVec2::new(x, y), radius };
    let cases = [
        (
            Edit::Add(disc(0.0, 1.5, RADIUS)),
            "place of a new grain is on another one, but must be free",
        ),
        (
            Edit::Add(disc(3.0, 30.0, 40.0 * RADIUS)),
            "diameter of a new grain is 40, but must be from 0.2 to 5",
        ),
        (
            Edit::Add(disc(-0.9, 30.0, RADIUS)),
            "place of a new grain is on a wall, but must be free",
        ),
        (Edit::Add(disc(f64::NAN, 30.0, RADIUS)), "diameter of a new grain"),
        (Edit::Remove(12), "grain is 12, but must be below 12, the number of grains"),
        (Edit::Draw { boundary: 3, to: DVec2::ZERO }, "wall is drawn until time passes"),
    ];
    for (edit, expected) in cases {
        let said = run.edit(&edit).expect_err(expected).to_string();
        assert!(said.starts_with(expected), "{said}");
    }
    assert_eq!(bits(&run, 0..12), before);
    for _ in 0..11 {
        run.edit(&Edit::Remove(0)).expect("there are more");
    }
    let said = run.edit(&Edit::Remove(0)).expect_err("it is the last").to_string();
    assert!(said.contains("more than one"), "{said}");
}

#[test]
fn a_grain_that_is_added_in_motion_is_one_of_the_scene() {
    let mut listed = heap();
    let Disc { position, radius } = far(1.5 * RADIUS);
    let velocity = DVec2::new(0.3, -0.2);
    listed.grains.push(Grain { velocity, ..Grain::at_rest(position, radius) });
    let (mut added, mut listed) = (start(&heap()), start(&listed));
    added.add_grain(far(1.5 * RADIUS), velocity).expect("there is room");
    for run in [&mut added, &mut listed] {
        take_steps(run, 40);
    }
    assert_eq!(bits(&added, 0..13), bits(&listed, 0..13));
    let said = added.add_grain(far(RADIUS), DVec2::new(f64::NAN, 0.0)).expect_err("no number");
    assert!(said.to_string().starts_with("velocity of a new grain is [NaN, 0]"), "{said}");
    assert_eq!(added.world().grains.len(), 13);
}

/// Takes one step and checks the balances of momentum and energy. Returns two relative errors. The first is the largest
/// momentum change of a grain that weight, body forces and contacts do not explain, divided by the largest body force
/// times the time step Δt. The second is the change of kinetic energy that the work of all forces does not explain,
/// divided by the kinetic energy.
fn left_open(run: &mut Simulation) -> [f64; 2] {
    let before = run.world().grains.velocities.clone();
    let energy = run.observables().kinetic_energy;
    let forces = run.body_forces().to_vec();
    let now = *run.step().expect("a finite state");
    let grains = &run.world().grains;
    let body_force = |grain: usize| forces.get(grain).copied().unwrap_or_default();
    let mut open: Vec<DVec2> = (0..grains.len())
        .map(|grain| {
            let changed = grains.velocities[grain] - before[grain] - now.time_step_secs * GRAVITY;
            grains.masses[grain] * changed - now.time_step_secs * body_force(grain)
        })
        .collect();
    for contact in run.moment().contacts {
        let impulse = now.time_step_secs * contact.force;
        open[contact.grain as usize] -= impulse;
        if let OtherBody::Grain(other) = contact.other {
            open[other as usize] += impulse;
        }
    }
    let largest = forces.iter().fold(f64::MIN_POSITIVE, |most, force| most.max(force.length()));
    let open = open.iter().fold(0f64, |most, open| most.max(open.length()));
    let works = now.normal_work + now.tangential_work + now.gravity_work;
    [
        open / (largest * now.time_step_secs),
        (now.kinetic_energy - energy - works).abs() / now.kinetic_energy,
    ]
}

#[test]
fn body_forces_are_in_momentum_and_works_of_every_way_and_are_held() {
    for (way, scene) in in_every_way() {
        let mut run = after(&scene, 20);
        let weight = run.world().grains.masses[0] * GRAVITY.length();
        let forces: Vec<DVec2> =
            (0..12).map(|grain| 3.0 * weight * DVec2::from_angle(f64::from(grain))).collect();
        let mut without = run.clone();
        run.set_body_forces(&forces).expect("sound forces");
        for _ in 0..10 {
            let [momentum, energy] = left_open(&mut run);
            // The stepper `avbd` conserves neither momentum nor energy.
            let is_exact = momentum < 1e-9 && energy < 1e-9;
            assert!(is_exact || scene.stepper == Stepper::Avbd, "{way}: {momentum} {energy}");
        }
        take_steps(&mut without, 10);
        assert_ne!(bits(&run, 0..12), bits(&without, 0..12), "{way}");
        run.add_grain(far(RADIUS), DVec2::ZERO).expect("there is room");
        run.edit(&Edit::Remove(3)).expect("it is there");
        let held = run.body_forces();
        assert_eq!(held.len(), 12, "{way}");
        assert_eq!([held[3], held[11]], [forces[4], DVec2::ZERO], "{way}");
        run.set_body_forces(&[DVec2::ZERO; 12]).expect("none");
        assert!(run.body_forces().is_empty(), "{way}");
    }
}

#[test]
fn a_weight_that_is_held_up_is_none() {
    for (&stepper, part) in pairs(Stepper::ALL, [1.0, 0.5]) {
        let mut scene = heap();
        scene.stepper = stepper;
        scene.boundaries.clear();
        scene.grains.truncate(1);
        let Ok(mut run) = scene.simulation() else { continue };
        let force = -part * run.world().grains.masses[0] * GRAVITY;
        run.set_body_forces(&[force]).expect("a force");
        take_steps(&mut run, 50);
        let expected = (1.0 - part) * run.time_secs() * GRAVITY;
        assert!(run.velocity(0).distance(expected) < 1e-12, "{stepper}: {}", run.velocity(0));
    }
}

#[test]
fn body_forces_of_other_grains_or_none_are_refused() {
    let mut run = after(&heap(), 5);
    let none = [DVec2::ZERO; 12];
    let mut infinite = none;
    infinite[7].y = f64::INFINITY;
    for (forces, expected) in [
        (&none[1..], "body_forces is 11, but must be 12, one a grain"),
        (&infinite, "body_forces[7] is [0, inf], but must be finite"),
    ] {
        let said = run.set_body_forces(forces).expect_err(expected).to_string();
        assert_eq!(said, expected);
    }
    assert!(run.body_forces().is_empty());
}

#[test]
fn slump_counts_a_new_grain_from_where_it_is_put() {
    let mut run = after(&heap(), 60);
    let settled = run.observables().slump;
    run.edit(&Edit::Add(far(RADIUS))).expect("there is room");
    take_steps(&mut run, 1);
    // The new grain has fallen by less than a thousandth of the sum of all heights.
    let heights: f64 = run.places().iter().map(|at| at.y).sum();
    let slump = run.observables().slump;
    assert!(slump.abs() < settled.abs() + 1e-3 && heights > 0.15, "{settled} {slump} {heights}");
}

/// Returns a scene without gravity with a grain in front of a wall.
fn before_a_wall(stepper: Stepper, restitution: f64) -> Scene {
    let grain = Grain::at_rest(DVec2::new(4.0 * RADIUS, 0.0), RADIUS);
    let physics = Physics::FULL;
    let numbers = parameters(0.0, 1e-4, restitution, 0.0);
    let mut scene = scene(physics, DVec2::ZERO, numbers, vec![grain]);
    scene.stepper = stepper;
    let (from, to) = (RADIUS * DVec2::new(0.0, -4.0), RADIUS * DVec2::new(0.0, 4.0));
    scene.boundaries = vec![Boundary::Segment { from, to }];
    scene
}

/// Returns the speed at which a wall follows the user's mouse in a scene without gravity, m/s: half of √(g·d) with g =
/// 9.8 m/s² and the mean diameter d. Slump limits the speed to this value, which every stepper tolerates.
fn speed_of_hand() -> f64 {
    0.5 * (9.8 * 2.0 * RADIUS).sqrt()
}

#[test]
fn a_wall_that_is_drawn_hits_grains_with_its_speed_and_stays_where_it_was_drawn() {
    for (&stepper, restitution) in pairs(Stepper::ALL, [0.0, 0.8]) {
        let scene = before_a_wall(stepper, restitution);
        let Ok(mut run) = scene.simulation() else { continue };
        let place = |run: &Simulation| place_of(&run.world().boundaries[0]);
        let goal = place(&run) + DVec2::new(3.5 * RADIUS, 0.0);
        run.edit(&Edit::Draw { boundary: 0, to: goal }).expect("a wall");
        let way_secs = 3.5 * RADIUS / speed_of_hand();
        let steps = (1.2 * way_secs / 1e-4) as usize;
        let mut fastest_wall = 0f64;
        for _ in 0..steps {
            let before = place(&run);
            run.step().expect("a finite state");
            fastest_wall = fastest_wall.max(place(&run).distance(before) / 1e-4);
        }
        assert!((fastest_wall - speed_of_hand()).abs() < 1e-9, "{stepper:?}: {fastest_wall}");
        assert!(place(&run).distance(goal) < 1e-12, "{stepper:?}");
        // The grain is at rest and the wall is infinitely heavy, so the grain gets (1 + ρ) times the speed of the wall.
        let speed = run.velocity(0).x;
        let rebound = if stepper == Stepper::Avbd { 0.0 } else { restitution };
        let expected = (1.0 + rebound) * speed_of_hand();
        // Steppers with springs or many substeps are approximate.
        let tolerance = if stepper == Stepper::Moreau { 1e-9 } else { 0.06 };
        assert!(
            (speed / expected - 1.0).abs() < tolerance,
            "{stepper:?}, {restitution}: {speed} {expected}"
        );
        run.edit(&Edit::LetGo).expect("a hand");
        let there = place(&run);
        take_steps(&mut run, 50);
        assert_eq!(place(&run), there, "{stepper:?}: at rest once it is let go");
        assert!(run.world().motions.is_empty(), "{stepper:?}");
    }
}

#[test]
fn a_wall_that_is_let_go_on_the_way_stays_there() {
    let mut run = start(&before_a_wall(Stepper::Moreau, 0.0));
    run.edit(&Edit::Draw { boundary: 0, to: DVec2::new(0.0, 1.0) }).expect("a wall");
    take_steps(&mut run, 10);
    let on_the_way = place_of(&run.world().boundaries[0]);
    run.edit(&Edit::LetGo).expect("a hand");
    take_steps(&mut run, 10);
    assert_eq!(place_of(&run.world().boundaries[0]), on_the_way);
    assert!(on_the_way.y > -4.0 * RADIUS && on_the_way.y < 0.0, "{on_the_way}");
}

#[test]
fn what_the_scene_moves_no_hand_draws() {
    for name in ["moving-walls", "drum"] {
        let mut run = slump::scene::built_in(name).expect("a scene").simulation().expect("sound");
        let world = run.world();
        let by_itself = |shape: &Boundary| matches!(shape, Boundary::Piston { .. });
        let moved = world.motions.iter().flat_map(|motion| motion.boundaries.first().copied());
        let moved = moved.chain(world.boundaries.iter().position(by_itself)).next();
        let boundary = moved.expect("the situation: something moves") as u32;
        let said = run.edit(&Edit::Draw { boundary, to: DVec2::ZERO });
        let said = said.expect_err(name).to_string();
        assert!(said.ends_with("but must be one that nothing else moves"), "{name}: {said}");
    }
}

#[test]
fn a_run_goes_on_from_a_file_with_the_hand_on_its_wall() {
    for &stepper in Stepper::ALL {
        let mut scene = heap();
        scene.stepper = stepper;
        let mut run = after(&scene, 20);
        run.edit(&Edit::Add(far(0.8 * RADIUS))).expect("there is room");
        run.edit(&Edit::Draw { boundary: 2, to: DVec2::new(6.8 * RADIUS, 0.0) }).expect("a wall");
        take_steps(&mut run, 5);
        let bytes = rmp_serde::to_vec_named(&run).expect("a state");
        let mut read: Simulation = rmp_serde::from_slice(&bytes).expect("a state");
        for run in [&mut run, &mut read] {
            take_steps(run, 20);
            run.edit(&Edit::LetGo).expect("a hand");
            run.edit(&Edit::Remove(3)).expect("it is there");
            take_steps(run, 20);
        }
        assert_eq!(bits(&read, 0..12), bits(&run, 0..12), "{stepper:?}");
        assert_eq!(read.world().boundaries, run.world().boundaries);
        let gone = place_of(&run.world().boundaries[2]).x / RADIUS;
        assert!(gone < 8.0, "the situation: the wall has gone, {gone}");
    }
}
