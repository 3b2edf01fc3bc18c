//! The interior point solves every step of a convex model, and a duality gap says so that anybody can check.

use crate::common::*;
use proptest::prelude::*;

use super::piles::CONVEX;
use crate::common::natural_map::judge;

fn by_interior_point(model: FrictionModel, tolerance: f64) -> SolverSettings {
    SolverSettings { friction_model: model, ..solved_by(Method::InteriorPoint, tolerance) }
}

fn falling(model: FrictionModel, bond: f64, time_step_secs: f64, restitution: f64) -> Simulation {
    let mut scene = built_in("pile").expect("a scene");
    scene.parameters.bond = bond;
    scene.parameters.time_step_secs = time_step_secs;
    scene.parameters.restitution = restitution;
    scene.solver = by_interior_point(model, 1e-8);
    start(&scene)
}

#[test]
fn every_step_of_a_pile_that_slumps_is_certified() {
    for model in CONVEX {
        for (bond, time_step_secs, restitution) in
            [(0.0, 1e-3, 0.2), (20.0, 1e-3, 0.9), (100.0, 5e-3, 0.2), (0.0, 5e-3, 0.9)]
        {
            let what = format!("{model}, Bond {bond}, dt {time_step_secs}, rho {restitution}");
            let mut run = falling(model, bond, time_step_secs, restitution);
            let mut factorisations = Vec::new();
            for step in 0..60 {
                let row = *run.step().expect("a finite state");
                assert!(row.converged, "{what}, step {step}: {:?}", row.model_residual);
                assert!(row.model_residual.is_some_and(|residual| residual <= 1e-8), "{what}");
                let gap = row.duality_gap.expect("a gap");
                assert!((-1e-14..1e-4).contains(&gap), "{what}, step {step}: {gap:e}");
                factorisations.push(row.factorisations);
            }
            assert!(run.observables().slump > 1e-3, "{what}: it slumps");
            factorisations.sort_unstable();
            let [median, most] = [30, 59].map(|at| factorisations[at]);
            assert!(median <= 20 && most <= 80, "{what}: {median} in the median, {most} at most");
        }
    }
}

/// Σ m (σ(w + 2z) + g|v| + λv) from world data, as `solver::problem::residual` states it, and Σ m (v^free)².
fn gap_of_world(run: &Simulation, pile: &Scene, bounds: &[f64], before: &Simulation) -> [f64; 2] {
    let mut sums = [0.0; 2];
    let friction = pile.parameters.friction;
    let impulses = run.contacts().impulses();
    let judged = judge(run, before.grains());
    for ((contact, impulse), bound) in judged.iter().zip(impulses).zip(bounds) {
        let p = impulse.normal + contact.cohesion_impulse;
        let rebound = pile.parameters.restitution * contact.before[0];
        let (mut w, v) = (contact.after[0] + rebound, contact.after[1]);
        let least = match pile.solver.friction_model {
            FrictionModel::Tresca => 0.0,
            FrictionModel::Desaxce => {
                w += friction * contact.before[1].abs();
                friction * v.abs()
            }
            _ => friction * v.abs(),
        };
        let lacking = (least - w).max(0.0);
        sums[0] += p * (w + 2.0 * lacking) + bound * v.abs() + impulse.tangential * v;
        let free = contact.free[0] + rebound;
        sums[1] +=
            contact.normal_mass * free * free + contact.tangential_mass * contact.free[1].powi(2);
    }
    sums
}

#[test]
fn the_gap_is_what_world_data_make_it() {
    for model in CONVEX {
        let mut pile = pressed_pile(30, 0.3, 11, parameters(2.0, 1e-6, 0.3, 0.5));
        // Far from solved, so that the gap is far above rounding.
        pile.solver = SolverSettings { max_sweeps: 2, ..by_interior_point(model, 1e-8) };
        pile.solver.method = Method::Nsgs;
        let mut run = after(&pile, 3);
        let before = run.clone();
        let row = *run.step().expect("a finite state");
        let pairs = |run: &Simulation| -> Vec<_> {
            run.contacts().contacts().iter().map(|c| (c.grain, c.other)).collect()
        };
        assert_eq!(pairs(&before), pairs(&run), "bounds are those of the same contacts");
        let bound = |(index, impulse): (usize, &Impulse)| {
            let cohesion = judge(&run, before.grains())[index].cohesion_impulse;
            0.5 * (impulse.normal + cohesion).max(0.0)
        };
        let bounds: Vec<f64> = match model {
            FrictionModel::Tresca => {
                before.contacts().impulses().iter().enumerate().map(bound).collect()
            }
            _ => vec![0.0; before.contacts().impulses().len()],
        };
        let [gap, scale] = gap_of_world(&run, &pile, &bounds, &before);
        let told = row.duality_gap.expect("a gap");
        assert!(told > 1e-6, "{model}: {told:e}");
        assert_close(told, gap / scale, 1e-9, &format!("{model}"));
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn the_gap_is_never_negative_and_falls_with_the_tolerance(
        seed in 0u64..1000,
        bond in prop_oneof![Just(0.0), 0.0..50.0],
        restitution in 0.0..1.0,
        // Cones this narrow leave any pile of discs a way to come apart (see below).
        friction in 0.02..0.2,
        model in prop::sample::select(CONVEX.to_vec()),
    ) {
        let mut pile = pressed_pile(40, 0.2, seed, parameters(bond, 1e-3, restitution, friction));
        pile.solver = by_interior_point(model, 1e-9);
        let mut run = start(&pile);
        run.step().expect("a finite state");
        let mut last = f64::INFINITY;
        for tolerance in [1e-2, 1e-5, 1e-8] {
            let mut next = run.clone();
            next.set_solver(by_interior_point(model, tolerance)).expect("proper settings");
            let row = *next.step().expect("a finite state");
            prop_assert!(row.converged, "{row:?} at {tolerance:e}");
            let gap = row.duality_gap.expect("a gap");
            prop_assert!(gap >= -1e-13, "{gap:e}");
            prop_assert!(gap <= last.max(1e-13), "{gap:e} after {last:e}");
            last = gap;
        }
    }
}

/// A disc wedged between two fixed ones, at whose contacts the cones leave it no way out: it would have to leave
/// each at more than the angle whose tangent is μ from its tangent.
#[test]
fn a_step_that_no_velocity_solves_says_so_and_leaves_no_huge_impulses() {
    let radius = 0.1;
    let angle = 75f64.to_radians();
    let disc = |side: f64| Disc {
        position: 2.0 * radius * (1.0 - 1e-9) * DVec2::new(side * angle.sin(), -angle.cos()),
        radius,
    };
    for (model, friction, solved) in [
        (FrictionModel::Associated, 0.9, false),
        (FrictionModel::Associated, 0.2, true),
        (FrictionModel::Tresca, 0.9, true),
    ] {
        let grain = moving(DVec2::ZERO, radius, DVec2::new(0.0, -1.0));
        let mut wedge = Scene {
            fixed_discs: vec![disc(-1.0), disc(1.0)],
            ..scene(UNTURNING, -G * DVec2::Y, parameters(0.0, 1e-3, 0.5, friction), vec![grain])
        };
        wedge.solver = by_interior_point(model, 1e-8);
        let mut run = start(&wedge);
        let row = *run.step().expect("a finite state");
        assert_eq!((row.converged, row.stalled), (solved, !solved), "{model}, mu {friction}");
        let mass = run.grains().masses[0];
        for impulse in run.contacts().impulses() {
            assert!(impulse.normal.abs() < 100.0 * mass, "{model}, mu {friction}: {impulse:?}");
        }
    }
}
