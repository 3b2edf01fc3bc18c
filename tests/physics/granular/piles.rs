//! Tests of measured quantities of simulated piles: they must agree with the balance of forces.

use std::path::Path;

use crate::common::*;
use slump::config::read_scene;

use super::packings::box_walls;

const RADIUS: f64 = 0.1;

/// Returns the measured sum Σ f ⊗ ℓ of contact forces f times branch vectors ℓ (between the centres; components xx, xy,
/// yx, yy), J.
fn virial(pile: &PileMeasures) -> [f64; 4] {
    [pile.stress_xx, pile.stress_xy, pile.stress_yx, pile.stress_yy]
        .map(|stress| stress * pile.area)
}

/// Returns the sum Σ f ⊗ ℓ of contact forces f times branch vectors ℓ (components xx, xy, yx, yy), J, computed from
/// external forces. If `force` returns the total contact force on each grain, the sum is this force times the position
/// of the grain, minus the contact forces on bodies that are not grains times the contact points.
fn virial_from_outside(
    moment: &Moment,
    before: &Moment,
    force: impl Fn(usize) -> DVec2,
) -> [f64; 4] {
    let mut sums = [0.0; 4];
    let mut add = |force: DVec2, place: DVec2| {
        let dyad = [force.x * place.x, force.x * place.y, force.y * place.x, force.y * place.y];
        sums.iter_mut().zip(dyad).for_each(|(sum, part)| *sum += part);
    };
    for (index, grain) in before.grains.iter().enumerate() {
        add(force(index), grain.position);
    }
    for contact in &moment.contacts {
        if !matches!(contact.other, OtherBody::Grain(_)) {
            let grain = before.grains[contact.grain as usize];
            let touched = grain.position - (grain.radius + contact.gap) * contact.normal;
            add(-contact.force, touched);
        }
    }
    sums
}

#[track_caller]
fn assert_same(found: [f64; 4], expected: [f64; 4], tolerance: f64) {
    let scale = expected.iter().map(|part| part.abs()).fold(0.0, f64::max);
    for (found, expected) in found.into_iter().zip(expected) {
        let off = (found - expected).abs() / scale;
        assert!(off < tolerance, "{found} instead of {expected}, off by {off:e} of the largest");
    }
}

fn weight(moment: &Moment, index: usize, gravity: &Gravity) -> DVec2 {
    let grain = moment.grains[index];
    let acts = if grain.feels_gravity { grain.mass } else { 0.0 };
    acts * gravity.acceleration(grain.position)
}

/// Runs a scene and checks that its stress agrees with the momentum that the grains gained in the last step.
fn assert_balance_of_momentum(mut run: Simulation, steps: usize) {
    take_steps(&mut run, steps);
    let before = run.moment();
    take_steps(&mut run, 1);
    let moment = run.moment();
    let gravity = run.world().gravity;
    let secs = moment.observables.time_step_secs;
    let force = |index: usize| {
        let (was, is) = (before.grains[index], moment.grains[index]);
        (is.velocity - was.velocity) * is.mass / secs - weight(&before, index, &gravity)
    };
    let expected = virial_from_outside(&moment, &before, force);
    assert!(moment.contacts.iter().any(|contact| contact.tangential_force != 0.0));
    assert_same(virial(&PileMeasures::of(&moment)), expected, 1e-9);
}

#[test]
fn stress_of_a_pile_in_motion_is_what_the_change_of_momentum_says() {
    for bond in [0.0, 50.0] {
        let mut scene = built_in("pile").expect("the pile");
        scene.parameters.bond = bond;
        scene.parameters.time_step_secs = 5e-4;
        assert_balance_of_momentum(start(&scene), 60);
    }
}

#[test]
fn walls_of_all_shapes_take_their_part_of_the_stress() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/scenes/hourglass.toml");
    let mut scene = read_scene(&file).expect("the hourglass");
    scene.parameters.time_step_secs = 1e-3;
    assert_balance_of_momentum(start(&scene), 150);
}

#[test]
fn stress_of_a_pile_at_rest_is_what_its_weight_says() {
    let mut scene = built_in("pile").expect("the pile");
    // Adds the walls of the box in which the pile was made, so that nothing moves.
    let half_width = 8.0 * scene.mean_diameter;
    let walls = box_walls(DVec2::new(-half_width, -1.0), DVec2::new(half_width, 1.0));
    scene.boundaries.extend(walls);
    scene.parameters.restitution = 0.0;
    scene.parameters.time_step_secs = 1e-4;
    scene.solver.method = Method::Newton;
    scene.solver.tolerance = 1e-10;
    let run = after(&scene, 200);
    let moment = run.moment();
    let gravity = run.world().gravity;
    let expected = virial_from_outside(&moment, &moment, |index| -weight(&moment, index, &gravity));
    let pile = PileMeasures::of(&moment);
    assert!(pile.kinetic_pressure < 1e-6 * pile.pressure, "{pile:?}");
    assert_same(virial(&pile), expected, 1e-3);
    assert!(pile.sliding_share < 0.2 && pile.coordination > 3.0, "{pile:?}");
}

/// Returns a scene with these grains and boundaries in which touching discs still touch if rounding opens their gaps
/// slightly.
fn at_rest(physics: Physics, grains: Vec<Grain>, boundaries: Vec<Boundary>) -> Scene {
    let gravity = DVec2::new(0.0, -G);
    Scene {
        gap_tolerance: 1e-9 * RADIUS,
        boundaries,
        ..scene(physics, gravity, parameters(0.0, 1e-3, 0.0, 0.0), grains)
    }
}

