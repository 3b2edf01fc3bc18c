//! Tests of grains that pass through walls or leave the simulated region ("lost" grains): Slump reports them and omits
//! them from the measured slump (the relative drop of the mean height). Grains do not pass through walls if contacts
//! are detected before the grains touch.

use slump::scene::stability::{WALL_DISTANCE, heap, thin_wall};

use crate::common::*;

const RADIUS: f64 = 0.05;

fn world(gravity: f64, grains: Vec<Grain>, boundaries: Vec<Boundary>) -> Scene {
    let parameters = parameters(0.0, 1e-2, 0.0, 0.5);
    Scene { boundaries, ..scene(Physics::FULL, DVec2::new(0.0, -gravity), parameters, grains) }
}

fn is_on_loss(kind: AlarmKind) -> bool {
    [AlarmKind::GrainLost, AlarmKind::GrainLeft].contains(&kind)
}

fn at(x: f64, y: f64) -> DVec2 {
    DVec2::new(x, y)
}

/// Returns the number of grains that have passed through a wall or left the simulated region. Checks that Slump warns
/// if and only if the number is above 0.
#[track_caller]
fn lost(run: &Simulation) -> u32 {
    let lost = run.observables().lost_grains;
    let told = run.alarms().iter().any(|alarm| is_on_loss(alarm.kind));
    assert_eq!(told, lost > 0, "{lost} lost, {:?}", run.alarms());
    lost
}

fn square(side: f64) -> Vec<DVec2> {
    vec![at(-side, -side), at(side, -side), at(side, side), at(-side, side)]
}

#[test]
fn a_grain_that_jumps_through_a_wall_of_any_shape_is_lost() {
    let walls = [
        Boundary::Segment { from: at(0.0, -1.0), to: at(0.0, 1.0) },
        Boundary::Polyline { points: vec![at(0.1, -1.0), at(0.0, 0.0), at(0.1, 1.0)] },
        Boundary::ConvexPolygon { points: square(0.04) },
        Boundary::ConvexPolygon { points: square(0.2) },
        plane(at(0.0, 0.0), at(-1.0, 0.0)),
    ];
    for wall in walls {
        // The grain moves 0.6 m per step, so it is on the other side of the wall before any contact is detected.
        let fast = moving(at(-0.3, 0.0), RADIUS, at(60.0, 0.0));
        let run = after(&world(0.0, vec![fast], vec![wall.clone()]), 1);
        assert!(run.place(0).x > 0.2, "{wall:?} held it");
        assert_eq!(lost(&run), 1, "{wall:?}");
        let slow = moving(at(-0.3, 0.0), RADIUS, at(1.0, 0.0));
        let run = after(&world(0.0, vec![slow], vec![wall.clone()]), 300);
        assert!(run.place(0).x < 0.0, "{wall:?} did not hold it");
        assert_eq!(lost(&run), 0, "{wall:?}");
    }
}

#[test]
fn a_grain_that_goes_around_the_end_of_a_wall_is_not_lost() {
    // The grain rolls over the upper end of a wall, down on the other side, and onto a floor. So it did not pass
    // through the wall.
    let walls = vec![
        Boundary::Segment { from: at(0.0, 0.0), to: at(0.0, 1.0) },
        Boundary::Segment { from: at(-1.0, 0.0), to: at(1.0, 0.0) },
    ];
    let grain = moving(at(-0.004, 1.0 + RADIUS), RADIUS, at(0.1, 0.0));
    let run = after(&world(G, vec![grain], walls), 200);
    let place = run.place(0);
    assert!(place.x > RADIUS && (0.0..1.0).contains(&place.y), "{place}");
    assert_eq!(lost(&run), 0);
}

