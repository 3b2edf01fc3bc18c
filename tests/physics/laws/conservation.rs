//! Tests of conserved quantities: momentum, angular momentum (which changes only if the forces of a contact act at
//! different points on the two grains, because the grains overlap), and the energy balance.

use crate::common::*;

/// Returns a scene of 40 discs of unequal size that spin and fly towards the origin, without gravity.
fn cluster(physics: Physics, bond: f64, restitution: f64, friction: f64) -> Scene {
    let mut random = random(7);
    let grains = (0..40)
        .map(|index| {
            let radius = random.random_range(0.02..0.06);
            let (row, column) = (index / 8, index % 8);
            let place = 0.13 * DVec2::new(f64::from(column) - 3.5, f64::from(row) - 2.0);
            let drift = DVec2::new(0.2, -0.1);
            Grain {
                feels_gravity: false,
                angular_velocity: random.random_range(-20.0..20.0),
                ..moving(place, radius, drift - 2.0 * place)
            }
        })
        .collect();
    let parameters = parameters(bond, 1e-3, restitution, friction);
    Scene {
        solver: SolverSettings { max_sweeps: 500, ..to_residual(1e-8) },
        mean_diameter: 0.08,
        ..scene(physics, -G * DVec2::Y, parameters, grains)
    }
}

/// Returns the angular momentum of all grains about the origin, including spins, and the sum of the magnitudes of its
/// terms, both in kg·m²/s.
fn angular_momentum(run: &Simulation) -> (f64, f64) {
    let grains = run.grains();
    let orbits = (0..grains.len())
        .map(|k| grains.masses[k] * grains.positions[k].perp_dot(grains.velocities[k]));
    let spins = (0..grains.len()).map(|k| grains.inertia(k) * grains.angular_velocities[k]);
    orbits.chain(spins).fold((0.0, 0.0), |(sum, size), term| (sum + term, size + term.abs()))
}

#[test]
fn a_free_cluster_keeps_its_momentum() {
    for (physics, (bond, restitution, friction)) in pairs(
        [SMOOTH, UNTURNING, Physics::FULL],
        [(0.0, 1.0, 0.0), (0.0, 0.3, 0.5), (30.0, 0.3, 0.5)],
    ) {
        let mut run = start(&cluster(physics, bond, restitution, friction));
        let before = momentum(&run);
        let mut contacts = 0;
        for _ in 0..400 {
            run.step().expect("a finite state");
            contacts += run.observables().contacts;
        }
        assert!(contacts > 100, "they met: {contacts}");
        let off = momentum(&run).distance(before);
        assert!(off < 1e-13 * before.length(), "{physics:?}: off by {off:e}");
    }
}

#[test]
fn the_overlap_alone_changes_the_angular_momentum() {
    // The impulses of a contact act at the distance r_i from one centre and r_j from the other, but the centres are r_i
    // + r_j + gap apart. So the tangential impulse P_t exerts the moment gap·P_t on the pair. Nothing else changes the
    // angular momentum: a rolling moment acts on both discs with opposite signs.
    let mut scene = cluster(Physics::FULL, 30.0, 0.3, 0.5);
    let (explained, scale) = check_angular_momentum(&scene);
    // With steps of 1e-3 s the overlaps change the angular momentum of this cluster by 0.1 % in total.
    assert!(explained.abs() < 2e-3 * scale, "{explained:e} of {scale:e}");
    scene.parameters.rolling_friction = 0.3;
    check_angular_momentum(&scene);
}

/// Runs 400 steps and checks in each step that the change of the angular momentum is the sum, over all contacts, of gap
/// (negative for an overlap) times tangential impulse. Returns the sum of these changes and the sum of the magnitudes
/// of the initial terms of the angular momentum, both in kg·m²/s.
fn check_angular_momentum(scene: &Scene) -> (f64, f64) {
    let mut run = start(scene);
    let (mut explained, mut largest) = (0.0, 0f64);
    let (_, scale) = angular_momentum(&run);
    for _ in 0..400 {
        let (before, _) = angular_momentum(&run);
        run.step().expect("a finite state");
        let list = run.contacts();
        let couple: f64 = list
            .contacts()
            .iter()
            .zip(list.impulses())
            .map(|(contact, impulse)| contact.gap * impulse.tangential)
            .sum();
        let change = angular_momentum(&run).0 - before;
        assert!((change - couple).abs() < 1e-14 * scale, "{change:e} for {couple:e}");
        explained += couple;
        largest = largest.max(couple.abs());
    }
    assert!(largest > 1e-9 * scale, "there was friction");
    (explained, scale)
}

