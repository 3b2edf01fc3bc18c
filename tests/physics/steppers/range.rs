//! Tests of the contact law of the stepper `range` (`contact::range`), mostly by comparing a single bond with its exact
//! motion.

use crate::common::*;

const RADIUS: f64 = 2.5e-3;
const BOND: f64 = 20.0;
/// Time steps, s. A bond breaks in 0.7 ms at Bond 20, so the time steps range from a tenth to about ten times this
/// time.
const TIME_STEPS: [f64; 7] = [5e-5, 1e-4, 2e-4, 5e-4, 1e-3, 2e-3, 5e-3];

/// Returns a run of a grain that touches a disc at rest and moves away from it at `speed` (m/s). A load, given as the
/// acceleration `load` (m/s²), also pulls the grain away. For every load the cohesion force C₀ is the same as for Bond
/// [`BOND`] under the gravity g.
fn pair(time_step_secs: f64, speed: f64, load: f64, physics: Physics) -> Simulation {
    let direction = DVec2::X;
    let grain = moving(2.0 * RADIUS * direction, RADIUS, speed * direction);
    // C₀ is proportional to the norm of gravity, and gravity is the load here. This Bond number makes C₀ = BOND·G per
    // mass.
    let (gravity, bond) = if load == 0.0 { (G, BOND) } else { (load, BOND * G / load.abs()) };
    let feels_gravity = load != 0.0;
    start(&Scene {
        fixed_discs: vec![fixed(DVec2::ZERO, RADIUS)],
        stepper: Stepper::Range,
        solver: certain(),
        ..scene(
            physics,
            gravity * direction,
            range(bond, time_step_secs),
            vec![Grain { feels_gravity, ..grain }],
        )
    })
}

/// Returns the speed of the grain when it has moved away by three debonding distances (m/s), or `None` if the bond does
/// not break.
fn speed_far_away(mut run: Simulation) -> Option<f64> {
    let far = 2.0 * RADIUS * (1.0 + 3.0 * DISTANCE_IN_DIAMETERS);
    let steps = (0.1 / run.parameters().time_step_secs) as usize;
    for _ in 0..steps {
        take_steps(&mut run, 1);
        if run.place(0).x > far {
            return Some(run.velocity(0).x);
        }
    }
    None
}

/// Returns the work C₀δ_c that breaks a bond, divided by the effective mass m_ij, m²/s² (C₀: cohesion force, δ_c:
/// debonding distance).
fn work() -> f64 {
    BOND * G * DISTANCE_IN_DIAMETERS * 2.0 * RADIUS
}

#[test]
fn a_pair_thrown_apart_parts_above_the_escape_speed_and_has_lost_the_bonds_work() {
    let escape = (2.0 * work()).sqrt();
    for (physics, time_step_secs) in pairs([LINE, SMOOTH, Physics::FULL], TIME_STEPS) {
        for factor in [1.001, 1.1, 1.5, 3.0, 10.0] {
            let speed = factor * escape;
            let found = speed_far_away(pair(time_step_secs, speed, 0.0, physics))
                .unwrap_or_else(|| panic!("held at {factor} of it, Δt = {time_step_secs}"));
            let lost = 0.5 * (speed * speed - found * found);
            assert_close(lost, work(), 1e-9, &format!("work at {factor}, {time_step_secs} s"));
        }
        for factor in [0.1, 0.5, 0.9, 0.999] {
            let left = speed_far_away(pair(time_step_secs, factor * escape, 0.0, physics));
            assert_eq!(left, None, "at {factor} of the escape speed, Δt = {time_step_secs}");
        }
    }
}

#[test]
fn the_static_pull_off_force_is_the_cohesion_at_every_time_step() {
    for time_step_secs in TIME_STEPS {
        let cohesion = BOND * G;
        let away = |load| speed_far_away(pair(time_step_secs, 0.0, load, LINE));
        assert_eq!(away(0.999 * cohesion), None, "Δt = {time_step_secs}");
        assert!(away(1.05 * cohesion).is_some(), "Δt = {time_step_secs}");
    }
}

