//! Tests of the command `slump calibrate` and of the statistics of its confidence regions.

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use slump::config::Config;
use slump::granular::HeapShape;
use slump::scene::{NewPile, settle};
use slump::study::{Region, mean};

use crate::program::*;

/// Ranges of the two parameters that are calibrated: the friction coefficient μ and the Bond number.
const BOX: [[f64; 2]; 2] = [[0.2, 0.8], [0.0, 50.0]];

/// Returns point `number` (friction coefficient μ, Bond number) of a sequence that fills the ranges evenly: multiples
/// of two irrational numbers, modulo 1.
fn point(number: usize) -> Vec<f64> {
    let share = |ratio: f64| (0.5 + (number + 1) as f64 * ratio).fract();
    let shares = [0.754_877_666_246_693, 0.569_840_290_998_053].map(share);
    BOX.iter().zip(shares).map(|([from, to], share)| from + (to - from) * share).collect()
}

/// Returns a calibration target: the mean of one result over several runs, and its standard error.
fn target(runs: &[Vec<f64>], result: usize) -> [f64; 2] {
    let mean = mean(&runs.iter().map(|run| run[result]).collect::<Vec<_>>());
    [mean.mean, mean.standard_error]
}

/// Returns artificial results of a run, slump and angle: functions of the friction coefficient μ and the Bond number
/// that are not polynomials, plus correlated random errors whose size varies.
fn stand_in(point: &[f64], random: &mut Pcg64) -> Vec<f64> {
    let [friction, bond] = [point[0], point[1]];
    let slump = 0.05 + 0.5 * (-bond / 18.0).exp() * (1.0 - 0.6 * (friction - 0.3));
    let angle = 12.0 + 25.0 * friction + 20.0 * (1.0 - slump);
    // A sum of twelve uniform random numbers is close enough to a normal distribution here.
    let mut normal = || (0..12).map(|_| random.random_range(-0.5..0.5)).sum::<f64>();
    let scatter = 0.3 + 0.7 * (-bond / 30.0).exp();
    let [one, other] = [scatter * normal(), scatter * normal()];
    vec![slump + 0.06 * one, angle - 2.0 * one + 2.0 * other]
}

#[test]
fn a_region_contains_the_true_parameters_in_nine_of_ten_calibrations() {
    let mut random = Pcg64::seed_from_u64(1);
    let (mut contained, mut shares) = (0, Vec::new());
    for _ in 0..200 {
        let truth = BOX.map(|[from, to]| random.random_range(from..to));
        let points: Vec<_> = (0..100).map(point).collect();
        let results: Vec<_> = points.iter().map(|point| stand_in(point, &mut random)).collect();
        let measured: Vec<_> = (0..16).map(|_| stand_in(&truth, &mut random)).collect();
        let targets = [0, 1].map(|result| target(&measured, result));
        let region = Region::new(&BOX, &targets, &points, &results).expect("enough runs");
        contained += u32::from(region.misfit(&truth) <= 1.0);
        shares.push(region.share());
    }
    // If a region contains the true parameters with a probability of exactly 90 %, then 168 to 191 of 200 regions
    // contain them in 99.6 % of tests.
    assert!((168..=191).contains(&contained), "{contained}");
    let share = mean(&shares).mean;
    assert!(share < 0.1, "{share}");
}

#[test]
fn targets_that_no_parameters_give_have_no_region() {
    let mut random = Pcg64::seed_from_u64(2);
    let points: Vec<_> = (0..100).map(point).collect();
    let results: Vec<_> = points.iter().map(|point| stand_in(point, &mut random)).collect();
    let region = |targets: &[[f64; 2]]| Region::new(&BOX, targets, &points, &results);
    let far = region(&[[0.9, 0.01], [30.0, 1.0]]).expect("enough runs");
    assert_eq!(far.share(), 0.0);
    assert!(far.misfit(far.best()) > 1.0);
    // With a single target, the region is a narrow band along which both parameters change.
    let valley = region(&[[0.25, 0.01]]).expect("enough runs");
    assert!((0.03..0.5).contains(&valley.share()), "{}", valley.share());
    assert!(Region::new(&BOX, &[[0.25, 0.01]], &points[..11], &results[..11]).is_none());
}

fn calibrate(out: &Path, more: &[&str]) -> Command {
    let mut command = slump("calibrate");
    command.arg("--out").arg(out);
    command.args(["--grains", "12", "--box-width", "6", "--deposition", "drop-and-roll"]);
    command.args(["--duration", "0.02", "--dt", "2e-3"]).args(more);
    command
}

const ASKED: [&str; 6] = [
    "--target",
    "slump=0.01±0.02",
    "--target",
    "repose_angle=40+-20",
    "--vary",
    "friction=0.3..0.7",
];

