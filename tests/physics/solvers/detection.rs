//! Compares the search for near pairs with a test of every pair, and parallel (coloured) sweeps on several threads with
//! sweeps on one thread.

use rand_pcg::Pcg64;

use crate::common::*;

/// Returns all touching pairs of bodies, found by testing every pair. Boundaries must be half-spaces.
fn every_pair(world: &World, gap_tolerance: f64) -> Vec<(u32, u32)> {
    let grains = &world.grains;
    let count = grains.len();
    let mut pairs = Vec::new();
    for i in 0..count {
        let (place, radius) = (grains.positions[i], grains.radii[i]);
        let mut add = |other: usize, gap: f64| {
            if gap < gap_tolerance {
                pairs.push((i as u32, other as u32));
            }
        };
        for j in i + 1..count {
            add(j, place.distance(grains.positions[j]) - (radius + grains.radii[j]));
        }
        for (k, disc) in world.fixed_discs.iter().enumerate() {
            add(count + k, place.distance(disc.position) - (radius + disc.radius));
        }
        for (k, boundary) in world.boundaries.iter().enumerate() {
            let Boundary::HalfSpace { point, normal } = boundary else { unreachable!() };
            let height = (place - *point).dot(normal.normalize());
            add(count + world.fixed_discs.len() + k, height - radius);
        }
    }
    pairs
}

fn found(contacts: &ContactList) -> Vec<(u32, u32)> {
    contacts.contacts().iter().map(|contact| (contact.grain, contact.other)).collect()
}

/// Checks the impulses after a search for contacts: contacts that existed before (`before`) must still have their
/// impulses, and new contacts zero impulses. Then gives each contact an impulse that identifies it.
fn check_impulses(contacts: &mut ContactList, before: &[(u32, u32)]) {
    for (pair, impulse) in found(contacts).into_iter().zip(contacts.impulses_mut()) {
        let own = Impulse { normal: 1.0 + f64::from(pair.0), tangential: f64::from(pair.1) };
        let lived_on = before.binary_search(&pair).is_ok();
        assert_eq!(*impulse, if lived_on { own } else { Impulse::default() }, "{pair:?}");
        *impulse = own;
    }
}

/// Returns a random radius, m. `kind` selects one of three distributions, in which the ratio of the largest to the
/// smallest radius is 1, 2 and 20.
fn radius(kind: usize, random: &mut Pcg64) -> f64 {
    match kind {
        0 => 0.5,
        1 => random.random_range(0.4..0.8),
        // Uniform in the logarithm of the radius.
        _ => 0.1 * 20f64.powf(random.random_range(0.0..1.0)),
    }
}

/// Returns a dense random set of grains in a square of 8 m whose lower left corner is `origin`, with a floor and with
/// small and large discs that are not grains. `kind` selects one of the distributions of the radii in [`radius`].
fn random_world(kind: usize, origin: DVec2, random: &mut Pcg64) -> World {
    let mut place = || origin + 8.0 * DVec2::new(random.random(), random.random());
    let places: Vec<DVec2> = (0..160).map(|_| place()).collect();
    let discs: Vec<DVec2> = (0..12).map(|_| place()).collect();
    let grains: Vec<Grain> =
        places.into_iter().map(|place| Grain::at_rest(place, radius(kind, random))).collect();
    let mut fixed_discs: Vec<Disc> =
        discs.into_iter().map(|place| fixed(place, radius(kind, random))).collect();
    // Two very large discs: one below all grains, and one whose centre is among the grains.
    fixed_discs.push(fixed(origin + DVec2::new(3.0, -100.0), 101.0));
    fixed_discs.insert(3, fixed(origin + DVec2::new(12.0, 4.0), 9.0));
    World {
        grains: Grains::new(&grains, 1.0),
        fixed_discs,
        motions: Vec::new(),
        gravity_turn: None,
        periodic: None,
        materials: Vec::new(),
        pairs: Vec::new(),
        boundaries: vec![Boundary::HalfSpace {
            point: origin + DVec2::new(0.5, 0.0),
            normal: DVec2::new(2.0, 0.1),
        }],
        gravity: Gravity::Uniform { acceleration: DVec2::ZERO },
        mean_diameter: 1.0,
    }
}

#[test]
fn no_contact_is_missed_or_invented_while_discs_move() {
    let mut random = random(3);
    for (origin, kind, (skin, gap_tolerance)) in triples(
        [DVec2::ZERO, DVec2::new(-4.0, -4.0), DVec2::new(3e5, -7e6)],
        0..3,
        [(0.2, 0.0), (0.05, 1e-3)],
    ) {
        let mut world = random_world(kind, origin, &mut random);
        let mut candidates =
            Candidates::new(&world, Reach { skin, gap_tolerance }).expect("proper shapes");
        let mut contacts = ContactList::default();
        let (mut builds, mut changes) = (0, 0);
        for step in 0..60 {
            // Displacements range from slow motion to jumps over several diameters.
            let largest = skin * 10f64.powf(random.random_range(-2.0..1.5));
            let only = (step % 3 == 0).then(|| random.random_range(0..160));
            for (k, position) in world.grains.positions.iter_mut().enumerate() {
                let mut along = || largest * random.random_range(-1.0..1.0);
                let way = DVec2::new(along(), along());
                if only.is_none_or(|only| only == k) {
                    *position += way;
                }
            }
            let before = found(&contacts);
            let built = candidates.update::<2>(&world);
            contacts.detect::<2>(&world, &candidates);
            let expected = every_pair(&world, gap_tolerance);
            assert_eq!(found(&contacts), expected, "kind {kind}, {origin}, step {step}");
            check_impulses(&mut contacts, &before);
            builds += u32::from(built);
            changes += u32::from(!built && before != expected);
        }
        assert!((5..60).contains(&builds), "built {builds} times");
        assert!(changes > 3, "contacts came and went on the same list {changes} times");
    }
}