#[test]
fn a_bond_that_holds_a_load_at_rest_asks_for_no_substeps_and_breaks_where_its_strength_ends() {
    // Longer than the time in which a bond breaks, 0.7 ms. If a bond opens, Slump divides such a step into four.
    let time_step_secs = 1e-3;
    // The load is more than half of the bond's strength, so a bond at rest differs from one that is about to break only
    // by its speed.
    let load = 0.75 * BOND * G;
    let mut run = pair(time_step_secs, 0.3 * (2.0 * work()).sqrt(), load, LINE);
    take_steps(&mut run, 1);
    assert!(run.observables().sweeps > 4, "one in which a bond so loaded opens is cut");
    take_steps(&mut run, 20);
    assert!(run.observables().sweeps < 4, "one that stands is not");
    // The Bond number is C₀ divided by the weight of the grain, and the weight is the load.
    let mut parameters = *run.parameters();
    while parameters.bond > 0.5 && run.velocity(0).x < 1e-3 {
        parameters.bond *= 0.999;
        run.set_parameters(parameters).expect("a Bond number");
        take_steps(&mut run, 1);
    }
    let strength = parameters.bond;
    assert!((0.99..1.0).contains(&strength), "it let go at {strength} of its load");
}

#[test]
fn a_load_that_breaks_a_bond_gives_it_just_its_work() {
    for (time_step_secs, factor) in pairs(TIME_STEPS, [1.1, 2.0, 5.0]) {
        let mut run = pair(time_step_secs, 0.0, factor * BOND * G, LINE);
        while run.place(0).x < 3.0 * RADIUS {
            take_steps(&mut run, 1);
        }
        // The bond pulls with the force C₀ until the pair has opened by the debonding distance δ_c.
        let opened = DISTANCE_IN_DIAMETERS * 2.0 * RADIUS;
        let time = (2.0 * opened / ((factor - 1.0) * BOND * G)).sqrt();
        let at = run.time_secs();
        let free = factor * BOND * G * at - BOND * G * time;
        let found = run.velocity(0).x;
        assert_close(found, free, 1e-9, &format!("v at {factor}, Δt = {time_step_secs}"));
    }
}

#[test]
fn two_free_grains_part_by_the_energy_of_their_relative_motion() {
    let escape = (2.0 * work()).sqrt();
    for (time_step_secs, factor) in pairs(TIME_STEPS, [0.8, 1.3]) {
        let second = DVec2::new(2.0 * RADIUS, 0.0);
        let grains = [
            moving(DVec2::ZERO, RADIUS, DVec2::ZERO),
            moving(second, RADIUS, DVec2::new(factor * escape, 0.0)),
        ];
        let weightless = |grain| Grain { feels_gravity: false, ..grain };
        let grains = grains.into_iter().map(weightless).collect();
        let scene = scene(LINE, DVec2::new(G, 0.0), range(BOND, time_step_secs), grains);
        let run =
            after(&Scene { stepper: Stepper::Range, ..scene }, (0.1 / time_step_secs) as usize);
        let velocities = run.velocities();
        let found = velocities[1].x - velocities[0].x;
        let expected = escape * (factor * factor - 1.0f64).max(0.0).sqrt();
        assert!((found - expected).abs() < 1e-9, "{factor}, Δt = {time_step_secs}: {found}");
    }
}

#[test]
fn overlap_is_pushed_out_and_moves_nothing() {
    let grains = vec![
        weightless(Grain::at_rest(DVec2::ZERO, RADIUS)),
        weightless(Grain::at_rest(DVec2::new(1.8 * RADIUS, 0.0), RADIUS)),
    ];
    for bond in [0.0, BOND] {
        let scene = scene(LINE, DVec2::new(G, 0.0), range(bond, 1e-3), grains.clone());
        let scene = Scene { stepper: Stepper::Range, ..scene };
        let run = after(&scene, 60);
        assert_eq!(run.observables().kinetic_energy, 0.0);
        let gap = run.place(1).x - 2.0 * RADIUS;
        let first = run.place(0).x;
        assert!((gap - first).abs() < 1e-9, "gap {:e}", gap - first);
    }
}

