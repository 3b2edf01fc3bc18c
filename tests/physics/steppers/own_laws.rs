//! Tests of a contact law that a user adds by `Stage::prepare_within`: here, cohesion that acts up to a finite gap.

use crate::common::*;
use slump::sim::{Advance, Stage, StepResult};
use slump::solver::{Approach, Model};

const RADIUS: f64 = 2.5e-3;
const BOND: f64 = 20.0;
const RANGE: f64 = 0.01 * 2.0 * RADIUS;

struct Wet;

impl Advance for Wet {
    fn advance<M: Model>(&mut self, stage: &mut Stage<'_, M>, settings: &Settings) -> StepResult {
        let time_step_secs = settings.parameters.time_step_secs;
        let rebound = |Approach { gap, .. }| gap.max(0.0) / time_step_secs;
        stage.prepare_within(settings, RANGE, rebound);
        let report = stage.solve(settings);
        stage.move_by(report, settings)
    }
}

/// Kind of the body next to a grain; this body is not a grain and does not move.
#[derive(Clone, Copy, Debug)]
enum Near {
    Disc,
    Wall,
    /// A disc across a border of a periodic cell.
    Image,
}

/// Takes one step with a grain next to a body at rest, from an initial gap (m) and an initial speed away from the body
/// (m/s). Returns the final velocity of the grain away from the body, m/s.
fn after_a_step(near: Near, gap: f64, speed: f64, time_step_secs: f64, physics: Physics) -> f64 {
    const CELL: f64 = 20.0 * RADIUS;
    let (place, away, disc, boundaries, periodic) = match near {
        Near::Disc => (2.0 * RADIUS + gap, 1.0, true, vec![], None),
        Near::Wall => (
            RADIUS + gap,
            1.0,
            false,
            vec![Boundary::HalfSpace { point: DVec2::ZERO, normal: DVec2::X }],
            None,
        ),
        Near::Image => {
            (CELL - 2.0 * RADIUS - gap, -1.0, true, vec![], Some(Periodic::along_x([0.0, CELL])))
        }
    };
    let grain = moving(place * DVec2::X, RADIUS, away * speed * DVec2::X);
    // The Bond number refers to gravity, so gravity exists although the grain does not feel it.
    let grains = vec![Grain { feels_gravity: false, ..grain }];
    let mut run = start(&Scene {
        fixed_discs: disc.then(|| fixed(DVec2::ZERO, RADIUS)).into_iter().collect(),
        boundaries,
        periodic,
        solver: certain(),
        ..scene(physics, G * DVec2::X, range(BOND, time_step_secs), grains)
    });
    run.step_by(&mut Wet).expect("a finite state");
    away * run.velocity(0).x
}

#[test]
fn a_law_that_goes_by_the_gap_pulls_through_the_whole_step_and_no_farther_than_to_touch() {
    let cases = pairs([LINE, SMOOTH, Physics::FULL], [1e-4, 1e-3, 5e-3]);
    for ((physics, time_step_secs), near) in pairs(cases, [Near::Disc, Near::Wall, Near::Image]) {
        let pull = BOND * G * time_step_secs;
        for (gap, speed) in pairs([0.0, 0.3 * RANGE, 0.99 * RANGE], [0.0, 0.5 * pull, 3.0 * pull]) {
            let expected = (speed - pull).max(-gap / time_step_secs);
            let found = after_a_step(near, gap, speed, time_step_secs, physics);
            let off = (found - expected).abs();
            assert!(
                off < 1e-9 * pull,
                "{near:?}, gap {gap}, {speed} m/s, {time_step_secs} s: {found}, not {expected}"
            );
        }
        let beyond = after_a_step(near, 1.01 * RANGE, 0.5 * pull, time_step_secs, physics);
        assert_eq!(beyond, 0.5 * pull, "beyond its range it pulls nothing");
    }
}