#[test]
fn on_a_line_the_y_coordinate_counts_for_nothing() {
    let mut random = random(4);
    let mut world = random_world(1, DVec2::ZERO, &mut random);
    world.boundaries.clear();
    let mut flat = world.clone();
    let centres = flat.grains.positions.iter_mut();
    centres.chain(flat.fixed_discs.iter_mut().map(|disc| &mut disc.position)).for_each(|centre| {
        centre.y = 0.0;
    });
    let mut candidates =
        Candidates::new(&world, Reach { skin: 0.2, gap_tolerance: 0.0 }).expect("proper shapes");
    let mut contacts = ContactList::default();
    candidates.update::<1>(&world);
    contacts.detect::<1>(&world, &candidates);
    assert_eq!(found(&contacts), every_pair(&flat, 0.0));
    assert!(contacts.contacts().iter().all(|contact| contact.normal.y == 0.0));
}

#[test]
fn a_running_simulation_sees_every_contact_of_fast_grains() {
    let mut random = random(5);
    let grains = (0..120)
        .map(|k| {
            let place = 1.3 * DVec2::new(f64::from(k % 12), f64::from(k / 12) + 1.0);
            let mut speed = || random.random_range(-20.0..20.0);
            let velocity = DVec2::new(speed(), speed());
            moving(place, 0.3 + 0.3 * random.random::<f64>(), velocity)
        })
        .collect();
    let wall = |point: DVec2, normal: DVec2| Boundary::HalfSpace { point, normal };
    let mut scene = Scene {
        boundaries: vec![
            wall(DVec2::ZERO, DVec2::Y),
            wall(DVec2::new(-1.0, 0.0), DVec2::X),
            wall(DVec2::new(16.0, 0.0), -DVec2::X),
        ],
        ..under_g(parameters(2.0, 3e-3, 0.8, 0.3), grains)
    };
    scene.mean_diameter = 0.9;
    scene.solver.max_sweeps = 20;
    let tolerance = scene.parameters.touch_tolerance * scene.mean_diameter;
    let mut run = start(&scene);
    let mut contacts = 0;
    for step in 0..400 {
        let before = run.world().clone();
        run.step().expect("a finite state");
        let expected = every_pair(&before, tolerance);
        assert_eq!(found(run.contacts()), expected, "step {step}");
        contacts += expected.len();
    }
    assert!(contacts > 1000, "{contacts} contacts");
}

/// Takes three steps on this many threads. Returns the number of sweeps of each step, the final impulses, and the final
/// grains.
fn three_steps(scene: &Scene, threads: usize) -> ([u32; 3], Vec<Impulse>, Grains) {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    pool.expect("threads").install(|| {
        let mut run = start(scene);
        let sweeps = [(); 3].map(|()| run.step().expect("a finite state").sweeps);
        (sweeps, run.contacts().impulses().to_vec(), run.grains().clone())
    })
}

/// Checks that parallel sweeps on two threads give bitwise the same result as the method `nsgs` on one thread, if
/// `nsgs` visits the contacts in the order of the colours (groups of contacts that share no grain).
fn assert_a_sweep_like_any_other(mut scene: Scene) {
    (scene.solver.method, scene.solver.stop) = (Method::NsgsParallel, StopTest::Residual);
    let parallel = three_steps(&scene, 2);
    scene.solver.method = Method::Nsgs;
    assert!(three_steps(&scene, 1) != parallel, "another order");
    scene.solver.ordering = Ordering::Coloured;
    assert!(three_steps(&scene, 1) == parallel, "{:?}", scene.physics);
}

#[test]
fn colours_on_any_number_of_threads_give_bitwise_the_sweeps_of_one() {
    let mut scene = pressed_pile(40_000, 0.1, 5, parameters(20.0, 1e-3, 0.3, 0.5));
    scene.solver = SolverSettings {
        method: Method::NsgsParallel,
        stop: StopTest::RelativeChange,
        tolerance: 1e-3,
        max_sweeps: 60,
        ..SolverSettings::SWEEPS
    };
    let alone = three_steps(&scene, 1);
    assert!(alone.0[0] > 10 && alone.1.len() > 40_000, "{:?} sweeps", alone.0);
    for threads in [2, 4] {
        assert!(three_steps(&scene, threads) == alone, "{threads} threads");
    }
    scene.solver.tolerance = 1e-2;
    assert_a_sweep_like_any_other(scene);
}

#[test]
fn colours_give_bitwise_the_sweeps_of_one_in_every_model() {
    for physics in [SMOOTH, UNTURNING, Physics::FULL] {
        for (cone, stepper) in [
            (FrictionCone::Shifted, Stepper::Moreau),
            (FrictionCone::Compressive, Stepper::Moreau),
            (FrictionCone::Shifted, Stepper::Range),
        ] {
            let mut parameters = parameters(20.0, 1e-3, 0.3, 0.5);
            parameters.cone = cone;
            let mut scene = pressed_pile(300, 0.1, 7, parameters);
            (scene.physics, scene.stepper) = (physics, stepper);
            (scene.solver.tolerance, scene.solver.max_sweeps) = (1e-6, 200);
            assert_a_sweep_like_any_other(scene);
        }
    }
}