#[test]
fn a_bond_gives_back_what_it_took_or_keeps_all_of_it() {
    for (time_step_secs, factor) in pairs(TIME_STEPS, [0.5, 0.9, 1.1, 3.0]) {
        let speed = factor * (2.0 * work()).sqrt();
        let mut run = pair(time_step_secs, speed, 0.0, Physics::FULL);
        let mass = run.grains().masses[0];
        let begun = run.observables().kinetic_energy;
        let (mut of_bonds, mut of_pushes, mut most) = (0.0, 0.0, 0f64);
        for _ in 0..(0.1 / time_step_secs) as u32 {
            let now = *run.step().expect("finite");
            let [of_step, stored, broken] =
                [now.bond_work, now.bond_energy, now.broken_bond_energy].map(Option::unwrap);
            of_bonds += of_step;
            of_pushes += now.normal_work - of_step;
            most = most.max(stored);
            let what = format!("{factor} of the escape speed, Δt = {time_step_secs}");
            assert!((of_bonds + stored + broken).abs() <= 1e-9 * begun, "{what}");
            let sum = now.kinetic_energy - of_bonds - of_pushes;
            assert_close(sum, begun, 1e-9, &what);
            assert!(of_pushes <= 1e-9 * begun, "{what}: pushes gave {of_pushes} J");
        }
        let broken = run.observables().broken_bond_energy.unwrap();
        let kept = if factor > 1.0 { mass * work() } else { 0.0 };
        assert_close(broken, kept, 1e-9, "kept by the bond");
        assert_eq!(run.observables().bond_energy, Some(0.0));
        // Only short steps resolve the opening of the bond.
        let bond_time = (2.0 * DISTANCE_IN_DIAMETERS * 2.0 * RADIUS / (BOND * G)).sqrt();
        if factor < 1.0 && time_step_secs < 0.2 * bond_time {
            assert!(most > 0.8 * begun, "stored {most} of {begun} J");
        }
    }
}

/// Returns the ratio ω/ω_c above which a bonded pair that turns as one body at the angular velocity ω breaks its bond.
/// L is the distance of the centres, and ω_c = √(C₀/(m_ij L)) is the angular velocity at which the cohesion force C₀ is
/// the centripetal force (m_ij: effective mass).
///
/// The bond pulls with C₀ up to the debonding distance δ_c = δL, and L²ω is conserved. So the pair opens to L(1 + δ) if
/// ½ω²L²(1 − (1 + δ)⁻²) = (C₀/m_ij)Lδ.
fn tearing_part(delta: f64) -> f64 {
    (2.0 * delta / (1.0 - (1.0 + delta).powi(-2))).sqrt()
}

/// Returns true if two bonded grains that turn as one body are still together after two turns. `part` is their angular
/// velocity divided by the angular velocity at which the cohesion force is the centripetal force, and `size` the ratio
/// of their radii.
fn circling_pair_holds(
    part: f64,
    [bond, time_step_secs, size]: [f64; 3],
    physics: Physics,
) -> bool {
    let distance = RADIUS * (1.0 + size);
    let rate = part * (bond * G / distance).sqrt();
    let share = size * size / (1.0 + size * size);
    let at = |x: f64, radius: f64| Grain {
        feels_gravity: false,
        angular_velocity: if physics.rotation { rate } else { 0.0 },
        ..moving(DVec2::new(x, 0.0), radius, DVec2::new(0.0, rate * x))
    };
    let grains = vec![at(-share * distance, RADIUS), at((1.0 - share) * distance, size * RADIUS)];
    let run = after(
        &Scene {
            stepper: Stepper::Range,
            ..scene(physics, DVec2::new(0.0, -G), range(bond, time_step_secs), grains)
        },
        (4.0 * std::f64::consts::PI / (rate * time_step_secs)) as usize + 1,
    );
    let [one, other] = [0, 1].map(|grain| run.place(grain));
    one.distance(other) < distance * 1.05
}

#[test]
fn a_pair_that_circles_holds_up_to_the_speed_at_which_its_bond_tears() {
    for physics in [SMOOTH, Physics::FULL] {
        for bond in [3.0, BOND] {
            for size in [1.0, 0.4] {
                for time_step_secs in TIME_STEPS {
                    let numbers = [bond, time_step_secs, size];
                    // If Δt is longer than 6.4 times the breaking time, sixteen substeps do not resolve the break, and
                    // Slump reports this step.
                    let bond_time = (4.0 * DISTANCE_IN_DIAMETERS * RADIUS / (bond * G)).sqrt();
                    let below = if time_step_secs < 6.4 * bond_time { 0.99 } else { 0.98 };
                    assert!(circling_pair_holds(below, numbers, physics), "{numbers:?} at {below}");
                    let above = 1.01 * tearing_part(2.0 * DISTANCE_IN_DIAMETERS / (1.0 + size));
                    assert!(
                        !circling_pair_holds(above, numbers, physics),
                        "{numbers:?} at {above}"
                    );
                }
            }
        }
    }
}

