//! Benchmark: compares searches for candidate pairs, that is pairs of discs that may touch soon. The searches are
//! Slump's own search (a grid or a tree, depending on the size ratio of the discs), the hashed cell grid alone, and
//! parry's bounding volume hierarchy traversed against itself. The hierarchy is rebuilt every time, or kept and
//! refitted to the moved grains, with or without parry's incremental optimisation. The benchmark first checks that all
//! searches give the same sorted list. It then times the update of the structure and the listing of the pairs, on one
//! thread.

mod common;

use std::hint::black_box;

use common::timing::{criterion, least_secs};
use criterion::Criterion;
use glam::DVec2;
use parry2d_f64::bounding_volume::Aabb;
use parry2d_f64::partitioning::{Bvh, BvhBuildStrategy, BvhWorkspace};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use slump::contact::{Candidates, Grid, Reach};
use slump::world::{Grain, Grains, Gravity, World};

/// Returns the radii of `count` discs, largest first, for a kind of size distribution.
fn radii(kind: &str, count: usize, random: &mut Pcg64) -> Vec<f64> {
    let mut radii: Vec<f64> = (0..count)
        .map(|index| match kind {
            "0.8-1.2 d" => random.random_range(0.4..0.6),
            "1:20 log-uniform" => 0.05 * 20f64.powf(random.random()),
            // One large disc for 200 small discs: the large discs fill about two thirds of the area of all discs.
            _ => {
                if index % 200 == 0 {
                    1.0
                } else {
                    0.05
                }
            }
        })
        .collect();
    radii.sort_by(|a, b| b.total_cmp(a));
    radii
}

/// Returns a world of discs without overlap, in random order. The discs fill at least half of a square.
fn packed(kind: &str, count: usize) -> World {
    let mut random = Pcg64::seed_from_u64(count as u64);
    let radii = radii(kind, count, &mut random);
    let area: f64 = radii.iter().map(|radius| std::f64::consts::PI * radius * radius).sum();
    let fill = if kind == "0.8-1.2 d" { 0.5 } else { 0.6 };
    let side = (area / fill).sqrt();
    let cells = (side / (2.0 * radii[0])).floor().max(1.0) as usize;
    let mut placed: Vec<Vec<(DVec2, f64)>> = vec![Vec::new(); cells * cells];
    let cell = |x: f64| ((x / side * cells as f64) as usize).min(cells - 1);
    let mut grains: Vec<Grain> = Vec::new();
    for radius in radii {
        let place = loop {
            let place = side * DVec2::new(random.random(), random.random());
            let (x, y) = (cell(place.x), cell(place.y));
            let near = |at: usize| at.saturating_sub(1)..(at + 2).min(cells);
            let free = near(x).all(|x| {
                near(y).all(|y| {
                    placed[x * cells + y]
                        .iter()
                        .all(|&(other, other_radius)| place.distance(other) > radius + other_radius)
                })
            });
            if free {
                break place;
            }
        };
        placed[cell(place.x) * cells + cell(place.y)].push((place, radius));
        grains.insert(random.random_range(0..=grains.len()), Grain::at_rest(place, radius));
    }
    let diameters: f64 = grains.iter().map(|grain| 2.0 * grain.radius).sum();
    World {
        mean_diameter: diameters / count as f64,
        grains: Grains::new(&grains, 1.0),
        fixed_discs: Vec::new(),
        boundaries: Vec::new(),
        motions: Vec::new(),
        gravity_turn: None,
        periodic: None,
        materials: Vec::new(),
        pairs: Vec::new(),
        gravity: Gravity::Uniform { acceleration: DVec2::ZERO },
    }
}

/// Returns the bounding box of each grain, enlarged by half the skin (m).
fn boxes(world: &World, skin: f64) -> impl Iterator<Item = Aabb> {
    let grains = world.grains.positions.iter().zip(&world.grains.radii);
    grains.map(move |(&place, &radius)| {
        Aabb::from_half_extents(place, DVec2::splat(radius + 0.5 * skin))
    })
}

fn near(world: &World, i: u32, j: u32, skin: f64) -> bool {
    let grains = &world.grains;
    let (i, j) = (i as usize, j as usize);
    grains.positions[i].distance(grains.positions[j]) < grains.radii[i] + grains.radii[j] + skin
}

/// Fills `pairs` with the sorted candidate pairs that are found by traversing the tree against itself.
fn walk(
    tree: &Bvh,
    workspace: &mut BvhWorkspace,
    world: &World,
    skin: f64,
    pairs: &mut Vec<(u32, u32)>,
) {
    pairs.clear();
    tree.traverse_bvtt_single_tree::<false>(workspace, &mut |i, j| {
        if near(world, i, j, skin) {
            pairs.push((i.min(j), i.max(j)));
        }
    });
    pairs.sort_unstable();
}

