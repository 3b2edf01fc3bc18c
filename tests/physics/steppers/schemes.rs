//! Tests of the steppers `tgs-soft`, `dem` and `avbd`: properties that each of them must have.

use rayon::prelude::*;

use crate::common::*;

#[test]
fn soft_substeps_part_a_pair_with_the_restitution_that_is_asked_for() {
    let ways = triples([LINE, SMOOTH, Physics::FULL], [0.0, 0.1, 0.5, 1.0], [1, 4, 16]);
    for ((physics, restitution, substeps), speculative) in pairs(ways, [false, true]) {
        let mut scene = by(Stepper::TgsSoft, substeps, meeting(physics, restitution, 1e-3));
        scene.remedies.speculative = speculative;
        let mut run = start(&scene);
        let (before, carried) = (relative_velocity(&run), momentum(&run));
        take_steps(&mut run, 2);
        if speculative {
            assert!(run.place(0).distance(run.place(1)) > 0.25 - 1e-12, "they did not overlap");
        } else {
            assert_eq!(run.observables().contacts, 1, "they met");
        }
        let after = relative_velocity(&run);
        let off = (after + restitution * before).length();
        assert!(off < 1e-12, "ρ {restitution}, {substeps} substeps: off by {off:e}");
        assert!(momentum(&run).distance(carried) < 1e-12 * carried.length());
    }
}

#[test]
fn a_threshold_of_restitution_holds_for_soft_substeps() {
    // The discs collide at 1 m/s, which is 102 g·Δt. Restitution acts only above the threshold, which is in units of
    // g·Δt.
    for (threshold, parts) in [(90.0, true), (110.0, false)] {
        let mut scene = by(Stepper::TgsSoft, 0, meeting(LINE, 0.5, 1e-3));
        scene.parameters.restitution_threshold = threshold;
        assert_eq!(relative_velocity(&after(&scene, 2)).x > 0.1, parts, "threshold {threshold}");
    }
}

/// The steppers [`SCHEMES`] with the remedy `speculative` off, and `tgs-soft` also with this remedy on.
const WITH_REMEDY: [(Stepper, bool); 3] =
    [(Stepper::TgsSoft, false), (Stepper::TgsSoft, true), (Stepper::Dem, false)];

/// Returns a scene in which gravity pulls a disc off another disc above it. The upper disc is a weightless grain if
/// `free` is true; otherwise it is not a grain and does not move.
fn pulled(stepper: Stepper, bond: f64, dt: f64, free: bool) -> Scene {
    let (radius, other) = (0.15, 0.1);
    let hanging = Grain::at_rest(DVec2::new(0.0, -(radius + other) * (1.0 - 1e-9)), radius);
    let mut grains = vec![hanging];
    if free {
        grains.push(weightless(Grain::at_rest(DVec2::ZERO, other)));
    }
    let fixed_discs = if free { Vec::new() } else { vec![fixed(DVec2::ZERO, other)] };
    let scene = under_g(parameters(bond, dt, 0.2, 0.5), grains);
    by(stepper, 0, Scene { fixed_discs, ..scene })
}

#[test]
fn the_static_pull_off_force_does_not_depend_on_the_time_step() {
    for (method, speculative) in WITH_REMEDY {
        for (dt, substeps) in [(1e-4, 0), (1e-3, 0), (1e-3, 400), (3e-3, 0), (1e-2, 0), (1e-2, 900)]
        {
            for free in [false, true] {
                let run = |bond: f64| {
                    let mut scene = pulled(method, bond, dt, free);
                    scene.parameters.substeps = substeps;
                    scene.remedies.speculative = speculative;
                    after(&scene, (0.5 / dt) as usize)
                };
                let holds = |bond: f64| run(bond).observables().contacts == 1;
                // The pull is m_ij g and C₀ is Bond·m_ij·g, so the bond breaks below Bond = 1.
                let found = border(0.5, 2.0, 9, |bond| !holds(bond));
                assert!((found - 1.0).abs() < 2e-3, "{method:?}, Δt {dt}: C₀ of {found} weights");

                let held = run(1.5);
                let grains = held.grains();
                let mass = if free { effective_mass(&held) } else { grains.masses[0] };
                let force = held.contacts().impulses()[0].normal / dt;
                assert_close(force, -mass * G, 1e-6, "the force that holds it");
                assert!(held.observables().tensile_contacts == 1);
            }
        }
    }
}

