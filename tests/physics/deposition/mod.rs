//! Tests of piles made by dropping discs that roll down until they are supported ("drop and roll"): final positions of
//! single discs, properties of all packings, and settled piles that stay at rest.

use proptest::prelude::*;
use rand::SeedableRng;
use rand_pcg::Pcg64;
use slump::config::{Config, read_scene};

use crate::common::*;
use crate::program::*;

const FLOOR: f64 = -10.0;

/// A test case: name, half the width of the box, discs that already lie in the box (x, y, radius), initial x and radius
/// of the dropped disc, its expected position, and the discs or walls that are expected to support it (`None` if the
/// supports are not checked).
type Drop<'a> =
    (&'a str, f64, &'a [[f64; 3]], [f64; 2], [f64; 2], Option<(Support, Option<Support>)>);

/// Checks where single dropped discs come to rest. Each disc is dropped twice: on the discs of its test case, and,
/// mirrored at x = 0, at the mirrored position on the mirrored discs.
#[test]
fn single_discs_come_to_lie_where_geometry_says() {
    let (floor, between) = ((Support::Floor, None), (Support::Disc(0), Some(Support::Disc(1))));
    let (one, low) = ([[0.0, 0.0, 1.0]], [[0.0, FLOOR + 1.0, 1.0]]);
    let on = |support| Some((Support::Disc(0), Some(support)));
    let cases: [Drop; 10] = [
        ("alone", 50.0, &[], [3.0, 1.5], [3.0, FLOOR + 1.5], Some(floor)),
        (
            "a small one falls from beside one",
            50.0,
            &low,
            [0.5, 0.5],
            [1.5, FLOOR + 0.5],
            Some(floor),
        ),
        (
            "a large one leans",
            50.0,
            &low,
            [0.5, 2.0],
            [8f64.sqrt(), FLOOR + 2.0],
            on(Support::Floor),
        ),
        (
            "between two",
            50.0,
            &[[0.0, 0.0, 1.0], [3.0, 0.0, 1.0]],
            [1.0, 1.0],
            [1.5, (4.0f64 - 2.25).sqrt()],
            Some(between),
        ),
        (
            "between unequal ones",
            50.0,
            &[[0.0, 0.0, 2.0], [4.0, 0.0, 1.0]],
            [1.0, 1.0],
            [2.625, (9.0f64 - 2.625 * 2.625).sqrt()],
            None,
        ),
        // The final position forms a 3-4-5 triangle with the first disc.
        (
            "the second is above the disc that leans on it",
            50.0,
            &[[0.0, 0.0, 2.0], [3.2, 1.85, 0.75]],
            [0.1, 0.5],
            [2.0, 1.5],
            Some(between),
        ),
        (
            "through a gap that leaves it just the room",
            50.0,
            &[[0.0, 0.0, 1.0], [4.0, 0.0, 1.0]],
            [0.5, 1.0],
            [2.0, FLOOR + 1.0],
            None,
        ),
        (
            "on over what lies on the same side",
            50.0,
            &[[0.0, 0.0, 1.0], [1.3, -1.6, 1.0]],
            [0.5, 1.0],
            [3.3, FLOOR + 1.0],
            None,
        ),
        ("against the wall", 2.2, &one, [0.5, 1.0], [1.2, 1.6], on(Support::Wall)),
        // The disc starts at the side of the first disc and passes below the second disc, which must not catch it from
        // above. It leaves the first disc at x = 2 and then the left side of the third disc at x = 0.5.
        (
            "past what hangs over",
            50.0,
            &[[0.0, 0.0, 1.0], [4.5, 1.0, 1.0], [2.5, -5.0, 1.0]],
            [0.5, 1.0],
            [0.5, FLOOR + 1.0],
            None,
        ),
    ];
    for (name, half_width, discs, [x, radius], expected, supports) in cases {
        let rest = |sign: f64| {
            let mut surface = Deposit::new(FLOOR, half_width, 2.0);
            for &[x, y, radius] in discs {
                surface.add(Disc { position: DVec2::new(sign * x, y), radius });
            }
            dropped(&surface, sign * x, radius)
        };
        let (here, mirrored) = (rest(1.0), rest(-1.0));
        assert_eq!(mirrored.centre, DVec2::new(-here.centre.x, here.centre.y), "{name}");
        assert_eq!(mirrored.supports, here.supports, "{name}");
        let off = here.centre.distance(DVec2::from(expected));
        assert!(off < 1e-14, "{name}: {here:?} is not at {expected:?}");
        assert!(supports.is_none_or(|supports| supports == here.supports), "{name}: {here:?}");
    }
}

