//! Contacts that are looked for ahead of a step: nothing tunnels, and what that costs.

use crate::common::*;
use slump::scene::stability::{WALL_DISTANCE, heap, thin_wall};

const PHASES: u32 = 20;

/// A disc that flies at a thin wall with ρ, `travel` diameters a step. Velocities afterwards over the
/// one before, one a phase; negative where it came back.
fn rebounds(travel: f64, restitution: f64, mend: impl Fn(&mut Scene)) -> Vec<f64> {
    let rebound = |phase| {
        let mut scene = thin_wall(travel, (f64::from(phase) + 0.5) / f64::from(PHASES));
        scene.parameters.restitution = restitution;
        mend(&mut scene);
        let run = after(&scene, ((WALL_DISTANCE + 5.0) / travel) as usize);
        let beyond = run.place(0).x > WALL_DISTANCE * scene.mean_diameter;
        assert!(!beyond, "travel {travel}, phase {phase}: it went through");
        run.velocity(0).x / scene.grains[0].velocity.x
    };
    (0..PHASES).map(rebound).collect()
}

#[test]
fn nothing_goes_through_a_wall_but_the_bounce_is_half_lost() {
    let restitution = 0.8;
    for travel in [0.4, 1.0, 4.0] {
        let ahead = rebounds(travel, restitution, |scene| scene.remedies.speculative = true);
        // What is left of the speed is spread evenly between none and all.
        let mean = ahead.iter().sum::<f64>() / f64::from(PHASES);
        assert!((mean + 0.5 * restitution).abs() < 0.08, "travel {travel}: {mean}");
        let in_pieces = rebounds(travel, restitution, |scene| {
            scene.remedies.max_travel = 0.25;
        });
        for speed in in_pieces {
            assert!((speed + restitution).abs() < 1e-9, "travel {travel}: {speed}");
        }
    }
}

#[test]
fn a_falling_disc_lands_in_touch_and_rests() {
    for bond in [0.0, 5.0] {
        let grain = Grain::at_rest(0.5 * DVec2::Y, 0.05);
        let grains = vec![grain];
        let mut fall =
            scene(Physics::FULL, -G * DVec2::Y, parameters(bond, 5e-3, 0.0, 0.5), grains);
        fall.boundaries = vec![level()];
        fall.remedies.speculative = true;
        let mut run = start(&fall);
        let mut deepest = 0f64;
        for _ in 0..200 {
            deepest = deepest.max(run.step().expect("a finite state").max_overlap);
        }
        assert_eq!(run.observables().contacts, 1, "Bond {bond}");
        // The usual step would bury it by up to a step of its fall, 0.1 d.
        assert!(deepest < 2e-4, "Bond {bond}: {deepest} d");
        assert!(run.velocity(0).length() < 1e-12);
    }
}

#[test]
fn cohesion_does_not_pull_across_a_gap() {
    let pair = vec![
        moving(DVec2::ZERO, 0.05, DVec2::ZERO),
        moving(DVec2::new(0.1 + 1e-3, 0.0), 0.05, DVec2::new(-0.5, 0.0)),
    ];
    let mut scene =
        scene(Physics::FULL, DVec2::new(0.0, -G), parameters(50.0, 1e-3, 0.0, 0.5), pair);
    scene.remedies.speculative = true;
    let mut run = after(&scene, 1);
    assert_eq!((run.observables().contacts, run.observables().tensile_contacts), (0, 0));
    assert_eq!(run.velocity(1).x, -0.5, "half the gap is left");
    take_steps(&mut run, 3);
    assert_eq!(run.observables().contacts, 1);
    let velocities = run.velocities();
    assert!((velocities[0].x - velocities[1].x).abs() < 1e-12, "they stick: {velocities:?}");
}

#[test]
fn a_heap_at_rest_stays_as_it_is() {
    let mut scene = heap(5);
    scene.remedies.speculative = true;
    let run = after(&scene, 300);
    let now = run.places();
    let ways = scene.grains.iter().zip(now).map(|(grain, now)| grain.position.distance(*now));
    let longest = ways.fold(0.0, f64::max) / scene.mean_diameter;
    assert!(longest < 0.01, "{longest} d");
}