#[test]
fn a_grain_that_rides_on_a_moving_disc_does_not_circle_it() {
    // Returns true if Slump treats a grain that moves at 1 m/s along a disc with this speed (m/s) as circling about the
    // disc.
    let circles = |disc_speed: f64| {
        let direction = DVec2::Y;
        let course = MotionCourse::Straight { direction, speed: disc_speed, travel: None };
        let of_disc = discs_go(1, course);
        let grain = moving(DVec2::new(2.0 * RADIUS, 0.0), RADIUS, direction);
        let run = after(
            &Scene {
                fixed_discs: vec![fixed(DVec2::ZERO, RADIUS)],
                motions: vec![of_disc],
                stepper: Stepper::Range,
                solver: tight(),
                ..scene(
                    SMOOTH,
                    G * DVec2::X,
                    range(100.0, 5e-3),
                    vec![Grain { feels_gravity: false, ..grain }],
                )
            },
            3,
        );
        run.alarms().iter().any(|alarm| alarm.kind == AlarmKind::BreakUnseen)
    };
    assert!(circles(0.0), "the situation: past a disc that rests it circles too fast for the step");
    assert!(!circles(1.0));
}

/// Returns a scene of a pile that collapses and forms bonds, with the stepper `range`.
fn pile(bond: f64, time_step_secs: f64, method: Method) -> Scene {
    let parameters =
        Parameters { restitution: 0.1, restitution_threshold: 2.0, ..range(bond, time_step_secs) };
    Scene {
        stepper: Stepper::Range,
        solver: SolverSettings { method, max_sweeps: 20_000, tolerance: 1e-8, ..tight() },
        ..pressed_pile(60, 0.3, 5, parameters)
    }
}

#[test]
fn the_energy_budget_of_a_pile_closes_and_overlap_goes() {
    for (bond, time_step_secs) in pairs([0.0, 10.0, 100.0], [2e-4, 2e-3]) {
        let mut run = start(&pile(bond, time_step_secs, Method::Newton));
        let mass: f64 = run.grains().masses.iter().sum();
        for _ in 0..(0.1 / time_step_secs) as usize {
            let (_, off, scale) = balance(&mut run);
            assert!(off <= 1e-10 * (scale + mass * (G * time_step_secs).powi(2)));
        }
        let overlap = run.observables().mean_overlap;
        assert!(overlap < 1e-3, "Bond {bond}, Δt = {time_step_secs}: {overlap}");
    }
}

#[test]
fn bonds_of_a_collapsing_pile_keep_their_books_and_pushes_give_nothing() {
    for time_step_secs in [5e-3, 1e-3] {
        let mut scene = paper_pile().expect("the shipped state");
        scene.stepper = Stepper::Range;
        scene.parameters = Parameters { restitution: 0.1, ..range(10.0, time_step_secs) };
        scene.solver = SolverSettings {
            method: Method::Newton,
            stop: StopTest::Residual,
            tolerance: 1e-6,
            ..scene.solver
        };
        let mut run = start(&scene);
        let (mut of_bonds, mut lost, mut raised) = (0.0, 0.0, 0.0);
        for _ in 0..(0.2 / time_step_secs) as u32 {
            let now = *run.step().expect("finite");
            let of_step = now.bond_work.expect("bonds");
            of_bonds += of_step;
            let of_pushes = now.normal_work - of_step;
            lost -= of_pushes.min(0.0);
            raised += of_pushes.max(0.0);
        }
        let now = run.observables();
        let (stored, broken) = (now.bond_energy.unwrap(), now.broken_bond_energy.unwrap());
        assert!(
            (of_bonds + stored + broken).abs() <= 1e-9 * broken,
            "{of_bonds}, {stored}, {broken}"
        );
        assert!(broken > 0.02 * lost, "bonds broke: {broken} of {lost} J");
        assert!(raised < 1e-3 * lost, "pushes gave {raised} and took {lost} J");
    }
}

#[test]
fn the_paper_s_law_tells_nothing_of_bonds() {
    let mut scene = pile(10.0, 1e-3, Method::Newton);
    scene.stepper = Stepper::Moreau;
    let run = after(&scene, 2);
    let now = run.observables();
    assert_eq!((now.bond_work, now.bond_energy, now.broken_bond_energy), (None, None, None));
    assert!(!serde_json::to_string(now).expect("numbers").contains("bond_"));
}