/// Largest gap at which two discs count as touching, in diameters.
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

/// Returns true if compressive forces along two of these contact normals can carry the weight of a disc.
fn is_held(normals: &[DVec2]) -> bool {
    let bear = |one: DVec2, other: DVec2| {
        let across = one.perp_dot(other);
        // Solves a · one + b · other = up.
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

/// Mean diameter d of the piles, m.
const DIAMETER: f64 = 5e-3;

fn pile(grains: usize, width: f64, seed: u64) -> NewPile {
    let deposition = Deposition::DropAndRoll;
    NewPile { grains, box_width_in_diameters: width, seed, deposition, ..NewPile::default() }
}

fn walled(grains: Vec<Grain>, width: f64) -> Scene {
    let wall = |side: f64| Boundary::HalfSpace {
        point: DVec2::new(0.5 * side * width * DIAMETER, 0.0),
        normal: DVec2::new(-side, 0.0),
    };
    let pile = pile_of(grains, width).expect("a pile");
    Scene { boundaries: vec![wall(-1.0), wall(1.0)], ..pile }
}

/// Returns the kinetic energy of all grains divided by their weight times the mean diameter d (dimensionless).
fn energy(run: &Simulation) -> f64 {
    let mass: f64 = run.grains().masses.iter().sum();
    run.observables().kinetic_energy / (mass * 9.8 * DIAMETER)
}

#[test]
fn a_pile_says_how_much_it_moves_and_overlaps_and_both_are_little() {
    for seed in 0..4 {
        let Settled { grains, kinetic_energy, mean_overlap, max_overlap } =
            deposit(&pile(300, 24.0, seed), |_| true).expect("at rest");
        assert_eq!(grains.len(), 300);
        assert!(kinetic_energy < 1e-6, "seed {seed}: {kinetic_energy:e} m g d");
        assert!(mean_overlap > 0.0 && mean_overlap < 1e-3, "seed {seed}: {mean_overlap:e} d");
        assert!(max_overlap < 1e-2, "seed {seed}: {max_overlap:e} d");
        assert!(grains.iter().all(|grain| grain.velocity == DVec2::ZERO));
    }
}

#[test]
fn a_pile_at_rest_stays_at_rest_under_the_papers_law() {
    for seed in 0..4 {
        let grains = settle(&pile(300, 24.0, seed), |_| true).expect("at rest");
        // Without cohesion, and with Bond 20.
        for bond in [0.0, 20.0] {
            let mut scene = walled(grains.clone(), 24.0);
            scene.parameters.bond = bond;
            scene.parameters.time_step_secs = 2e-4;
            let mut run = start(&scene);
            while run.time_secs() < 0.1 {
                run.step().expect("a step");
            }
            let energy = energy(&run);
            assert!(energy < 1e-6, "Bond {bond}, seed {seed}: {energy:e} m g d");
            let slump = run.observables().slump;
            assert!(slump.abs() < 1e-3, "Bond {bond}, seed {seed}: it sank by {slump:e}");
        }
        // Without the walls the pile moves, so the check above is able to fail.
        let mut released = pile_of(grains, 24.0).expect("a pile");
        released.parameters.bond = 0.0;
        let mut run = start(&released);
        while run.time_secs() < 0.1 {
            run.step().expect("a step");
        }
        assert!(energy(&run) > 1e-3, "seed {seed}: {:e}", energy(&run));
    }
}

#[test]
fn a_pile_is_the_same_to_the_last_bit_on_one_thread_and_on_two() {
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| settle(&pile(400, 25.0, 7), |_| true)).expect("at rest")
    };
    let (one, two) = (on(1), on(2));
    assert!(one == two);
    assert!(one != settle(&pile(400, 25.0, 8), |_| true).expect("at rest"));
}

#[test]
fn piles_of_any_shape_come_to_rest() {
    for (grains, width) in [(1, 16.0), (2, 1.3), (3, 4.0), (60, 1.5), (120, 5.0), (100, 200.0)] {
        let settled = deposit(&pile(grains, width, 5), |_| true);
        let settled = settled.unwrap_or_else(|error| panic!("{grains} in {width} d: {error}"));
        assert!(settled.grains.iter().all(|grain| grain.position.y > 0.0));
    }
}

