//! Tests of distributions of grain diameters: moments, sieve tables, error messages, and piles that come to rest.

use slump::config::{Config, read_scene};
use slump::scene::{Deposition, NewPile, Sizes, settle, start_of};

use crate::program::*;

const DIAMETER: f64 = 5e-3;
/// Largest allowed deviation of the moment of a sample of diameters from the exact moment, in standard errors. With a
/// correct program and random seeds, one of the 30 comparisons would fail in one of 5,000 test runs.
const ERRORS: f64 = 4.5;
const COUNT: usize = 20_000;
/// Hash of a pile made by the deposition `rain` (all grains fall together) in a version before the option `sizes`
/// existed; the default sizes must still give this pile.
const RAIN: u64 = 0x539b_adf8_4444_897f;
/// Hash of a pile made by the deposition `drop-and-roll` (grains are placed one by one and roll until two others hold
/// them) in a version before the option `sizes` existed; the default sizes must still give this pile.
const ROLL: u64 = 0x6c11_af30_2490_f32f;

fn sizes(text: &str) -> Sizes {
    text.parse().expect("sizes")
}

fn pile(text: &str, seed: u64) -> NewPile {
    NewPile {
        grains: COUNT,
        box_width_in_diameters: 400.0,
        seed,
        sizes: sizes(text),
        ..NewPile::default()
    }
}

/// Returns the diameters of the grains in a new pile, in mean diameters d.
fn diameters(pile: &NewPile) -> Vec<f64> {
    start_of(pile).iter().map(|grain| 2.0 * grain.radius / DIAMETER).collect()
}

/// Returns the integral of the function `value` between two bounds, by the midpoint rule with 20,000 intervals.
fn integral(from: f64, to: f64, value: impl Fn(f64) -> f64) -> f64 {
    let step = (to - from) / 20_000.0;
    (0..20_000).map(|k| step * value(from + (f64::from(k) + 0.5) * step)).sum()
}

/// Returns the moments 1 to 4 of a distribution of diameters, each divided by the same power of the mean. Each diameter
/// is a function of a random variable, which has the given probability density between two bounds.
fn moments(
    bounds: [f64; 2],
    density: impl Fn(f64) -> f64,
    diameter: impl Fn(f64) -> f64,
) -> [f64; 4] {
    let [from, to] = bounds;
    let total = integral(from, to, &density);
    let moment = |power: i32| integral(from, to, |x| density(x) * diameter(x).powi(power)) / total;
    let mean = moment(1);
    [1, 2, 3, 4].map(|power| moment(power) / mean.powi(power))
}

#[test]
fn diameters_have_the_moments_of_their_distribution_and_the_mean_d() {
    let normal = |x: f64| (-0.5 * x * x).exp();
    let two = |power: i32| (0.7 + 0.3 * 1.4f64.powi(power)) / (0.7 + 0.3 * 1.4f64).powi(power);
    // The mass fractions are 0.3 between the diameters 1 and 2, and 0.7 between 2 and 4. The number of grains is mass
    // over D².
    let graded = |size: f64| if size < 2.0 { 0.3 / size.powi(2) } else { 0.35 / size.powi(2) };
    let cases = [
        ("uniform:0.2", moments([0.8, 1.2], |_| 1.0, |x| x)),
        ("normal:0.3", moments([-2.5, 2.5], normal, |x| 1.0 + 0.3 * x)),
        ("lognormal:0.5", moments([-2.5, 2.5], normal, |x| (0.5 * x).exp())),
        ("bidisperse:1.4,0.3", [1, 2, 3, 4].map(two)),
        ("sieves:1=0,2=0.3,4=1", moments([1.0, 4.0], graded, |x| x)),
    ];
    for (text, exact) in cases {
        for seed in 1..=3 {
            let drawn = diameters(&pile(text, seed));
            for power in [1, 2] {
                let mean = drawn.iter().map(|size| size.powi(power)).sum::<f64>() / COUNT as f64;
                let power = power as usize;
                let variance = exact[2 * power - 1] - exact[power - 1].powi(2);
                let error = (variance / COUNT as f64).sqrt();
                let off = (mean - exact[power - 1]) / error;
                assert!(off.abs() < ERRORS, "{text}, seed {seed}, moment {power}: {off}");
            }
        }
    }
}