fn build(world: &World, skin: f64) -> Bvh {
    Bvh::from_iter(BvhBuildStrategy::Binned, boxes(world, skin).enumerate())
}

fn refit(tree: &mut Bvh, world: &World, skin: f64) {
    for (index, reach) in (0..).zip(boxes(world, skin)) {
        tree.insert_or_update_partially(reach, index, 0.0);
    }
    tree.refit_without_opt();
}

/// Returns a state in which single grains have moved by more than half the skin (m), so that the grid's list must be
/// rebuilt.
fn moved(world: &World, skin: f64) -> World {
    let mut moved = world.clone();
    let mut random = Pcg64::seed_from_u64(1);
    for place in &mut moved.grains.positions {
        let mut along = || 0.6 * skin * random.random_range(-1.0..1.0);
        *place += DVec2::new(along(), along());
    }
    moved
}

/// Checks that all searches give the same list on two states, and returns the list of the second state. `tree` was
/// built for the second state.
fn checked_pairs(
    states: [&World; 2],
    skin: f64,
    candidates: &mut Candidates,
    tree: &mut Bvh,
) -> Vec<(u32, u32)> {
    let (mut workspace, mut pairs) = (BvhWorkspace::default(), Vec::new());
    for state in states {
        assert!(candidates.update::<2>(state), "built anew");
        let list = |i: u32| candidates.of(i as usize).iter().map(move |&j| (i, j));
        let expected: Vec<(u32, u32)> = (0..state.grains.len() as u32).flat_map(list).collect();
        walk(&build(state, skin), &mut workspace, state, skin, &mut pairs);
        assert_eq!(pairs, expected);
        refit(tree, state, skin);
        walk(tree, &mut workspace, state, skin, &mut pairs);
        assert_eq!(pairs, expected);
    }
    pairs
}

/// Times all searches on `count` discs, and returns one line that summarises the times.
fn compare(criterion: &mut Criterion, kind: &str, count: usize) -> String {
    let world = packed(kind, count);
    let skin = 0.2 * world.mean_diameter;
    let moved = moved(&world, skin);
    let mut states = [&world, &moved].into_iter().cycle();
    let mut next = || states.next().expect("they go round");

    let reach = Reach { skin, gap_tolerance: 0.0 };
    let mut candidates = Candidates::new(&world, reach).expect("no boundaries");
    let (mut tree, mut kept) = (build(&world, skin), build(&world, skin));
    let mut pairs = checked_pairs([&moved, &world], skin, &mut candidates, &mut tree);
    let (mut workspace, pair_count) = (BvhWorkspace::default(), pairs.len());

    let mut time = |method: &str, routine: &mut dyn FnMut()| {
        1e3 * least_secs(criterion, &format!("{kind}/{count}/{method}"), routine)
    };
    next();
    let of_ours = time("as the program does it", &mut || {
        assert!(black_box(&mut candidates).update::<2>(next()), "built anew");
    });
    let mut grid = Grid::default();
    let width = 2.0 * world.grains.radii.iter().copied().fold(0.0, f64::max) + skin;
    let of_grid = time("grid", &mut || {
        let world = next();
        grid.rebuild::<2>(&world.grains.positions, width);
        pairs.clear();
        grid.pairs::<2>(|i, j| {
            if near(world, i, j, skin) {
                pairs.push((i.min(j), i.max(j)));
            }
        });
        pairs.sort_unstable();
    });
    let of_new = time("parry, built anew", &mut || {
        let world = next();
        walk(black_box(&build(world, skin)), &mut workspace, world, skin, &mut pairs);
    });
    let of_kept = time("parry, refitted and optimised", &mut || {
        let world = next();
        refit(&mut kept, world, skin);
        kept.optimize_incremental(&mut workspace);
        walk(black_box(&kept), &mut workspace, world, skin, &mut pairs);
    });
    let of_refit = time("parry, refitted", &mut || {
        let world = next();
        refit(&mut tree, world, skin);
        walk(black_box(&tree), &mut workspace, world, skin, &mut pairs);
    });
    let [new, kept, refit] = [of_new, of_kept, of_refit].map(|of_parry| of_grid / of_parry);
    format!(
        "{kind}, {count} discs, {pair_count} pairs: the program {of_ours:.2} ms; grid {of_grid:.2}; parry \
         built anew {of_new:.2}, refitted and optimised {of_kept:.2}, refitted {of_refit:.2}; \
         grid / parry {new:.2}, {kept:.2}, {refit:.2}"
    )
}

fn main() {
    let mut criterion = criterion();
    let mut summary = Vec::new();
    for kind in ["0.8-1.2 d", "1:20 log-uniform", "1:20, one large for 200 small"] {
        for count in [2_000, 10_000] {
            summary.push(compare(&mut criterion, kind, count));
        }
    }
    println!("\nleast over all repeats:\n{}", summary.join("\n"));
    criterion.final_summary();
}