#[test]
fn free_fall_is_that_of_symplectic_euler_with_the_substep() {
    let (dt, velocity) = (1e-3, DVec2::new(-0.7, 2.0));
    let of_moreau = [LINE, SMOOTH, Physics::FULL].map(|physics| (Stepper::Moreau, 0, physics));
    let of_scheme = |scheme| [0, 1, 7].map(|substeps| (scheme, substeps, Physics::FULL));
    let ways = of_moreau.into_iter().chain(ALL_SCHEMES.into_iter().flat_map(of_scheme));
    for (stepper, substeps, physics) in ways {
        let what = format!("{stepper}, {substeps} substeps, {physics:?}");
        let count = if stepper == Stepper::Moreau { 1000 } else { 300 };
        let mask = if physics.axes == 1 { DVec2::X } else { DVec2::ONE };
        let (gravity, velocity) = (mask * DVec2::new(1.5, -G), mask * velocity);
        let grains = vec![Grain { angular_velocity: 3.0, ..moving(DVec2::X, 0.1, velocity) }];
        let scene = scene(physics, gravity, parameters(20.0, dt, 0.1, 0.5), grains);
        let run = after(&by(stepper, substeps, scene), count);
        let n = f64::from(run.substeps()) * count as f64;
        let time = dt * count as f64;
        let fallen = velocity + time * gravity;
        let way = time * velocity + 0.5 * time * time * (1.0 + 1.0 / n) * gravity;
        assert!(run.velocity(0).distance(fallen) < 1e-11, "{what}");
        assert!((run.place(0) - DVec2::X).distance(way) < 1e-11, "{what}");
        let turned = if physics.rotation { 3.0 * time } else { 0.0 };
        assert!((run.grains().angles[0] - turned).abs() < 1e-11, "{what}");
    }
}

#[test]
fn every_step_closes_its_energy_budget() {
    for (method, speculative) in WITH_REMEDY {
        for (bond, mu, physics) in [
            (0.0, 0.5, Physics::FULL),
            (50.0, 0.3, Physics::FULL),
            (20.0, 0.5, UNTURNING),
            (20.0, 0.0, SMOOTH),
        ] {
            let pile = pressed_pile(30, 0.1, 3, parameters(bond, 1e-3, 0.3, mu));
            let mut scene = by(method, 0, Scene { physics, ..pile });
            scene.remedies.speculative = speculative;
            let mut run = start(&scene);
            run.set_pull(Some(Pull { grain: 29, target: DVec2::new(0.02, 0.05) }));
            let mut worked = 0.0;
            for _ in 0..100 {
                let (after, off, scale) = balance(&mut run);
                assert!(off <= 1e-10 * scale, "{method:?}, step {}: {off:e}", after.step);
                worked += after.normal_work.abs();
                assert!(after.converged && after.residual.is_finite());
            }
            assert!(worked > 0.0, "contacts worked");
        }
    }
}

#[test]
fn the_substeps_left_to_the_scheme_are_stable_and_counted() {
    let pile = paper_pile().expect("the shipped state");
    let soft = start(&by(Stepper::TgsSoft, 0, pile.clone()));
    assert_eq!((soft.substeps(), soft.critical_time_step_secs()), (4, None));
    let mut dem = start(&by(Stepper::Dem, 0, pile.clone()));
    let critical = dem.critical_time_step_secs().expect("springs");
    let substep = 1e-3 / f64::from(dem.substeps());
    assert!((0.45..=0.5).contains(&(substep / critical)), "{substep} of {critical}");
    let substeps = dem.substeps();
    assert_eq!(dem.step().expect("a finite state").sweeps, substeps);
    assert_eq!(start(&pile).substeps(), 1);
}

