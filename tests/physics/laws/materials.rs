//! Tests of pairs of materials with their own friction, restitution and cohesion, and of grains of different density.

use crate::common::*;

const RADIUS: f64 = 0.1;
const DT: f64 = 1e-3;
/// Overlap of touching grains, in radii.
const TOUCH: f64 = 1e-10;

fn material(name: &str) -> Material {
    Material { name: name.into(), ..Material::default() }
}

fn between(one: &str, other: &str) -> MaterialPair {
    MaterialPair { between: [one.into(), other.into()], ..MaterialPair::default() }
}

fn made_of(name: &str, grain: Grain) -> Grain {
    Grain { material: Some(name.into()), ..grain }
}

/// Returns solver settings with every method that supports different laws for pairs of materials.
fn every_solver() -> impl Iterator<Item = SolverSettings> {
    METHODS.iter().filter(|info| info.takes_pairs).map(|info| solved_by(info.method, 1e-12))
}

#[test]
fn each_disc_holds_on_a_slope_up_to_the_friction_of_its_own_pair() {
    const FRICTIONS: [(&str, f64); 2] = [("rough", 0.5), ("smooth", 0.2)];
    let run = |solver: SolverSettings, slope: f64, cone: FrictionCone| {
        let grains = [0.0, 3.0].map(|x| DVec2::new(x, RADIUS * (1.0 - TOUCH)));
        let grains = grains.into_iter().zip(FRICTIONS);
        let grains =
            grains.map(|(place, (name, _))| made_of(name, Grain::at_rest(place, RADIUS))).collect();
        let gravity = G * DVec2::new(slope, -1.0).normalize();
        let parameters = Parameters { cone, ..parameters(0.0, DT, 0.0, 0.3) };
        let mut scene = Scene {
            boundaries: vec![level()],
            solver,
            ..scene(UNTURNING, gravity, parameters, grains)
        };
        scene.materials = ["ground", "rough", "smooth"].map(material).to_vec();
        let pair =
            |(name, friction)| MaterialPair { friction: Some(friction), ..between(name, "ground") };
        scene.pairs = FRICTIONS.map(pair).to_vec();
        // These two materials never touch. Without cohesion the two friction cones are the same law. The cohesion of
        // these materials makes them different: friction is bounded by the normal force plus the cohesion force, or by
        // the pushing part of the normal force only.
        scene.pairs.push(MaterialPair { cohesion_force: Some(1.0), ..between("rough", "smooth") });
        let run = after(&scene, 100);
        let contacts = run.moment().contacts;
        [0, 1].map(|grain| (run.velocity(grain).x, contacts[grain].status))
    };
    for solver in every_solver() {
        for cone in [FrictionCone::Shifted, FrictionCone::Compressive] {
            for (disc, (name, friction)) in FRICTIONS.into_iter().enumerate() {
                let (held, status) = run(solver, friction * (1.0 - 1e-4), cone)[disc];
                assert!(held.abs() < 1e-10, "{}, {name}: {held} m/s", solver.method);
                assert_eq!(status, ContactStatus::Stick, "{}, {name}", solver.method);
                let slope: f64 = 1.5 * friction;
                let expected = G / slope.hypot(1.0) * (slope - friction) * 100.0 * DT;
                let (found, status) = run(solver, slope, cone)[disc];
                assert_eq!(status, ContactStatus::Slip, "{}, {name}", solver.method);
                assert_close(found, expected, 1e-8, &format!("{}, {name}", solver.method));
            }
        }
    }
}

