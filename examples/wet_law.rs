//! A contact law of finite range that depends on the gap, as LMGC90's law for wet grains does (`IQS_WET_DS_CLB`): a
//! pair attracts with C₀ if its gap is at most W when a step begins.
//!
//! The example compares it with the paper's law, in which a pair attracts while it touches, and with `range`, in which
//! a pair attracts from its first touch until it has opened by δc = W. It prints the mean slump of sixteen piles at
//! three time steps, ± 95 %, with little restitution and with more.
//!
//! cargo run --release --example wet_law        # eight minutes on two cores

use std::time::Instant;

use rayon::prelude::*;
use slump::error::Result;
use slump::scene::{NewPile, pile_of, settle};
use slump::sim::{Advance, Settings, Stage, StepResult, Stepper};
use slump::solver::{Approach, Model};
use slump::study::mean;
use slump::world::Grain;

/// W and δc, in mean diameters.
const RANGE_IN_DIAMETERS: f64 = 0.01;
const TIME_STEPS_SECS: [f64; 3] = [2e-4, 1e-3, 5e-3];

struct Wet;

impl Advance for Wet {
    fn advance<M: Model>(&mut self, stage: &mut Stage<'_, M>, settings: &Settings) -> StepResult {
        let range = RANGE_IN_DIAMETERS * stage.world().mean_diameter;
        let time_step_secs = settings.parameters.time_step_secs;
        let restitution = settings.parameters.restitution;
        // A pair with a gap touches at the end of the step at the earliest; a pair in contact rebounds.
        let rebound = |Approach { gap, velocity, .. }| {
            if gap > 0.0 { gap / time_step_secs } else { restitution * velocity }
        };
        stage.prepare_within(settings, range, rebound);
        let report = stage.solve(settings);
        stage.move_by(report, settings)
    }
}

/// The compared contact laws.
#[derive(Clone, Copy)]
enum Law {
    Of(Stepper),
    Wet,
}

/// Contact parameters that all laws of a comparison share.
#[derive(Clone, Copy)]
struct Contacts {
    bond: f64,
    restitution: f64,
}

fn slump(grains: &[Grain], law: Law, contacts: Contacts, time_step_secs: f64) -> Result<f64> {
    let mut scene = pile_of(grains.to_vec(), NewPile::default().box_width_in_diameters)?;
    let mut settings = scene.settings().with_bond(contacts.bond).over(time_step_secs);
    settings.parameters.restitution = contacts.restitution;
    settings.parameters.restitution_threshold = 0.0;
    settings.parameters.debonding_distance = RANGE_IN_DIAMETERS;
    if let Law::Of(stepper) = law {
        settings.stepper = stepper;
    }
    scene.set_settings(settings);
    let mut simulation = scene.simulation()?;
    for _ in 0..scene.parameters.steps_in(scene.duration_secs) {
        match law {
            Law::Of(_) => simulation.step()?,
            Law::Wet => simulation.step_by(&mut Wet)?,
        };
    }
    Ok(simulation.observables().slump)
}

/// Formats a mean with half its 95 % interval.
fn written(values: &[f64]) -> String {
    let mean = mean(values);
    format!("{:+.3} ± {:.3}", mean.mean, mean.high - mean.mean)
}

/// Differences between piles of the same seed.
fn less(ones: &[f64], others: &[f64]) -> Vec<f64> {
    ones.iter().zip(others).map(|(one, other)| one - other).collect()
}

fn main() -> Result<()> {
    let seeds: Vec<u64> = (1..=17).filter(|&seed| seed != NewPile::default().seed).collect();
    let pile = |&seed: &u64| settle(&NewPile { seed, ..NewPile::default() }, |_| true);
    let piles = seeds.par_iter().map(pile).collect::<Result<Vec<_>>>()?;
    let of_piles = |law, contacts, time_step_secs| -> Result<Vec<f64>> {
        piles.par_iter().map(|grains| slump(grains, law, contacts, time_step_secs)).collect()
    };
    let laws = [
        ("moreau", Law::Of(Stepper::Moreau)),
        ("wet", Law::Wet),
        ("range", Law::Of(Stepper::Range)),
    ];
    for (bond, restitution) in [(8.0, 0.1), (20.0, 0.1), (50.0, 0.1), (8.0, 0.5), (20.0, 0.5)] {
        let contacts = Contacts { bond, restitution };
        let mut all = Vec::new();
        for (name, law) in laws {
            let begun = Instant::now();
            let slumps =
                TIME_STEPS_SECS.map(|time_step_secs| of_piles(law, contacts, time_step_secs));
            let [short, middle, long] = slumps;
            let [short, middle, long] = [short?, middle?, long?];
            println!(
                "Bond {bond}, ρ {restitution}, {name}: {}, {}, {}; the last less the first {}; {:.0} s",
                written(&short),
                written(&middle),
                written(&long),
                written(&less(&long, &short)),
                begun.elapsed().as_secs_f64()
            );
            all.push([short, middle, long].concat());
        }
        let apart = less(&all[1], &all[2]);
        println!(
            "Bond {bond}, ρ {restitution}, wet less range: {} at the shortest Δt, {} at all",
            written(&apart[..seeds.len()]),
            written(&of_seeds(&apart, seeds.len()))
        );
    }
    Ok(())
}

/// Means over Δt for each seed, because runs with one seed are not independent.
fn of_seeds(differences: &[f64], seeds: usize) -> Vec<f64> {
    let of_seed = |seed: usize| {
        let all: Vec<f64> = differences.iter().skip(seed).step_by(seeds).copied().collect();
        all.iter().sum::<f64>() / all.len() as f64
    };
    (0..seeds).map(of_seed).collect()
}