#[test]
fn what_is_lost_is_in_neither_sum_of_the_slump() {
    let floor = Boundary::Segment { from: at(-1.0, 0.0), to: at(1.0, 0.0) };
    let resting = Grain::at_rest(at(-0.5, RADIUS), RADIUS);
    let fast = moving(at(0.5, 0.3), RADIUS, at(0.0, -60.0));
    let run = after(&world(G, vec![resting, fast], vec![floor]), 100);
    let places = run.places();
    assert!(places[1].y < -1.0 && (places[0].y - RADIUS).abs() < 1e-3, "{places:?}");
    assert_eq!(lost(&run), 1);
    let expected = (RADIUS - places[0].y) / RADIUS;
    assert_eq!(run.observables().slump, expected);
    assert!(expected.abs() < 0.02, "with the fallen one it would be above 1: {expected}");
}

#[test]
fn a_grain_that_falls_off_the_end_of_its_floor_is_lost_soon() {
    let floor = Boundary::Segment { from: at(-1.0, 0.0), to: at(1.0, 0.0) };
    let rolling = moving(at(0.9, RADIUS), RADIUS, at(1.0, 0.0));
    let mut run = start(&world(G, vec![rolling], vec![floor]));
    while run.place(0).y > -0.5 {
        run.step().expect("a finite state");
    }
    assert_eq!(lost(&run), 1);
}

#[test]
fn no_grain_leaves_a_closed_box_at_random_without_being_counted() {
    let mut random = random(13);
    let (mut escaped, mut held) = (0, 0);
    for scene_number in 0..60 {
        let corners = [at(-1.0, -1.0), at(1.0, -1.0), at(1.0, 1.0), at(-1.0, 1.0), at(-1.0, -1.0)];
        let walls = match scene_number % 2 {
            0 => vec![Boundary::Polyline { points: corners.to_vec() }],
            _ => corners
                .windows(2)
                .map(|ends| Boundary::Segment { from: ends[0], to: ends[1] })
                .collect(),
        };
        let speed = 10f64.powf(random.random_range(-1.0..2.0));
        let grains = (0..9)
            .map(|k| {
                let place = at(f64::from(k % 3) - 1.0, f64::from(k / 3) - 1.0) * 0.5;
                let mut component = || speed * random.random_range(-1.0..1.0);
                moving(place, RADIUS, at(component(), component()))
            })
            .collect();
        let mut run = start(&world(G, grains, walls));
        let mut out = [false; 9];
        for _ in 0..50 {
            run.step().expect("a finite state");
            for (out, place) in out.iter_mut().zip(run.places()) {
                *out |= place.abs().max_element() > 1.0 + 0.3 * RADIUS;
            }
        }
        let out = out.iter().filter(|out| **out).count() as u32;
        assert!(lost(&run) >= out, "scene {scene_number}: {out} are out, {} counted", lost(&run));
        if out == 0 {
            held += 1
        } else {
            escaped += 1
        }
        if speed < 0.5 {
            assert_eq!(lost(&run), 0, "scene {scene_number}: nothing is fast enough to get out");
        }
    }
    assert!(escaped > 5 && held > 5, "{escaped} boxes lost grains, {held} did not");
}

const PHASES: u32 = 20;

/// Runs a disc that flies at a thin wall with restitution ρ and moves `travel` diameters per step. Returns the final
/// velocity divided by the initial velocity (negative after a rebound), for 20 different times of the impact within a
/// step. The function `mend` changes the scene before the run, for example its remedies (optional corrections of a
/// step).
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
        // The rebound speeds are evenly spread between 0 and ρ times the initial speed.
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
        let mut fall = under_g(parameters(bond, 5e-3, 0.0, 0.5), grains);
        fall.boundaries = vec![level()];
        fall.remedies.speculative = true;
        let mut run = start(&fall);
        let mut deepest = 0f64;
        for _ in 0..200 {
            deepest = deepest.max(run.step().expect("a finite state").max_overlap);
        }
        assert_eq!(run.observables().contacts, 1, "Bond {bond}");
        // Without contacts detected ahead, the overlap would be up to the distance of one step of the fall, 0.1 d.
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
    let mut scene = under_g(parameters(50.0, 1e-3, 0.0, 0.5), pair);
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