#[test]
fn each_pair_bounces_by_its_own_restitution() {
    const SPEED: f64 = 1.0;
    // Three impacts: a grain on a grain, a grain on a wall, and a piston on a grain.
    let pair_at = |x: f64, other: &str| {
        let gap = 2.0 * RADIUS * (1.0 - TOUCH);
        let struck = made_of(other, Grain::at_rest(DVec2::new(x + gap, 0.0), RADIUS));
        [made_of("a", moving(DVec2::new(x, 0.0), RADIUS, SPEED * DVec2::X)), struck]
    };
    let on_wall = |x: f64, side: f64| {
        let place = DVec2::new(x + side * RADIUS * (1.0 - TOUCH), 0.0);
        made_of("a", moving(place, RADIUS, -side * SPEED * DVec2::X))
    };
    let grains =
        [pair_at(0.0, "a"), pair_at(10.0, "b"), [on_wall(-10.0, 1.0), on_wall(30.0, -1.0)]];
    for solver in every_solver() {
        let parameters = parameters(0.0, DT, 0.9, 0.0);
        let mut scene = scene(LINE, DVec2::ZERO, parameters, grains.concat());
        scene.solver = solver;
        scene.boundaries = vec![
            plane(-10.0 * DVec2::X, DVec2::X),
            piston(30.0 * DVec2::X, DVec2::NEG_X, 0.5, 1.0),
        ];
        scene.materials = vec![
            material("a"),
            material("b"),
            Material { boundaries: vec![0, 1], ..material("wall") },
        ];
        let pair = |other, restitution| MaterialPair { restitution, ..between(other, "a") };
        scene.pairs = vec![pair("b", Some(0.4)), pair("wall", Some(0.7)), pair("a", None)];
        let run = after(&scene, 1);
        let speed = |grain: usize| run.velocity(grain).x;
        let name = solver.method.name();
        assert_close(speed(1) - speed(0), 0.9 * SPEED, 1e-10, name);
        assert_close(speed(3) - speed(2), 0.4 * SPEED, 1e-10, name);
        assert_close(speed(4), 0.7 * SPEED, 1e-10, name);
        assert_close(speed(5), -0.5 - 0.7 * (SPEED + 0.5), 1e-10, name);
    }
}

#[test]
fn a_pair_is_pulled_off_by_its_cohesion_force_whatever_its_masses_and_without_gravity() {
    const FORCE: f64 = 2.0;
    // Contacts with different effective masses: a small grain on a large grain, on a wall and on a fixed disc, and a
    // heavy grain on a wall.
    let large = 2.0 * RADIUS;
    let above = |x: f64, height: f64| Grain::at_rest(DVec2::new(x, height * (1.0 - TOUCH)), RADIUS);
    let heavy = Grain { mass: Some(3.0), ..above(4.0, RADIUS) };
    let grains =
        [above(0.0, RADIUS + large), above(2.0, RADIUS), above(6.0, RADIUS + large), heavy];
    let carrier = Grain::at_rest(DVec2::ZERO, large);
    let pulled = |gravity: DVec2, force: f64, solver: SolverSettings| {
        let mut all = grains.to_vec();
        all.push(carrier.clone());
        let all = all.into_iter().map(weightless).collect();
        let mut scene = scene(UNTURNING, gravity, parameters(7.0, DT, 0.0, 0.5), all);
        scene.solver = solver;
        scene.boundaries = vec![Boundary::Segment { from: DVec2::X, to: 5.0 * DVec2::X }];
        scene.fixed_discs = vec![fixed(6.0 * DVec2::X, large)];
        scene.materials = vec![material("one")];
        scene.pairs = vec![MaterialPair { cohesion_force: Some(FORCE), ..between("one", "one") }];
        let mut run = start(&scene);
        let mut forces = vec![force * DVec2::Y; 4];
        forces.push(-force * DVec2::Y);
        run.set_body_forces(&forces).expect("one a grain");
        run
    };
    let masses = [RADIUS, large].map(|radius| std::f64::consts::PI * radius * radius);
    let pair_mass = masses[0] * masses[1] / (masses[0] + masses[1]);
    let effective_masses = [pair_mass, masses[0], masses[0], 3.0];
    for solver in every_solver() {
        for gravity in [DVec2::ZERO, -G * DVec2::Y] {
            let name = format!("{}, {gravity}", solver.method);
            let opening = |run: &Simulation, grain: usize| {
                let below = if grain == 0 { run.velocity(4).y } else { 0.0 };
                run.velocity(grain).y - below
            };
            let mut held = pulled(gravity, FORCE * (1.0 - 1e-6), solver);
            take_steps(&mut held, 50);
            for contact in &held.moment().contacts {
                assert_close(contact.normal_force, -FORCE * (1.0 - 1e-6), 1e-9, &name);
                assert_eq!(contact.status, ContactStatus::Stick, "{name}");
            }
            assert_eq!(held.moment().contacts.len(), 4, "{name}");
            let mut parted = pulled(gravity, 1.5 * FORCE, solver);
            take_steps(&mut parted, 1);
            for (grain, mass) in effective_masses.into_iter().enumerate() {
                assert!(opening(&held, grain).abs() < 1e-9, "{name}, {grain}");
                assert_close(opening(&parted, grain), 0.5 * FORCE * DT / mass, 1e-9, &name);
            }
        }
    }
}