#[test]
fn a_calibration_resumes_and_more_runs_add_to_it() {
    let folder = folder();
    let out = folder.path();
    let bond = ["--vary", "bond=0..20"];
    succeed(calibrate(out, &ASKED).args(bond).args(["--runs", "12"]));
    let first = read(out.join("report.md"));
    for part in [
        "At 90 % confidence",
        "| mu | 0.3 | 0.7 |",
        "| slump |  | 0.01 ± 0.02 |",
        "| repose_angle | degree | 40 ± 20 |",
        "degree 2 to 12 of 12 runs",
        "| Δt 1e-3 s |",
        "steps solved by newton",
        "Measurements that would narrow the region",
    ] {
        assert!(first.contains(part), "{part}: {first}");
    }
    let lines = || read(out.join("calibrate.jsonl")).lines().count();
    // 18 runs for the three variants of the method (two changes and none), six for each variant.
    assert_eq!(lines(), 12 + 18);
    succeed(calibrate(out, &ASKED).args(bond).args(["--runs", "12"]));
    assert_eq!(read(out.join("report.md")), first);
    assert_eq!(lines(), 30);
    succeed(calibrate(out, &ASKED).args(bond).args(["--runs", "14"]));
    assert_eq!(lines(), 30 + 2 + 18);
    for name in ["region.png", "region.svg", "region.csv"] {
        assert!(out.join(name).metadata().is_ok_and(|file| file.len() > 100), "{name}");
    }
    succeed(calibrate(&out.join("one"), &ASKED).args(["--runs", "6"]));
    let said = read(out.join("one/report.md"));
    assert!(
        said.contains("of the box of mu") || said.contains("no point of the box of mu"),
        "{said}"
    );
}

#[test]
fn targets_and_parameters_that_are_none_are_refused_before_any_run() {
    let folder = folder();
    let out = folder.path().join("none");
    let bond = ["--vary", "bond=0..20"];
    for (more, said) in [
        (
            &["--target", "slump=0.3", "--vary", "bond=0..20"][..],
            "target is slump=0.3, but must be QUANTITY=VALUE±ERROR",
        ),
        (&["--target", "slump=0.3±0", "--vary", "bond=0..20"], "target is slump=0.3±0,"),
        (
            &["--target", "slumpp=0.3±0.1", "--vary", "bond=0..20"],
            "quantity is slumpp, but must be",
        ),
        (
            &["--target", "slump=0.3±0.1", "--target", "slump=0.2±0.1", "--vary", "bond=0..20"],
            "target is slump twice,",
        ),
        (
            &["--target", "slump=0.3±0.1", "--vary", "bond=20"],
            "vary is bond=20, but must be SETTING=FROM..TO",
        ),
        (&["--target", "slump=0.3±0.1", "--vary", "bond=20..0"], "vary is bond=20..0,"),
        (&["--target", "slump=0.3±0.1", "--vary", "seed=1..9"], "vary is seed=1..9,"),
        (&["--target", "slump=0.3±0.1", "--vary", "glue=1..9"], "--glue is given, but must be"),
        (
            &["--target", "slump=0.3±0.1", "--vary", "mu=0..1", "--vary", "friction=0..2"],
            "vary is mu twice,",
        ),
        (&["--target", "slump=0.3±0.1", "--vary", "mu=-1..1"], "mu is -1, but must be"),
        (
            &["--target", "slump=0.3±0.1", "--vary", "mu=0..1", "--runs", "5"],
            "runs is 5, but must be between 6 and",
        ),
        (
            &[
                "--target=slump=0.3±0.1",
                "--target=kinetic_energy=0±0.1",
                "--target=max_overlap=0±0.1",
                "--target=run_out=1±0.1",
                "--vary=mu=0..1",
                "--runs=6",
            ],
            "runs is 6, but must be between 7 and",
        ),
    ] {
        let refused = sentence(&mut calibrate(&out, more));
        assert!(refused.contains(said), "{refused}");
    }
    let refused = sentence(&mut calibrate(&out, &bond));
    assert!(refused.contains("--target"), "{refused}");
    assert!(!out.exists());
}

#[test]
fn a_heap_has_the_slope_and_the_base_of_its_triangle() {
    let mut scene = slump::scene::built_in("pile").expect("a scene");
    // Small discs that fill a triangle of height 2 and half base 5, with the lowest point at y = 0.
    let mut random = Pcg64::seed_from_u64(3);
    let grain = scene.grains[0].clone();
    scene.grains = (0..4000)
        .map(|_| {
            let [mut x, mut y] = [1.0, 1.0].map(|end| random.random_range(0.0..end));
            if x + y > 1.0 {
                (x, y) = (1.0 - x, 1.0 - y);
            }
            let mut grain = grain.clone();
            grain.radius = 3e-5;
            let side = if random.random_range(0.0..1.0) < 0.5 { -1.0 } else { 1.0 };
            grain.position.x = 3.0 + side * 5.0 * x;
            grain.position.y = 2.0 * y;
            grain
        })
        .collect();
    scene.fixed_discs.clear();
    let shape = HeapShape::of(&scene.simulation().expect("a simulation").moment());
    // The standard errors are 0.2° for the angle of repose and 0.06 for the run-out.
    assert!((shape.repose_angle - 0.4f64.atan().to_degrees()).abs() < 1.0, "{shape:?}");
    assert!((shape.run_out - 5.0).abs() < 0.3, "{shape:?}");
}

