//! Compares single steps of piles with LMGC90, an independent program, under its law `RST_WET_CLB` with thickness 0.
//! This is the law of the stepper `moreau` with the shifted friction cone (friction bounded by the normal force plus
//! the cohesion force). `tests/lmgc90/README.md` describes how LMGC90 computed the reference velocities.

use crate::common::*;

/// Largest allowed difference between Slump and LMGC90 in a grain's velocity, and in its angular velocity times its
/// radius, m/s. The masses in LMGC90 are 2.8e-8 (relative) too large, because its π has single precision.
const LARGEST_DIFFERENCE: f64 = 1e-8;

/// A disc before a step, and the velocity and angular velocity that LMGC90 computes for the end of the step.
struct Reference {
    before: Grain,
    velocity: DVec2,
    spin: f64,
}

/// Returns the fields of each line of a CSV file in `tests/lmgc90`, without the header.
fn lines(name: &str) -> Vec<Vec<String>> {
    let path = format!("{}/tests/lmgc90/{name}", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(&path).expect(&path);
    text.lines().skip(1).map(|line| line.split(',').map(str::to_owned).collect()).collect()
}

fn number(text: &str) -> f64 {
    text.parse().expect(text)
}

fn references(name: &str) -> Vec<Reference> {
    let reference = |line: Vec<String>| {
        let numbers: Vec<f64> = line.iter().map(|text| number(text)).collect();
        let [x, y, radius, vx, vy, spin, vx_after, vy_after, spin_after] = numbers[..] else {
            panic!("{name}: {line:?}")
        };
        let before = moving(DVec2::new(x, y), radius, DVec2::new(vx, vy));
        Reference {
            before: Grain { angular_velocity: spin, ..before },
            velocity: DVec2::new(vx_after, vy_after),
            spin: spin_after,
        }
    };
    lines(name).into_iter().map(reference).collect()
}

/// Takes the same step as LMGC90, from the same grains, solved as precisely as Gauss–Seidel can solve it.
fn step(references: &[Reference], bond: f64, time_step_secs: f64) -> Simulation {
    let grains = references.iter().map(|reference| reference.before.clone()).collect();
    let scene = pile_of(grains, NewPile::default().box_width_in_diameters).expect("a pile");
    let solver = SolverSettings { max_sweeps: 100_000, ..tight() };
    let law = parameters(bond, time_step_secs, 0.1, 0.5);
    let parameters = Parameters { touch_tolerance: 0.0, ..law };
    let mut run = start(&Scene { parameters, solver, ..scene });
    run.step().expect("a step");
    run
}

#[test]
fn single_steps_of_piles_agree_with_lmgc90() {
    let steps = lines("index.csv");
    assert_eq!(steps.len(), 12);
    for line in steps {
        let [name, bond, time_step_secs, ..] = &line[..] else { panic!("{line:?}") };
        let references = references(name);
        assert_eq!(references.len(), 138, "{name}");
        let time_step_secs = number(time_step_secs);
        let run = step(&references, number(bond), time_step_secs);
        let grains = &run.world().grains;
        let (mut difference, mut change) = (0f64, 0f64);
        for (index, Reference { before, velocity, spin }) in references.iter().enumerate() {
            let spin_difference = (grains.angular_velocities[index] - spin).abs() * before.radius;
            difference = difference.max(grains.velocities[index].distance(*velocity));
            difference = difference.max(spin_difference);
            let fall = before.velocity - G * time_step_secs * DVec2::Y;
            change = change.max(velocity.distance(fall));
        }
        assert!(change > 1e-3, "{name}: contacts change velocities by {change:e} m/s");
        assert!(difference <= LARGEST_DIFFERENCE, "{name}: {difference:e} m/s");
    }
}
