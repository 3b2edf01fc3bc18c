//! Tests of rolling resistance against exact motion. About the contact point, a solid disc of mass m and radius r has
//! the moment of inertia (3/2) m r². If the disc rolls without slip down a slope of angle θ, gravity (acceleration g)
//! exerts the moment r m g sinθ and rolling friction, with the coefficient μ_r, resists with the moment M = μ_r r m g
//! cosθ. So its acceleration is a = ⅔ g (sinθ − μ_r cosθ).

use proptest::prelude::*;

use crate::common::*;

const RADIUS: f64 = 0.1;
const ROLLING: f64 = 0.2;
const DT: f64 = 1e-3;
const METHODS_THAT_ROLL: [Method; 4] = [Method::Nsgs, Method::Nncg, Method::Newton, Method::Auto];

fn rolling(rolling_friction: f64, friction: f64) -> Parameters {
    Parameters { rolling_friction, ..parameters(0.0, DT, 0.0, friction) }
}

/// Returns a scene with a disc on the level y = 0 under gravity inclined by θ (`slope` = tanθ). With the friction
/// coefficient of 5, the disc does not slip.
fn on_slope(method: Method, slope: f64, cone: FrictionCone, bond: f64) -> Scene {
    let grain = Grain::at_rest(DVec2::new(0.0, RADIUS * (1.0 - 1e-10)), RADIUS);
    let gravity = G * DVec2::new(slope, -1.0).normalize();
    let numbers = Parameters { cone, bond, ..rolling(ROLLING, 5.0) };
    let solver = SolverSettings { max_sweeps: 20_000, ..solved_by(method, 1e-13) };
    Scene {
        boundaries: vec![level()],
        solver,
        ..scene(Physics::FULL, gravity, numbers, vec![grain])
    }
}

#[test]
fn a_disc_on_a_slope_stays_up_to_its_rolling_friction_and_rolls_above() {
    for method in METHODS_THAT_ROLL {
        let at = |slope: f64| after(&on_slope(method, slope, FrictionCone::Shifted, 0.0), 500);
        for slope in [0.05, ROLLING * (1.0 - 1e-6)] {
            let run = at(slope);
            assert_eq!(run.observables().contacts, 1, "{method}");
            let [velocity, spin] = [run.velocity(0).length(), run.grains().angular_velocities[0]];
            assert!(velocity < 1e-12 && spin.abs() < 1e-11, "{method}: {velocity:e}, {spin:e}");
            // The rolling moment balances the weight: M = m g sinθ r.
            let carried = run.grains().masses[0] * G * slope / slope.hypot(1.0) * RADIUS * DT;
            assert_close(run.contacts().rolling(0).abs(), carried, 1e-9, "the moment");
        }
        for slope in [ROLLING * (1.0 + 1e-4), 0.5, 2.0] {
            let run = at(slope);
            let expected = 2.0 / 3.0 * G * (slope - ROLLING) / slope.hypot(1.0) * 500.0 * DT;
            assert_close(run.velocity(0).x, expected, 1e-7, &format!("{method}, tanθ {slope}"));
            let rim = -RADIUS * run.grains().angular_velocities[0];
            assert_close(rim, expected, 1e-7, "no slip");
        }
    }
}

#[test]
fn each_disc_resists_rolling_by_the_number_of_its_own_pair() {
    const FRICTIONS: [(&str, f64); 2] = [("holds", 0.3), ("rolls", 0.1)];
    let slope: f64 = 0.2;
    for method in METHODS_THAT_ROLL {
        let mut scene = on_slope(method, slope, FrictionCone::Shifted, 0.0);
        scene.parameters.rolling_friction = 0.0;
        let material = |name: &str| Material { name: name.into(), ..Material::default() };
        scene.materials = ["ground", "holds", "rolls"].map(material).to_vec();
        scene.pairs = FRICTIONS
            .map(|(name, rolling)| MaterialPair {
                between: [name.into(), "ground".into()],
                rolling_friction: Some(rolling),
                ..MaterialPair::default()
            })
            .to_vec();
        let disc = scene.grains.remove(0);
        let made_of = |name: &str, x: f64| Grain {
            material: Some(name.into()),
            position: disc.position + x * DVec2::X,
            ..disc.clone()
        };
        scene.grains = vec![made_of("holds", 0.0), made_of("rolls", 1.0)];
        let run = after(&scene, 500);
        let expected = 2.0 / 3.0 * G * (slope - 0.1) / slope.hypot(1.0) * 500.0 * DT;
        assert!(run.velocity(0).length() < 1e-12, "{method}: {}", run.velocity(0));
        assert_close(run.velocity(1).x, expected, 1e-7, &format!("{method}"));
    }
}