#[test]
fn a_table_of_sieves_reproduces_its_mass_fractions() {
    let table = [(0.5, 0.0), (0.8, 0.15), (1.0, 0.15), (1.6, 0.7), (3.0, 1.0)];
    let rows: Vec<_> = table.iter().map(|(size, passes)| format!("{size}={passes}")).collect();
    let text = format!("sieves:{}", rows.join(","));
    for seed in 1..=4 {
        let drawn = diameters(&pile(&text, seed));
        // The unit of the sieve table is arbitrary. The diameters are scaled so that the mean is d.
        let number =
            |[low, high]: [f64; 2], power: f64| (high.powf(power) - low.powf(power)) / power;
        let rate = |power: f64| {
            let of_class = |pair: &[(f64, f64)]| {
                let [(low, passes), (high, more)] = [pair[0], pair[1]];
                (more - passes) / (high - low) * integral(low, high, |size| size.powf(power))
            };
            table.windows(2).map(of_class).sum::<f64>()
        };
        assert!((number([1.0, 2.0], 1.0) - 1.0).abs() < 1e-12);
        let unit = rate(-1.0) / rate(-2.0);
        let mass: f64 = drawn.iter().map(|size| size * size).sum();
        for (size, passes) in table {
            let is_below = |drawn: &f64| *drawn * unit <= size;
            let below: f64 =
                drawn.iter().filter(|size| is_below(size)).map(|size| size * size).sum();
            // Standard error of a ratio of sums, by first-order propagation of the residuals.
            let residual = |drawn: &f64| {
                let mass = drawn * drawn;
                (if is_below(drawn) { mass } else { 0.0 }) - passes * mass
            };
            let squares: f64 = drawn.iter().map(|size| residual(size).powi(2)).sum();
            let error = squares.sqrt() / mass;
            let off = below / mass - passes;
            // Of these 12 comparisons, one fails in one of 12,000 random test runs with a correct program. At both ends
            // of the table the mass fraction is exact.
            assert!(
                off.abs() <= ERRORS * error + 1e-12,
                "seed {seed}: {off} of {passes} at {size}"
            );
        }
        let within = |size: &f64| (0.5 - 1e-9..=3.0 + 1e-9).contains(&(size * unit));
        assert!(drawn.iter().all(within));
        assert!(!drawn.iter().any(|size| (0.8 + 1e-9..1.0 - 1e-9).contains(&(size * unit))));
    }
}

#[test]
fn sizes_that_are_not_given_are_those_of_earlier_versions_bit_for_bit() {
    for (deposition, expected) in [(Deposition::Rain, RAIN), (Deposition::DropAndRoll, ROLL)] {
        let pile = NewPile {
            grains: 40,
            box_width_in_diameters: 9.0,
            seed: 2,
            deposition,
            ..NewPile::default()
        };
        let bits = |pile: &NewPile| {
            settle(pile, |_| true).expect("at rest").iter().fold(0u64, |sum, grain| {
                let numbers = [grain.position.x, grain.position.y, grain.radius];
                numbers.iter().fold(sum, |sum, it| sum.rotate_left(7) ^ it.to_bits())
            })
        };
        assert_eq!(bits(&pile), expected);
        let said = NewPile { sizes: sizes("uniform:0.2"), ..pile.clone() };
        assert_eq!(said, pile);
    }
}