#[test]
fn what_a_scheme_remembers_is_for_itself_alone() {
    let pile = by(Stepper::Dem, 0, paper_pile().expect("the shipped state"));
    let mut run = after(&pile, 5);
    let blank = |memory: &ContactMemory| *memory == ContactMemory::default();
    assert!(!run.contacts().memories().iter().all(blank));
    let settings = Settings { stepper: Stepper::Moreau, ..*run.settings() };
    run.change(settings).expect("sound");
    take_steps(&mut run, 1);
    assert!(run.contacts().memories().iter().all(blank));
}

#[test]
fn settings_that_change_before_the_first_step_are_those_of_the_start() {
    let pile = paper_pile().expect("the shipped state");
    for &stepper in Stepper::ALL {
        for time_step_secs in [1e-4, 5e-3] {
            let mut scene = by(stepper, 0, pile.clone());
            scene.parameters.time_step_secs = time_step_secs;
            let mut changed = start(&pile);
            changed.change(scene.settings()).expect("sound");
            take_steps(&mut changed, 150);
            let [hash, expected] =
                [&changed, &after(&scene, 150)].map(|run| run.snapshot().state_hash());
            assert_eq!(hash, expected, "{stepper}, {time_step_secs} s");
        }
    }
}

/// Returns the mean of these numbers and the standard error of the mean.
fn mean(values: &[f64]) -> (f64, f64) {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
    (mean, (squares / (count - 1.0) / count).sqrt())
}

#[test]
fn a_pile_without_cohesion_slumps_as_it_does_in_contact_dynamics() {
    // Slumps by contact dynamics: Gauss–Seidel to a relative change of 1e-6 with Δt = 1e-3 s, for the seeds 1 to 4 of
    // the initial state.
    let contact_dynamics = [0.454, 0.484, 0.532, 0.475];
    let states: Vec<Scene> = (1..=4)
        .into_par_iter()
        .map(|seed| {
            let rain = NewPile { seed, ..NewPile::default() };
            let grains = settle(&rain, |_| true).expect("it comes to rest");
            let mut pile = pile_of(grains, rain.box_width_in_diameters).expect("a pile");
            pile.parameters.bond = 0.0;
            pile
        })
        .collect();
    for method in ALL_SCHEMES {
        let slump = |pile: &Scene| {
            let run = after(&by(method, 0, pile.clone()), 1000);
            run.observables().slump
        };
        let slumps: Vec<f64> = states.par_iter().map(slump).collect();
        let pairs = slumps.iter().zip(contact_dynamics);
        let (change, error) = mean(&pairs.map(|(slump, other)| slump - other).collect::<Vec<_>>());
        println!("{method:?}: {slumps:.3?}, more by {change:.3} ± {error:.3}");
        assert!(error < 0.02, "± {error} tells nothing");
        assert!(change.abs() + error < 0.05, "{method:?}: more by {change} ± {error}");
    }
}

/// Returns a scene of a column of discs along x, on a disc that does not move. The radius of the top disc is `ratio`
/// times the radius of the others.
fn column(count: usize, ratio: f64) -> Scene {
    let radius = 0.1;
    let apart = 2.0 * radius * (1.0 - 1e-9);
    let mut grains: Vec<Grain> = (0..count)
        .map(|level| Grain::at_rest(DVec2::X * apart * (level + 1) as f64, radius))
        .collect();
    let top = DVec2::X * (apart * count as f64 + (1.0 + ratio) * radius);
    grains.push(Grain::at_rest(top, ratio * radius));
    let scene = scene(LINE, -G * DVec2::X, parameters(0.0, 1e-3, 0.0, 0.0), grains);
    let fixed_discs = vec![fixed(DVec2::ZERO, radius)];
    by(Stepper::Avbd, 0, Scene { fixed_discs, ..scene })
}