#[test]
fn cohesion_steepens_the_slope_with_the_shifted_cone_alone() {
    // The disc stays at rest if sinθ ≤ μ_r (cosθ + Bond), because its cohesion to a boundary is C₀ = Bond·m·g.
    let bond = 2.0;
    let speed = |slope: f64, cone| {
        after(&on_slope(Method::Auto, slope, cone, bond), 200).velocity(0).x / (G * DT * 200.0)
    };
    let phi = ROLLING.atan();
    let steepest = (phi + (ROLLING * bond * phi.cos()).asin()).tan();
    assert!(steepest > 2.0 * ROLLING);
    assert!(speed(steepest * (1.0 - 1e-6), FrictionCone::Shifted).abs() < 1e-12);
    assert!(speed(steepest * (1.0 + 1e-4), FrictionCone::Shifted) > 1e-6);
    assert!(speed(ROLLING * (1.0 - 1e-6), FrictionCone::Compressive).abs() < 1e-12);
    assert!(speed(ROLLING * (1.0 + 1e-4), FrictionCone::Compressive) > 1e-6);
}

#[test]
fn a_rolling_disc_stops_after_the_exact_distance() {
    // The speed v falls by aΔt per step, with a = ⅔ μ_r g, until it is 0. The scheme moves the disc by Δt times the
    // speed at the end of each step, so the stopping distance is v²/2a − vΔt/2, except for at most aΔt²/8 in the last
    // step.
    let (speed, slowing) = (0.7, 2.0 / 3.0 * ROLLING * G);
    for method in METHODS_THAT_ROLL {
        let mut scene = on_slope(method, 0.0, FrictionCone::Shifted, 0.0);
        scene.grains[0].velocity = speed * DVec2::X;
        scene.grains[0].angular_velocity = -speed / RADIUS;
        let mut run = start(&scene);
        let steps = (speed / slowing / DT) as usize;
        take_steps(&mut run, steps);
        assert!(run.velocity(0).x > 0.0, "{method}: it still rolls");
        assert_close(run.velocity(0).x, speed - slowing * DT * steps as f64, 1e-7, "its speed");
        take_steps(&mut run, 200);
        let exact = speed * speed / (2.0 * slowing) - 0.5 * speed * DT;
        let off = (run.place(0).x - exact).abs();
        assert!(off < slowing * DT * DT / 8.0 + 1e-9, "{method}: off by {off:e} m of {exact} m");
        assert!(run.velocity(0).length() < 1e-12, "{method}: at rest");
    }
}

/// Returns a scene of two discs of different size that touch and spin without friction. Cohesion with the Bond number 3
/// (cohesion force C₀ = 3 m_ij a, with the effective mass m_ij and the acceleration a of the setting
/// `bond_acceleration`) pulls the discs together.
fn spinning_pair(method: Method, cone: FrictionCone) -> Scene {
    let (one, other) = (0.1, 0.06);
    let spinning = |place: f64, radius: f64, rate: f64| Grain {
        angular_velocity: rate,
        ..Grain::at_rest(place * DVec2::X, radius)
    };
    let reach = (one + other) * (1.0 - 1e-9);
    let grains = vec![spinning(0.0, one, 4.0), spinning(reach, other, -9.0)];
    let numbers = Parameters { bond: 3.0, bond_acceleration: 5.0, cone, ..rolling(ROLLING, 0.0) };
    let solver = SolverSettings { max_sweeps: 20_000, ..solved_by(method, 1e-13) };
    Scene { solver, ..without_g(numbers, grains) }
}

fn spins(run: &Simulation) -> (f64, f64) {
    let grains = run.grains();
    let momentum = |k: usize| grains.inertia(k) * grains.angular_velocities[k];
    let spins = &grains.angular_velocities;
    (spins[0] - spins[1], momentum(0) + momentum(1))
}