/// Returns the number of steps of a collapsing pile that both Newton's method and the given method have solved, and the
/// number of those steps in which the final velocities of the two agree.
fn solved_and_alike(seed: u64, friction: f64, method: Method) -> [u32; 2] {
    let parameters =
        Parameters { restitution: 0.1, restitution_threshold: 2.0, friction, ..range(20.0, 2e-4) };
    let solver =
        SolverSettings { method: Method::Newton, max_sweeps: 20_000, tolerance: 1e-9, ..tight() };
    let scene =
        Scene { stepper: Stepper::Range, solver, ..pressed_pile(60, 0.3, seed, parameters) };
    let mut run = start(&scene);
    let mut counts = [0; 2];
    for _ in 0..MOMENTS {
        take_steps(&mut run, 10);
        let [reference, found] = [Method::Newton, method].map(|method| {
            let mut copy = run.clone();
            copy.set_solver(SolverSettings { method, ..solver }).expect("fine");
            take_steps(&mut copy, 1);
            copy
        });
        if !(found.observables().converged && reference.observables().converged) {
            continue;
        }
        let [found, reference] = [&found, &reference].map(|run| run.velocities());
        let off = found.iter().zip(reference).map(|(a, b)| (*a - *b).length());
        counts[0] += 1;
        counts[1] += u32::from(off.fold(0.0, f64::max) < 1e-5);
    }
    counts
}

/// Number of steps that are compared in each pile.
const MOMENTS: u32 = 12;

/// Checks that other methods agree with Newton's method on nearly all steps. They need not agree on all steps:
/// Coulomb's law may have several solutions, and the method decides which solution is found. If the impulses of a
/// collision are not unique, the method also decides which bond breaks first. Methods that solve different laws would
/// agree on hardly any step.
#[test]
fn methods_agree_on_nearly_all_steps_with_bonds() {
    for (method, (friction, least_share)) in
        pairs([Method::Nsgs, Method::Nncg, Method::NsgsParallel], [(0.0, 0.95), (0.5, 0.8)])
    {
        let counts = (1..=8).map(|seed| solved_and_alike(seed, friction, method));
        let [solved, alike] = counts.fold([0; 2], |sum, more| [0, 1].map(|at| sum[at] + more[at]));
        // Steps that are not solved within the allowed sweeps say nothing about agreement.
        assert!(2 * solved > 8 * MOMENTS, "{method:?}, μ = {friction}: {solved} solved");
        let share = f64::from(alike) / f64::from(solved);
        assert!(share >= least_share, "{method:?}, μ = {friction}: {alike} of {solved} alike");
    }
}

/// Checks that all steps of a pile are solved with bounded friction, and that some of them are unsolved under Coulomb
/// friction. At the time step Δt = 5e-3 s, half the steps of a slumping pile are unsolved under Coulomb friction.
#[test]
fn under_bounds_of_friction_no_piece_of_a_step_is_left_unsolved() {
    let run = |bond: f64, time_step_secs: f64, solver: SolverSettings| {
        let mut scene = built_in("pile").expect("a scene");
        (scene.stepper, scene.solver) = (Stepper::Range, solver);
        scene.parameters.bond = bond;
        scene.parameters.time_step_secs = time_step_secs;
        let mut run = start(&scene);
        let (mut unsolved, mut factorisations) = (0, 0);
        for _ in 0..(0.15 / time_step_secs).round() as u32 {
            let of_model = solver.friction_model != FrictionModel::Coulomb;
            assert!(!of_model || error_against_model(&run) < 5e-5);
            let row = run.step().expect("a finite state");
            unsolved += u32::from(!row.converged);
            factorisations = factorisations.max(row.factorisations);
        }
        assert!(bond > 20.0 || run.observables().slump > 0.1, "Bond {bond}: it slumps");
        (unsolved, factorisations)
    };
    let bounded = SolverSettings::BOUNDED;
    for (bond, time_step_secs) in pairs([0.0, 8.0, 100.0], [1e-3, 5e-3]) {
        let (unsolved, most) = run(bond, time_step_secs, bounded);
        assert_eq!(unsolved, 0, "Bond {bond}, {time_step_secs} s");
        assert!(most > 20, "Bond {bond}, {time_step_secs} s: {most} factorisations in no step");
    }
    let newton = SolverSettings { max_sweeps: 200, ..solved_by(Method::Newton, 1e-6) };
    let newton = SolverSettings { friction_model: FrictionModel::Coulomb, ..newton };
    let (unsolved, _) = run(8.0, 5e-3, newton);
    assert!(unsolved > 5, "{unsolved}: Coulomb's law is as easily solved");
}