#[test]
fn a_light_and_a_heavy_grain_collide_with_the_masses_of_their_materials() {
    const SPEEDS: [f64; 2] = [0.3, -1.1];
    let gap = 2.0 * RADIUS * (1.0 - TOUCH);
    let light = moving(DVec2::ZERO, RADIUS, SPEEDS[0] * DVec2::X);
    let heavy = made_of("steel", moving(gap * DVec2::X, RADIUS, SPEEDS[1] * DVec2::X));
    let weighed = Grain { mass: Some(2.5), ..light.clone() };
    for (light, mass) in [(light, 3.0 * std::f64::consts::PI * RADIUS * RADIUS), (weighed, 2.5)] {
        let grains = vec![light, heavy.clone()];
        let mut scene = scene(LINE, DVec2::ZERO, parameters(0.0, DT, 0.6, 0.0), grains);
        scene.areal_density = 3.0;
        let steel = Material { areal_density: Some(50.0), ..material("steel") };
        scene.materials = vec![material("cork"), steel];
        let run = after(&scene, 1);
        let masses = [mass, 50.0 * std::f64::consts::PI * RADIUS * RADIUS];
        assert_eq!(run.grains().masses, masses);
        let momentum = |speeds: [f64; 2]| masses[0] * speeds[0] + masses[1] * speeds[1];
        let speeds = [0, 1].map(|grain| run.velocity(grain).x);
        assert_close(momentum(speeds), momentum(SPEEDS), 1e-14, "momentum");
        assert_close(speeds[1] - speeds[0], 0.6 * (SPEEDS[0] - SPEEDS[1]), 1e-14, "restitution");
    }
}

/// Returns a scene of a cohesive pile over a rough base. Every third grain and the base have the material "other", all
/// other grains the material "one".
fn mixed_pile(parameters: Parameters) -> Scene {
    let mut pile = pressed_pile(30, 0.3, 5, parameters);
    pile.duration_secs = 0.1;
    pile.grains.iter_mut().step_by(3).for_each(|grain| grain.material = Some("other".into()));
    let fixed_discs = (0..pile.fixed_discs.len()).collect();
    pile.materials = vec![material("one"), Material { fixed_discs, ..material("other") }];
    pile
}

#[test]
fn pairs_with_the_numbers_of_the_scene_change_no_bit() {
    let same = |scene: &Scene, one, other| {
        let Parameters { bond, restitution, friction, .. } = scene.parameters;
        let (friction, restitution, bond) = (Some(friction), Some(restitution), Some(bond));
        MaterialPair { friction, restitution, bond, ..between(one, other) }
    };
    for (method, model) in pairs(
        METHODS.iter().filter(|info| info.takes_pairs).map(|info| info.method),
        [FrictionModel::Coulomb, FrictionModel::Tresca],
    ) {
        if model == FrictionModel::Tresca && !method.info().takes_models {
            continue;
        }
        for (cone, tolerance) in
            pairs([FrictionCone::Shifted, FrictionCone::Compressive], [0.0, 1e-3])
        {
            let numbers =
                Parameters { cone, touch_tolerance: tolerance, ..parameters(20.0, DT, 0.1, 0.5) };
            let mut scene = mixed_pile(numbers);
            scene.solver =
                SolverSettings { method, friction_model: model, ..SolverSettings::default() };
            let followed = |scene: &Scene| {
                let run = after(scene, 30);
                let statuses: Vec<_> = run.moment().contacts.iter().map(|it| it.status).collect();
                (bits(&run), format!("{:?}", run.observables()), statuses)
            };
            let plain = followed(&Scene { materials: Vec::new(), ..bare(&scene) });
            let name = format!("{method}, {model}, {cone}, {tolerance}");
            assert_eq!(followed(&scene), plain, "{name}: materials alone");
            scene.pairs = vec![same(&scene, "one", "one"), same(&scene, "other", "one")];
            assert_eq!(followed(&scene), plain, "{name}: pairs");
            scene.pairs.swap_remove(0).bond = Some(0.0);
            scene.pairs[0].friction = Some(0.1);
            assert_ne!(followed(&scene).0, plain.0, "{name}: another friction");
        }
    }
}