#[test]
fn the_relative_spin_of_a_cohesive_pair_dies_and_its_angular_momentum_stays() {
    for method in METHODS_THAT_ROLL {
        let mut run = start(&spinning_pair(method, FrictionCone::Shifted));
        let (relative, momentum) = spins(&run);
        // No external force presses the discs together, so the moment is μ_r R C₀ on one disc and the opposite on the
        // other, where R is the reduced radius.
        let reduced = 0.1 * 0.06 / 0.16;
        let moment = ROLLING * reduced * 3.0 * 5.0 * effective_mass(&run);
        let slowing = moment * (1.0 / run.grains().inertia(0) + 1.0 / run.grains().inertia(1));
        let steps = (relative / slowing / DT) as usize;
        assert!(steps > 20, "{steps}");
        for step in 1..=steps + 20 {
            take_steps(&mut run, 1);
            let (now, total) = spins(&run);
            let expected = (relative - slowing * DT * step as f64).max(0.0);
            assert!(
                (now - expected).abs() < 1e-9 * relative,
                "{method}, {step}: {now}, {expected}"
            );
            assert!((total - momentum).abs() < 1e-13 * momentum.abs(), "{method}: {total}");
        }
        assert_eq!(run.observables().contacts, 1);
    }
    // With the compressive cone only the pushing part of the normal force bounds friction and rolling resistance, so a
    // contact resists rolling only under pressure.
    let run = after(&spinning_pair(Method::Auto, FrictionCone::Compressive), 100);
    assert_close(spins(&run).0, 13.0, 1e-14, "the relative spin");
}

#[test]
fn a_fixed_disc_counts_with_its_radius_and_its_spin() {
    // A disc of radius r on top of a fixed disc of radius B that turns with Ω, without friction: the moment M = μ_r R m
    // g with R = rB/(r + B) turns the upper disc until its angular velocity is Ω.
    let (other, rate) = (0.3, 6.0);
    let grain = Grain::at_rest((other + RADIUS) * (1.0 - 1e-10) * DVec2::Y, RADIUS);
    let scene = Scene {
        fixed_discs: vec![fixed(DVec2::ZERO, other)],
        motions: vec![discs_go(1, round(DVec2::ZERO, rate))],
        ..under_g(rolling(ROLLING, 0.0), vec![grain])
    };
    let mut run = start(&scene);
    let speeding = ROLLING * other / (RADIUS + other) * G * 2.0 / RADIUS;
    take_steps(&mut run, 100);
    assert_close(run.grains().angular_velocities[0], 0.1 * speeding, 1e-9, "its spin");
    let (after, off, scale) = balance(&mut run);
    assert!(off < 1e-11 * scale, "{off:e} J of {scale:e} J");
    assert!(after.wall_work > 0.0, "the turning disc does work");
    take_steps(&mut run, (rate / speeding / DT) as usize);
    assert_close(run.grains().angular_velocities[0], rate, 1e-9, "its last spin");
}

/// Returns a scene of a collapsing pile with rolling friction. Its steps are limited to 40 sweeps, which leaves large
/// residuals.
fn pile(method: Method, rolling_friction: f64) -> Scene {
    let mut scene = paper_pile().expect("the shipped state");
    scene.parameters = Parameters { rolling_friction, ..parameters(20.0, 2e-3, 0.1, 0.5) };
    scene.solver = SolverSettings { method, max_sweeps: 40, ..SolverSettings::default() };
    scene
}

#[test]
fn every_step_of_a_pile_with_rolling_friction_closes_its_energy_budget() {
    for method in METHODS_THAT_ROLL {
        let mut scene = pile(method, ROLLING);
        scene.parameters.bond = 0.0;
        let mut run = start(&scene);
        for _ in 0..100 {
            let (after, off, scale) = balance(&mut run);
            assert!(off <= 1e-11 * scale, "{method}, step {}: off by {off:e}", after.step);
        }
        assert!(run.observables().slump > 0.01, "{method}: it moved");
    }
}

#[test]
fn walls_that_turn_or_yield_and_borders_that_shear_take_part_in_the_energy_budget() {
    for name in ["drum", "shear", "shear-periodic"] {
        let mut scene = built_in(name).expect("a scene");
        let without = after(&scene, 200);
        scene.parameters.rolling_friction = ROLLING;
        let mut run = start(&scene);
        for _ in 0..200 {
            let (after, off, scale) = balance(&mut run);
            assert!(
                off <= 1e-11 * scale,
                "{name}, step {}: off by {off:e} of {scale:e}",
                after.step
            );
        }
        assert!(bits(&run) != bits(&without), "{name}: it matters");
    }
}

