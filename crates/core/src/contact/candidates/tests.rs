use super::*;
use crate::world::{Grain, Grains, Gravity};

/// Discs in rows, three radii from centre to centre, of radii that are given in turn.
fn rows(count: usize, radii: &[f64], mean_diameter: f64) -> World {
    let largest = radii.iter().copied().fold(0.0, f64::max);
    let columns = (count as f64).sqrt() as usize;
    let grain = |k: usize| {
        let place = DVec2::new((k % columns) as f64, (k / columns) as f64);
        Grain::at_rest(3.0 * largest * place, radii[k % radii.len()])
    };
    World {
        grains: Grains::new(&(0..count).map(grain).collect::<Vec<_>>(), 1.0),
        fixed_discs: Vec::new(),
        boundaries: Vec::new(),
        motions: Vec::new(),
        gravity_turn: None,
        periodic: None,
        gravity: Gravity::Uniform { acceleration: DVec2::ZERO },
        mean_diameter,
    }
}

fn of(world: &World) -> Candidates {
    let reach = Reach { skin: 0.2 * world.mean_diameter, gap_tolerance: 0.0 };
    Candidates::new(world, reach).expect("no boundaries")
}

#[test]
fn one_grain_that_looks_far_ahead_makes_candidates_of_its_own_pairs_alone() {
    let count = 4_000;
    let world = rows(count, &[1.0], 2.0);
    let mut candidates = of(&world);
    assert!(candidates.update::<2>(&world));
    let at_rest = candidates.others.len();
    let fast = 777;
    // It sees all others, and nothing else becomes a candidate.
    let way = |grain: usize| if grain == fast { 1e3 } else { 0.0 };
    assert!(candidates.update_ahead::<2>(&world, way, 0.0));
    assert_eq!(candidates.others.len(), at_rest + count - 1);
    assert!(!candidates.update_ahead::<2>(&world, way, 0.0), "good for another step");
    let farther = |grain: usize| if grain == fast { 3e3 } else { 0.0 };
    assert!(candidates.update_ahead::<2>(&world, farther, 0.0));
    assert!(!candidates.update::<2>(&world), "what looks ahead sees what touches");
}

#[test]
fn small_discs_have_few_candidates_whatever_lengths_are_measured_in() {
    for mean_diameter in [1.0, 100.0, 1e6] {
        let count = 4_000;
        let world = rows(count, &[0.5, 0.45, 0.4], mean_diameter);
        let mut candidates = of(&world);
        candidates.update::<2>(&world);
        assert!(candidates.others.len() < 24 * count, "{}", candidates.others.len());
    }
    // Next to one that is as large as all of them.
    let count = 4_000;
    let mut world = rows(count, &[1e-3], 1.0);
    let large = Grain::at_rest(DVec2::new(-2.0, 0.0), 2.0);
    let mut grains: Vec<Grain> =
        world.grains.positions.iter().map(|&place| Grain::at_rest(place, 1e-3)).collect();
    grains.push(large);
    world.grains = Grains::new(&grains, 1.0);
    let mut candidates = of(&world);
    candidates.update::<2>(&world);
    assert!(candidates.others.len() < 24 * count, "{}", candidates.others.len());
}
