//! Benchmark: time to compute all granular measures of one moment, for 10,000 discs on a floor.

mod common;

use std::hint::black_box;

use common::timing::{criterion, least_secs};
use glam::DVec2;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use slump::granular::measure;
use slump::scene::built_in;
use slump::world::{Boundary, Grain};

const COLUMNS: usize = 100;

fn main() {
    let mut random = Pcg64::seed_from_u64(1);
    let mut scene = built_in("pile").expect("the pile");
    let radius = 0.5 * scene.mean_diameter;
    let grains = (0..COLUMNS * COLUMNS).map(|index| {
        let (row, column) = (index / COLUMNS, index % COLUMNS);
        let place = DVec2::new((2 * column + row % 2) as f64, 1.0 + row as f64 * 3f64.sqrt());
        Grain::at_rest(radius * place, radius * random.random_range(0.96..1.04))
    });
    scene.grains = grains.collect();
    scene.fixed_discs.clear();
    scene.boundaries = vec![Boundary::HalfSpace { point: DVec2::ZERO, normal: DVec2::Y }];
    scene.solver.max_sweeps = 40;
    let mut simulation = scene.simulation().expect("a proper scene");
    simulation.take_steps(20).expect("finite steps");
    let moment = simulation.moment();
    let mut criterion = criterion();
    let secs = least_secs(&mut criterion, "measures of 10,000 grains", || {
        black_box(measure(black_box(&moment)));
    });
    let (grains, contacts) = (moment.grains.len(), moment.contacts.len());
    println!("{grains} grains, {contacts} contacts: {:.2} ms", 1e3 * secs);
    criterion.final_summary();
}