#[test]
fn stress_in_a_column_grows_with_depth() {
    let count = 12;
    let grains = (0..count)
        .map(|k| Grain::at_rest(DVec2::new(0.0, (2.0 * f64::from(k) + 1.0) * RADIUS), RADIUS));
    let floor = level();
    let run = after(&at_rest(SMOOTH, grains.collect(), vec![floor]), 1);
    let measured = measure(&run.moment());
    // The stress is ρ g h at the depth h, in a column with the width of one disc (ρ: mean density).
    let weight_by_area = std::f64::consts::PI / 4.0 * G;
    for (k, grain) in (0..count).zip(&measured.grains) {
        let depth = (2.0 * f64::from(count - k) - 1.0) * RADIUS;
        assert_close(grain.stress_yy, weight_by_area * depth, 1e-7, "σ_yy at a depth");
        assert!(grain.stress_xx.abs() < 1e-9 && grain.stress_xy.abs() < 1e-9);
    }
    let height = 2.0 * RADIUS * f64::from(count);
    assert_close(measured.pile.stress_yy, 0.5 * weight_by_area * height, 1e-7, "the mean σ_yy");
    assert_eq!(measured.pile.principal_direction, 90.0);
    assert_close(measured.pile.fabric_yy, 1.0, 1e-12, "F_yy");
    assert_close(measured.pile.normal_force_second_moment, 2.0 * 25.0 / 39.0, 1e-6, "⟨f²⟩");
    // The top disc has a single contact, so it is a rattler. Without it, the next disc has a single contact, and so on.
    assert_eq!(measured.pile.rattlers, count);
}

/// Returns a scene with rows of discs between two walls, in turn with `columns` and with `columns` − 1 discs, and the
/// row number of each disc. Only the top row has weight.
fn under_a_lid(columns: usize, rows: usize) -> (Scene, Vec<usize>) {
    let (mut grains, mut row_of) = (Vec::new(), Vec::new());
    for row in 0..rows {
        for column in 0..columns - row % 2 {
            let x = (2 * column + 1 + row % 2) as f64;
            let y = 1.0 + row as f64 * 3f64.sqrt();
            let grain = Grain::at_rest(RADIUS * DVec2::new(x, y), RADIUS);
            grains.push(Grain { feels_gravity: row + 1 == rows, ..grain });
            row_of.push(row);
        }
    }
    let width = 2.0 * RADIUS * columns as f64;
    let mut walls = box_walls(DVec2::ZERO, DVec2::new(width, 1.0));
    walls.pop();
    (at_rest(SMOOTH, grains, walls), row_of)
}

#[test]
fn a_force_on_a_packing_between_walls_goes_through_each_of_its_rows() {
    let (columns, rows) = (6, 7);
    let (scene, row_of) = under_a_lid(columns, rows);
    let run = after(&scene, 1);
    let moment = run.moment();
    let force: f64 =
        moment.grains.iter().filter(|grain| grain.feels_gravity).map(|grain| grain.mass * G).sum();
    let grains = GrainMeasures::of_each(&moment);
    for row in 1..rows - 1 {
        let of_row = || grains.iter().zip(&row_of).filter(|&(_, &other)| other == row);
        let pushed: f64 = of_row().map(|(grain, _)| grain.cell_area * grain.stress_yy).sum();
        // The stress is σ = F/L on the width L, and the strip of a row has the area L · √3 r.
        assert_close(pushed, force * 3f64.sqrt() * RADIUS, 1e-7, "σ_yy of a row");
    }
    let pile = PileMeasures::of(&moment);
    let height = moment.grains.last().expect("a grain").position.y;
    assert_close(pile.stress_yy, force * height / pile.area, 1e-7, "σ_yy");
    // Both walls carry the same force, which gives σ_xx over the width between them.
    let on_wall = |wall: u32| -> f64 {
        let on =
            moment.contacts.iter().filter(|contact| contact.other == OtherBody::Boundary(wall));
        on.map(|contact| contact.normal_force).sum()
    };
    assert_close(on_wall(0), on_wall(1), 1e-7, "forces on the walls");
    let width = 2.0 * RADIUS * columns as f64;
    assert_close(pile.stress_xx, on_wall(0) * width / pile.area, 1e-7, "σ_xx");
    assert!(on_wall(0) > 0.1 * force, "{} of {force}", on_wall(0));
    assert_eq!((pile.rattlers, pile.clusters), (0, 1));
}

#[test]
fn motion_carries_momentum_of_its_own() {
    let run = after(
        &at_rest(
            SMOOTH,
            [-1.0, 1.0].map(|side| Grain::at_rest(DVec2::new(0.5 * side, 1.0), RADIUS)).into(),
            Vec::new(),
        ),
        3,
    );
    let mut moment = run.moment();
    // The grains fall side by side at the same velocity, which is not a pressure.
    let pile = PileMeasures::of(&moment);
    assert!(moment.grains[0].velocity.y < 0.0 && pile.kinetic_pressure == 0.0, "{pile:?}");
    for (grain, speed) in moment.grains.iter_mut().zip([3.0, -1.0]) {
        grain.velocity.x = speed;
    }
    let pile = PileMeasures::of(&moment);
    let mass = moment.grains[0].mass;
    // Both grains move at 2 m/s relative to the mean velocity.
    assert_close(
        pile.kinetic_pressure,
        2.0 * mass * 4.0 / (2.0 * pile.area),
        1e-12,
        "kinetic part",
    );
    assert_eq!(pile.pressure, 0.0);
}
