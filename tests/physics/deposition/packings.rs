//! What holds of every packing, whatever its seed and its sizes.

use crate::common::*;
use proptest::prelude::*;
use rand::SeedableRng;
use rand_pcg::Pcg64;

/// Gap below which discs touch, in d.
const TOUCHING: f64 = 1e-9;

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 60,
        rng_seed: proptest::test_runner::RngSeed::Fixed(15),
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    #[test]
    fn every_disc_is_held_and_overlaps_none(
        seed in any::<u64>(),
        spread in prop_oneof![Just(0.0), 0.0..0.6f64],
        width in prop_oneof![Just(4.0), 1.7..30.0f64],
    ) {
        let mut random = Pcg64::seed_from_u64(seed);
        let radius = |random: &mut Pcg64| 0.5 * random.random_range(1.0 - spread..=1.0 + spread);
        let radii: Vec<f64> = (0..150).map(|_| radius(&mut random)).collect();
        let base = rough_base(width + 4.0, 1.0);
        let discs = drop_and_roll(&radii, &base, 0.5 * width, &mut random);
        prop_assert_eq!(discs.len(), radii.len());
        for (index, disc) in discs.iter().enumerate() {
            prop_assert_eq!(disc.radius, radii[index]);
            let out = disc.position.x.abs() + disc.radius - 0.5 * width;
            prop_assert!(out <= TOUCHING, "disc {} is {:e} d outside", index, out);
            let others = base.iter().chain(&discs[..index]);
            let mut normals: Vec<DVec2> = Vec::new();
            for other in others {
                let apart = disc.position - other.position;
                let gap = apart.length() - disc.radius - other.radius;
                prop_assert!(gap >= -TOUCHING, "disc {} overlaps by {:e} d", index, -gap);
                if gap <= TOUCHING {
                    normals.push(apart.normalize());
                }
            }
            if out >= -TOUCHING {
                normals.push(DVec2::new(-disc.position.x.signum(), 0.0));
            }
            prop_assert!(is_held(&normals), "disc {} lies on {:?}", index, normals);
        }
    }
}

/// Whether forces along two of these directions can bear a weight.
fn is_held(normals: &[DVec2]) -> bool {
    let bear = |one: DVec2, other: DVec2| {
        let across = one.perp_dot(other);
        // a · one + b · other = up.
        let (a, b) = (-other.x / across, one.x / across);
        a >= -1e-9 && b >= -1e-9 && a.is_finite() && b.is_finite()
    };
    let pairs = normals
        .iter()
        .enumerate()
        .flat_map(|(at, &one)| normals[at + 1..].iter().map(move |&other| (one, other)));
    pairs.into_iter().any(|(one, other)| bear(one, other))
}

#[test]
fn what_is_not_held_is_told_from_what_is() {
    let at = |degrees: f64| DVec2::from_angle(degrees.to_radians());
    assert!(is_held(&[at(60.0), at(120.0)]));
    assert!(is_held(&[at(-10.0), at(120.0)]));
    assert!(!is_held(&[at(60.0), at(80.0)]));
    assert!(!is_held(&[at(-10.0), at(200.0)]));
    assert!(!is_held(&[at(60.0)]));
}

#[test]
fn a_packing_does_not_depend_on_what_was_dropped_later() {
    let base = rough_base(12.0, 1.0);
    let dropped = |count: usize| -> Vec<Disc> {
        drop_and_roll(&vec![0.5; count], &base, 4.0, &mut Pcg64::seed_from_u64(3))
    };
    assert_eq!(dropped(40)[..], dropped(90)[..40]);
}
