//! Several heaps solved island by island against all of them as one problem: time of a step, steps that are not solved, and
//! what looking for islands costs where there is one.

mod common;

use std::hint::black_box;

use common::timing::{criterion, least_secs};
use glam::DVec2;
use slump::scene::{Deposition, NewPile, Scene, pile_of, settle};
use slump::sim::Simulation;
use slump::solver::{FrictionModel, Method, SolverSettings, StopTest};
use slump::world::Parameters;

/// Grains of a heap.
const GRAINS: usize = 138;
const BOX_WIDTH: f64 = 16.0;
/// Between the middles of two heaps, in diameters.
const APART: f64 = 60.0;
/// Steps that are timed together: the heaps begin to fall.
const STEPS: usize = 30;
const METHODS: [(Method, FrictionModel); 4] = [
    (Method::Nsgs, FrictionModel::Coulomb),
    (Method::Nncg, FrictionModel::Coulomb),
    (Method::Newton, FrictionModel::Coulomb),
    (Method::InteriorPoint, FrictionModel::Tresca),
];

/// So many heaps on one base, each dropped and rolled by a seed of its own.
fn heaps(count: usize) -> Scene {
    let heap = |seed: usize| {
        let pile = NewPile {
            grains: GRAINS,
            box_width_in_diameters: BOX_WIDTH,
            seed: seed as u64,
            deposition: Deposition::DropAndRoll,
        };
        let mut grains = settle(&pile, |_| true).expect("a pile at rest");
        let place = seed as f64 - 0.5 * (count - 1) as f64;
        let aside = 2.0 * grains[0].radius * APART * place;
        grains.iter_mut().for_each(|grain| grain.position += DVec2::new(aside, 0.0));
        grains
    };
    let grains: Vec<_> = (0..count).flat_map(heap).collect();
    let pile = pile_of(grains, APART * count as f64).expect("a pile");
    let parameters = Parameters {
        bond: 2.0,
        time_step_secs: 1e-3,
        restitution_threshold: 2.0,
        ..pile.parameters
    };
    Scene { parameters, ..pile }
}

fn started(scene: &Scene, solver: SolverSettings) -> Simulation {
    Scene { solver, ..scene.clone() }.simulation().expect("a proper scene")
}

fn main() {
    let mut criterion = criterion();
    let mut summary = Vec::new();
    for count in [1, 12] {
        let scene = heaps(count);
        for (method, friction_model) in METHODS {
            let mut time = |islands: bool| {
                let solver = SolverSettings {
                    method,
                    friction_model,
                    stop: StopTest::Residual,
                    tolerance: 1e-6,
                    max_sweeps: 1_000,
                    islands,
                    ..SolverSettings::SWEEPS
                };
                let start = started(&scene, solver);
                let mut unsolved = 0;
                let way = if islands { "islands" } else { "whole" };
                let name = format!("{count} heaps/{method}, {friction_model}, {way}");
                let secs = least_secs(&mut criterion, &name, || {
                    let mut simulation = start.clone();
                    unsolved = 0;
                    for _ in 0..STEPS {
                        let step = black_box(simulation.step().expect("a finite state"));
                        unsolved += u32::from(!step.converged);
                    }
                });
                (1e3 * secs / STEPS as f64, unsolved)
            };
            let ((whole, left_by_whole), (islands, left_by_islands)) = (time(false), time(true));
            summary.push(format!(
                "{count} heaps of {GRAINS}, {method}, {friction_model}: ms a step {whole:.3} as one problem, \
                 {islands:.3} island by island, ratio {:.2}; steps of {STEPS} not solved {left_by_whole} and \
                 {left_by_islands}",
                whole / islands
            ));
        }
    }
    println!("\nleast over all repeats:\n{}", summary.join("\n"));
    criterion.final_summary();
}