/// Command that repeats the calibrations of [`calibrations_of_piles_contain_the_parameters_that_made_their_targets`].
pub const TEST: &str = "cargo test --release --test program calibrations_of_piles -- --ignored";
const GRAINS: usize = 60;
const RUNS: usize = 100;
/// Number of initial states that are simulated for each pair of friction coefficient μ and Bond number, and how many of
/// them each calibration uses.
const STATES: [usize; 2] = [8, 2];
/// Number of initial states that are simulated with the true parameters, and how many of them each calibration uses for
/// its targets.
const TARGET_STATES: [usize; 2] = [200, 50];
/// True parameters, with which the calibration targets are computed: friction coefficient μ and Bond number.
const TRUTH: [f64; 2] = [0.5, 15.0];

/// Runs a small pile with the parameters `point` (friction coefficient μ, Bond number) for half a second. Returns its
/// slump and its angle of repose (degrees).
fn results_of(point: &[f64], seed: u64) -> Vec<f64> {
    let (grains, box_width_in_diameters) = (GRAINS, 10.5);
    let new = NewPile { grains, box_width_in_diameters, seed, ..NewPile::default() };
    let grains = settle(&new, |_| true).expect("at rest");
    let mut config = Config::default();
    config.source.set_new_pile(&new);
    config.source.duration = Some(0.5);
    config.parameters.friction = Some(point[0]);
    config.parameters.bond = Some(point[1]);
    let scene = config.scene_from(grains).expect("a scene");
    let mut simulation = scene.simulation().expect("a simulation");
    simulation.take_steps(scene.parameters.steps_in(scene.duration_secs)).expect("steps");
    vec![simulation.observables().slump, HeapShape::of(&simulation.moment()).repose_angle]
}

/// Draws `count` different random whole numbers below `all`.
fn drawn([all, count]: [usize; 2], random: &mut Pcg64) -> Vec<usize> {
    let mut order: Vec<usize> = (0..all).collect();
    for place in 0..count {
        order.swap(place, random.random_range(place..all));
    }
    order.truncate(count);
    order
}

/// Checks how often the confidence region of a calibration contains the true parameters: at least in 18 of 20
/// calibrations. Each calibrates the friction coefficient μ and the Bond number to the slump and the angle of repose of
/// piles made with [`TRUTH`]. All runs are computed once, and each calibration draws a random quarter of them: of the
/// runs at each pair of μ and Bond, and of the runs with [`TRUTH`]. So two calibrations have on average a quarter of
/// their runs in common. `SLUMP_REPORT=FILE` writes the results to a file.
#[test]
#[ignore = "takes six core minutes"]
fn calibrations_of_piles_contain_the_parameters_that_made_their_targets() {
    use rayon::prelude::*;
    let points: Vec<_> = (0..RUNS).map(point).collect();
    let of_targets = 100_001..100_001 + TARGET_STATES[0] as u64;
    let truths: Vec<_> = of_targets.into_par_iter().map(|seed| results_of(&TRUTH, seed)).collect();
    let numbers = (0..STATES[0] * RUNS).into_par_iter();
    let pool: Vec<_> = numbers.map(|run| results_of(&points[run % RUNS], 1 + run as u64)).collect();
    let mut random = Pcg64::seed_from_u64(5);
    let (mut tries, mut contained, mut largest) = (Vec::new(), 0, 0.0f64);
    for _ in 0..20 {
        let (mut places, mut results) = (Vec::new(), Vec::new());
        for (place, point) in points.iter().enumerate() {
            for state in drawn(STATES, &mut random) {
                places.push(point.clone());
                results.push(pool[place + RUNS * state].clone());
            }
        }
        let measured = drawn(TARGET_STATES, &mut random).into_iter();
        let measured: Vec<_> = measured.map(|number| truths[number].clone()).collect();
        let targets = [0, 1].map(|result| target(&measured, result));
        let region = Region::new(&BOX, &targets, &places, &results).expect("enough runs");
        let (misfit, share) = (region.misfit(&TRUTH), region.share());
        contained += u32::from(misfit <= 1.0);
        largest = largest.max(share);
        tries.push(serde_json::json!({
            "slump": targets[0], "repose_angle": targets[1], "best": region.best(),
            "misfit": misfit, "share": share,
        }));
    }
    if let Ok(path) = std::env::var("SLUMP_REPORT") {
        let report = serde_json::json!({
            "program": "slump", "command": TEST, "grains": GRAINS, "mu": TRUTH[0], "bond": TRUTH[1], "box": BOX,
            "runs": RUNS * STATES[1], "states_of_targets": TARGET_STATES[1],
            "contained": contained, "largest_share": largest, "tries": tries,
        });
        write(path, format!("{report:#}\n"));
    }
    assert!(contained >= 18, "{contained} of 20");
    assert!(largest <= 0.25, "{largest}");
}
