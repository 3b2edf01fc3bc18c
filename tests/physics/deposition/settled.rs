//! Piles that have come to rest.

use crate::common::*;
use slump::config::{Config, read_scene};

/// d, m.
const DIAMETER: f64 = 5e-3;

fn pile(grains: usize, width: f64, seed: u64) -> NewPile {
    let deposition = Deposition::DropAndRoll;
    NewPile { grains, box_width_in_diameters: width, seed, deposition }
}

fn walled(grains: Vec<Grain>, width: f64) -> Scene {
    let wall = |side: f64| Boundary::HalfSpace {
        point: DVec2::new(0.5 * side * width * DIAMETER, 0.0),
        normal: DVec2::new(-side, 0.0),
    };
    let pile = pile_of(grains, width).expect("a pile");
    Scene { boundaries: vec![wall(-1.0), wall(1.0)], ..pile }
}

/// Mean kinetic energy of a grain, in m g d.
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
        // Without cohesion, and as it comes.
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
        // It is the walls that hold it: the check above can fail.
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
    let refused = |pile: NewPile| deposit(&pile, |_| true).expect_err("none").to_string();
    assert!(refused(pile(0, 16.0, 1)).starts_with("grains is 0, but must be"));
    for width in [1.0, -4.0, f64::NAN, f64::INFINITY] {
        assert!(refused(pile(5, width, 1)).starts_with("box-width is "));
    }
    let interrupted = deposit(&pile(50, 16.0, 1), |_| false).expect_err("interrupted");
    assert!(interrupted.to_string().contains("interrupted"));
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
        let simulation = after(&scene, 50);
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
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("scene.toml");
    let read = |source: &str| {
        std::fs::write(&path, format!("{head}\n{source}\n{arrays}")).expect("written");
        read_scene(&path).map(|scene| scene.grains)
    };
    let dropped = read(&format!("{source}deposition = \"drop-and-roll\"\n")).expect("a scene");
    assert!(dropped == asked.grains);
    // Files from before there was a choice.
    let rained = read(&source.replace("new-pile", "rain")).expect("a scene");
    assert_eq!(rained, read(source).expect("a scene"));
    assert!(rained != dropped);
    assert!(read(&format!("{source}deposition = \"pour\"\n")).is_err());
}