#[test]
fn what_is_no_pile_is_refused_in_a_sentence() {
    for deposition in [Deposition::DropAndRoll, Deposition::Rain] {
        let of = |grains: usize, width: f64| NewPile { deposition, ..pile(grains, width, 1) };
        let refused = |pile: NewPile| deposit(&pile, |_| true).expect_err("none").to_string();
        assert!(refused(of(0, 16.0)).starts_with("grains is 0, but must be"));
        for width in [0.0, 1.0, -4.0, 1e9, f64::NAN, f64::INFINITY] {
            assert!(refused(of(5, width)).starts_with("box-width is "));
        }
        let interrupted = deposit(&of(50, 16.0), |_| false).expect_err("interrupted");
        assert!(interrupted.to_string().contains("interrupted"));
    }
    let said = |options: &[(&str, &str)]| {
        let config = Config::of_options(options.iter().copied());
        config.and_then(|config| config.scene(|_| true)).expect_err("refused").to_string()
    };
    let unknown = said(&[("deposition", "pour")]);
    assert!(unknown.contains("pour") && unknown.contains("drop-and-roll"), "{unknown}");
    let no_pile = said(&[("deposition", "drop-and-roll"), ("scene", "cradle")]);
    assert!(no_pile.starts_with("scene is cradle, but must be pile"), "{no_pile}");
    let both = said(&[("deposition", "rain"), ("initial", "pile.csv")]);
    assert!(both.contains("deposition") && both.contains("initial"), "{both}");
}

#[test]
fn a_wider_base_changes_no_bit_of_a_pile_that_stays_on_it() {
    let said = |options: &[(&str, &str)]| {
        let config = Config::of_options(options.iter().copied());
        config.and_then(|config| config.scene(|_| true))
    };
    let run = |scene: &Scene| {
        let simulation = after(scene, 50);
        simulation.grains().positions.clone()
    };
    let (own, wide) = (said(&[]).expect("a pile"), said(&[("base-width", "500")]).expect("a pile"));
    let ends = [&own, &wide].map(|scene| scene.fixed_discs[0].position.x / scene.mean_diameter);
    assert!(ends[0] > -100.0 && ends[1] == -250.0, "the situation: {ends:?}");
    assert_eq!(run(&own), run(&wide));
    for (width, allowed) in [("0", "1 to 100000"), ("inf", "1 to 100000"), ("-3", "1 to 100000")] {
        let refused = said(&[("base-width", width)]).expect_err("refused").to_string();
        assert!(refused.starts_with("base-width is ") && refused.contains(allowed), "{refused}");
    }
    let no_pile =
        said(&[("base-width", "9"), ("scene", "cradle")]).expect_err("refused").to_string();
    assert_eq!(no_pile, "scene is cradle, but must be pile where base-width is given");
}

#[test]
fn options_and_scene_files_ask_for_the_same_pile() {
    let options =
        [("grains", "40"), ("box-width", "9"), ("seed", "2"), ("deposition", "drop-and-roll")];
    let asked = Config::of_options(options).and_then(|config| config.scene(|_| true));
    let asked = asked.expect("a scene");
    let scene = Scene { grains: Vec::new(), ..asked.clone() };
    let text = slump::config::scene_to_toml(&scene).expect("TOML");
    let (head, arrays) = text.split_at(text.find("[[").expect("the base"));
    let source =
        "[source]\nfrom = \"new-pile\"\ngrains = 40\nbox_width_in_diameters = 9.0\nseed = 2\n";
    let folder = folder();
    let path = folder.path().join("scene.toml");
    let read = |source: &str| {
        write(&path, format!("{head}\n{source}\n{arrays}"));
        read_scene(&path).map(|scene| scene.grains)
    };
    let dropped = read(&format!("{source}deposition = \"drop-and-roll\"\n")).expect("a scene");
    assert!(dropped == asked.grains);
    // Older files have no option `deposition` and name the pile `rain`. They must still be read.
    let rained = read(&source.replace("new-pile", "rain")).expect("a scene");
    assert_eq!(rained, read(source).expect("a scene"));
    assert!(rained != dropped);
    assert!(read(&format!("{source}deposition = \"pour\"\n")).is_err());
}