#[test]
fn a_disc_of_a_thousand_masses_rests_on_light_ones() {
    let run = after(&column(4, 1000f64.sqrt()), 3000);
    let grains = run.grains();
    let mut carried: f64 = grains.masses.iter().sum();
    let mut impulses = run.contacts().impulses().iter();
    let of_pairs = run.contacts().contacts().iter().zip(impulses.by_ref());
    let mut forces: Vec<f64> = of_pairs.map(|(_, impulse)| impulse.normal / 1e-3).collect();
    forces.sort_by(|one, other| other.total_cmp(one));
    assert_eq!(forces.len(), 5);
    for (force, mass) in forces.iter().zip(&grains.masses) {
        assert_close(*force / G, carried, 1e-2, "what a contact carries");
        carried -= mass;
    }
    let fastest = grains.velocities.iter().map(|velocity| velocity.length()).fold(0.0, f64::max);
    assert!(fastest < 0.1 * G * 1e-3, "a tenth of what gravity does in a step: {fastest:e} m/s");
}

#[test]
fn a_pair_that_meets_stays_together_and_keeps_its_momentum_as_far_as_iterations_get() {
    for physics in [LINE, SMOOTH, Physics::FULL] {
        let mut run = start(&by(Stepper::Avbd, 0, meeting(physics, 0.5, 1e-3)));
        let (before, carried) = (relative_velocity(&run), momentum(&run));
        take_steps(&mut run, 2);
        assert_eq!(run.observables().contacts, 1, "they met");
        let (after, lost) = (relative_velocity(&run), momentum(&run) - carried);
        assert!(after.length() < 1e-2 * before.length(), "{after} is left of {before}");
        assert!(lost.length() < 1e-2 * carried.length(), "{lost} of {carried} is lost");
    }
}

/// Returns the change of kinetic energy in a step that the works of gravity and contacts do not explain, J. `before` is
/// the kinetic energy before the step, J.
fn unexplained(before: f64, after: &Observables) -> f64 {
    let works = after.gravity_work + after.normal_work + after.tangential_work;
    (after.kinetic_energy - before - works).abs()
}

#[test]
fn the_energy_that_iterations_leave_unexplained_goes_as_a_column_comes_to_rest() {
    let mut run = start(&column(9, 1.0));
    let mut left = Vec::new();
    for _ in 0..2000 {
        let before = run.observables().kinetic_energy;
        let after = run.step().expect("a finite state");
        assert!(after.residual.is_finite(), "{after:?}");
        left.push(unexplained(before, after));
    }
    let (first, last) = (left[..10].iter().copied().fold(0.0, f64::max), left[1999]);
    assert!(first > 1e-9, "ten iterations do not solve ten discs: {first:e} J");
    assert!(last < 1e-6 * first, "{last:e} J of {first:e} J");
}

#[test]
fn a_disc_sticks_below_the_friction_angle_and_slides_above() {
    let mu = 0.5;
    for (slope, sticks) in [(0.98 * mu, true), (0.7, false)] {
        let down = DVec2::new(slope, -1.0).normalize();
        let disc = Grain::at_rest(DVec2::new(0.0, 0.1), 0.1);
        let mut pile = scene(UNTURNING, G * down, parameters(0.0, 1e-3, 0.0, mu), vec![disc]);
        pile.boundaries = vec![level()];
        let mut run = after(&by(Stepper::Avbd, 0, pile), 200);
        let velocity = run.velocity(0).x;
        take_steps(&mut run, 200);
        let gained = run.velocity(0).x - velocity;
        if sticks {
            assert!(gained.abs() < 1e-6, "it sticks: {gained:e} m/s");
        } else {
            assert_close(gained / 0.2, down.x * G + mu * down.y * G, 2e-3, "how it slides");
        }
    }
}