#[test]
fn piles_of_all_sizes_come_to_rest_and_are_named_alike_by_options_and_files() {
    for text in
        ["uniform:0", "normal:0.3", "lognormal:0.5", "bidisperse:3,0.2", "sieves:1=0,2=0.4,8=1"]
    {
        for deposition in [Deposition::Rain, Deposition::DropAndRoll] {
            let options = [
                ("grains", "40"),
                ("box-width", "9"),
                ("seed", "2"),
                ("sizes", text),
                ("deposition", deposition.name()),
            ];
            let config = Config::of_options(options).expect("options");
            let pile = config.new_pile().expect("a pile").expect("a pile");
            assert_eq!(
                pile,
                NewPile {
                    grains: 40,
                    box_width_in_diameters: 9.0,
                    seed: 2,
                    deposition,
                    sizes: sizes(text)
                }
            );
            let grains = settle(&pile, |_| true).unwrap_or_else(|error| panic!("{text}: {error}"));
            assert_eq!(grains.len(), 40);
            let written = serde_json::to_string(&pile).expect("JSON");
            assert_eq!(serde_json::from_str::<NewPile>(&written).expect("a pile"), pile);
        }
    }
    let folder = folder();
    let path = folder.path().join("scene.toml");
    let scene = slump::scene::built_in("pile").expect("a scene");
    let scene = slump::scene::Scene { grains: Vec::new(), ..scene };
    let text = slump::config::scene_to_toml(&scene).expect("TOML");
    let (head, arrays) = text.split_at(text.find("[[").expect("the base"));
    let source =
        "[source]\nfrom = \"new-pile\"\ngrains = 12\nbox_width_in_diameters = 5.0\nseed = 2\n";
    let read = |sizes: &str| {
        write(&path, format!("{head}\n{source}{sizes}\n{arrays}"));
        read_scene(&path)
    };
    let one_size = read("sizes = \"uniform:0\"").expect("a scene");
    assert!(one_size.grains.iter().all(|grain| grain.radius == 0.5 * DIAMETER));
    let refused = read("sizes = \"normal:0.5\"").expect_err("refused").to_string();
    assert!(
        refused.contains("sizes is normal:0.5, but must be uniform:S (0 ≤ S ≤ 0.8), "),
        "{refused}"
    );
}

#[test]
fn sizes_outside_their_ranges_are_refused_by_name() {
    for text in [
        "",
        "uniform",
        "uniform:",
        "uniform:-0.1",
        "uniform:0.9",
        "uniform:nan",
        "normal:0",
        "normal:0.31",
        "lognormal:0.6",
        "lognormal:inf",
        "gauss:0.1",
        "bidisperse:1.4",
        "bidisperse:1,0.5",
        "bidisperse:6,0.5",
        "bidisperse:1.4,0",
        "bidisperse:1.4,1",
        "sieves:",
        "sieves:1=0",
        "sieves:1=0,2=0.9",
        "sieves:1=0.1,2=1",
        "sieves:2=0,1=1",
        "sieves:1=0,2=0.6,3=0.5,4=1",
        "sieves:0=0,2=1",
        "sieves:1=0,21=1",
        "sieves:1=0,nan=0.5,2=1",
    ] {
        let refused = Config::of_options([("sizes", text)]).expect_err(text).to_string();
        assert!(
            refused.starts_with(&format!("--sizes is {text}"))
                && refused.contains("lognormal:S (0 < S ≤ 0.5)"),
            "{refused}"
        );
    }
    // Large grains need a wider box.
    let narrow =
        NewPile { box_width_in_diameters: 1.8, sizes: sizes("uniform:0.8"), ..NewPile::default() };
    let refused = settle(&narrow, |_| true).expect_err("refused").to_string();
    assert_eq!(refused, "box-width is 1.8, but must be between 1.9 and 1e6 diameters");
    let both =
        Config::of_options([("sizes", "uniform:0"), ("initial", "pile.csv")]).expect_err("refused");
    assert!(both.to_string().contains("sizes") && both.to_string().contains("initial"), "{both}");
}