#[test]
fn a_pile_with_rolling_friction_is_the_same_on_one_and_two_threads() {
    let scene = pile(Method::Auto, ROLLING);
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| after(&scene, 150))
    };
    let [one, two] = [1, 2].map(on);
    assert!(bits(&one) == bits(&two));
    assert!(bits(&one) != bits(&after(&pile(Method::Auto, 0.0), 150)), "it matters");
}

/// Solves the contact problem of the next step with the equations of the model `M`, which defines the number of axes
/// and whether there are friction and rotation. Returns the velocities as bit patterns.
fn solved_in<M: Model>(run: &Simulation, method: Method, rolling_friction: f64) -> Vec<[u64; 3]> {
    let (world, parameters) = (run.world(), run.parameters());
    let numbers = ProblemNumbers {
        time_step_secs: parameters.time_step_secs,
        friction: parameters.friction,
        rolling_friction,
        capture_speed: parameters.capture_speed(world.gravity.magnitude()),
        cone: parameters.cone,
    };
    let settings = SolverSettings { max_sweeps: 60, ..solved_by(method, 1e-9) };
    let mut problem = StepProblem::<M>::default();
    problem.prepare(world, run.contacts(), numbers, &settings, |_| 0.0, None, None);
    solve(&mut problem, &mut Memory::default(), &settings);
    problem.bodies.now.iter().map(|body| M::coordinates(body).map(f64::to_bits)).collect()
}

#[test]
fn without_rolling_friction_its_model_computes_the_bits_of_the_leaner_one() {
    let run = after(&pile(Method::Nsgs, 0.0), 40);
    for method in METHODS_THAT_ROLL {
        let lean = solved_in::<SpinningPlane>(&run, method, 0.0);
        assert!(lean == solved_in::<RollingPlane>(&run, method, 0.0), "{method}");
        assert!(lean != solved_in::<RollingPlane>(&run, method, 0.1), "{method}");
    }
}

#[test]
fn methods_find_the_same_motion_of_a_pile_and_its_residual_is_the_laws() {
    let by = |method| {
        let mut scene = pile(method, ROLLING);
        scene.solver = SolverSettings { max_sweeps: 100_000, ..solved_by(method, 1e-9) };
        let mut run = start(&scene);
        let mut worst = 0f64;
        for _ in 0..3 {
            run.step().expect("a finite state");
            assert!(run.observables().converged, "{method}: {}", run.observables().residual);
            worst = worst.max(run.observables().velocity_error);
        }
        (run, worst)
    };
    let (first, _) = by(Method::Nsgs);
    for method in [Method::Nncg, Method::Newton, Method::Auto] {
        let (other, error) = by(method);
        let off = farthest(first.velocities(), other.velocities());
        assert!(off < 1e-6, "{method}: {off:e} m/s apart");
        assert!(error < 1e-4, "{method}: {error:e} m/s");
    }
}

#[test]
fn moments_keep_to_their_bound_and_do_no_positive_work() {
    let numbers = (prop_oneof![Just(0.0), 1.0..50.0], 0.0..1.0f64, 0.0..1.0f64, 1e-4..5e-3);
    let kinds = (any::<u64>(), any::<bool>(), 0usize..4);
    let (mut below, mut at) = (0, 0);
    let counts = std::cell::RefCell::new((&mut below, &mut at));
    for_random(40, (numbers, kinds), |((bond, mu, mu_r, dt), (seed, shifted, method))| {
        let cone = if shifted { FrictionCone::Shifted } else { FrictionCone::Compressive };
        let numbers = Parameters { cone, rolling_friction: mu_r, ..parameters(bond, dt, 0.1, mu) };
        let mut scene = pressed_pile(30, 0.3, seed, numbers);
        scene.solver =
            SolverSettings { max_sweeps: 3_000, ..solved_by(METHODS_THAT_ROLL[method], 1e-10) };
        let mut run = start(&scene);
        for _ in 0..3 {
            run.step().expect("a finite state");
            let (list, grains) = (run.contacts(), run.grains());
            for (number, contact) in list.contacts().iter().enumerate() {
                let (i, j) = (contact.grain as usize, contact.other as usize);
                let of_j = (j < grains.len()).then_some(j);
                let inverse = of_j.map_or(0.0, |j| 1.0 / grains.masses[j]);
                let mass = 1.0 / (1.0 / grains.masses[i] + inverse);
                let radius_of_j = of_j.map_or_else(
                    || run.world().fixed_discs[j - grains.len()].radius,
                    |j| grains.radii[j],
                );
                let radius = 1.0 / (1.0 / grains.radii[i] + 1.0 / radius_of_j);
                let normal = list.impulses()[number].normal;
                let rubbing = if shifted { normal + bond * mass * G * dt } else { normal.max(0.0) };
                let bound = mu_r * radius * rubbing;
                let moment = list.rolling(number);
                let scale = mass * radius * 1e-3;
                prop_assert!(moment.abs() <= bound + 1e-12 * scale, "{moment:e} above {bound:e}");
                let spin = grains.angular_velocities[i]
                    - of_j.map_or(0.0, |j| grains.angular_velocities[j]);
                if run.observables().converged {
                    let rounding = 1e-8 * moment.abs() / radius;
                    prop_assert!(moment * spin <= rounding, "{moment:e} with {spin:e} rad/s");
                    let mut counts = counts.borrow_mut();
                    let holds = moment.abs() < bound - 1e-3 * scale;
                    *(if holds { &mut *counts.0 } else { &mut *counts.1 }) += 1;
                    prop_assert!(!holds || (radius * spin).abs() < 1e-3, "turns at {spin:e} rad/s");
                }
            }
        }
        Ok(())
    });
    assert!(below > 100 && at > 100, "{below} moments held, {at} yielded");
}