/// Takes `count` steps and checks the energy balance of each step: the change of kinetic energy is the work of gravity
/// plus the work of the contacts.
fn check_budget(run: &mut Simulation, count: usize) {
    let mut contacts = 0;
    for _ in 0..count {
        let start = run.grains().clone();
        let (after, off, scale) = balance(run);
        contacts += after.contacts;
        assert!(off <= 1e-11 * scale, "step {}: off by {off:e}", after.step);
        // The work of gravity, computed independently: gravity's impulse times the mean of the velocities before and
        // after the step.
        let world = run.world();
        let by_gravity: f64 = (0..world.grains.len())
            .filter(|&k| world.grains.feels_gravity[k])
            .map(|k| {
                let force = world.grains.masses[k] * world.gravity.acceleration(start.positions[k]);
                let velocities = start.velocities[k] + world.grains.velocities[k];
                0.5 * after.time_step_secs * force.dot(velocities)
            })
            .sum();
        let off = (after.gravity_work - by_gravity).abs();
        assert!(off <= 1e-11 * scale, "{} for {by_gravity}", after.gravity_work);
    }
    assert!(contacts > 0, "there were contacts");
}

#[test]
fn every_step_of_a_cohesive_pile_closes_its_energy_budget() {
    let kinds = [(0.0, 0.5), (20.0, 0.5), (100.0, 0.3), (20.0, 0.0)];
    for ((bond, friction), touch_tolerance) in pairs(kinds, [0.0, 1e-5, 1e-2]) {
        let mut scene = paper_pile().expect("the shipped state");
        scene.parameters = Parameters { touch_tolerance, ..parameters(bond, 2e-3, 0.1, friction) };
        // The energy balance must be exact even if steps are badly solved.
        scene.solver.max_sweeps = 50;
        check_budget(&mut start(&scene), 100);
    }
    let mut free = start(&cluster(UNTURNING, 30.0, 0.3, 0.5));
    check_budget(&mut free, 300);
    let mut cradle = start(&cradle());
    check_budget(&mut cradle, 5000);
}

#[test]
fn contacts_with_one_restitution_lose_what_moreaus_theorem_says() {
    // P are the impulses, W is the Delassus operator, m are the masses, and u are the contact velocities. Without
    // friction, cohesion and gravity, u^n − u^{n−1} = W P and P ⟂ v̄ give the work ½P·(u^n + u^{n−1}) = P·v̄ − ½
    // (1−ρ)/(1+ρ) P·WP, and P·WP = Σ m |v^n − v^{n−1}|². So the kinetic energy never grows, falls by exactly that
    // amount, and is constant for ρ = 1.
    for restitution in [0.0, 0.3, 0.7, 1.0] {
        let mut scene = cluster(SMOOTH, 0.0, restitution, 0.0);
        scene.solver = tight();
        // The impulse that closes an open gap within the touch tolerance is not a shock.
        scene.parameters.touch_tolerance = 0.0;
        let mut run = start(&scene);
        let (mut shocks, mut most_contacts) = (0, 0);
        for _ in 0..500 {
            let before = run.observables().kinetic_energy;
            let velocities = run.grains().velocities.clone();
            let after = *run.step().expect("a finite state");
            assert!(after.converged, "residual {:e}", after.residual);
            let grains = run.grains();
            let shock: f64 = (0..grains.len())
                .map(|k| grains.masses[k] * grains.velocities[k].distance_squared(velocities[k]))
                .sum();
            let expected = -0.5 * (1.0 - restitution) / (1.0 + restitution) * shock;
            let change = after.kinetic_energy - before;
            assert!((change - expected).abs() < 1e-11 * before, "{change:e} for {expected:e}");
            assert_eq!(after.tangential_work, 0.0);
            assert!(after.normal_work <= 1e-11 * before, "contacts do no positive work");
            shocks += u32::from(shock > 1e-3 * before);
            most_contacts = most_contacts.max(after.compressive_contacts);
        }
        assert!(shocks > 5 && most_contacts > 3, "{shocks} shocks, {most_contacts} at once");
    }
}