/// Returns a copy of the scene in which no grain names a material.
fn bare(scene: &Scene) -> Scene {
    let mut scene = scene.clone();
    scene.grains.iter_mut().for_each(|grain| grain.material = None);
    scene
}

#[test]
fn every_row_of_a_mixed_pile_is_within_the_bounds_of_its_own_pair() {
    const FORCE: f64 = 2e-3;

    /// Gets the contact problem of a step from [`Simulation::next_problem`] and returns, for each pair of materials,
    /// the largest ratio of the tangential impulse to its friction bound and the smallest ratio of the normal impulse
    /// to the cohesion impulse. Also returns true if two solvers solve the problem: Gauss–Seidel, and Newton's method
    /// with at most 100 Gauss–Seidel sweeps. (Newton's method makes such sweeps before and after each factorisation of
    /// a matrix.)
    struct Extremes<'a>(&'a World);

    impl ProblemVisitor for Extremes<'_> {
        type Output = ([[f64; 2]; 3], bool);

        fn visit<M: Model>(self, problem: &mut StepProblem<M>, list: &ContactList) -> Self::Output {
            let by_newton =
                SolverSettings { max_sweeps: 1_000, ..solved_by(Method::Newton, 1e-10) };
            let newton = solve(&mut problem.clone(), &mut Memory::default(), &by_newton);
            let report = solve(problem, &mut Memory::default(), &to_residual(1e-10));
            let error = velocity_error(problem).told;
            assert!(!report.converged || error < 1e-5, "{error} m/s");
            let mut extremes = [[0.0, f64::INFINITY]; 3];
            for (number, row) in problem.rows() {
                let contact = &list.contacts()[problem.rows.contacts[number] as usize];
                let other = match Numbering::of(self.0).other(contact.other) {
                    Other::Grain(grain) => self.0.grains.material(grain),
                    _ => 1,
                };
                let pair = usize::from(self.0.grains.material(contact.grain as usize) + other);
                let [normal, tangential] =
                    problem.reduced_impulse(number, row).map(|it| it * row.effective_mass / DT);
                let pull = [FORCE, 20.0 * G * row.effective_mass, 0.0][pair];
                let extreme = &mut extremes[pair];
                let bound = [0.1, 0.5, 0.8][pair] * (normal + pull);
                extreme[0] = f64::max(extreme[0], tangential.abs() / bound.max(1e-12));
                extreme[1] = extreme[1].min(normal / if pull > 0.0 { pull } else { 1.0 });
            }
            (extremes, report.converged && newton.converged && newton.sweeps <= 100)
        }
    }

    let mut scene = mixed_pile(parameters(20.0, DT, 0.1, 0.5));
    scene.pairs = vec![
        MaterialPair { friction: Some(0.1), cohesion_force: Some(FORCE), ..between("one", "one") },
        MaterialPair { friction: Some(0.8), bond: Some(0.0), ..between("other", "other") },
    ];
    let mut run = start(&scene);
    let (mut all, mut quick) = ([[0.0, f64::INFINITY]; 3], 0);
    for _ in 0..40 {
        run.step().expect("a finite state");
        let (now, is_quick) = run.next_problem(Extremes(run.world()));
        quick += u32::from(is_quick);
        for (all, now) in all.iter_mut().zip(now) {
            *all = [all[0].max(now[0]), all[1].min(now[1])];
        }
    }
    // If Newton's method used the friction slopes of other pairs, it would need hundreds of sweeps.
    assert!(quick > 20, "{quick} of 40 problems");
    for (pair, [rubbing, pull]) in all.into_iter().enumerate() {
        assert!((0.999..1.0 + 1e-9).contains(&rubbing), "pair {pair}: {rubbing} of the bound");
        let least = if pair == 2 { 0.0 } else { -1.0 };
        assert!(pull >= least - 1e-9, "pair {pair}: pulls {pull}");
        // In this pile no bond of the middle pair ("one" and "other") pulls with its full cohesion force.
        assert!(pull <= least + 1e-3 || pair == 1, "pair {pair}: pulls {pull}");
    }
}