#[test]
fn what_does_not_compute_rolling_friction_refuses_it() {
    let good = pile(Method::Auto, ROLLING);
    start(&good);
    let allowed = "must be nsgs or newton or nncg or auto where rolling-friction is above 0";
    for info in METHODS.iter().filter(|info| !METHODS_THAT_ROLL.contains(&info.method)) {
        let said = format!("solver is {}, but {allowed}", info.name);
        refuses(&good, &[(&said, &|scene| scene.solver.method = info.method)]);
    }
    for &stepper in Stepper::ALL.iter().filter(|&&stepper| stepper != Stepper::Moreau) {
        let said = "rolling-friction is 0.2, but must be 0 where stepper is not moreau";
        refuses(&good, &[(said, &|scene| scene.stepper = stepper)]);
    }
    refuses(
        &good,
        &[
            (
                "friction-model is tresca, but must be coulomb where rolling-friction is above 0",
                &|scene| scene.solver.friction_model = FrictionModel::Tresca,
            ),
            ("rolling-friction is 0.2, but must be 0 where physics.rotation is false", &|scene| {
                scene.physics.rotation = false
            }),
            ("rolling-friction is -1, but must be a finite number ≥ 0", &|scene| {
                scene.parameters.rolling_friction = -1.0;
            }),
        ],
    );
}

/// Returns the mean of the eight numbers `numbers`, and half the width of the 95 % confidence interval of the mean.
fn interval(numbers: &[f64]) -> (f64, f64) {
    let count = numbers.len() as f64;
    let mean = numbers.iter().sum::<f64>() / count;
    let squares = numbers.iter().map(|number| (number - mean).powi(2)).sum::<f64>();
    // Student's t for 95 % and 7 degrees of freedom is 2.365.
    (mean, 2.365 * (squares / (count - 1.0) / count).sqrt())
}

#[test]
#[ignore = "56 collapses: five minutes"]
fn piles_slump_less_with_rolling_friction_until_no_grain_rolls() {
    use rayon::prelude::*;
    let piles: Vec<Scene> = (1..=8u64)
        .into_par_iter()
        .map(|seed| {
            let pile = NewPile { seed, ..NewPile::default() };
            let grains = settle(&pile, |_| true).expect("it comes to rest");
            pile_of(grains, pile.box_width_in_diameters).expect("a sound pile")
        })
        .collect();
    let slumps = [0.0, 0.1, 0.2, 0.4, 0.8, 2.0, 4.0].map(|rolling_friction| {
        let of_pile = |pile: &Scene| {
            let numbers = Parameters { rolling_friction, ..parameters(0.0, 1e-3, 0.1, 0.5) };
            let solver = SolverSettings::default();
            let run = after(&Scene { parameters: numbers, solver, ..pile.clone() }, 1000);
            run.observables().slump
        };
        let (mean, half) = interval(&piles.par_iter().map(of_pile).collect::<Vec<_>>());
        println!("μ_r {rolling_friction}: {mean:.3} ± {half:.3}");
        mean
    });
    for (one, next) in slumps.iter().zip(&slumps[1..5]) {
        assert!(next < one, "{slumps:?}");
    }
    let [first, .., before, last] = slumps;
    assert!(last < 0.85 * first && (last - before).abs() < 0.1 * (first - last), "{slumps:?}");
}