#[test]
fn settings_that_pairs_of_materials_do_not_support_are_refused() {
    let sound = {
        let mut scene = mixed_pile(parameters(20.0, DT, 0.1, 0.5));
        scene.pairs = vec![MaterialPair { friction: Some(0.2), ..between("one", "other") }];
        scene
    };
    sound.validate().expect("a proper scene");
    let check = |spoil: &dyn Fn(&mut Scene), expected: &str| {
        let mut scene = sound.clone();
        spoil(&mut scene);
        let said = scene.validate().expect_err(expected).to_string();
        let (field, allowed) = expected.split_once('…').unwrap_or((expected, ""));
        assert!(said.starts_with(field) && said.ends_with(allowed), "{said}");
    };
    check(&|s| s.grains[4].material = Some("ice".into()), "grains[4].material is ice…one or other");
    check(&|s| s.grains[4].mass = Some(-1.0), "grains[4].mass is -1");
    check(&|s| s.materials[1].name = "one".into(), "grains[0].material is other");
    check(&|s| s.materials.push(material("one")), "materials[2].name is one");
    check(&|s| s.materials.push(material("")), "materials[2].name is");
    check(&|s| s.materials[0].areal_density = Some(0.0), "materials[0].areal_density is 0");
    check(&|s| s.materials[0].fixed_discs = vec![0], "materials[1].fixed_discs is 0");
    check(&|s| s.materials[0].boundaries = vec![0], "materials[0].boundaries is 0");
    check(&|s| s.pairs[0].between[1] = "ice".into(), "pairs[0].between is ice");
    check(&|s| s.pairs.push(between("other", "one")), "pairs[1].between is other and one");
    for value in [-1.0, f64::NAN, f64::INFINITY] {
        check(&|s| s.pairs[0].friction = Some(value), "pairs[0].friction is");
        check(&|s| s.pairs[0].restitution = Some(value), "pairs[0].restitution is");
        check(&|s| s.pairs[0].bond = Some(value), "pairs[0].bond is");
        check(&|s| s.pairs[0].cohesion_force = Some(value), "pairs[0].cohesion_force is");
    }
    let both =
        |s: &mut Scene| (s.pairs[0].bond, s.pairs[0].cohesion_force) = (Some(1.0), Some(1.0));
    check(&|s| both(s), "pairs[0].cohesion_force is 1…where the pair has a bond");
    check(&|s| s.physics = SMOOTH, "pairs[0].friction is 0.2");
    let cohesive = |s: &mut Scene| {
        s.physics.cohesion = false;
        s.pairs[0].cohesion_force = Some(1.0);
    };
    check(&cohesive, "pairs[0].cohesion_force is 1");
    for stepper in Stepper::ALL.iter().filter(|&&stepper| stepper != Stepper::Moreau) {
        check(
            &|s| s.stepper = *stepper,
            "stepper is…must be moreau where the scene has pairs of materials",
        );
    }
    check(&|s| s.solver.method = Method::NsgsParallel, "solver is nsgs-parallel");
    check(&|s| s.solver.friction_model = FrictionModel::Desaxce, "friction-model is desaxce");
    check(&|s| s.remedies.sequential_impacts = true, "sequential-impacts is given");
    let listed = |s: &mut Scene| (s.materials, s.pairs) = (Vec::new(), Vec::new());
    check(&|s| listed(s), "grains[0].material is other");
}
